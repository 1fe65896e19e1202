// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question: what the calls that overhead.py times in Python cost in C++. Prints one JSON object of microseconds: the
// fastest of some rounds, on the calling thread and oneTBB's.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <vector>

#include "limber/limber.h"

namespace {

using limber::Corners;
using limber::Vec3;

/// The fastest of `rounds` times of call(), in microseconds.
template <typename Call>
double fastest_us(int rounds, const Call& call) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < rounds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call();
    const std::chrono::duration<double, std::micro> elapsed = std::chrono::steady_clock::now() - start;
    best = std::min(best, elapsed.count());
  }
  return best;
}

limber::Mesh tetrahedron() {
  return limber::Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {Corners{0, 2, 1}, Corners{0, 1, 3}, Corners{1, 2, 3}, Corners{2, 0, 3}})
      .value();
}

/// A flat square of n x n squares, as overhead.py makes it.
limber::Mesh sheet(std::uint32_t n) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) positions.push_back({double(i) / n, double(j) / n, 0});
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      triangles.push_back({a, a + 1, a + n + 2});
      triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return limber::Mesh::create(std::move(positions), std::move(triangles)).value();
}

std::vector<float> frame_of(const limber::Mesh& mesh, double height) {
  std::vector<float> coordinates;
  for (const Vec3& p : mesh.positions()) {
    coordinates.insert(coordinates.end(), {float(p.x), float(p.y), float(height * p.x * p.y)});
  }
  return coordinates;
}

}  // namespace

int main() {
  constexpr int calls = 20'000;
  const limber::Model a(tetrahedron()), b(tetrahedron());
  std::vector<limber::Transform> poses(calls);
  for (int i = 0; i < calls; ++i) poses[i].translation = {3 + i / double(calls), 0, 0};
  double sum = 0;
  const double distance_us = fastest_us(20, [&] {
    for (int i = 0; i < calls; ++i) sum += limber::distance({a}, {b, poses[i]}).upper;
  });
  const double collide_us = fastest_us(20, [&] {
    for (int i = 0; i < calls; ++i) sum += limber::collide({a}, {b, poses[i]}).is_yes();
  });

  const limber::Mesh mesh = sheet(316);
  limber::Model cloth(mesh);
  const std::vector<float> frames[] = {frame_of(mesh, 0.1), frame_of(mesh, 0.2)};
  int turn = 0;
  const double frame_us = fastest_us(60, [&] {
    cloth.move_all(limber::PositionsView::packed(frames[++turn % 2])).value();
    cloth.commit();
  });
  std::printf(R"({"distance_us": %.5f, "collide_us": %.5f, "frame_us": %.2f, "sum": %.17g})"
              "\n",
              distance_us / calls, collide_us / calls, frame_us, sum);
}
