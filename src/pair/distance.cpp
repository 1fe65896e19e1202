// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/budget_meter.h"
#include "pair/collectors/collector.h"
#include "pair/placed_pair.h"
#include "pair/query_cache_impl.h"
#include "pair/search.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::pair {

/// Whether a part of one body's core lies inside of the other's, which is a solid.
struct Containment {
  Answer answer = Answer::no;
  /// If it does: a vertex that is inside, twice, a triangle that has it, and triangle 0 of the solid's surface.
  std::optional<Witness> witness;
};

inline bool has_solid(const Placed& a, const Placed& b) { return a.body().is_solid() || b.body().is_solid(); }

/// Looks for a part of either core inside of the other's surface. `steps` is how many the query has made so far; each
/// volume and each triangle that may be inside is one more, and takes as long as a closest point at most.
///
/// A core that is known to be in one piece is inside if its first vertex is. The tree of any other core is descended
/// where the sphere of a volume meets the surface, or is at least as large as the solid. Any other sphere is inside or
/// outside as a whole, as its center is; one that is off the box around the solid is outside, which is no step.
/// Triangles do not meet the surface, so each is inside if its first corner is.
///
/// Pre      The triangles of the two models do not meet. Both are committed, and both poses are rigid.
/// Cost     In practice some closest points, where the surfaces are not close to each other all over. O(n log m) at
///          worst. Allocates nothing.
Containment find_containment(const Placed& a, const Placed& b, std::uint64_t steps, BudgetMeter& meter,
                             QueryStats& stats);

namespace {

/// Searches the tree of one model for a part that is inside of another model's closed surface.
class InsideSearch {
 public:
  InsideSearch(const point::PlacedModel& model, const point::PlacedModel& solid, QueryStats& stats)
      : model_(model),
        solid_(solid),
        closest_(solid),
        stats_(stats),
        center_of_solid_(bvh::slot_center(solid.tree(), bvh::root_slot)),
        radius_of_solid_(bvh::root_radius(solid.tree())),
        error_(base::placement_error * (model.magnitude() + solid.magnitude())) {}

  /// Whether a vertex has been found; unknown if the budget has been spent first.
  Answer run(std::uint64_t& steps, BudgetMeter& meter) {
    const bvh::Tree& tree = model_.tree();
    bvh::SlotStack waiting;
    waiting.start(0);
    for (bvh::SlotStack::Entry next; waiting.take(0, next);) {
      const Vec3 center = model_.center_of(next.slot);
      const double radius = model_.radius_of(next.slot) + 2 * error_;
      if (is_off_solid(center, radius)) continue;
      if (meter.is_spent(steps)) return Answer::undecided;
      ++steps;
      // A volume as large as the solid that is next to it most likely meets its surface.
      if (radius < radius_of_solid_ && !meets_surface(center, radius)) {
        if (!is_inside(center)) continue;
        take(bvh::first_leaf(tree, next.slot).leaf, 0);
        return Answer::yes;
      }
      if (!bvh::has_leaf(tree, next.slot)) {
        const std::uint32_t n = bvh::child_of(tree, next.slot);
        waiting.add(n, (1U << tree.nodes[n].child_count) - 1);
        continue;
      }
      const bvh::Leaf& leaf = bvh::leaf_of(tree, next.slot);
      for (std::uint32_t k = 0; k < bvh::width; ++k) {
        if (!leaf.is_in_use(k)) continue;
        const Vec3 corner = model_.position(leaf.vertices[k][0]);
        if (is_off_solid(corner, 0)) continue;
        if (meter.is_spent(steps)) return Answer::undecided;
        ++steps;
        if (!is_inside(corner)) continue;
        take(leaf, k);
        return Answer::yes;
      }
    }
    return Answer::no;
  }

  /// Pre: run() has answered yes.
  const Vec3& vertex() const { return vertex_; }
  TriangleId triangle() const { return triangle_; }

  /// Whether the first vertex of the tree is inside: the answer where all of the model is.
  bool begins_inside() {
    const bvh::Leaf& leaf = bvh::first_leaf(model_.tree(), 0).leaf;
    if (!is_inside(model_.position(leaf.vertices[0][0]))) return false;
    take(leaf, 0);
    return true;
  }

 private:
  /// Whether a ball certainly misses the box around the solid, or its slab: then it is outside.
  bool is_off_solid(const Vec3& center, double radius) {
    ++stats_.node_tests;
    const Vec3 point = solid_.in_model(center) - center_of_solid_;
    const double rounding = (bvh::sum_of_coordinates(point) + radius) * base::root_error + error_;
    return bvh::root_gap(solid_.tree(), point) > radius + rounding;
  }
  bool meets_surface(const Vec3& center, double radius) {
    return closest_.find(center, radius, stats_, radius).has_value();
  }
  bool is_inside(const Vec3& point) { return point::surrounding_of(solid_, point, stats_).is_inside_or_on(); }
  void take(const bvh::Leaf& leaf, std::uint32_t k) {
    vertex_ = model_.position(leaf.vertices[k][0]), triangle_ = leaf.triangle[k];
  }

  const point::PlacedModel &model_, &solid_;
  point::ClosestPointSearch closest_;
  QueryStats& stats_;
  Vec3 center_of_solid_;  // of the box around it, in its own frame
  double radius_of_solid_, error_;
  Vec3 vertex_;
  TriangleId triangle_ = no_id;
};

}  // namespace

Containment find_containment(const Placed& a, const Placed& b, std::uint64_t steps, BudgetMeter& meter,
                             QueryStats& stats) {
  LIMBER_ASSERT(has_solid(a, b));
  const point::PlacedModel placed_a(a), placed_b(b);
  const auto is_solid = [&](bool is_a) { return (is_a ? a : b).body().is_solid(); };
  InsideSearch searches[] = {{placed_b, placed_a, stats}, {placed_a, placed_b, stats}};
  // Which triangle of the surface around it is named does not matter.
  const auto found = [](const InsideSearch& search, bool is_in_a) {
    const TriangleId of_a = is_in_a ? 0 : search.triangle(), of_b = is_in_a ? search.triangle() : 0;
    return Containment{Answer::yes, Witness{search.vertex(), search.vertex(), of_a, of_b}};
  };
  // Where one is inside of the other as a whole, its first vertex tells; to look at all of the outer one may take long.
  // A core in one piece is inside as a whole or not at all, since the surfaces do not meet: its first vertex is enough.
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a)) continue;
    if (meter.is_spent(steps)) return {Answer::undecided, {}};
    ++steps;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    if (search.begins_inside()) return found(search, is_in_a);
  }
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a) || Access::is_in_one_piece((is_in_a ? b : a).body())) continue;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    const Answer answer = search.run(steps, meter);
    if (answer == Answer::yes) return found(search, is_in_a);
    if (answer == Answer::undecided) return {answer, {}};
  }
  return {};
}

}  // namespace limber::pair

// The public queries: each checks its arguments, and searches with a collector.
namespace limber {
namespace {

using pair::answer_of;
using pair::BudgetMeter;

/// Below that distance of cores, rounding could make a pair that is skipped as a tie one whose swept triangles meet.
double tied_with_contacts(const pair::PlacedPair& placed, const pair::Radii& radii) {
  if (!radii.has_radius()) return 0;
  return radii.radius() + 4 * (placed.error() + base::tie_error * radii.radius());
}

/// Whether a part of one body can be inside of the other: that takes a solid, and bounds that overlap.
bool may_contain(const Placed& a, const Placed& b, const pair::PlacedPair& placed) {
  return pair::has_solid(a, b) && placed.root_bound(std::numeric_limits<double>::min()) == 0;
}

pair::Containment find_containment(const Placed& a, const Placed& b, const pair::Unsearched& unsearched,
                                   BudgetMeter& meter, QueryStats& stats) {
  return pair::find_containment(a, b, static_cast<std::uint64_t>(unsearched.work), meter, stats);
}

/// Takes into account what is inside of solids, once the surfaces are known not to meet.
void look_inside(CollideResult& result, const Placed& a, const Placed& b, const pair::PlacedPair& placed,
                 const pair::Unsearched& unsearched, BudgetMeter& meter) {
  if (!result.is_no() || !may_contain(a, b, placed)) return;
  const pair::Containment found = find_containment(a, b, unsearched, meter, result.stats);
  result.answer = found.answer, result.witness = found.witness;
  if (found.answer == Answer::undecided) result.stopped_by = meter.stopped_by();
}

void look_inside(DistanceResult& result, const Placed& a, const Placed& b, const pair::PlacedPair& placed,
                 const pair::Unsearched& unsearched, BudgetMeter& meter) {
  if (result.status == DistanceStatus::collision || !may_contain(a, b, placed)) return;
  if (result.status != DistanceStatus::interrupted) {
    const pair::Containment found = find_containment(a, b, unsearched, meter, result.stats);
    if (found.answer == Answer::no) return;
    if (found.answer == Answer::yes) {
      result.lower = result.upper = 0, result.status = DistanceStatus::collision, result.witness = found.witness;
      result.stopped_by = StoppedBy::nothing;
      return;
    }
  }
  result.lower = 0, result.status = DistanceStatus::interrupted, result.stopped_by = meter.stopped_by();
  if (result.witness) return;
  // Some pair, as of every distance that was interrupted.
  pair::ClosestPair some({}, 0);
  some.compare(pair::placed_triangle(placed, pair::Side::a, placed.first_triangle(pair::Side::a)),
               pair::placed_triangle(placed, pair::Side::b, placed.first_triangle(pair::Side::b)));
  pair::set_answer(result, some, {0, result.stopped_by}, {}, pair::Radii(a, b));
}

CollideResult within(const Placed& a, const Placed& b, const pair::PlacedPair& placed, const pair::Radii& radii,
                     double max_distance, const QueryOptions& options) {
  BudgetMeter meter(options.budget);
  QueryStats stats;
  const double limit = radii.core_limit(max_distance);
  pair::ClosestPair collector({.max_distance = limit}, limit);
  // So that the answer is that of comparing all pairs, whatever comes first.
  const pair::Unsearched unsearched =
      pair::search(placed, options.cache, collector, meter, stats, pair::Ties::compared);
  if (collector.upper > limit) {
    CollideResult result = answer_of(std::nullopt, unsearched.stopped_by, stats);
    look_inside(result, a, b, placed, unsearched, meter);
    return result;
  }
  pair::remember(options.cache, *collector.witness);
  radii.move_points(*collector.witness, collector.upper);
  return answer_of(collector.witness, unsearched.stopped_by, stats);
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  const pair::Radii radii(a, b);
  if (radii.has_radius()) return within(a, b, placed, radii, 0, options);
  BudgetMeter meter(options.budget);
  QueryStats stats;
  pair::AnyContact collector;
  const pair::Unsearched unsearched = pair::search(placed, options.cache, collector, meter, stats);
  if (collector.witness) pair::remember(options.cache, *collector.witness);
  if (!pair::has_solid(a, b)) return answer_of(collector.witness, unsearched.stopped_by, stats);
  CollideResult result = answer_of(collector.witness, unsearched.stopped_by, stats);
  look_inside(result, a, b, placed, unsearched, meter);
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::distance");
  const pair::PlacedPair placed(a, b);
  const pair::Radii radii(a, b);
  BudgetMeter meter(options.budget);
  DistanceResult result;
  const double limit = radii.core_limit(options.max_distance);
  pair::ClosestPair collector({options.relative_error, options.absolute_error, limit}, radii.radius(), radii.radius());
  const pair::Unsearched unsearched = pair::search(placed, options.cache, collector, meter, result.stats,
                                                   pair::Ties::skipped, tied_with_contacts(placed, radii));
  if (!collector.witness && unsearched.stopped_by != StoppedBy::nothing) {  // abandoned before anything was compared
    collector.compare(pair::placed_triangle(placed, pair::Side::a, placed.first_triangle(pair::Side::a)),
                      pair::placed_triangle(placed, pair::Side::b, placed.first_triangle(pair::Side::b)));
  }
  pair::set_answer(result, collector, unsearched, options, radii);
  if (result.witness) pair::remember(options.cache, *result.witness);
  look_inside(result, a, b, placed, unsearched, meter);
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  return within(a, b, pair::PlacedPair(a, b), pair::Radii(a, b), max_distance, options);
}

QueryCache::QueryCache() = default;
QueryCache::QueryCache(QueryCache&&) noexcept = default;
QueryCache& QueryCache::operator=(QueryCache&&) noexcept = default;
QueryCache::~QueryCache() = default;

void QueryCache::clear() { impl_.reset(); }

QueryCache::Impl& QueryCache::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

}  // namespace limber
