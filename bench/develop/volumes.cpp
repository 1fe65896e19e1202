// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  What does each bounding volume of the fast engine's nodes save, in tests and in time?
// Workload  Ball over square (aligned, and both turned together) and any two mesh files, at gaps of 0 to 10 times the
//           size, 16 seeded poses each; exact distance, without a cache.
// Metric    Node tests, triangle tests and microseconds: median over the poses, and the worst. Variants are
//           interleaved.
// Shape     The engine itself runs. A volume is switched off by making it too large to prune anything, which leaves the
//           sphere.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bvh/tree.h"
#include "limber/io.h"
#include "limber/model.h"
#include "model/model_impl.h"
#include "scenes/scenes.h"

namespace limber {
namespace {

struct Variant {
  const char* name;
  bool box, slab;
};
constexpr Variant variants[] = {{"sphere", false, false},
                                {"sphere, box", true, false},
                                {"sphere, slab", false, true},
                                {"sphere, box, slab", true, true}};
constexpr double gaps[] = {0, 1e-4, 1e-2, 0.1, 1, 10};
constexpr int pose_count = 16, repeat_count = 7;

/// A model in which the volumes that the variant is without prune no more than the sphere.
Model weakened(const Mesh& mesh, const Variant& variant) {
  Model model(mesh);
  auto& tree = const_cast<bvh::Tree&>(model.impl().tree);  // belongs to this experiment
  for (bvh::WideNode& node : tree.nodes) {
    for (std::uint32_t k = 0; k < bvh::width; ++k) {
      bvh::ChildBounds& n = node.bounds;
      if (!variant.box) n.half_x[k] = n.half_y[k] = n.half_z[k] = n.radius[k];
      if (!variant.slab) n.low[k] = -n.radius[k], n.high[k] = n.radius[k];
    }
  }
  return model;
}

double diagonal(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return length(high - low);
}

Vec3 center_of(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return (low + high) * 0.5;
}

/// Slides b along `outward` until the gap is right. No step goes too far, because its length is a distance.
Transform placed_at_gap(const Model& a, const Model& b, Transform pose, const Vec3& outward, double gap) {
  for (int step = 0; step < 100; ++step) {
    const double found = distance({a}, {b, pose}).upper;
    if (std::abs(found - gap) <= 1e-9) break;
    pose.translation += outward * (gap - found);
  }
  return pose;
}

struct Sample {
  double node_tests = 0, triangle_tests = 0, elapsed_us = 1e300;
};

Sample& measure(Sample& sample, const Model& a, const Model& b, const Transform& pose) {
  const auto start = std::chrono::steady_clock::now();
  const DistanceResult result = distance({a}, {b, pose});
  const std::chrono::duration<double, std::micro> elapsed = std::chrono::steady_clock::now() - start;
  sample = {static_cast<double>(result.stats.node_tests), static_cast<double>(result.stats.triangle_tests),
            std::min(sample.elapsed_us, elapsed.count())};
  return sample;
}

std::string cell(std::vector<Sample> samples) {
  const auto median = [&](double Sample::*value) {
    std::ranges::sort(samples, {}, value);
    return samples[samples.size() / 2].*value;
  };
  char text[100];
  const double nodes = median(&Sample::node_tests), triangles = median(&Sample::triangle_tests);
  const double elapsed = median(&Sample::elapsed_us);
  std::snprintf(text, sizeof text, "%.0f / %.0f / %.1f (%.0f)", nodes, triangles, elapsed, samples.back().elapsed_us);
  return text;
}

void compare(const char* scene, const Mesh& mesh_a, const Mesh& mesh_b, bool aligned) {
  std::vector<Model> a, b;
  for (const Variant& variant : variants) {
    a.push_back(weakened(mesh_a, variant));
    b.push_back(weakened(mesh_b, variant));
  }
  const double size = std::max(diagonal(mesh_a), diagonal(mesh_b));
  std::vector<std::vector<std::vector<Sample>>> table(std::size(variants),
                                                      std::vector<std::vector<Sample>>(std::size(gaps)));
  scenes::Rng rng(7);
  for (int p = 0; p < pose_count; ++p) {
    Transform start{scenes::random_rotation(rng), {}};
    Vec3 outward = scenes::random_rotation(rng).row0;
    if (aligned) outward = {0, 0, 1};
    start.translation = center_of(mesh_a) + outward * (3 * size) - start.rotation * center_of(mesh_b);
    for (std::size_t g = 0; g < std::size(gaps); ++g) {
      const Transform pose = placed_at_gap(a.back(), b.back(), start, outward, gaps[g] * size);
      std::vector<Sample> samples(std::size(variants));
      for (int repeat = 0; repeat < repeat_count; ++repeat) {
        for (std::size_t v = 0; v < std::size(variants); ++v) measure(samples[v], a[v], b[v], pose);
      }
      for (std::size_t v = 0; v < std::size(variants); ++v) table[v][g].push_back(samples[v]);
    }
  }
  std::printf("\n### %s\n\n| node tests / triangle tests / us (worst us), gap |", scene);
  for (const double gap : gaps) std::printf(" %g |", gap);
  std::printf("\n|:--|");
  for (std::size_t g = 0; g < std::size(gaps); ++g) std::printf("--:|");
  for (std::size_t v = 0; v < std::size(variants); ++v) {
    std::printf("\n| %s |", variants[v].name);
    for (std::size_t g = 0; g < std::size(gaps); ++g) std::printf(" %s |", cell(table[v][g]).c_str());
  }
  std::printf("\n");
  std::fflush(stdout);
}

Mesh turned(const Mesh& mesh, const Mat3& rotation) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p = rotation * p;
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// A sheet whose vertices are displaced at random, so that its slabs prune little.
Mesh noisy_sheet() {
  scenes::Rng rng(13);
  const Mesh flat = scenes::grid(100, 100, 0, 0, 1, 1);
  std::vector<Vec3> positions = flat.positions();
  for (Vec3& p : positions) p += Vec3{rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-1, 1)};
  return Mesh::create(std::move(positions), flat.triangles()).value();
}

}  // namespace
}  // namespace limber

int main(int argc, char** argv) {
  using namespace limber;
  scenes::Rng rng(11);
  const Mat3 rotation = scenes::random_rotation(rng);
  compare("Ball over square", scenes::thesis_square(), scenes::thesis_ball(), true);
  compare("Ball and square, turned together", turned(scenes::thesis_square(), rotation), scenes::thesis_ball(), false);
  compare("Two sheets of noise", noisy_sheet(), noisy_sheet(), false);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto a = load_mesh(argv[i]), b = load_mesh(argv[i + 1]);
    if (!a || !b) return std::fprintf(stderr, "%s\n", (!a ? a : b).error().text.c_str()), 2;
    const auto name = [](std::string path) { return path.substr(path.find_last_of('/') + 1); };
    compare((name(argv[i]) + " and " + name(argv[i + 1])).c_str(), *a, *b, false);
  }
}
