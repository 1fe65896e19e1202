// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/bench_run.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "command/output.h"
#include "command/text.h"
#include "limber/contacts.h"
#include "limber/points.h"
#include "scenes/scenes.h"
#include "verbs/models.h"

namespace limber::program {
namespace {

constexpr double limit_of_size = 0.002, self_margin_of_size = 0.001, wave_of_size = 0.01, gap_error_of_size = 1e-6;
constexpr double tolerance_of_coordinates = 1e-9;
constexpr int most_rounds = 5, most_slides = 200, most_tries = 100, path_frames = 20;
constexpr double shortest_sample_us = 30;  // a thousand times the cost of reading the clock

double diagonal(const Box& box) { return length(box.high - box.low); }
Vec3 center_of(const Box& box) { return 0.5 * (box.low + box.high); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rounded(double value) { return parsed_number(fmt::format("{:.2e}", value)).value(); }

/// A pose as the command line takes it. The quaternion is a column of four times its product with itself.
std::string pose_text(const Transform& pose) {
  const auto& [r, s, t] = pose.rotation;
  const std::array<std::array<double, 4>, 4> columns = {{{1 + r.x + s.y + t.z, t.y - s.z, r.z - t.x, s.x - r.y},
                                                         {t.y - s.z, 1 + r.x - s.y - t.z, r.y + s.x, r.z + t.x},
                                                         {r.z - t.x, r.y + s.x, 1 - r.x + s.y - t.z, s.z + t.y},
                                                         {s.x - r.y, r.z + t.x, s.z + t.y, 1 - r.x - s.y + t.z}}};
  std::size_t best = 0;
  for (std::size_t i = 1; i < 4; ++i) best = columns[i][i] > columns[best][best] ? i : best;
  const auto& [qw, qx, qy, qz] = columns[best];
  return fmt::format("{},{},{},{},{}", to_text(pose.translation, ","), qw, qx, qy, qz);
}

/// Times a call that puts some queries, and repeats it until the clock can tell.
template <typename Call>
std::function<double()> timed(Call call, int queries = 1) {
  return [call, queries, repetitions = 0]() mutable {
    const auto us_of = [&](int count) {
      const Stopwatch watch;
      for (int i = 0; i < count; ++i) static_cast<void>(call());
      return watch.microseconds() / count;
    };
    if (repetitions == 0) {
      const double us = us_of(1);
      repetitions = 1 + static_cast<int>(shortest_sample_us / std::max(us, 0.01));
      if (repetitions == 1) return us / queries;
    }
    return us_of(repetitions) / queries;
  };
}

/// A model that deforms: a wave along x moves all its vertices along z, and back.
struct BentModel {
  explicit BentModel(const Model& model) : rest(model.mesh().positions()), bent(rest), moving(model.mesh()) {
    const Box box = box_of(model.mesh());
    for (Vec3& p : bent) {
      p.z += wave_of_size * diagonal(box) * (2 + scenes::sine(20 * (p.x - box.low.x) / diagonal(box)));
    }
  }
  void move(std::span<const Vec3> positions) {
    value_or_bad_input(moving.move_all(positions));
    moving.commit();
  }
  void move(std::span<const VertexId> ids, std::span<const Vec3> positions) {
    value_or_bad_input(moving.move_vertices(ids, positions));
    moving.commit();
  }

  std::vector<Vec3> rest, bent;
  Model moving;  // at rest between two calls
};

class Bench {
 public:
  Bench(const Model& a, const Model& b, const BenchOptions& options)
      : a_(a), b_(b), options_(options), rng_(options.seed), a_center_(center_of(box_of(a.mesh()))) {
    const Box box_a = box_of(a.mesh()), box_b = box_of(b.mesh());
    size_ = std::max(diagonal(box_a), diagonal(box_b));
    if (!(std::min(diagonal(box_a), diagonal(box_b)) > 0)) throw BadInput("a model has no extent");
    b_center_ = center_of(box_b);
    tolerance_ = tolerance_of_coordinates * (size_ + max_abs(a_center_) + max_abs(b_center_));
    bent_.emplace_back(a);
    if (&a != &b) bent_.emplace_back(b);
    Mesh mesh = a.mesh();
    value_or_bad_input(mesh.set_positions(bent_[0].bent));
    bent_a_.emplace(std::move(mesh));
  }

  BenchTable run() {
    std::size_t least_turns = 0;
    // Half of the time is for drawing: a pose that takes as long as those before it has to end in it.
    const auto has_time = [&](auto poses) { return running_.seconds() * (poses + 1) < poses * options_.seconds / 2; };
    for (std::uint64_t i = 0; i < options_.poses && (i == 0 || has_time(static_cast<double>(i))); ++i) {
      draw();
      if (i == 0) least_turns = turns_.size();
    }
    for (int round = 0; round < most_rounds; ++round) {
      for (std::size_t i = 0; i < turns_.size(); ++i) {
        if (running_.seconds() > options_.seconds && (round > 0 || i >= least_turns)) return table();
        turns_[i].us.push_back(turns_[i].sample());
      }
    }
    return table();
  }

 private:
  struct Turn {
    std::string question, situation;
    std::function<double()> sample;
    std::vector<double> us = {};
  };

  /// The pose in which the center of b is at a point.
  Transform pose_at(const Mat3& rotation, const Vec3& center) const {
    return {rotation, center - rotation * b_center_};
  }

  /// The pose after b has slid back along `outward` until the gap is right. No step goes too far, because its length is
  /// a distance. Empty where there is no such pose.
  std::optional<Transform> at_gap(Transform pose, const Vec3& outward, double gap) const {
    for (int i = 0; i < most_slides; ++i) {
      const double missing = gap * size_ - distance({a_}, {b_, pose}).upper;
      if (std::abs(missing) <= gap_error_of_size * size_) return pose;
      pose.translation += outward * missing;
    }
    return std::nullopt;
  }

  /// Draws a direction and a turn of b, and adds what is measured from there at all gaps.
  void draw() {
    const Vec3 outward = scenes::random_rotation(rng_).row0;
    const Mat3 rotation = scenes::random_rotation(rng_);
    Transform pose = pose_at(rotation, a_center_ + outward * (3 * size_));
    std::vector<std::pair<const char*, Transform>> poses;
    for (const auto& [gap, name] : {std::pair(1.0, "1"), {0.05, "0.05"}, {0.001, "0.001"}}) {
      const std::optional<Transform> found = at_gap(pose, outward, gap);
      if (found) poses.insert(poses.begin(), {name, pose = *found});
    }
    const Vec3 way = pose(b_center_) - a_center_;
    for (int i = 0; i < most_tries; ++i) {
      const Transform inside = pose_at(rotation, a_center_ + way * rng_.uniform());
      if (!collide({a_}, {b_, inside}).is_yes()) continue;
      poses.insert(poses.begin(), {"overlapping", inside});
      break;
    }
    for (const auto& [situation, placed] : poses) add_queries(situation, placed);
    if (!poses.empty()) add_path(poses[poses.size() / 2].second);
    for (std::size_t m = 0; m < bent_.size(); ++m) add_updates(m == 0 ? "A" : "B", m == 0 ? a_ : b_, bent_[m]);
  }

  void add_queries(const char* situation, const Transform& pose) {
    const Placed a{a_}, b{b_, pose};
    const double limit = limit_of_size * size_;
    const auto every_contact = [](const Contact&) { return true; };
    const DistanceResult exact = distance(a, b), rough = distance(a, b, {.relative_error = 0.01});
    BenchAnswers answers{exact.upper, rough.lower, rough.upper};
    answers.collides = collide(a, b).is_yes(), answers.is_within = within(a, b, limit).is_yes();
    answers.contacts = visit_contacts(a, b, limit, every_contact).count;
    answers.witness_distance = closest_point(a, exact.witness->point_b).closest->distance;
    bent_[0].move(bent_[0].bent);
    answers.refitted = distance({bent_[0].moving}, b).upper, answers.built_anew = distance({*bent_a_}, b).upper;
    bent_[0].move(bent_[0].rest);
    expect_none(disagreement(answers, limit, tolerance_), pose);
    const Vec3 point = pose(b_.mesh().positions()[b_.mesh().triangles()[0][0]]);
    turns_.push_back({"collide", situation, timed([=] { return collide(a, b); })});
    turns_.push_back({"distance", situation, timed([=] { return distance(a, b); })});
    turns_.push_back(
        {"distance within 1 %", situation, timed([=] { return distance(a, b, {.relative_error = 0.01}); })});
    turns_.push_back({"within 0.002", situation, timed([=] { return within(a, b, limit); })});
    turns_.push_back({"contacts within 0.002", situation, timed([=] { visit_contacts(a, b, limit, every_contact); })});
    turns_.push_back({"closest point of A", situation, timed([=] { return closest_point(a, point); })});
  }

  /// From frame to frame b slides by 1/500 of the size, and turns by 1/200.
  void add_path(const Transform& start) {
    const Vec3 along = scenes::random_rotation(rng_).row0, axis = scenes::random_rotation(rng_).row0;
    std::vector<Transform> path;
    QueryCache cache;
    for (int i = 0; i < path_frames; ++i) {
      const Vec3 v = axis * scenes::sine(i / 400.0);
      const Mat3 turn = transform_from_quaternion({}, scenes::cosine(i / 400.0), v.x, v.y, v.z).value().rotation;
      path.push_back(pose_at(start.rotation * turn, start(b_center_) + along * (size_ / 500 * i)));
      const double cold = distance({a_}, {b_, path.back()}).upper;
      const double cached = distance({a_}, {b_, path.back()}, {.cache = &cache}).upper;
      const bool agree = std::abs(cached - cold) <= tolerance_;
      expect_none(agree ? "" : fmt::format("distance {}, with a cache {}", cold, cached), path.back());
    }
    const auto ask = [this](const std::vector<Transform>& poses, QueryCache* used) {
      for (const Transform& pose : poses) static_cast<void>(distance({a_}, {b_, pose}, {.cache = used}));
    };
    turns_.push_back({"distance", "path", timed([=] { ask(path, nullptr); }, path_frames)});
    turns_.push_back(
        {"distance", "path with a cache", timed([=, this] { cache_.clear(), ask(path, &cache_); }, path_frames)});
  }

  void add_updates(const char* name, const Model& model, BentModel& bent) {
    // The vertices nearest to one of them.
    const Vec3 place = bent.rest[rng_.below(bent.rest.size())];
    std::vector<VertexId> ids(bent.rest.size());
    for (VertexId v = 0; v < ids.size(); ++v) ids[v] = v;
    const std::size_t count = std::max<std::size_t>(1, ids.size() / 100);
    std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count - 1), ids.end(),
                     [&](auto v, auto w) { return length_sq(bent.rest[v] - place) < length_sq(bent.rest[w] - place); });
    ids.resize(count);
    std::vector<Vec3> there, back;
    for (const VertexId v : ids) there.push_back(bent.bent[v]), back.push_back(bent.rest[v]);
    const double margin = self_margin_of_size * diagonal(box_of(model.mesh()));
    const auto build = [&model] {
      Mesh mesh = model.mesh();
      const Stopwatch building;
      const Model built(std::move(mesh));
      return building.microseconds();
    };
    turns_.push_back({"build", name, build});
    turns_.push_back({"refit of all", name, timed([&bent] { bent.move(bent.bent), bent.move(bent.rest); }, 2)});
    turns_.push_back({"refit of 1 %", name, timed([=, &bent] { bent.move(ids, there), bent.move(ids, back); }, 2)});
    turns_.push_back({"self-contacts within 0.001", name, timed([&model, margin] {
                        visit_self_contacts(model, margin, [](const Contact&) { return true; });
                      })});
  }

  void expect_none(const std::string& what, const Transform& pose) const {
    if (what.empty()) return;
    throw std::runtime_error(fmt::format("answers disagree at --pose-b {}: {}", pose_text(pose), what));
  }

  /// A row for each question and situation that was measured, in the order in which questions were first put.
  BenchTable table() {
    std::map<std::string, std::size_t> first;
    std::vector<std::pair<std::size_t, std::size_t>> order;  // when its question was first put, and the turn
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      order.emplace_back(first.emplace(turns_[i].question, i).first->second, i);
    }
    std::sort(order.begin(), order.end());
    BenchTable table{size_, {}};
    std::vector<std::vector<double>> times;  // of the poses of each row
    for (const auto& [question, i] : order) {
      const Turn& turn = turns_[i];
      if (turn.us.empty()) continue;
      const auto row = std::find_if(table.rows.begin(), table.rows.end(), [&](const BenchRow& r) {
        return r.question == turn.question && r.situation == turn.situation;
      });
      const auto at = static_cast<std::size_t>(row - table.rows.begin());
      if (row == table.rows.end()) table.rows.push_back({turn.question, turn.situation}), times.emplace_back();
      times[at].push_back(median(turn.us));
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
      BenchRow& row = table.rows[i];
      row.poses = times[i].size(), row.median_us = rounded(median(times[i]));
      row.least_us = rounded(*std::min_element(times[i].begin(), times[i].end()));
    }
    return table;
  }

  const Model &a_, &b_;
  const BenchOptions& options_;
  scenes::Rng rng_;
  Vec3 a_center_, b_center_;
  double size_ = 0, tolerance_ = 0;
  std::vector<BentModel> bent_;
  std::optional<Model> bent_a_;  // built with the vertices of bent_[0] where these have moved
  QueryCache cache_;
  std::vector<Turn> turns_;
  Stopwatch running_;
};

}  // namespace

BenchTable run_bench(const Model& a, const Model& b, const BenchOptions& options) { return Bench(a, b, options).run(); }

}  // namespace limber::program
