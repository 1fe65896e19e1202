// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Quinlan1994] and the thesis this engine follows: two trees descended together, the larger sphere split,
//           the nearer child first; a pair is dropped when its lower bound cannot improve the answer by more than the
//           asked error.
// Differs   Both spheres of a pair are placed in the world, their bounds reduced by the rounding of the placement, so a
//           bound never overstates a gap. Dropped bounds are remembered: the smallest of them and the answer make the
//           certified interval. A pair whose bound is 0 is never dropped before a contact is found, at any error.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/rounding.h"
#include "classic/tree.h"
#include "geometry/primitives.h"
#include "geometry/rigid.h"
#include "limber/distance.h"

namespace limber::classic {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What all queries require of models and poses.
void check_placed(const Placed& a, const Placed& b) {
  for (const Placed* placed : {&a, &b}) {
    LIMBER_REQUIRE(placed->model().is_committed(),
                   "limber::classic: a query needs committed models; one has moved vertices, or has been moved from");
    LIMBER_REQUIRE(geometry::is_rigid(placed->pose),
                   "limber::classic: a query needs rigid poses; one of a model is not (see is_rigid())");
  }
}

/// A model's tree as it stands in the world.
class PlacedTree {
 public:
  explicit PlacedTree(const Placed& placed)
      : tree_(placed.model().tree()), pose_(placed.pose), stretch_(max_stretch(placed.pose.rotation)) {}

  const Node& node(std::uint32_t n) const { return tree_.nodes[n]; }
  Sphere sphere(std::uint32_t n) const {
    const Sphere& s = tree_.nodes[n].sphere;
    return {pose_(s.center), s.radius * stretch_};
  }
  Triangle triangle(TriangleId t) const {
    const Triangle& model = tree_.mesh.triangle(t);
    return {pose_(model.v0), pose_(model.v1), pose_(model.v2)};
  }

  /// Bounds how far rounding can shift a placed vertex against a placed sphere: each coordinate of either is off by at
  /// most 6 units (2^-53) of the magnitudes added, 2 * 6 * sqrt(3) < 2^5 for both together.
  double placement_error() const {
    const Sphere& all = tree_.nodes[root].sphere;
    const double magnitude = length(pose_.translation) + stretch_ * (length(all.center) + all.radius);
    return 0x1p-48 * magnitude;
  }

 private:
  const Tree& tree_;
  Transform pose_;
  double stretch_;
};

/// A node together with its sphere in the world.
struct Visit {
  std::uint32_t node;
  Sphere sphere;
};

/// The descent shared by all queries; `Query` says which bounds matter and what to do with two triangles.
///
/// Needs    bool Query::matters(double lower_bound): whether a pair that far apart must still be looked at.
///          void Query::compare(TriangleId a, TriangleId b, const Triangle&, const Triangle&).
template <typename Query>
class Descent {
 public:
  Descent(const Placed& a, const Placed& b, Query& query, QueryStats& stats)
      : a_(a), b_(b), query_(query), stats_(stats), error_(a_.placement_error() + b_.placement_error()) {}

  void run() {
    const Visit a{root, a_.sphere(root)}, b{root, b_.sphere(root)};
    visit(a, b, lower_bound(a.sphere, b.sphere));
  }

 private:
  void visit(const Visit& a, const Visit& b, double bound) {
    if (!query_.matters(bound)) return;
    const Node& node_a = a_.node(a.node);
    const Node& node_b = b_.node(b.node);
    if (node_a.is_leaf() && node_b.is_leaf()) {
      ++stats_.triangle_tests;
      query_.compare(node_a.triangle, node_b.triangle, a_.triangle(node_a.triangle), b_.triangle(node_b.triangle));
    } else if (node_b.is_leaf() || (!node_a.is_leaf() && a.sphere.radius >= b.sphere.radius)) {
      const Visit first = child(a_, node_a, 0), second = child(a_, node_a, 1);
      const double bound0 = lower_bound(first.sphere, b.sphere), bound1 = lower_bound(second.sphere, b.sphere);
      if (bound1 < bound0) visit(second, b, bound1);
      visit(first, b, bound0);
      if (bound1 >= bound0) visit(second, b, bound1);
    } else {
      const Visit first = child(b_, node_b, 0), second = child(b_, node_b, 1);
      const double bound0 = lower_bound(a.sphere, first.sphere), bound1 = lower_bound(a.sphere, second.sphere);
      if (bound1 < bound0) visit(a, second, bound1);
      visit(a, first, bound0);
      if (bound1 >= bound0) visit(a, second, bound1);
    }
  }

  static Visit child(const PlacedTree& tree, const Node& node, std::uint32_t which) {
    LIMBER_ASSERT(!node.is_leaf());
    const std::uint32_t n = node.first_child + which;
    return {n, tree.sphere(n)};
  }

  /// At most the distance of the triangles inside; 0 when the spheres meet.
  double lower_bound(const Sphere& a, const Sphere& b) {
    ++stats_.node_tests;
    const double radius_sum = base::add_up(base::add_up(a.radius, b.radius), error_);
    return std::max(0.0, (base::distance_down(a.center, b.center) - radius_sum) * (1 - 0x1p-52));
  }

  PlacedTree a_, b_;
  Query& query_;
  QueryStats& stats_;
  double error_;
};

struct CollisionQuery {
  std::optional<Witness> witness;

  bool matters(double lower_bound) const { return !witness && lower_bound == 0; }
  void compare(TriangleId id_a, TriangleId id_b, const Triangle& a, const Triangle& b) {
    if (!geometry::intersects(a, b)) return;
    const Vec3 shared = geometry::shared_point(a, b);
    witness = Witness{shared, shared, id_a, id_b};
  }
};

struct DistanceQuery {
  DistanceOptions options;
  double close_enough;  // a distance this small ends the query
  double cutoff;        // pairs at least this far apart cannot improve the answer enough
  double upper = infinity;
  double smallest_dropped = infinity;  // lower bound of everything that was not looked at
  std::optional<Witness> witness;

  // Closed: a pair exactly max_distance apart matters.
  DistanceQuery(const DistanceOptions& asked, double ends_below)
      : options(asked), close_enough(ends_below), cutoff(std::nextafter(asked.max_distance, infinity)) {}

  bool matters(double lower_bound) {
    if (upper <= close_enough) return false;
    if (lower_bound < cutoff || (lower_bound == 0 && upper > 0)) return true;
    smallest_dropped = std::min(smallest_dropped, lower_bound);
    return false;
  }
  void compare(TriangleId id_a, TriangleId id_b, const Triangle& a, const Triangle& b) {
    const ClosestPoints closest = geometry::closest_points(a, b);
    LIMBER_ASSERT(closest.distance >= 0);
    if (closest.distance >= upper) return;
    upper = closest.distance;
    witness = Witness{closest.point_a, closest.point_b, id_a, id_b};
    if (upper > options.max_distance) return;  // no answer, so nothing may be left out for its sake
    const double e = options.relative_error;
    const double relative = e == 0 ? upper : upper / (1 + e) * (1 - 0x1p-51);
    cutoff = std::min({cutoff, relative, upper - options.absolute_error});
  }
};

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) {
  const base::DefaultFloatEnvironment environment;
  check_placed(a, b);
  CollideResult result;
  CollisionQuery query;
  Descent(a, b, query, result.stats).run();
  result.witness = query.witness;
  result.answer = query.witness ? Answer::yes : Answer::no;
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::classic::distance");
  base::check_has_no_cache_or_budget(options, "limber::classic::distance");
  check_placed(a, b);
  DistanceResult result;
  DistanceQuery query(options, 0);
  Descent(a, b, query, result.stats).run();
  if (query.upper > options.max_distance) {
    result.lower = options.max_distance;
    result.upper = infinity;
    result.status = Status::beyond_limit;
    return result;
  }
  LIMBER_ASSERT(query.upper < infinity);
  result.upper = query.upper;
  result.lower = std::min(query.upper, query.smallest_dropped);
  LIMBER_ASSERT(result.lower <= result.upper);
  result.witness = query.witness;
  result.status = result.upper == 0              ? Status::collision
                  : result.lower == result.upper ? Status::exact
                                                 : Status::within_error;
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  check_placed(a, b);
  CollideResult result;
  DistanceQuery query({.max_distance = max_distance}, max_distance);
  Descent(a, b, query, result.stats).run();
  result.answer = query.upper <= max_distance ? Answer::yes : Answer::no;
  if (result.is_yes()) result.witness = query.witness;
  return result;
}

}  // namespace limber::classic
