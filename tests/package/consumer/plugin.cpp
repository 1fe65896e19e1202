// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limber/io.h>
#include <limber/limber.h>

extern "C" __attribute__((visibility("default"))) double distance_to_itself_raised_by(const char* mesh_file,
                                                                                      double height) {
  const limber::Model model(limber::load_mesh(mesh_file).value());
  return limber::distance({model}, {model, {{}, {0, 0, height}}}).upper;
}
