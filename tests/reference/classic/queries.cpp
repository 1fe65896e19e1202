// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Quinlan1994] and the thesis that limber follows, plain and recursive: two trees descended together, the
//           larger sphere split, the nearer child first; a pair is dropped when its lower bound cannot improve the
//           answer by more than the asked error.
// Differs   Both spheres of a pair are placed in the world, their bounds reduced by the rounding of the placement, so a
//           bound never overstates a gap. The smallest bound of a dropped pair is remembered: it and the answer make
//           the certified interval. A pair whose bound is 0 is never dropped before a contact is found, at any error,
//           even where an absolute error above the distance makes the cutoff negative.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/rounding.h"
#include "geometry/primitives.h"
#include "geometry/rigid.h"
#include "reference/classic/classic.h"

namespace limber::classic {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// An upper bound of how much a rotation R stretches any vector: |R v|^2 <= (1 + e) |v|^2 if e is the largest sum of a
/// row of |R^T R - I|. The last term covers the rounding of e itself.
double max_stretch(const Mat3& rotation) {
  const Mat3 product = transpose(rotation) * rotation;
  const auto sum = [](const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  const Mat3 unit;
  return std::sqrt(1 + std::max({sum(product.row0 - unit.row0), sum(product.row1 - unit.row1),
                                 sum(product.row2 - unit.row2)})) +
         0x1p-48;
}

/// A model's tree as it stands in the world.
class PlacedTree {
 public:
  explicit PlacedTree(const Placed& placed)
      : tree_(placed.model().tree()), pose_(placed.pose), stretch_(max_stretch(placed.pose.rotation)) {
    LIMBER_ASSERT(placed.model().is_committed());
    LIMBER_ASSERT(geometry::is_rigid(placed.pose));
  }

  const Node& node(std::uint32_t n) const { return tree_.nodes[n]; }
  Sphere sphere(std::uint32_t n) const {
    const Sphere& s = tree_.nodes[n].sphere;
    return {pose_(s.center), s.radius * stretch_};
  }
  Triangle triangle(TriangleId t) const {
    const Triangle& local = tree_.mesh.triangle(t);
    return {pose_(local.v0), pose_(local.v1), pose_(local.v2)};
  }

  /// Bounds how far rounding can shift a placed vertex against a placed sphere. A coordinate of either is a sum of
  /// three products and the translation: six roundings of at most 2^-53 times the magnitudes added. For both, and three
  /// coordinates: 2 * 6 * sqrt(3) < 2^5, so 2^5 * 2^-53 = 2^-48.
  double placement_error() const {
    const Sphere& all = tree_.nodes[root].sphere;
    const double magnitude = length(pose_.translation) + stretch_ * (length(all.center) + all.radius);
    return 0x1p-48 * magnitude;
  }

 private:
  const Tree& tree_;
  Transform pose_;
  double stretch_;  // of lengths: a rotation may be orthonormal up to rounding only
};

/// A node together with its sphere in the world.
struct PlacedNode {
  std::uint32_t node;
  Sphere sphere;
};

/// The descent shared by all queries; `Query` says which bounds matter and what to do with two triangles.
///
/// Needs    bool Query::keeps(double lower_bound): whether a pair that far apart must still be looked at; else it is
///          dropped.
///          void Query::compare(TriangleId a, TriangleId b, const Triangle&, const Triangle&).
template <typename Query>
class Descent {
 public:
  Descent(const Placed& a, const Placed& b, Query& query, QueryStats& stats)
      : a_(a), b_(b), query_(query), stats_(stats), error_(a_.placement_error() + b_.placement_error()) {}

  void run() {
    const PlacedNode a{root, a_.sphere(root)}, b{root, b_.sphere(root)};
    visit(a, b, lower_bound(a.sphere, b.sphere));
  }

 private:
  void visit(const PlacedNode& a, const PlacedNode& b, double bound) {
    if (!query_.keeps(bound)) return;
    const Node& node_a = a_.node(a.node);
    const Node& node_b = b_.node(b.node);
    if (node_a.is_leaf() && node_b.is_leaf()) {
      ++stats_.primitive_tests;
      query_.compare(node_a.triangle, node_b.triangle, a_.triangle(node_a.triangle), b_.triangle(node_b.triangle));
    } else if (node_b.is_leaf() || (!node_a.is_leaf() && a.sphere.radius >= b.sphere.radius)) {
      PlacedNode near = child(a_, node_a, 0), far = child(a_, node_a, 1);
      double near_bound = lower_bound(near.sphere, b.sphere), far_bound = lower_bound(far.sphere, b.sphere);
      if (far_bound < near_bound) {
        std::swap(near, far);
        std::swap(near_bound, far_bound);
      }
      visit(near, b, near_bound);
      visit(far, b, far_bound);
    } else {
      PlacedNode near = child(b_, node_b, 0), far = child(b_, node_b, 1);
      double near_bound = lower_bound(a.sphere, near.sphere), far_bound = lower_bound(a.sphere, far.sphere);
      if (far_bound < near_bound) {
        std::swap(near, far);
        std::swap(near_bound, far_bound);
      }
      visit(a, near, near_bound);
      visit(a, far, far_bound);
    }
  }

  static PlacedNode child(const PlacedTree& tree, const Node& node, std::uint32_t which) {
    LIMBER_ASSERT(!node.is_leaf());
    const std::uint32_t n = node.first_child + which;
    return {n, tree.sphere(n)};
  }

  /// A lower bound of the distance of the triangles inside; 0 when the spheres meet. The factor covers the rounding of
  /// the subtraction and of itself.
  double lower_bound(const Sphere& a, const Sphere& b) {
    ++stats_.node_tests;
    const double radius_sum = add_up(add_up(a.radius, b.radius), error_);
    return std::max(0.0, (base::distance_down(a.center, b.center) - radius_sum) * (1 - 0x1p-52));
  }

  PlacedTree a_, b_;
  Query& query_;
  QueryStats& stats_;
  double error_;
};

struct CollisionQuery {
  std::optional<Witness> witness;

  bool keeps(double lower_bound) const { return !witness && lower_bound == 0; }
  void compare(TriangleId id_a, TriangleId id_b, const Triangle& a, const Triangle& b) {
    if (!geometry::intersects(a, b)) return;
    const Vec3 shared = geometry::shared_point(a, b);
    witness = Witness{shared, shared, id_a, id_b};
  }
};

struct DistanceQuery {
  DistanceOptions options;
  double close_enough;  // a distance at most this ends the query
  double cutoff;        // pairs at least this far apart cannot improve the answer enough
  double upper = infinity;
  double smallest_dropped = infinity;  // a lower bound of the distance of all pairs that were dropped
  std::optional<Witness> witness;

  // The cutoff begins just above max_distance: a pair exactly that far apart is an answer.
  DistanceQuery(const DistanceOptions& asked, double ends_at)
      : options(asked), close_enough(ends_at), cutoff(std::nextafter(asked.max_distance, infinity)) {}

  /// Whether a pair is kept. If not, it is dropped, and its bound is remembered; after the query has ended the bound is
  /// of no use, and everything is dropped.
  bool keeps(double lower_bound) {
    if (upper <= close_enough) return false;
    if (lower_bound < cutoff || lower_bound == 0) return true;
    smallest_dropped = std::min(smallest_dropped, lower_bound);
    return false;
  }
  void compare(TriangleId id_a, TriangleId id_b, const Triangle& a, const Triangle& b) {
    const ClosestPoints closest = geometry::closest_points(a, b);
    LIMBER_ASSERT(closest.distance >= 0);
    if (closest.distance >= upper) return;
    upper = closest.distance;
    witness = Witness{closest.point_a, closest.point_b, id_a, id_b};
    if (upper > options.max_distance) return;  // not an answer: it must not lower the cutoff
    // The answer may be off by the relative or the absolute error, whichever allows more, so the least of the three is
    // the cutoff. The quotient is rounded down.
    const double e = options.relative_error;
    const double relative = e == 0 ? upper : upper / (1 + e) * (1 - 0x1p-51);
    cutoff = std::min({cutoff, relative, upper - options.absolute_error});
  }
};

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) {
  CollideResult result;
  CollisionQuery query;
  Descent(a, b, query, result.stats).run();
  result.witness = query.witness;
  result.answer = query.witness ? Answer::yes : Answer::no;
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  DistanceResult result;
  DistanceQuery query(options, 0);
  Descent(a, b, query, result.stats).run();
  if (query.upper > options.max_distance) {
    result.lower = options.max_distance;
    result.upper = infinity;
    result.status = DistanceStatus::beyond_limit;
    return result;
  }
  LIMBER_ASSERT(query.upper < infinity);
  result.upper = query.upper;
  result.lower = std::min(query.upper, query.smallest_dropped);
  LIMBER_ASSERT(result.lower <= result.upper);
  result.witness = query.witness;
  result.status = result.upper == 0              ? DistanceStatus::collision
                  : result.lower == result.upper ? DistanceStatus::exact
                                                 : DistanceStatus::within_error;
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance) {
  CollideResult result;
  DistanceQuery query({.max_distance = max_distance}, max_distance);
  Descent(a, b, query, result.stats).run();
  result.answer = query.upper <= max_distance ? Answer::yes : Answer::no;
  if (result.is_yes()) result.witness = query.witness;
  return result;
}

}  // namespace limber::classic
