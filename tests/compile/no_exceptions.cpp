// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <string_view>

#include "limber/limber.h"

// Makes the mistake that its argument names.
int main(int, char** arguments) {
  const std::string_view mistake = arguments[1];
  const limber::Model model(limber::Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}).value());
  if (mistake == "value") limber::Mesh::create({}, {}).value();
  if (mistake == "argument") static_cast<void>(limber::within({model}, {model}, -1));
  return 0;
}
