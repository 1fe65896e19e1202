// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The workloads of bench.js, natively on one thread: a line for each with its name, its answer, and minimum and median
// in us.
// Inputs are computed by the same IEEE operations in both, so answers are equal to the bit.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/points.h"

namespace {

using namespace limber;

/// Times runs of `body`, each given its number, and prints the sum of what they return.
template <typename Body>
void measure(const char* name, int runs, const Body& body) {
  std::vector<double> us;
  double answer = 0;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    answer += body(i);
    us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(us.begin(), us.begin() + runs / 2, us.end());
  const double median = us[static_cast<std::size_t>(runs / 2)], least = *std::min_element(us.begin(), us.end());
  std::printf("%s\t%a\t%.9g\t%.9g\n", name, answer, least, median);
}

constexpr int squares = 100;

/// A wave of period 1 between -1 and 1.
double wave(double x) {
  const double u = x - std::floor(x), v = u < 0.5 ? u : u - 0.5;
  return (u < 0.5 ? 16 : -16) * v * (0.5 - v);
}

/// A sheet of 20 000 triangles that waves above the bunny, in float32.
std::vector<float> sheet_positions(int frame) {
  std::vector<float> positions;
  for (int j = 0; j <= squares; ++j) {
    for (int i = 0; i <= squares; ++i) {
      const double x = 0.004 * i - 0.2, y = 0.004 * j - 0.1;
      positions.push_back(static_cast<float>(x)), positions.push_back(static_cast<float>(y));
      positions.push_back(static_cast<float>(0.12 + 0.01 * wave(6 * x + 0.06 * frame) * wave(8 * y - 0.04 * frame)));
    }
  }
  return positions;
}

std::vector<Corners> sheet_triangles() {
  std::vector<Corners> triangles;
  for (VertexId j = 0; j < squares; ++j) {
    for (VertexId i = 0; i < squares; ++i) {
      const VertexId a = j * (squares + 1) + i, d = a + squares + 1;
      triangles.push_back({a, a + 1, d + 1}), triangles.push_back({a, d + 1, d});
    }
  }
  return triangles;
}

Transform shift(double x, double y) { return {Mat3{}, {x, y, 0}}; }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: limber_web_bench FOLDER, with stanford-bunny.obj and armadillo.obj\n";
    return 2;
  }
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const std::string folder = std::string(argv[1]) + "/";
  const auto read = [&](const char* name) { return load_mesh(folder + name).value(); };
  measure("read stanford-bunny.obj", 5,
          [&](int) { return static_cast<double>(read("stanford-bunny.obj").triangles().size()); });
  const Mesh bunny_mesh = read("stanford-bunny.obj");
  measure("build a tree of 69 451 triangles", 5, [&](int) { return Model(bunny_mesh).bounding_sphere().radius; });
  const Model bunny(bunny_mesh), armadillo(read("armadillo.obj"));

  Model sheet(Mesh::create(PositionsView::packed(sheet_positions(0)), sheet_triangles()).value());
  std::vector<std::vector<float>> frames;
  for (int frame = 0; frame < 300; ++frame) frames.push_back(sheet_positions(frame));
  const auto move_all = [&](int i) {
    sheet.move_all(PositionsView::packed(frames[static_cast<std::size_t>(i)])).value();
    return 0.0;
  };
  const auto commit = [&](int) { return sheet.commit(), 0.0; };
  const auto distance_to_bunny = [&](int) { return distance(sheet, bunny).upper; };
  measure("frame: move 20 000 triangles, commit, distance to 69 451", 300, [&](int i) {
    move_all(i), commit(i);
    return distance_to_bunny(i);
  });
  measure("move_all of 10 201 vertices", 300, move_all);
  std::vector<VertexId> ids;
  std::vector<float> moved;
  for (VertexId v = 0; v < 500; ++v)
    ids.push_back(v), moved.insert(moved.end(), frames[0].begin() + 3 * v, frames[0].begin() + 3 * v + 3);
  measure("move_vertices of 500 and commit", 300, [&](int i) {
    for (std::size_t v = 0; v < ids.size(); ++v) moved[3 * v + 2] = 0.125F + 0.0009765625F * static_cast<float>(i % 7);
    sheet.move_vertices(ids, PositionsView::packed(moved)).value();
    return commit(i);
  });
  measure("contacts of sheet and bunny within 0.002", 100, [&](int i) {
    std::size_t count = 0;
    const auto keep = [&](const Contact&) { return ++count, true; };
    visit_contacts(Placed(sheet), Placed(bunny, Transform{Mat3{}, {0, 0, 0.0546875 + 0.0009765625 * (i % 8)}}), 0.002,
                   keep);
    return static_cast<double>(count);
  });

  measure("distance of bunny and armadillo", 400, [&](int i) {
    return distance(bunny, {armadillo, shift(0.9 - 0.0009765625 * i, 0.015625 * (i % 7))}).upper;
  });
  QueryCache cache;
  measure("the same with a cache", 400, [&](int i) {
    return distance(bunny, {armadillo, shift(0.9 - 0.0009765625 * i, 0)}, {.cache = &cache}).upper;
  });
  measure("the same within 10 %", 400, [&](int i) {
    const Placed placed(armadillo, shift(0.9 - 0.0009765625 * i, 0.015625 * (i % 7)));
    return distance(bunny, placed, {.relative_error = 0.1}).upper;
  });
  measure("collide of bunny and armadillo", 400, [&](int i) {
    return collide(bunny, {armadillo, shift(0.6 - 0.0009765625 * i, 0.015625 * (i % 7))}).is_yes() ? 1.0 : 0.0;
  });
  measure("self_collide of 69 451 triangles", 20, [&](int) { return self_collide(bunny).is_yes() ? 1.0 : 0.0; });
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back({0.001 * (i % 37) - 0.02, 0.001 * (i % 101), 0.001 * (i % 53) + 0.05});
  std::vector<PointResult> closest(points.size());
  measure("closest points of 100 points and bunny", 200, [&](int) {
    closest_points(bunny, points, closest);
    return closest[50].closest->distance;
  });

  const Model one(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}).value());
  measure("100 distances of two triangles, with a pose", 2000, [&](int) {
    double sum = 0;
    for (int i = 0; i < 100; ++i) sum += distance(one, {one, Transform{Mat3{}, {0, 0, 1}}}).upper;
    return sum;
  });
}
