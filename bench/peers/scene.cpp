// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        How fast are candidate pairs of many moving bodies found, next to other libraries?
// Workload        Balls of 1 088 triangles that fly about in a box and bounce off its walls, a tenth of their radius a
//                 frame, turned at random. The box is so large that each has about as many pairs as the table says.
// Metric          Time of a frame: all poses set, boxes and tree brought up to date, all candidate pairs collected.
//                 All libraries have the same boxes; what they spend on computing their own is counted. One thread.
// Expected shape  A third of the time of FCL and Coal, or less.
// Checked         limber's pairs are among the others' pairs, which only know boxes; of those that are missing the
//                 balls are apart.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

constexpr double step = 0.1;

/// Bodies of radius 1 that move about in a cube.
class Swarm {
 public:
  Swarm(std::size_t count, double pairs_per_body) : rng_(17) {
    // Boxes of edge 2 overlap where their centers are less than 2 apart along all axes.
    side_ = 4 * std::cbrt(static_cast<double>(count) / (2 * pairs_per_body));
    for (std::size_t i = 0; i < count; ++i) {
      poses.push_back({scenes::random_rotation(rng_), {place(), place(), place()}});
      steps_.push_back(step * Vec3{rng_.uniform(-1, 1), rng_.uniform(-1, 1), rng_.uniform(-1, 1)});
    }
  }
  void move() {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Vec3& at = poses[i].translation;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at[axis] + steps_[i][axis] < 0 || at[axis] + steps_[i][axis] > side_) steps_[i][axis] = -steps_[i][axis];
      }
      at += steps_[i];
    }
  }

  std::vector<Transform> poses;

 private:
  double place() { return rng_.uniform(0, side_); }

  scenes::Rng rng_;
  double side_;
  std::vector<Vec3> steps_;
};

/// Times of the parts of a frame.
struct FrameTimes {
  std::vector<double> poses, update, pairs, whole;

  void add(double poses_us, double update_us, double pairs_us) {
    poses.push_back(poses_us), update.push_back(update_us), pairs.push_back(pairs_us);
    whole.push_back(poses_us + update_us + pairs_us);
  }
};

bool is_before(const ObjectPair& s, const ObjectPair& t) { return s.a != t.a ? s.a < t.a : s.b < t.b; }

/// Whether the pairs of boxes are limber's pairs and others whose balls are apart.
void check_pairs(const Swarm& swarm, std::vector<ObjectPair> ours, std::vector<ObjectPair> theirs,
                 const std::string& name, Checker& checker) {
  std::sort(ours.begin(), ours.end(), is_before);
  std::sort(theirs.begin(), theirs.end(), is_before);
  checker.check(std::includes(theirs.begin(), theirs.end(), ours.begin(), ours.end(), is_before),
                "{} lacks pairs that limber has", name);
  std::vector<ObjectPair> missing;
  std::set_difference(theirs.begin(), theirs.end(), ours.begin(), ours.end(), std::back_inserter(missing), is_before);
  for (const ObjectPair& pair : missing) {
    const double between = length(swarm.poses[pair.a].translation - swarm.poses[pair.b].translation);
    checker.check(between > 2, "limber lacks a pair that {} has, {} apart", name, between);
  }
}

class Frames {
 public:
  Frames(const Mesh& shape, std::size_t count, double pairs_per_body)
      : count_(count), asked_(pairs_per_body), swarm_(count, pairs_per_body), model_(shape) {
    for (const Transform& pose : swarm_.poses) ids_.push_back(scene_.add({model_, pose}));
    for (const bool builds_anew : {false, true}) {
#ifdef LIMBER_PEER_COAL
      managers_.push_back(make_coal_manager(shape, count, builds_anew));
#endif
#ifdef LIMBER_PEER_FCL
      managers_.push_back(make_fcl_manager(shape, count, builds_anew));
#endif
    }
    theirs_.resize(managers_.size());
  }

  void play(int frames, Checker& checker) {
    std::vector<ObjectPair> pairs(64 * count_), found;
    found.reserve(pairs.size());
    for (int frame = -3; frame < frames; ++frame) {  // the first ones warm up
      swarm_.move();
      const double poses_us = mean_us(1, [&] { scene_.set_poses(ids_, swarm_.poses); });
      const double commit_us = mean_us(1, [&] { scene_.commit(); });
      std::size_t pair_count = 0;
      const double pairs_us = mean_us(1, [&] { pair_count = scene_.candidate_pairs(0, pairs).count; });
      checker.check(pair_count <= pairs.size(), "{} pairs", pair_count);
      if (frame >= 0) ours_.add(poses_us, commit_us, pairs_us);
      pair_count_ = pair_count;
      for (std::size_t m = 0; m < managers_.size(); ++m) {
        Manager& manager = *managers_[m];
        const double their_poses_us = mean_us(1, [&] {
          for (std::size_t i = 0; i < count_; ++i) manager.set_pose(i, swarm_.poses[i]);
        });
        for (std::size_t i = 0; i < count_; ++i) manager.set_box(i, scene_.bounding_box(ids_[i]));
        const double update_us = mean_us(1, [&] { manager.update(); });
        found.clear();
        const double their_pairs_us = mean_us(1, [&] { manager.find_pairs(found); });
        if (frame >= 0) theirs_[m].add(their_poses_us, update_us, their_pairs_us);
        box_pair_count_ = found.size();
        const std::vector<ObjectPair> ours(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(pair_count));
        check_pairs(swarm_, ours, found, manager.name(), checker);
      }
    }
  }

  void report(Table& text) const {
    const auto row = [&](const std::string& name, const FrameTimes& t, std::size_t pairs, const std::string& ratio) {
      const Summary whole = summarize(t.whole);
      text.line("| {} | {} | {} | {:.2f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {} |", count_, asked_,
                name, static_cast<double>(pairs) / static_cast<double>(count_), median(t.poses), median(t.update),
                median(t.pairs), whole.min, whole.median, whole.p99, ratio);
    };
    row("limber", ours_, pair_count_, "1");
    for (std::size_t m = 0; m < managers_.size(); ++m) {
      const double ratio = median(theirs_[m].whole) / median(ours_.whole);
      row(managers_[m]->name(), theirs_[m], box_pair_count_, fmt::format("{:.1f}", ratio));
    }
  }

 private:
  std::size_t count_;
  double asked_;
  Swarm swarm_;
  Model model_;
  Scene scene_;
  std::vector<ObjectId> ids_;
  std::vector<std::unique_ptr<Manager>> managers_;
  FrameTimes ours_;
  std::vector<FrameTimes> theirs_;
  std::size_t pair_count_ = 0, box_pair_count_ = 0;
};

void run(const Options& options, Checker& checker) {
  const int frames = options.quick ? 10 : 300;
  Table text(options, "scene.md");
  const Mesh shape = scenes::ball(32, 18);
  text.line("# Candidate pairs of moving bodies, as printed by `limber_bench_scene`\n");
  text.line("Balls of {} triangles, {} frames. Medians in microseconds, one thread.\n", shape.triangles().size(),
            frames);
  text.line("- **pairs a body**: asked for, of boxes; found. limber also compares spheres, the others do not.");
  text.line(
      "- **poses**: placing all bodies, in the others with computing boxes. **update**: of the boxes (limber), of");
  text.line("  the tree. **pairs**: collecting them. The others get limber's boxes before their update, not timed.\n");
  text.line(
      "| bodies | pairs a body, asked | library | found | poses | update | pairs | frame, minimum | median | p99 | "
      "times limber |");
  text.line("|--:|--:|:--|--:|--:|--:|--:|--:|--:|--:|--:|");
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  for (const auto& [count, pairs_per_body] :
       {std::pair<std::size_t, double>{200, 2}, {2000, 1}, {2000, 2}, {2000, 3}, {20'000, 2}}) {
    if (options.quick && count > 2000) continue;
    Frames bodies(shape, count, pairs_per_body);
    bodies.play(count > 2000 ? frames / 10 : frames, checker);
    bodies.report(text);
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv,
                                  "How fast candidate pairs of many moving bodies are found, next to other libraries",
                                  limber::bench::run);
}
