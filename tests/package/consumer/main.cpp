// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limber/eigen.h>
#include <limber/io.h>
#include <limber/limber.h>

#include <cstdio>

int main() {
  const limber::Mesh square =
      limber::Mesh::create({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}).value();
  const limber::Model a(square), b(square);
  Eigen::Isometry3d pose_b = Eigen::Isometry3d::Identity();
  pose_b.translation().z() = 3;
  const double distance = limber::distance({a}, {b, limber::transform_from_eigen(pose_b).value()}).upper;
  try {
    static_cast<void>(limber::load_mesh("missing.obj").value());
  } catch (const limber::BadResult& missing) {
    std::printf("%g apart; %s\n", distance, missing.what());
    return distance == 3 ? 0 : 1;
  }
  return 1;
}
