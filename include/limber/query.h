// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "limber/base.h"
#include "limber/math.h"

/// What queries are asked and what they answer; one vocabulary for every engine.
///
/// Triangles are surfaces, not solids: a model wholly inside another does not collide with it. When models meet, the
/// distance is 0, both points of the witness are one point that lies on both up to rounding, and the triangle ids name
/// a pair that truly intersects. `collide` says yes exactly when `distance` gives 0. Models are compared as placed:
/// every vertex is moved to the world frame in float64 first, and the answer is for those rounded vertices. Whether
/// they meet is exact. Distances are rounded: with E the largest extent of a pair of triangles at about that distance,
/// they are within 2^-46 E + 2^-44 distance of the true ones, plus 2^-45 of the sum of the models' largest coordinates
/// and translations where a pose is not the identity. docs/algorithms/numerics.md has the details.
namespace limber {

/// Why a query stopped where it did.
enum class Status {
  exact,         ///< lower == upper: the distance up to the rounding that docs/algorithms/numerics.md bounds
  within_error,  ///< lower < upper, and upper is within the asked error of the true distance
  collision,     ///< the models meet: lower == upper == 0
  beyond_limit,  ///< nothing is as close as max_distance: lower >= max_distance, upper is infinite, no witness
  interrupted,   ///< the budget was spent: lower <= distance <= upper, farther apart than the errors allow
};

/// When a query has to end, whether or not it has its answer. Set any of them: the first that is reached ends the
/// query.
///
/// A query looks at its budget after every few steps, each of which takes some 0.1 to 1 us, and now and then several: a
/// deadline is overrun by that much. Every query with a budget that is not cancelled or empty makes at least one step.
struct QueryBudget {
  std::optional<std::chrono::steady_clock::time_point> deadline = std::nullopt;
  /// Steps are the same on all machines. A query may make one more than this, where it compares two pairs of nodes side
  /// by side.
  std::uint64_t max_steps = std::numeric_limits<std::uint64_t>::max();
  const std::atomic<bool>* cancel = nullptr;  ///< ends the query once it is true
};

/// Which limit of its budget has ended a query.
enum class StoppedBy { nothing, deadline, max_steps, cancel };

/// A pair of points, one on each model, and the triangles they lie on. Of within(), and of a distance with an error,
/// they need not be the closest points of these triangles.
///
/// Frame    World: the one that both poses map to.
struct Witness {
  Vec3 point_a, point_b;
  TriangleId triangle_a = no_id, triangle_b = no_id;  ///< index each model's own mesh
};

/// Work done by one query.
struct QueryStats {
  std::uint64_t node_tests = 0;      ///< pairs of bounding volumes compared
  std::uint64_t triangle_tests = 0;  ///< pairs of triangles compared
};

/// How good the answer must be: within either error is enough. Contacts are found at any setting.
struct DistanceOptions {
  double relative_error = 0;  ///< the answer may exceed the true distance by this fraction of it; finite, >= 0
  double absolute_error = 0;  ///< the answer may exceed the true distance by this length; finite, >= 0
  /// Beyond this distance the query only reports `beyond_limit`; >= 0, infinity for no limit.
  double max_distance = std::numeric_limits<double>::infinity();
};

struct DistanceResult {
  double lower = 0;  ///< no two points of the models are closer, up to the rounding stated above
  double upper = 0;  ///< the distance of the witness points, up to that rounding
  Status status = Status::exact;
  std::optional<Witness> witness;             ///< none exactly when `beyond_limit`
  StoppedBy stopped_by = StoppedBy::nothing;  ///< something else exactly when `interrupted`
  QueryStats stats{};
};

struct CollideResult {
  bool collision = false;
  std::optional<Witness> witness;  ///< there exactly when `collision`; both points are the same
  QueryStats stats{};
};

struct WithinResult {
  bool within = false;
  /// A pair of points at most that far apart, there exactly when `within`; not necessarily the closest.
  std::optional<Witness> witness;
  QueryStats stats{};
};

/// What a question of yes or no is answered within a budget.
enum class Answer {
  no,
  yes,
  unknown,  ///< the budget was spent before either was proven
};

struct BudgetedAnswer {
  Answer answer = Answer::unknown;
  std::optional<Witness> witness;             ///< there exactly when the answer is yes
  StoppedBy stopped_by = StoppedBy::nothing;  ///< something else exactly when the answer is unknown
  QueryStats stats{};
};

}  // namespace limber
