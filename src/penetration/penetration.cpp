// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "geometry/rigid.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "limber/model.h"
#include "limber/penetration.h"
#include "pair/budget_meter.h"
#include "penetration/deepest_vertex.h"
#include "penetration/sweep.h"
#include "point/placed_model.h"

namespace limber::penetration {
namespace {

constexpr std::size_t most_contacts = 4096, most_contact_starts = 4;  // that are looked at, and to climb from
// What rounds, in tolerances of the sweep: placing each body, once before the move and once after it.
constexpr double placed_twice = 4;
// Placing each body once: depths and radii may be too large by that much.
constexpr double placed_once = 2;
constexpr int most_refinements = 16, most_pushes = 16;
// A refinement has to shorten a translation by this part of it to be worth another one.
constexpr double least_gain = 0x1p-10;
// By how much a direction is turned to look for a better one, if all else is done.
constexpr double widest_look = 0.5, narrowest_look = 0.03;

Placed moved(const Placed& body, const Vec3& translation) {
  return {body.model(), {body.pose.rotation, body.pose.translation + translation}};
}

Vec3 center_of(const Placed& body) { return body.pose(body.model().bounding_sphere().center); }

/// A few of many points, evenly spread over their order.
struct PointSample {
  std::vector<Vec3> points;
  std::size_t count = 0, stride = 1;

  void add(const Vec3& p) {
    if (count++ % stride != 0) return;
    points.push_back(p);
    if (points.size() < 2 * most_contact_starts) return;
    for (std::size_t i = 0; i < most_contact_starts; ++i) points[i] = points[2 * i];
    points.resize(most_contact_starts), stride *= 2;
  }
};

/// The deepest vertices of two placed bodies.
DeepestPair find_deepest(const point::PlacedModel& a, const point::PlacedModel& b, pair::Meter& meter) {
  DeepestVertexSearch of_a(a, b), of_b(b, a);
  of_a.run(meter), of_b.run(meter);
  return {of_a.deepest(), of_b.deepest(), std::max({of_a.upper(), of_b.upper(), 0.0})};
}

/// Looks for a short translation of a body that makes it apart from another one, and for a lower bound of all of them.
///
/// The translations that do not make two convex bodies apart are a convex set, and a sweep along a direction finds
/// where that direction leaves it, and a plane that bounds it there. The nearest point of that plane lies along its
/// normal. So a sweep along the normal is no longer than the last one, and so on to a facet whose normal leads to
/// itself. Bodies that are not convex take the same steps, which are kept while they shorten the translation.
class ShortestTranslation {
 public:
  /// Starts with a translation that parts the bounding spheres.
  ShortestTranslation(const Placed& a, const Placed& b, double relative_error, pair::Meter& meter)
      : a_(a),
        b_(b),
        placed_a_(a),
        placed_b_(b),
        relative_error_(relative_error),
        meter_(meter),
        sweep_(placed_a_, placed_b_),
        balls_(placed_a_, placed_b_) {
    const Vec3 between = center_of(b) - center_of(a);
    const double radii = a.model().bounding_sphere().radius + b.model().bounding_sphere().radius;
    const double apart = geometry::safe_length(between);
    upper_ =
        std::max(0.0, radii * (1 + base::rigidity_error) - apart * base::inward) + placed_twice * sweep_.tolerance();
    translation_ = upper_ * (apart > 0 ? unit(between) : Vec3{1, 0, 0});
    upper_ *= base::outward;
  }

  /// Pre: the bodies have a common point. `deepest` are their deepest vertices.
  void run(const DeepestPair& deepest) {
    look_at_contacts();
    raise_lower(deepest);
    add_directions(deepest);
    for (const Vec3& direction : directions_) {
      SweepResult found;
      if (!is_done() && shorten_along(direction, found)) refine(direction, found);
    }
    if (!is_done()) push_out(deepest);
    if (!is_done()) look_around();
    LIMBER_ASSERT(lower_ <= upper_);
  }

  /// Moved by this, b is apart from a.
  const Vec3& translation() const { return translation_; }
  double upper() const { return upper_; }  ///< at least its length
  double lower() const { return lower_; }  ///< no translation that makes them apart is shorter

 private:
  bool is_done() const {
    return upper_ <= (1 + relative_error_) * lower_ + placed_twice * sweep_.tolerance() ||
           meter_.stopped_by() != StoppedBy::nothing;
  }
  /// Takes a translation that is shorter than the best one, if a query proves that the surfaces do not meet after it.
  /// Pre: neither body is inside of the other then.
  bool accept(const Vec3& translation) {
    const double size = geometry::safe_length(translation) * base::outward;
    const Placed b = moved(b_, translation);
    if (size >= upper_ || !geometry::is_rigid(b.pose)) return false;
    const CollideResult met = collide(a_, b, {.budget = meter_.limits_of_time()});
    meter_.stats += met.stats;
    meter_.stop(met.stopped_by);
    if (!met.is_no()) return false;
    translation_ = translation, upper_ = size;
    return true;
  }
  void raise_lower(const DeepestPair& deepest) {
    for (const auto& vertex : {deepest.of_a, deepest.of_b}) {
      if (!vertex) continue;
      if (vertex->depth > placed_once * sweep_.tolerance())
        lower_ = std::max(lower_, vertex->depth);  // else it may but touch
      starts_.push_back(0.5 * (vertex->position + vertex->closest.position));
    }
    starts_.push_back(center_of(a_)), starts_.push_back(center_of(b_));
    const double reach = std::min(a_.model().bounding_sphere().radius, b_.model().bounding_sphere().radius);
    for (const Vec3& start : starts_) balls_.climb(start, reach, meter_);
    if (!balls_.best()) return;
    lower_ = std::max(lower_, balls_.best()->radii - placed_once * sweep_.tolerance());
    const Vec3 between = balls_.best()->out_a - balls_.best()->out_b;
    if (max_abs(between) > 0) directions_.push_back(unit(between));
  }
  /// Where the surfaces meet, normals tell the way out, and both insides are near.
  void look_at_contacts() {
    Vec3 way;
    PointSample sample;
    const PairCount found = visit_contacts(a_, b_, 0,
                                           [&](const Contact& contact) {
                                             if (contact.normal_side == NormalSide::outward) way = way + contact.normal;
                                             sample.add(contact.point_a);
                                             return sample.count < most_contacts && !meter_.is_spent();
                                           },
                                           {.oriented_faces = OrientedFaces::both, .budget = meter_.limits_of_time()});
    meter_.stats += found.stats;
    meter_.stop(found.stopped_by);
    if (max_abs(way) > 0) directions_.push_back(unit(way));
    starts_ = std::move(sample.points);
    // Between two of them, both insides are nearer still.
    for (std::size_t i = 1, n = starts_.size(); i < n; ++i) starts_.push_back(0.5 * (starts_[i] + starts_[i - 1]));
  }
  void add_directions(const DeepestPair& deepest) {
    if (deepest.of_a) directions_.push_back(-deepest.of_a->direction);
    if (deepest.of_b) directions_.push_back(deepest.of_b->direction);
    const Vec3 between = center_of(b_) - center_of(a_);
    if (max_abs(between) > 0) directions_.push_back(unit(between));
    for (const Placed* body : {&a_, &b_}) {
      const Mat3 axes = transpose(body->pose.rotation);
      for (const Vec3& axis : {axes.row0, axes.row1, axes.row2}) {
        directions_.push_back(unit(axis)), directions_.push_back(-unit(axis));
      }
    }
  }
  /// Whether a direction gives a shorter translation, which is then taken.
  bool shorten_along(const Vec3& direction, SweepResult& found) {
    found = sweep_.along(direction, meter_, upper_);
    return !found.is_over && accept((found.upper * base::outward + sweep_.tolerance()) * direction);
  }
  void refine(Vec3 direction, SweepResult found) {
    for (int i = 0; i < most_refinements && !is_done() && found.upper > 0; ++i) {
      const double before = upper_;
      for (const Vec3& next : {found.normal, unit(direction + found.normal)}) {
        SweepResult there;
        if (max_abs(next - direction) == 0 || !shorten_along(next, there)) continue;
        direction = next, found = there;
        break;
      }
      if (upper_ > (1 - least_gain) * before) return;
    }
  }
  /// Turns the best direction a little to each side, and less where that is no better.
  void look_around() {
    for (double turn = widest_look; turn >= narrowest_look && !is_done();) {
      const Vec3 direction = unit(translation_), side = perpendicular_to(direction), other = cross(direction, side);
      const double before = upper_;
      for (const Vec3& aside : {side, other, -side, -other, side + other, side - other, other - side, -side - other}) {
        const Vec3 next = unit(direction + turn * aside);
        SweepResult found;
        if (!is_done() && shorten_along(next, found)) refine(next, found);
        if (upper_ < (1 - least_gain) * before) break;
      }
      if (upper_ >= (1 - least_gain) * before) turn *= 0.5;
    }
  }
  /// Moves b by what the deepest vertex has to go, again and again. That finds the way where b is in a cavity of a.
  void push_out(DeepestPair deepest) {
    Vec3 translation;
    for (int i = 0; i < most_pushes && (deepest.of_a || deepest.of_b); ++i) {
      const bool is_of_a = deepest.of_a && (!deepest.of_b || deepest.of_a->depth >= deepest.of_b->depth);
      const DeepestVertex& vertex = is_of_a ? *deepest.of_a : *deepest.of_b;
      const double size = vertex.depth * base::outward + placed_twice * sweep_.tolerance();
      translation = translation + size * (is_of_a ? -vertex.direction : vertex.direction);
      const Placed b = moved(b_, translation);
      if (!(geometry::safe_length(translation) < upper_) || !geometry::is_rigid(b.pose)) return;
      deepest = find_deepest(placed_a_, point::PlacedModel(b), meter_);
    }
    if (!deepest.of_a && !deepest.of_b && meter_.stopped_by() == StoppedBy::nothing) accept(translation);
  }

  Placed a_, b_;
  point::PlacedModel placed_a_, placed_b_;
  double relative_error_;
  pair::Meter& meter_;
  Sweep sweep_;
  CommonBallsSearch balls_;
  std::vector<Vec3> starts_, directions_;
  Vec3 translation_;
  double upper_, lower_ = 0;
};

}  // namespace

}  // namespace limber::penetration

// The public queries: each checks its arguments, and searches.
namespace limber {

DeepestVertices deepest_vertices(const PlacedSurface& a, const PlacedSurface& b, const QueryBudget& budget) {
  const base::DefaultFloatEnvironment environment;
  const point::PlacedModel placed_a(Access::placed(a)), placed_b(Access::placed(b));
  pair::Meter meter(budget);
  const DeepestPair found = penetration::find_deepest(placed_a, placed_b, meter);
  return {found, meter.stopped_by(), meter.stats};
}

SeparatingTranslation separating_translation(const PlacedSurface& a, const PlacedSurface& b, const Vec3& direction,
                                             const QueryBudget& budget) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(is_finite(direction) && max_abs(direction) > 0,
                 "limber::separating_translation: the direction must be finite, and not 0");
  const point::PlacedModel placed_a(Access::placed(a)), placed_b(Access::placed(b));
  pair::Meter meter(budget);
  penetration::Sweep sweep(placed_a, placed_b);
  SeparatingTranslation result;
  result.direction = penetration::unit(direction * (max_abs(direction) > 1 ? 0x1p-100 : 1));
  const penetration::SweepResult found = sweep.along(result.direction, meter);
  result.lower = found.lower, result.upper = found.upper, result.witness = found.witness;
  result.stopped_by = meter.stopped_by(), result.stats = meter.stats;
  return result;
}

SolidDistance signed_distance(const PlacedSurface& a, const PlacedSurface& b, const SolidDistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(base::is_finite_and_not_negative(options.relative_error),
                 "limber::signed_distance: relative_error must be finite and at least 0");
  const Placed placed_a = Access::placed(a), placed_b = Access::placed(b);
  pair::Meter meter(options.budget);
  SolidDistance result;
  const DistanceResult apart = distance(placed_a, placed_b, {.budget = options.budget});
  result.deepest = penetration::find_deepest(point::PlacedModel(placed_a), point::PlacedModel(placed_b), meter);
  const bool has_vertex_inside = result.deepest.of_a || result.deepest.of_b;
  if (!has_vertex_inside && apart.lower > 0 && meter.stopped_by() == StoppedBy::nothing) {
    result.lower = apart.lower, result.upper = apart.upper, result.witness = apart.witness;
    result.stopped_by = apart.stopped_by;
  } else {
    penetration::ShortestTranslation translation(placed_a, placed_b, options.relative_error, meter);
    const bool have_common_point = has_vertex_inside || apart.upper == 0;
    if (have_common_point) translation.run(result.deepest);
    result.translation = translation.translation();
    result.lower = -translation.upper();
    result.upper = have_common_point ? 0 - translation.lower() : apart.upper;
    result.stopped_by = meter.stopped_by() == StoppedBy::nothing ? apart.stopped_by : meter.stopped_by();
  }
  result.stats = meter.stats;
  result.stats += apart.stats;
  return result;
}

}  // namespace limber
