// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        How much faster is what runs on several threads, on 2, 4, 8, ... of them?
// Workload        A heap of 2 000 bodies: a frame of a solver, distances and collisions of all its pairs, the closest
//                 objects of 2 000 configurations. A made sheet of 2 000 000 triangles: building, moving and committing
//                 all vertices, contacts with another sheet. With files: a bunny, an armadillo and a cloth on a ball
//                 with themselves, closest points of 100 000 points in their boxes, the impacts of the cloth's step.
// Metric          Milliseconds on one thread, median; how many times as fast the others are, by medians. Numbers of
//                 threads take turns, up to the processors that this process may use.
// Expected shape  Queries of many pairs or points nearly as many times as there are processors; pairs of one query some
//                 ten times on 16; building a tree and committing all vertices three to seven times.
// Checked         Answers of queries are the same on any number of threads, to the bit. Models that were built or
//                 moved are not compared here.
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/limber.h"
#include "scenes/scenes.h"
#include "scenes/surfaces.h"

namespace limber::bench {
namespace {

/// A hash of answers, which depends on their order.
class Hash {
 public:
  void add(std::uint64_t value) { hash_ = (std::rotl(hash_, 23) ^ value) * 0x9E3779B97F4A7C15U; }
  void add(std::uint32_t value) { add(std::uint64_t{value}); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Contact& contact) { add(contact.triangle_a), add(contact.triangle_b), add(contact.distance); }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 1;
};

/// 1, 2, 4, ... threads, and as many as there are.
std::vector<int> thread_counts() {
  std::vector<int> counts;
  const int all = oneapi::tbb::info::default_concurrency();
  for (int count = 1; count < all; count *= 2) counts.push_back(count);
  counts.push_back(all);
  return counts;
}

class Threads {
 public:
  Threads(const Options& options, Checker& checker)
      : rounds_(options.quick ? 2 : 15), checker_(checker), table_(options, "threads.md"), counts_(thread_counts()) {
    for (const int count : counts_) arenas_.emplace_back(count);
    table_.line("# What runs on several threads, as printed by `limber_bench_threads`\n");
    std::string head = "| what | ms on one thread |", line = "|:--|--:|";
    for (std::size_t i = 1; i < counts_.size(); ++i) head += fmt::format(" {} threads |", counts_[i]), line += "--:|";
    table_.line("{}\n{}", head, line);
  }

  /// Times `ask`, which returns a hash of its answers, after `prepare`, which is not timed.
  void time(const std::string& what, const std::function<void()>& prepare, const std::function<std::uint64_t()>& ask) {
    std::vector<std::vector<double>> us(counts_.size());
    std::optional<std::uint64_t> expected;
    const Stopwatch since_start;
    for (int round = 0; round < rounds_ && (round < 3 || since_start.us() < 20e6); ++round) {
      for (std::size_t i = 0; i < counts_.size(); ++i) {
        prepare();
        std::uint64_t answer = 0;
        us[i].push_back(mean_us(1, [&] { arenas_[i].execute([&] { answer = ask(); }); }));
        if (!expected) expected = answer;
        checker_.check(answer == *expected, "{}: other answers on {} threads", what, counts_[i]);
      }
    }
    const double one = median(us[0]);
    std::string cells = fmt::format("| {} | {:.3g} |", what, 1e-3 * one);
    for (std::size_t i = 1; i < counts_.size(); ++i) cells += fmt::format(" {:.1f} |", one / median(us[i]));
    if (checker_.all_right()) table_.line("{}", cells);
  }
  void time(const std::string& what, const std::function<std::uint64_t()>& ask) {
    time(
        what, [] {}, ask);
  }

 private:
  int rounds_;
  Checker& checker_;
  Table table_;
  std::vector<int> counts_;
  std::vector<oneapi::tbb::task_arena> arenas_;
};

/// 2 000 bodies of about radius 1, a little less than 2 apart: balls of 1 088 triangles, boxes and rings that have
/// fallen into a heap, so that each touches some of its neighbors.
class Heap {
 public:
  Heap() : rng_(17) {
    const Box box{{-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}};
    models_.reserve(3);
    models_.emplace_back(scenes::ball(32, 18));
    models_.emplace_back(scenes::boxes({box}));
    models_.emplace_back(scenes::ring(24, 12, 0.3));
    constexpr std::size_t body_count = 2000, side = 20;
    for (std::size_t i = 0; i < body_count; ++i) {
      const std::size_t row = i / side, layer = row / side;
      const Vec3 cell{static_cast<double>(i % side), static_cast<double>(row % side), static_cast<double>(layer)};
      poses.push_back({scenes::random_rotation(rng_), 1.95 * cell + within(0.05)});
      ids.push_back(scene.add({models_[i % models_.size()], poses.back()}));
    }
  }

  void move() {
    const double angle = 0.01, c = scenes::cosine(angle), s = scenes::sine(angle);
    const Mat3 turn{{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
    for (Transform& pose : poses) {
      pose.translation += within(0.01);
      pose.rotation = turn * pose.rotation;
    }
  }

  Scene scene;
  std::vector<ObjectId> ids;
  std::vector<Transform> poses;

 private:
  Vec3 within(double most) { return {rng_.uniform(-most, most), rng_.uniform(-most, most), rng_.uniform(-most, most)}; }

  scenes::Rng rng_;
  std::vector<Model> models_;
};

void time_scene(Threads& threads) {
  constexpr double margin = 0.01;
  Heap heap;
  std::vector<ObjectPair> room(64 * heap.ids.size());
  std::span<const ObjectPair> pairs;
  ObjectContacts found;
  threads.time("2 000 bodies: poses, commit, candidate pairs, contacts", [&] {
    heap.scene.set_poses(heap.ids, heap.poses);
    heap.scene.commit();
    pairs = std::span(room).first(heap.scene.candidate_pairs(margin, room).count);
    heap.scene.contacts(pairs, margin, found);
    Hash hash;
    for (const Contact& contact : found.contacts) hash.add(contact);
    return hash.value();
  });
  std::vector<DistanceResult> distances(pairs.size());
  threads.time("distances of their pairs", [&] {
    heap.scene.distance(pairs, distances);
    Hash hash;
    for (const DistanceResult& distance : distances) hash.add(distance.upper);
    return hash.value();
  });
  std::vector<CollideResult> collisions(pairs.size());
  threads.time("collisions of their pairs", [&] {
    heap.scene.collide(pairs, collisions);
    Hash hash;
    for (const CollideResult& collision : collisions) hash.add(std::uint64_t{collision.is_yes()});
    return hash.value();
  });
}

/// One body that moves among 200 others.
void time_configurations(Threads& threads) {
  scenes::Rng rng(3);
  const Model ball(scenes::ball(32, 18));
  Scene scene;
  const auto place = [&] {
    return Transform{scenes::random_rotation(rng), {rng.uniform(0, 30), rng.uniform(0, 30), rng.uniform(0, 30)}};
  };
  const ObjectId moving = scene.add({ball, {}});
  for (int i = 0; i < 200; ++i) static_cast<void>(scene.add({ball, place()}));
  scene.commit();
  std::vector<Transform> poses(2000);
  for (Transform& pose : poses) pose = place();
  std::vector<ClosestObjectsResult> results(poses.size());
  const auto is_of_moving = [&](ObjectId a, ObjectId b) { return a == moving || b == moving; };
  threads.time("closest objects, 2 000 configurations of one of 201 bodies", [&] {
    scene.closest_objects_many(std::span(&moving, 1), poses, results, {.filter = is_of_moving});
    Hash hash;
    for (const ClosestObjectsResult& found : results) hash.add(found.result.upper);
    return hash.value();
  });
}

/// Contacts with another model, or with itself.
std::uint64_t hash_of_contacts(const std::function<void(ContactVisitor, const PairOptions&)>& visit_all) {
  Hash hash;
  visit_all([&](const Contact& contact) { return hash.add(contact), true; }, {.parallel = true});
  return hash.value();
}

void time_updates(const std::string& name, const Mesh& mesh, Threads& threads) {
  std::optional<Model> model;
  threads.time(
      fmt::format("{}: build", name), [&] { model.reset(); }, [&] { return model.emplace(mesh), 0; });
  const auto move = [&] { model->move_all(mesh.positions()).value(); };
  threads.time(
      fmt::format("{}: move all vertices", name), [&] { model->commit(); }, [&] { return move(), 0; });
  threads.time(fmt::format("{}: commit all vertices", name), move, [&] { return model->commit(), 0; });
}

void time_sheets(std::uint32_t side, Threads& threads) {
  const Mesh sheet = scenes::wave_sheet(side, side, 0);
  time_updates(fmt::format("sheet of {} triangles", sheet.triangles().size()), sheet, threads);
  const Model a(sheet), b(scenes::wave_sheet(side / 2, side / 2, 3));
  threads.time("contacts with another sheet", [&] {
    return hash_of_contacts(
        [&](ContactVisitor visit, const PairOptions& options) { visit_contacts({a}, {b}, 1e-4, visit, options); });
  });
}

void time_mesh(const std::string& name, const Mesh& mesh, Threads& threads) {
  time_updates(name, mesh, threads);
  const Model model(mesh);
  const Box box = model.bounding_box();
  threads.time(fmt::format("{}: contacts with itself within 1e-3 of its size", name), [&] {
    return hash_of_contacts([&](ContactVisitor visit, const PairOptions& options) {
      visit_self_contacts(model, 1e-3 * length(box.high - box.low), visit, options);
    });
  });
  scenes::Rng rng(4);
  std::vector<Vec3> points(100'000);
  for (Vec3& p : points) {
    for (std::size_t k = 0; k < 3; ++k) p[k] = rng.uniform(box.low[k], box.high[k]);
  }
  std::vector<PointResult> results(points.size());
  threads.time(fmt::format("{}: closest points of 100 000", name), [&] {
    closest_point_many({model}, points, results);
    Hash hash;
    for (const PointResult& found : results) hash.add(found.closest->distance);
    return hash.value();
  });
}

void time_motion(const Mesh& first, const Mesh& second, Threads& threads) {
  const Model model(first);
  MovingModel moving(model);
  threads.time("cloth: set a motion", [&] { return moving.set_motion(second.positions()).value(), 0; });
  threads.time("cloth: all impacts with itself", [&] {
    Hash hash;
    const auto visit = [&](const Impact& impact) {
      hash.add(impact.elements.a), hash.add(impact.elements.b);
      return hash.add(impact.time.upper), true;
    };
    visit_self_impacts(moving, visit, {.parallel = true});
    return hash.value();
  });
}

void run(const Options& options, Checker& checker) {
  Threads threads(options, checker);
  time_scene(threads);
  time_configurations(threads);
  time_sheets(options.quick ? 100 : 1000, threads);
  if (options.meshes.empty()) return;
  const auto mesh = [&](const char* file) { return load_mesh(options.meshes / file).value(); };
  const Mesh cloth = mesh("cloth_ball_92.ply");
  time_mesh("bunny", mesh("stanford-bunny.obj"), threads);
  time_mesh("armadillo", mesh("armadillo.obj"), threads);
  time_mesh("cloth", cloth, threads);
  time_motion(cloth, mesh("cloth_ball_93.ply"), threads);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "How much faster is what runs on several threads?", limber::bench::run);
}
