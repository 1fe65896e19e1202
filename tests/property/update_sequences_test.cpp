// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Random sequences of all operations on a deforming model, compared with brute force: 60 000 from one generator
// (LIMBER_UPDATE_SEQUENCES sets another number), and a few thousand that are shrunk when they fail, so that the printed
// sequence is short.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/brute_force.h"
#include "support/random_scene.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

/// A mesh, determined by a kind and two numbers.
struct Shape {
  enum class Kind { ball, sheet, uniform_soup, lattice_soup, small_soup, needles, count };
  Kind kind = Kind::ball;
  std::uint32_t size = 1;  ///< of soups: triangles; otherwise of the order of its root
  std::uint32_t seed = 0;

  Mesh mesh() const {
    Rng rng(seed + 1);
    if (kind == Kind::ball) return scenes::ball(3 + size % 6, 2 + size % 4);
    if (kind == Kind::sheet) return dented_sheet(rng);
    std::vector<Triangle> triangles;
    const std::uint64_t of_kind = kind == Kind::lattice_soup   ? 0
                                  : kind == Kind::uniform_soup ? 1
                                  : kind == Kind::small_soup   ? 2
                                                               : 5;
    for (std::uint32_t i = 0; i < size; ++i) triangles.push_back(arbitrary_triangle(rng, of_kind));
    return soup(triangles);
  }
};

/// The initial state of a Subject.
struct Start {
  Shape shape, still;
  double motion_margin = 0;
  RebuildPolicy rebuild_policy = RebuildPolicy::off;
  std::optional<double> rebuild_budget_us = ModelOptions::automatic;  // memory is allocated beforehand if there is one
};

struct Update {
  enum class Kind {
    move,               ///< `count` vertices by up to 10^exponent, some of them twice
    move_to_own,        ///< `count` vertices to positions that are the model's own
    move_all,           ///< by up to 10^exponent
    stay,               ///< all, to the model's own positions
    collapse,           ///< all to one point, 10^exponent or 10^(4 exponent) from the origin
    regrow,             ///< all to where they were at first
    scale,              ///< all to 2^(draw % 121 - 60) times where they were at first
    reject,             ///< updates that are refused
    set_motion_margin,  ///< to 0 or 10^exponent
    rebuild,
    reset,   ///< to the present mesh, moved by up to 10^exponent
    commit,  ///< and give a worker time
    check,   ///< commit and compare
    count
  };
  Kind kind = Kind::check;
  std::uint32_t count = 1;  ///< 1 to 5
  std::int32_t exponent = 0;
  std::uint32_t draw = 0;  ///< seed of all random choices
};

constexpr const char* shape_names[] = {"ball", "sheet", "uniform soup", "lattice soup", "small soup", "needles"};
constexpr const char* update_names[] = {"move",  "move_to_own", "move_all",          "stay",    "collapse", "regrow",
                                        "scale", "reject",      "set_motion_margin", "rebuild", "reset",    "commit",
                                        "check"};
constexpr const char* policy_names[] = {"off", "in_commit", "on_worker"};

double largest_coordinate(const Mesh& mesh) {
  double largest = 0;
  for (const Corners& c : mesh.triangles()) {
    for (const VertexId v : c) largest = std::max(largest, max_abs(mesh.positions()[v]));
  }
  return largest;
}

template <typename... Parts>
std::string text_of(const Parts&... parts) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << parts);
  return out.str();
}

std::string failed(const char* call, const Result<void>& result) {
  return result ? "" : text_of(call, " failed: ", result.error().text);
}

std::ostream& operator<<(std::ostream& out, const Shape& shape) {
  return out << shape_names[static_cast<std::size_t>(shape.kind)] << " of size " << shape.size << ", seed "
             << shape.seed;
}

std::ostream& operator<<(std::ostream& out, const Start& start) {
  out << start.shape << "; beside it a " << start.still << "; ";
  out << "motion margin " << start.motion_margin << "; ";
  out << policy_names[static_cast<std::size_t>(start.rebuild_policy)];
  if (start.rebuild_budget_us) out << " within " << *start.rebuild_budget_us << " us";
  return out;
}

std::ostream& operator<<(std::ostream& out, const Update& update) {
  return out << update_names[static_cast<std::size_t>(update.kind)] << "(count " << update.count << ", exponent "
             << update.exponent << ", draw " << update.draw << ")";
}

/// A model under test, and the mesh that it should have.
class Subject {
 public:
  explicit Subject(const Start& start)
      : mesh_(start.shape.mesh()),
        comes_first_(start.shape.seed % 2 == 0),
        first_(mesh_.positions()),
        model_(mesh_, {.motion_margin = start.motion_margin,
                       .rebuild_policy = start.rebuild_policy,
                       .rebuild_budget_us = start.rebuild_budget_us,
                       .preallocate = start.rebuild_budget_us.has_value()}),
        still_(start.still.mesh()) {}

  /// Returns what went wrong, or nothing.
  std::string apply(const Update& update) {
    Rng rng(update.draw + 1);
    std::vector<Vec3> positions = mesh_.positions();
    const double step = std::pow(10.0, update.exponent);
    switch (update.kind) {
      case Update::Kind::move:
        return move(update, rng);
      case Update::Kind::move_to_own:
        return move_to_own(update, rng);
      case Update::Kind::move_all:
        for (Vec3& p : positions) p += step * uniform_point(rng);
        return move_all_to(positions);
      case Update::Kind::stay:
        return failed("move_all to the model's own positions", model_.move_all(model_.mesh().positions()));
      case Update::Kind::collapse: {
        const Vec3 at = (rng.below(2) == 0 ? step : std::pow(10.0, 4 * update.exponent)) * uniform_point(rng);
        return move_all_to(std::vector<Vec3>(positions.size(), at));
      }
      case Update::Kind::regrow:
        return move_all_to(first_);
      case Update::Kind::scale:
        for (std::size_t v = 0; v < positions.size(); ++v) {
          positions[v] = first_[v] * std::ldexp(1.0, static_cast<int>(update.draw % 121) - 60);
        }
        return move_all_to(positions);
      case Update::Kind::reject:
        return reject(rng);
      case Update::Kind::set_motion_margin:
        model_.set_motion_margin(update.count == 1 ? 0 : step);
        return "";
      case Update::Kind::rebuild:
        model_.rebuild();
        return model_.is_committed() ? "" : "rebuild left the model uncommitted";
      case Update::Kind::reset:
        for (Vec3& p : positions) p += step * uniform_point(rng);
        mesh_.set_positions(positions).value();
        model_.reset(mesh_);
        return model_.is_committed() ? "" : "reset left the model uncommitted";
      case Update::Kind::commit:
        model_.commit();
        std::this_thread::sleep_for(std::chrono::microseconds(update.draw % 8 == 0 ? 50 : 0));
        return "";
      default:
        return check(update.draw);
    }
  }
  /// Commits, and compares with brute force. Returns what went wrong, or nothing.
  std::string check(std::uint32_t draw) {
    model_.commit();
    if (!model_.is_committed()) return "the model is not committed";
    if (model_.mesh().positions() != mesh_.positions()) return "vertices are not where they were moved to";
    if (const Result<void> valid = model_.validate(); !valid) return valid.error().text;
    // The number of levels: docs/algorithms/bounds.md.
    const std::size_t leaves = (mesh_.triangles().size() + 7) / 8;
    std::uint32_t levels = 1;
    for (std::size_t most = 1; most < leaves; most *= 8) ++levels;
    if (model_.tree_stats().levels != levels) return text_of("the tree has ", model_.tree_stats().levels, " levels");
    Rng rng(draw + 1);
    return compare(rng.below(3) == 0 ? random_pose(rng, 4) : Transform{});
  }

  const Model& model() const { return model_; }

 private:
  std::string move(const Update& update, Rng& rng) {
    std::vector<VertexId> ids;
    std::vector<Vec3> positions;
    for (std::uint32_t i = 0; i < update.count; ++i) {
      const bool again = i > 0 && rng.below(4) == 0;
      ids.push_back(again ? ids.back() : static_cast<VertexId>(rng.below(mesh_.positions().size())));
      positions.push_back(mesh_.positions()[ids.back()] + std::pow(10.0, update.exponent) * uniform_point(rng));
      mesh_.set_position(ids.back(), positions.back()).value();
    }
    return failed("move_vertices", model_.move_vertices(ids, positions));
  }
  std::string move_to_own(const Update& update, Rng& rng) {
    const std::size_t vertex_count = mesh_.positions().size();
    const std::size_t count = std::min<std::size_t>(update.count + rng.below(vertex_count), vertex_count);
    const std::size_t from = rng.below(vertex_count - count + 1);
    std::vector<VertexId> ids;
    for (std::size_t i = 0; i < count; ++i) ids.push_back(static_cast<VertexId>(rng.below(vertex_count)));
    const std::vector<Vec3> before = mesh_.positions();
    for (std::size_t i = 0; i < count; ++i) mesh_.set_position(ids[i], before[from + i]).value();
    return failed("move_vertices to the model's own positions",
                  model_.move_vertices(ids, std::span(model_.mesh().positions()).subspan(from, count)));
  }
  std::string move_all_to(const std::vector<Vec3>& positions) {
    mesh_.set_positions(positions).value();
    return failed("move_all", model_.move_all(positions));
  }
  std::string reject(Rng& rng) {
    const bool was_committed = model_.is_committed();
    std::vector<Vec3> positions = mesh_.positions();
    const std::size_t bad = rng.below(positions.size());
    positions[bad].z = rng.below(2) == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e70;
    const Result<void> all = model_.move_all(positions);
    if (all || all.error().where != bad) return "move_all did not name the bad position";
    const std::vector<VertexId> ids{0, static_cast<VertexId>(positions.size())};
    const Result<void> some = model_.move_vertices(ids, std::vector<Vec3>(2));
    if (some || some.error().where != 1U) return "move_vertices did not name the bad id";
    return model_.is_committed() == was_committed ? "" : "a rejected update moved something";
  }
  std::string compare(const Transform& pose) {
    // The size of the coordinates that are rounded when triangles are placed and compared.
    const double extent = largest_coordinate(mesh_) + largest_coordinate(still_.mesh()) + max_abs(pose.translation);
    const Placed a = comes_first_ ? Placed{model_} : Placed{still_, pose};
    const Placed b = comes_first_ ? Placed{still_, pose} : Placed{model_};
    const Truth truth{brute_force_distance({a.model().mesh(), a.pose}, {b.model().mesh(), b.pose}),
                      0x1p-45 * extent};  // docs/algorithms/numerics.md
    for (QueryCache* cache : {static_cast<QueryCache*>(nullptr), &cache_}) {
      std::string wrong = wrong_answer(distance(a, b, {.cache = cache}), {}, a, b, truth);
      for (const double limit : {0.0, 0.5 * truth.distance, truth.distance + truth.tolerance}) {
        if (!wrong.empty()) break;
        const QueryOptions options{.cache = cache};
        wrong = wrong_answer(limit == 0 ? collide(a, b, options) : within(a, b, limit, options), limit, a, b, truth);
      }
      if (!wrong.empty())
        return text_of(cache == nullptr ? "cold: " : "warm: ", wrong, "; the distance is ", truth.distance);
    }
    return "";
  }

  Mesh mesh_;         // the mesh that the model should have
  bool comes_first_;  // in queries of the model and the one beside it
  std::vector<Vec3> first_;
  Model model_, still_;
  QueryCache cache_;
};

Shape drawn_shape(Rng& rng, std::uint32_t most) {
  const auto kind = static_cast<Shape::Kind>(rng.below(static_cast<std::uint64_t>(Shape::Kind::count)));
  return {kind, some(rng, 1, most), some(rng, 0, 1000)};
}

Start drawn_start(Rng& rng) {
  const double margins[] = {0, std::pow(10.0, rng.uniform(-4, 0.5)), std::pow(10.0, rng.uniform(-4, 0.5))};
  const Shape shape = drawn_shape(rng, rng.below(4) == 0 ? 150 : 12), still = drawn_shape(rng, 5);
  const std::optional<double> budgets_us[] = {ModelOptions::automatic, 2, 1e4};
  return {shape, still, margins[rng.below(3)], static_cast<RebuildPolicy>(rng.below(3)), budgets_us[rng.below(3)]};
}

/// Kinds that are drawn more often than the others.
constexpr Update::Kind often[] = {Update::Kind::move, Update::Kind::move, Update::Kind::move_all, Update::Kind::check,
                                  Update::Kind::check};

Update drawn_update(Rng& rng) {
  const Update::Kind kind = rng.below(3) == 0
                                ? static_cast<Update::Kind>(rng.below(static_cast<std::uint64_t>(Update::Kind::count)))
                                : often[rng.below(std::size(often))];
  const auto exponent = static_cast<std::int32_t>(rng.below(6)) - 4;
  return {kind, some(rng, 1, 5), exponent, some(rng, 0, 1U << 30)};
}

TEST(UpdateSequences, LeaveEveryModelSoundAndEveryAnswerRight) {
  Rng rng(91);
  const std::uint64_t all = count_from("LIMBER_UPDATE_SEQUENCES", 60'000);
  std::uint64_t sequences = 0, rebuilt_triangles = 0;
  for (; sequences < all; ++sequences) {
    const Start start = drawn_start(rng);
    Subject subject(start);
    const std::uint64_t count = 1 + rng.below(rng.below(12) == 0 ? 80 : 6);
    std::vector<Update> done;
    for (std::uint64_t i = 0; i < count; ++i) {
      done.push_back(i + 1 < count ? drawn_update(rng) : Update{});
      const std::string wrong = subject.apply(done.back());
      ASSERT_EQ(wrong, "") << "in sequence " << sequences << ": " << start << ::testing::PrintToString(done);
    }
    rebuilt_triangles += subject.model().maintenance_stats().rebuilt_triangles;
  }
  // Some 90 in a thousand sequences; more where workers get the time to end theirs.
  EXPECT_GT(20 * rebuilt_triangles, all);
}

RC_GTEST_PROP(UpdateSequences, StayRightAndShrinkToFewUpdatesWhenTheyFail,
              (std::uint32_t seed_of_start, std::vector<std::uint32_t> seeds)) {
  Rng rng(seed_of_start);
  const Start start = drawn_start(rng);
  Subject subject(start);
  std::vector<Update> done;
  seeds.push_back(0);
  for (const std::uint32_t seed : seeds) {
    Rng of_update(seed);
    done.push_back(seed == 0 ? Update{} : drawn_update(of_update));
    const std::string wrong = subject.apply(done.back());
    if (!wrong.empty()) RC_FAIL(text_of(wrong, ": ", start, ::testing::PrintToString(done)));
  }
}

}  // namespace
}  // namespace limber::testing
