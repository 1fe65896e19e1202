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

/// Queries of two models: whether they meet, how far apart they are, whether they are within a distance.
///
/// Triangles are surfaces, not solids: a model wholly inside another does not collide with it. When models meet, the
/// distance is 0, the two points of the witness are the same and lie on both models up to rounding, and its triangles
/// truly intersect. `collide` says yes if and only if `distance` gives 0.
///
/// Bodies with a radius, and solids, which also have an inside, are explained in shapes.h.
///
/// Models are compared as placed: every vertex is moved to the world frame in float64 first, and answers are about
/// these rounded vertices. Whether they meet is decided exactly. A distance d differs from theirs by at most
///     2^-46 E + 2^-44 d, and 2^-45 M more if a pose is not the identity.
/// E is the largest coordinate of a corner of the closest triangles, relative to the first corner of a's triangle; the
/// largest such number if several pairs are equally close. M is the sum of both models' largest coordinates and
/// translations: nodes and triangles are pruned before their vertices are placed. See docs/algorithms/numerics.md.
///
/// Threads  Every query is reentrant; any number of calls may share models.
namespace limber {

/// Why a query stopped where it did.
enum class DistanceStatus {
  exact,         ///< lower == upper > 0: there is no error but rounding
  within_error,  ///< lower < upper, and upper is within the asked error of the true distance
  collision,     ///< the models meet: lower == upper == 0
  beyond_limit,  ///< the distance is above max_distance: lower >= max_distance, upper is infinite, no witness
  interrupted,   ///< the budget was spent: lower <= distance <= upper, farther apart than the asked errors allow
};

/// When a query has to end, whether or not it has its answer: at the first of these limits that it reaches.
///
/// A step compares the children of one node with another node, or two leaves. It takes 0.1 to 1 us, rarely several. The
/// clock is read every few steps, so a deadline is overrun by a few steps. A query makes at least one step, even if its
/// deadline has passed, unless it is cancelled or `max_steps` is 0. Without a step, the witness of a distance is some
/// pair of triangles.
struct QueryBudget {
  std::optional<std::chrono::steady_clock::time_point> deadline = std::nullopt;
  /// A number of steps gives the same answer on every machine, however fast it is.
  std::uint64_t max_steps = (std::numeric_limits<std::uint64_t>::max)();
  /// Ends the query once it is true. Has to live as long as the query; may be set by any thread.
  const std::atomic<bool>* cancel = nullptr;
  /// As `cancel`, for callers who then throw the answer away: what the query returns means nothing once this is true,
  /// and its cache has to be cleared. Until then the query takes the time and gives the bits of one without a budget.
  const std::atomic<bool>* abandon = nullptr;
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
  std::uint64_t node_tests = 0;       ///< bounding volumes compared
  std::uint64_t primitive_tests = 0;  ///< pairs of triangles compared; of elements where the query is about these

  QueryStats& operator+=(const QueryStats& other) {
    node_tests += other.node_tests, primitive_tests += other.primitive_tests;
    return *this;
  }
};

/// What a query of two models has found, for the next query of the same two to start from: the two triangles of its
/// answer; the pairs of nodes that it pruned, which stay pruned while the models have moved little; and those that were
/// still open when its budget was spent. A cache changes distances only within the asked errors and rounding; it never
/// changes a yes or a no. One that was filled by other models costs a little time. Self-queries (contacts.h) use only
/// the two triangles.
///
/// Cost     90 kB, allocated by the first query. It throws std::bad_alloc if that fails, and then changes nothing.
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

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  Impl& impl();

  std::unique_ptr<Impl> impl_;
};

/// How a question of yes or no is asked.
struct QueryOptions {
  QueryCache* cache = nullptr;  ///< what the last query of these models has found, to start from; null for none
  QueryBudget budget = {};      ///< when the query has to end; the default has no limits
};

/// How good the answer must be: within either error is enough. Models that meet are found to meet at any setting.
struct DistanceOptions {
  double relative_error = 0;  ///< the answer may exceed the true distance by this fraction of it; finite, >= 0
  double absolute_error = 0;  ///< the answer may exceed the true distance by this length; finite, >= 0
  /// If the distance is above this, the query only reports `beyond_limit`; >= 0, infinity for no limit.
  double max_distance = std::numeric_limits<double>::infinity();
  QueryCache* cache = nullptr;  ///< as in QueryOptions
  QueryBudget budget = {};      ///< as in QueryOptions
};

struct [[nodiscard]] DistanceResult {
  double lower = 0;  ///< no two points of the models are closer, up to rounding (docs/algorithms/numerics.md)
  double upper = 0;  ///< the distance of the witness points, up to that rounding
  DistanceStatus status = DistanceStatus::exact;
  std::optional<Witness> witness;             ///< empty if and only if the status is `beyond_limit`
  StoppedBy stopped_by = StoppedBy::nothing;  ///< which limit, if the status is `interrupted`
  QueryStats stats{};
};

/// The answer to a question of yes or no.
enum class Answer {
  no,
  yes,
  undecided,  ///< the budget was spent before either was proven; never without a budget
};

/// The answer of collide() and within(). If it is undecided, neither is_yes() nor is_no() is true.
struct [[nodiscard]] CollideResult {
  Answer answer = Answer::undecided;
  /// Two points, if and only if the answer is yes: the same point twice if the models meet, else points at most as far
  /// apart as was asked, not necessarily the closest.
  std::optional<Witness> witness;
  StoppedBy stopped_by = StoppedBy::nothing;  ///< which limit, if the answer is undecided
  QueryStats stats{};

  bool is_yes() const { return answer == Answer::yes; }
  bool is_no() const { return answer == Answer::no; }
};

/// Whether two placed models meet; stops at the first intersecting pair found.
///
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid (is_rigid()).
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a cache's memory.
/// Budget   With one, the answer is undecided if the budget is spent before there is a contact or a proof that there is
///          none. The next call with the same cache goes on from there. If the models have moved since, what was proven
///          holds less the motion.
/// Source   docs/algorithms/traversal.md.
LIMBER_API CollideResult collide(const Placed& a, const Placed& b, const QueryOptions& options = {});

/// Shortest distance between two placed models, with a pair of points that attains it.
///
/// Promise  lower <= true distance <= upper, each up to rounding (docs/algorithms/numerics.md). upper exceeds the true
///          distance by no more than the larger of the asked errors. Models that meet are found to meet at any setting.
/// Overlap  If the models meet, lower == upper == 0 and both points coincide. Depth is not computed.
/// Limit    If the distance is above max_distance, lower is at least max_distance, upper is infinite, and there is no
///          witness.
/// Budget   If it is spent first, the status is `interrupted`: the distance is still between lower and upper, and upper
///          is that of the witness. The next call with the same cache goes on from there, as in collide(). If the same
///          query is repeated while the models rest, the interval never becomes wider, but for rounding.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, the errors are finite and
///          >= 0, and max_distance is >= 0 or infinite.
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a cache's memory.
/// Source   [Quinlan1994] for the error-bounded descent; docs/algorithms/traversal.md.
LIMBER_API DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});

/// Whether two placed models are at most `max_distance` apart; stops at the first such pair of triangles found.
///
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and max_distance is finite
///          and >= 0.
/// Promise  The answer is that of comparing all pairs of triangles, each distance rounded as numerics.md states,
///          whatever the cache and the motion margin. So it is yes for a finite `upper` that distance(a, b) has
///          returned for the same poses. For 0 it is yes if and only if the models meet.
/// Budget   See collide().
/// Cost     See collide(), which does the same for a distance of 0.
LIMBER_API CollideResult within(const Placed& a, const Placed& b, double max_distance,
                                const QueryOptions& options = {});

}  // namespace limber
