// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A force loop at 1 kHz: a tool is pressed into tissue that gives way, and every tick has a deadline.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <thread>

#include "limber/distance.h"
#include "proxy.h"
#include "shapes.h"

int main() {
  using namespace std::chrono_literals;
  constexpr int ticks = 500;
  limber::Model tissue(shapes::sheet(60, 6), limber::ModelOptions::real_time(10));  // 10 us of each commit for the tree
  const limber::Model tool(shapes::ball(32));
  std::vector<limber::VertexId> soft;  // what gives way: the vertices below the tool
  for (limber::VertexId v = 0; v < tissue.mesh().positions().size(); ++v) {
    if (length(tissue.mesh().positions()[v]) < 1) soft.push_back(v);
  }
  std::vector<limber::Vec3> positions(soft.size());
  Proxy proxy{.place = {0, 0, 1.5}, .standoff = 0.05, .retreat = 0.01};
  limber::QueryCache cache;
  (void)limber::distance({tissue}, {tool, {{}, proxy.place}}, {.cache = &cache});  // allocates before the loop

  double largest_force = 0, nearest = 1;
  int late = 0, wrong = 0;
  auto time = std::chrono::steady_clock::now();
  for (int tick = 0; tick < ticks; ++tick, time += 1ms) {
    std::this_thread::sleep_until(time);
    const double turn = 2 * std::numbers::pi * tick / ticks;
    const limber::Vec3 device{0.2 * std::sin(turn), 0, 1 + 0.5 * std::cos(turn)};  // 0.5 deep at most
    const double depth = 0.5 * std::max(0.0, 1 - device.z);
    for (std::size_t i = 0; i < soft.size(); ++i) {
      const limber::Vec3 p = tissue.mesh().positions()[soft[i]];
      positions[i] = {p.x, p.y, -depth * (1 - p.x * p.x - p.y * p.y)};
    }
    tissue.move_vertices(soft, positions).value();
    tissue.commit();

    const limber::Placed placed{tool, {{}, proxy.place}};
    const auto deadline = std::chrono::steady_clock::now() + 100us;
    const limber::DistanceResult found = limber::distance(
        {tissue}, placed,
        {.relative_error = 0.1, .max_distance = 0.2, .cache = &cache, .budget = {.deadline = deadline}});
    proxy.follow(device, found);
    largest_force = std::max(largest_force, 0.5 * length(proxy.place - device));  // a spring of 0.5 N a unit

    late += found.status == limber::DistanceStatus::interrupted ? 1 : 0;
    const double exact = limber::distance({tissue}, placed).upper;  // for this example: what the interval has to hold
    wrong += found.lower > exact + 1e-12 || found.upper < exact - 1e-12 ? 1 : 0;
    nearest = std::min(nearest, exact);
  }
  std::printf("largest force %.2f N, never nearer than %.3f; %d of %d ticks interrupted\n", largest_force, nearest,
              late, ticks);
  return wrong == 0 && largest_force > 0.1 ? 0 : 1;
}
