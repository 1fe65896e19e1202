// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "limber/base.h"
#include "limber/math.h"
#include "limber/model.h"

/// Queries of two models: whether they meet, how far apart they are, whether they are within a distance. What they are
/// asked and what they answer is one vocabulary for every engine.
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
  /// Steps are the same on all machines.
  std::uint64_t max_steps = std::numeric_limits<std::uint64_t>::max();
  const std::atomic<bool>* cancel = nullptr;  ///< ends the query once it is true
};

/// Which limit of its budget has ended a query.
enum class StoppedBy { nothing, deadline, max_steps, cancel };

/// The closest points of two triangles, one of each model, or a point that they share; and which triangles these are.
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

/// What a query of two models has found, for the next query of the same two to start from: the triangles it ended with,
/// the pairs of nodes that it pruned, which stay pruned while the models have moved little, and those that were open
/// when its budget was spent. Answers do not depend on it beyond the asked error and rounding; a cache that was filled
/// by other models only costs time, and little of that. Self-queries (contacts.h) use and leave the triangles alone.
///
/// Cost     90 kB, allocated by the first query, which throws std::bad_alloc if it cannot, and then changes nothing.
/// Threads  One call at a time.
/// Source   docs/algorithms/traversal.md, "Warm start".
class QueryCache {
 public:
  LIMBER_API QueryCache();
  LIMBER_API QueryCache(QueryCache&&) noexcept;
  LIMBER_API QueryCache& operator=(QueryCache&&) noexcept;
  LIMBER_API ~QueryCache();

  /// Makes the next query start from nothing.
  LIMBER_API void clear();

  /// For the library's own use: allocated when it is first asked for.
  struct Impl;
  Impl& impl();

 private:
  std::unique_ptr<Impl> impl_;
};

/// How a question of yes or no is asked.
struct QueryOptions {
  QueryCache* cache = nullptr;  ///< what the last query of these models has found, to start from; null for none
  QueryBudget budget = {};      ///< when the query has to end; the default has no limits
};

/// How good the answer must be: within either error is enough. Contacts are found at any setting.
struct DistanceOptions {
  double relative_error = 0;  ///< the answer may exceed the true distance by this fraction of it; finite, >= 0
  double absolute_error = 0;  ///< the answer may exceed the true distance by this length; finite, >= 0
  /// Beyond this distance the query only reports `beyond_limit`; >= 0, infinity for no limit.
  double max_distance = std::numeric_limits<double>::infinity();
  QueryCache* cache = nullptr;  ///< as in QueryOptions
  QueryBudget budget = {};      ///< as in QueryOptions
};

struct DistanceResult {
  double lower = 0;  ///< no two points of the models are closer, up to the rounding stated above
  double upper = 0;  ///< the distance of the witness points, up to that rounding
  Status status = Status::exact;
  std::optional<Witness> witness;             ///< none exactly when `beyond_limit`
  StoppedBy stopped_by = StoppedBy::nothing;  ///< something else exactly when `interrupted`
  QueryStats stats{};
};

/// The answer to a question of yes or no.
enum class Answer {
  no,
  yes,
  unknown,  ///< the budget was spent before either was proven
};

/// The answer of collide() and within(). Neither is_yes() nor is_no() if it is unknown, which takes a budget.
struct CollideResult {
  Answer answer = Answer::unknown;
  /// A pair of points, there exactly when the answer is yes: the same point if the models meet; else at most as far
  /// apart as was asked, and not necessarily the closest.
  std::optional<Witness> witness;
  StoppedBy stopped_by = StoppedBy::nothing;  ///< something else exactly when the answer is unknown
  QueryStats stats{};

  bool is_yes() const { return answer == Answer::yes; }
  bool is_no() const { return answer == Answer::no; }
};

/// Whether two placed models meet; stops at the first intersecting pair found.
///
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid (is_rigid()).
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a cache's memory.
/// Budget   With one, the answer is unknown if the budget is spent before there is a contact or a proof that there is
///          none. The next call with the same cache goes on from there, whether or not the models have moved.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/traversal.md.
LIMBER_API CollideResult collide(const Placed& a, const Placed& b, const QueryOptions& options = {});

/// Shortest distance between two placed models, with a pair of points that attains it.
///
/// Promise  lower <= true distance <= upper, each up to the rounding stated above. upper is within either of the
///          asked errors. Contacts are found at every setting.
/// Overlap  If the models meet, lower == upper == 0 and both points coincide. Depth is not computed.
/// Limit    If nothing is as close as max_distance, lower is at least that, upper is infinite, the witness is empty.
/// Budget   If it is spent first, the status is `interrupted`; lower and upper keep their promises, and the witness
///          attains upper. The next call with the same cache goes on from there, whether or not the models have moved.
///          Asked the same again while they rest, the interval never becomes wider; its ends may move back by rounding
///          only.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, the errors are finite and
///          >= 0, and max_distance is >= 0 or infinite.
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a cache's memory.
/// Threads  Reentrant; any number of calls may share models.
/// Source   [Quinlan1994] for the error-bounded descent; docs/algorithms/traversal.md.
LIMBER_API DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});

/// Whether two placed models are at most `max_distance` apart; stops at the first such pair of triangles found.
///
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and max_distance is finite
///          and >= 0.
/// Promise  The answer is that of comparing all pairs of triangles, each distance rounded as stated above. A cache or
///          a motion margin does not change it. So it is true for a finite `upper` that distance() has returned for the
///          same models, poses and order; for 0 it is true exactly when the models meet.
/// Budget   As collide().
/// Cost     As collide(), which is within() of 0.
LIMBER_API CollideResult within(const Placed& a, const Placed& b, double max_distance,
                                const QueryOptions& options = {});

}  // namespace limber
