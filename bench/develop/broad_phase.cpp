// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        Which structure finds pairs of overlapping boxes fastest, when all of them are new in each frame?
// Workload        Boxes of edge 2 spread out in a cube, with two pairs a box; in a flat layer; of edges 0.02 to 20; and
//                 with one box far away. All random, nothing known from the frame before.
// Metric          Time to build the structure and to find all pairs, minimum of the frames, one thread.
// Expected shape  A sweep costs more per box the more boxes there are. A grid is good for boxes of one size. A tree is
//                 never far from the best.
// Checked         All find the same pairs.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "scene/box_tree.h"
#include "scenes/scenes.h"
#include "simd/kernels.h"

namespace limber::bench {
namespace {

using scene::WorldBounds;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

bool overlap(const Box& a, const Box& b) { return scene::gaps(a, b) == Vec3{}; }

/// Finds pairs, lower index first, in any order.
class Structure {
 public:
  virtual ~Structure() = default;
  virtual void build(const std::vector<WorldBounds>& bounds) = 0;
  virtual void find(Pairs& pairs) = 0;

 protected:
  static void add(std::uint32_t i, std::uint32_t j, Pairs& pairs) {
    pairs.emplace_back(std::min(i, j), std::max(i, j));
  }
};

/// What scenes use.
class Tree : public Structure {
 public:
  void build(const std::vector<WorldBounds>& bounds) override {
    ids_.resize(bounds.size());
    std::iota(ids_.begin(), ids_.end(), 0U);
    tree_.build(ids_, bounds);
  }
  void find(Pairs& pairs) override {
    for (std::uint32_t leaf = 0; leaf < tree_.leaf_count(); ++leaf) {
      tree_.visit_pairs(leaf, 0, [&](std::uint32_t a, std::uint32_t b) {
        add(tree_.id_of(a), tree_.id_of(b), pairs);
        return true;
      });
    }
  }

 private:
  std::vector<std::uint32_t> ids_;
  scene::BoxTree tree_;
};

/// Boxes in the order of where they begin along the axis that they are spread most along; each is compared, eight at a
/// time, with those that begin before it ends.
class Sweep : public Structure {
 public:
  void build(const std::vector<WorldBounds>& bounds) override {
    Vec3 mean, square;
    for (const WorldBounds& b : bounds) mean += b.sphere.center * (1 / static_cast<double>(bounds.size()));
    for (const WorldBounds& b : bounds) {
      const Vec3 d = b.sphere.center - mean;
      square += Vec3{d.x * d.x, d.y * d.y, d.z * d.z};
    }
    axis_ = square.x >= square.y ? (square.x >= square.z ? 0 : 2) : (square.y >= square.z ? 1 : 2);
    begins_.clear();
    for (std::uint32_t i = 0; i < bounds.size(); ++i) begins_.emplace_back(bounds[i].box.low[axis_], i);
    std::sort(begins_.begin(), begins_.end());
    boxes_.resize((bounds.size() + bvh::width - 1) / bvh::width);
    sorted_.clear();
    for (std::size_t i = 0; i < boxes_.size() * bvh::width; ++i) {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
      if (i < bounds.size()) box = bounds[begins_[i].second].box;
      if (i < bounds.size()) sorted_.push_back(box);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        boxes_[i / bvh::width].low[axis][i % bvh::width] = box.low[axis];
        boxes_[i / bvh::width].high[axis][i % bvh::width] = box.high[axis];
      }
    }
  }
  void find(Pairs& pairs) override {
    const simd::Kernels& kernels = simd::kernels();
    for (std::uint32_t i = 0; i < sorted_.size(); ++i) {
      const Box& box = sorted_[i];
      unsigned after = ~0U << (i % bvh::width + 1);
      for (std::size_t k = i / bvh::width; k < boxes_.size() && boxes_[k].low[axis_][0] <= box.high[axis_]; ++k) {
        unsigned found = kernels.overlapping_boxes(boxes_[k], box.low, box.high) & std::exchange(after, ~0U);
        for (; found != 0; found &= found - 1) {
          add(begins_[i].second, begins_[k * bvh::width + static_cast<std::size_t>(std::countr_zero(found))].second,
              pairs);
        }
      }
    }
  }

 private:
  std::size_t axis_ = 0;
  std::vector<std::pair<double, std::uint32_t>> begins_;
  std::vector<Box> sorted_;
  std::vector<bvh::WideBoxes> boxes_;
};

/// Cells as large as the largest box, hashed; each box is in the cell of its center.
class Grid : public Structure {
 public:
  void build(const std::vector<WorldBounds>& bounds) override {
    double edge = 0;
    Vec3 low = bounds[0].sphere.center;
    for (const WorldBounds& b : bounds) edge = std::max(edge, max_abs(b.box.high - b.box.low));
    for (const WorldBounds& b : bounds) low = min(low, b.sphere.center);
    buckets_ = std::bit_ceil(2 * bounds.size());
    begin_.assign(buckets_ + 1, 0);
    cells_.resize(bounds.size()), entries_.resize(bounds.size());
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
      const Vec3 at = (bounds[i].sphere.center - low) * (1 / edge);
      const auto cell = [](double x) { return static_cast<std::int32_t>(std::min(x, 1e9)); };
      cells_[i] = {cell(at.x), cell(at.y), cell(at.z)};
      ++begin_[bucket(cells_[i]) + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
      entries_[next[bucket(cells_[i])]++] = {cells_[i], i, bounds[i].box};
    }
  }
  void find(Pairs& pairs) override {
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      const Entry& entry = entries_[e];
      // Half of the neighbors, and its own cell.
      for (int neighbor = 13; neighbor < 27; ++neighbor) {
        const Cell cell{entry.cell.x + neighbor % 3 - 1, entry.cell.y + neighbor / 3 % 3 - 1,
                        entry.cell.z + neighbor / 9 - 1};
        const std::size_t b = bucket(cell);
        for (std::size_t k = neighbor == 13 ? e + 1 : begin_[b]; k < begin_[b + 1]; ++k) {
          const Entry& other = entries_[k];
          if (other.cell == cell && overlap(entry.box, other.box)) add(entry.index, other.index, pairs);
        }
      }
    }
  }

 private:
  struct Cell {
    std::int32_t x, y, z;
    bool operator==(const Cell&) const = default;
  };
  struct Entry {
    Cell cell;
    std::uint32_t index;
    Box box;
  };
  std::size_t bucket(const Cell& c) const {
    const auto part = [](std::int32_t x, std::uint32_t by) { return static_cast<std::uint32_t>(x) * by; };
    return (part(c.x, 73'856'093U) ^ part(c.y, 19'349'663U) ^ part(c.z, 83'492'791U)) & (buckets_ - 1);
  }

  std::size_t buckets_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> begin_;
  std::vector<Entry> entries_;
};

/// A frame of a workload.
std::vector<WorldBounds> boxes_of(const std::string& workload, std::size_t count, scenes::Rng& rng) {
  const bool is_flat = workload == "flat";
  const double pairs_per_body = 2, n = static_cast<double>(count) / (2 * pairs_per_body);
  const double side = 4 * (is_flat ? std::sqrt(n) : std::cbrt(n));
  std::vector<WorldBounds> all;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 at{rng.uniform(0, side), rng.uniform(0, side), is_flat ? rng.uniform(0, 1) : rng.uniform(0, side)};
    if (workload == "one far away" && i == 5) at = {1e12, -1e12, 1e9};
    double half = 1;
    if (workload == "many sizes") half = rng.below(200) == 0 ? 10 : 0.01 * std::exp2(rng.uniform(0, 6.6));
    // Spheres as large as the boxes, so that boxes decide.
    all.push_back({{at - half * Vec3{1, 1, 1}, at + half * Vec3{1, 1, 1}}, {at, 2 * half}});
  }
  return all;
}

int run(const Options& options) {
  Checker checker;
  Markdown text(options, "develop_broad_phase.md");
  text.line("# Structures for boxes that are all new, as printed by `limber_bench_broad_phase`\n");
  text.line("Microseconds to build and to find all pairs, minimum over the frames, one thread.\n");
  text.line("| boxes | workload | pairs | tree: build | find | sweep: build | find | grid: build | find |");
  text.line("|--:|:--|--:|--:|--:|--:|--:|--:|--:|");
  for (const std::size_t count : {200, 2000, 20'000}) {
    for (const char* workload : {"spread out", "flat", "many sizes", "one far away"}) {
      scenes::Rng rng(3);
      Tree tree;
      Sweep sweep;
      Grid grid;
      Structure* const structures[] = {&tree, &sweep, &grid};
      double build_us[3] = {1e300, 1e300, 1e300}, find_us[3] = {1e300, 1e300, 1e300};
      Pairs pairs[3];
      const int frames = options.quick ? 2 : count > 2000 ? 30 : 200;
      for (int frame = 0; frame < frames; ++frame) {
        const std::vector<WorldBounds> bounds = boxes_of(workload, count, rng);
        for (int s = 0; s < 3; ++s) {
          pairs[s].clear();
          build_us[s] = std::min(build_us[s], mean_us(1, [&] { structures[s]->build(bounds); }));
          find_us[s] = std::min(find_us[s], mean_us(1, [&] { structures[s]->find(pairs[s]); }));
          std::sort(pairs[s].begin(), pairs[s].end());
          checker.check(pairs[s] == pairs[0], "{}, {}: {} pairs instead of {}", workload, s, pairs[s].size(),
                        pairs[0].size());
        }
      }
      text.line("| {} | {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |", count, workload,
                pairs[0].size(), build_us[0], find_us[0], build_us[1], find_us[1], build_us[2], find_us[2]);
    }
  }
  return checker.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  const auto [options, exit_code] =
      limber::bench::parse_options(argc, argv, "Which structure finds pairs of overlapping boxes fastest");
  if (exit_code) return *exit_code;
  return limber::bench::run(options);
}
