// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <fstream>

extern "C" double distance_to_itself_raised_by(const char* mesh_file, double height);

int main() {
  std::ofstream("triangle.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const double distance = distance_to_itself_raised_by("triangle.obj", 2);
  std::printf("%g apart\n", distance);
  return distance == 2 ? 0 : 1;
}
