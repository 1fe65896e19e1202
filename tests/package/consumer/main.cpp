// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limber/limber.h>

#include <cstdio>

int main() {
  const limber::Mesh square =
      limber::Mesh::create({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}).value();
  const limber::Model a(square), b(square);
  const double distance = limber::distance({a}, {b, {{}, {0, 0, 3}}}).upper;
  std::printf("%g apart\n", distance);
  return distance == 3 ? 0 : 1;
}
