// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// When two elements come within a separation of each other: pieces of the time are decided in order, by decide().
// Bounds of the distance over a piece, the cheapest first (docs/algorithms/impact.md):
//   1. the distance at the beginning, less what the elements move relative to each other;
//   2. the gap along a direction that moves linearly, from one that separates the elements at the beginning to one that
//      separates them at the end;
//   3. the distance of the vertex from the plane of the face, or of the lines of the edges.
// The errors of the last two fall with the square of the piece's length. are_certainly_apart() uses the same bounds.
#include "motion/element_impact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "base/check.h"
#include "base/error_bounds.h"
#include "geometry/primitives.h"

namespace limber::motion {
namespace {

class SeparationSearch {
 public:
  SeparationSearch(const MovingElements& e, const ElementImpactOptions& options)
      : kind_(e.kind), max_time_(options.max_time), time_error_(std::max(options.time_error, time_resolution)) {
    const Vec3& origin = e.corners[0][0];
    double extent = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      extent = std::max({extent, max_abs(e.corners[0][i] - origin), max_abs(e.corners[1][i] - origin)});
    }
    // In a unit in which the extent is from 1 to 2, so that nothing that matters underflows. In two steps, because one
    // factor may be out of range.
    const int exponent = extent > 0 ? std::ilogb(extent) : 0, half = exponent / 2;
    const double scale = std::ldexp(1.0, -half), rest = std::ldexp(1.0, half - exponent);
    const auto scaled = [&](const auto& x) { return rest * (scale * x); };
    for (std::size_t i = 0; i < 4; ++i) {
      start_[i] = scaled(e.corners[0][i] - origin);
      motion_[i] = scaled(e.corners[1][i] - origin) - start_[i];
    }
    separation_ = scaled(options.min_separation);
    for_each_difference(at(0), at(1), [&](const Vec3& x0, const Vec3& x1) {
      relative_motion_ = std::max(relative_motion_, length(x1 - x0));
    });
    // From corners as they are given, so that each vector is as exact as its own size allows.
    const auto scaled_vectors = [&](const Vec3(&corners)[4]) { return scaled(vectors_of(kind_, corners)); };
    start_vectors_ = scaled_vectors(e.corners[0]);
    const Vectors end = scaled_vectors(e.corners[1]);
    motion_of_vectors_ = end - start_vectors_;
    const auto largest = [](const Vec3& x, const Vec3& y) { return std::max(max_abs(x), max_abs(y)); };
    const double u = largest(start_vectors_.u, end.u), v = largest(start_vectors_.v, end.v);
    normal_error_ = base::moving_area_error * u * v;
    volume_error_ = base::moving_volume_error * u * v * largest(start_vectors_.w, end.w);
  }

  ElementImpact run() {
    Moment begin = moment(0);
    if (is_within(begin)) return {ImpactStatus::initial_contact, 0, 0};
    Moment ends[most_halvings + 1];  // of the pieces that are left, the next one on top
    std::size_t open = 0;
    ends[open++] = moment(max_time_);
    Moment middle = begin;
    for (std::uint64_t steps = 1; open > 0; ++steps) {
      if (steps % many_steps == 0) tolerance_ *= 2;
      Moment& end = ends[open - 1];
      const Decision decision = decide(begin, end, middle);
      if (decision == Decision::last) return {ImpactStatus::contact, begin.time, end.time};
      if (decision == Decision::shorten) {
        end = middle;
      } else if (decision == Decision::halve) {
        LIMBER_ASSERT(open <= most_halvings);
        ends[open++] = middle;
      } else {
        // Its end may still exceed the separation by no more than the tolerance: then it is the answer.
        if (is_within(end)) return {ImpactStatus::contact, end.time, end.time};
        begin = end, --open;
      }
    }
    return {};
  }

  /// Whether a few pieces are enough to show that the elements are apart up to the largest time. Unlike run(), gives up
  /// where they are within the separation at any moment.
  bool proves_apart() const {
    Moment begin = moment(0);
    Moment ends[most_pieces];  // of the pieces that are left, the next one on top
    std::size_t open = 0;
    ends[open++] = moment(max_time_);
    if (is_within(begin) || is_within(ends[0])) return false;
    for (std::size_t pieces = 1; open > 0; ++pieces) {
      const Moment& end = ends[open - 1];
      if (are_apart(begin, end)) {
        begin = end, --open;
        continue;
      }
      const double middle = 0.5 * (begin.time + end.time);
      if (pieces >= most_pieces || !(middle > begin.time && middle < end.time)) return false;
      ends[open++] = moment(middle);
      if (is_within(ends[open - 1])) return false;
    }
    return true;
  }

 private:
  // Elements that do not touch are rarely left after so many pieces; the filter gives up after as many.
  static constexpr std::size_t most_pieces = 24;
  // Halving [0, 1] ends at pieces of time_resolution, 2^-53: after 53 times. One to spare.
  static constexpr std::size_t most_halvings = 54;
  // Elements that turn while they stay hardly beyond the separation need any number of pieces: after every so many
  // steps the tolerance doubles. That rounds the separation up, which the promise allows (docs/algorithms/impact.md):
  // no contact is missed. A guess: others take about a step for each binary digit of the time.
  static constexpr std::uint64_t many_steps = 2048;
  // As a part of the extent, the largest coordinate relative to the first corner at the start, with eps = 2^-53: a
  // placed corner is off by 8 eps in each coordinate, the difference of two by 28 eps, a gap by 34 eps more: 62 eps <
  // 2^-47. A distance is off by less. The extent is up to 2 here.
  static constexpr double element_gap_error = 2 * 0x1p-47;
  // Shorter vectors have no squared length in float64.
  static constexpr double least_length_sq = 0x1p-900;

  struct Placed {
    Vec3 corners[4];
  };
  /// A beginning or an end of pieces of time, and the closest points of the elements there.
  struct Moment {
    double time;
    ClosestPoints closest;
  };
  Placed at(double t) const {
    Placed placed;
    for (std::size_t i = 0; i < 4; ++i) placed.corners[i] = start_[i] + t * motion_[i];
    return placed;
  }

  bool is_face() const { return kind_ == MovingElements::Kind::vertex_face; }

  Moment moment(double time) const {
    const Placed placed = at(time);
    const auto& [a, b, c, d] = placed.corners;
    return {time, is_face() ? geometry::closest_points(a, Triangle{b, c, d})
                            : geometry::closest_points(Segment{a, b}, Segment{c, d})};
  }

  /// Whether the elements are within the separation, or above it by no more than the tolerance.
  bool is_within(const Moment& moment) const { return moment.closest.distance <= separation_ + tolerance_; }

  enum class Decision { last, shorten, halve, clear };
  /// What to do with a piece of time. Unless that is `last` or the piece is too short to be split, fills `middle`.
  Decision decide(const Moment& begin, const Moment& end, Moment& middle) const {
    const double length = end.time - begin.time;
    // As short as asked for, and within the separation at its end: it holds the first contact.
    if (length <= time_error_ && is_within(end)) return Decision::last;
    // So short a piece counts as clear: nothing in it moves by more than the rounding of positions.
    if (length <= time_resolution) return Decision::clear;
    middle = moment(begin.time + 0.5 * length);
    if (is_within(middle)) return Decision::shorten;  // the first contact is not after the middle
    return are_apart(begin, end) ? Decision::clear : Decision::halve;
  }

  /// Calls use() with all differences of a corner of the second element and one of the first, at two times.
  template <typename Use>
  void for_each_difference(const Placed& begin, const Placed& end, const Use& use) const {
    const std::size_t first_count = is_face() ? 1 : 2;
    for (std::size_t i = 0; i < first_count; ++i) {
      for (std::size_t k = first_count; k < 4; ++k) {
        use(begin.corners[k] - begin.corners[i], end.corners[k] - end.corners[i]);
      }
    }
  }

  /// Whether a bound shows that the elements are farther apart than the separation from one time to another.
  bool are_apart(const Moment& from, const Moment& to) const {
    const auto &first = from.closest, &last = to.closest;
    if (first.distance - relative_motion_ * (to.time - from.time) - element_gap_error > separation_) return true;
    const Placed begin = at(from.time), end = at(to.time);
    if (are_apart_along(begin, first.point_b - first.point_a, end, last.point_b - last.point_a)) return true;
    const Vectors a = start_vectors_ + from.time * motion_of_vectors_,
                  b = start_vectors_ + to.time * motion_of_vectors_;
    if (are_planes_apart(a, b) || are_apart_along(begin, cross(a.u, a.v), end, cross(b.u, b.v))) return true;
    const auto are_apart_across = [&](const EdgeAndWay& i) {
      return are_apart_along(begin, across(i, begin), end, across(i, end));
    };
    const std::span<const EdgeAndWay> all = is_face() ? std::span<const EdgeAndWay>(of_face) : of_edges;
    return std::any_of(all.begin(), all.end(), are_apart_across);
  }

  /// Bound 3: det(u, v, w) / |u x v|. The length of a quadratic in Bernstein form is at most the largest length of its
  /// coefficients.
  bool are_planes_apart(const Vectors& a, const Vectors& b) const {
    // u x v is the sum of these times (1 - t)^2, 2 t (1 - t) and t^2, for t from 0 to 1 in the piece.
    const Vec3 normals[3] = {cross(a.u, a.v), 0.5 * (cross(a.u, b.v) + cross(b.u, a.v)), cross(b.u, b.v)};
    const double longest = std::max({length(normals[0]), length(normals[1]), length(normals[2])});
    if (!(longest * longest > least_length_sq)) return false;
    const double least_size = BernsteinVolume(a, b).least_size() - volume_error_;
    return least_size > (separation_ + element_gap_error) * (longest + 2 * normal_error_);
  }

  /// The corners of an edge, and two between which a way leads from it to the other element.
  struct EdgeAndWay {
    std::size_t edge[2], way[2];
  };
  // From the edges of a face to the vertex; from each of two edges to both ends of the other.
  static constexpr EdgeAndWay of_face[] = {{{1, 2}, {0, 1}}, {{2, 3}, {0, 2}}, {{3, 1}, {0, 3}}};
  static constexpr EdgeAndWay of_edges[] = {{{0, 1}, {0, 2}}, {{0, 1}, {0, 3}}, {{2, 3}, {0, 2}}, {{2, 3}, {1, 2}}};

  /// The part of the way across the edge: perpendicular to it up to the rounding of a product, however near the
  /// elements are.
  static Vec3 across(const EdgeAndWay& i, const Placed& placed) {
    const Vec3(&p)[4] = placed.corners;
    const Vec3 edge = p[i.edge[1]] - p[i.edge[0]], way = p[i.way[1]] - p[i.way[0]];
    return cross(cross(edge, way), edge);
  }

  /// The direction with length 1, on the side of the second element.
  std::optional<Vec3> unit_direction(const Placed& placed, const Vec3& direction) const {
    if (!(length_sq(direction) > least_length_sq)) return {};
    double side = 0;
    for_each_difference(placed, placed, [&](const Vec3& x, const Vec3&) { side += dot(direction, x); });
    return ((side < 0 ? -1 : 1) / length(direction)) * direction;
  }

  /// Bound 2. Along a direction that moves linearly the difference of two corners is a quadratic in time, so its
  /// Bernstein coefficients bound it; and between two directions of length 1 it is not longer than 1.
  bool are_apart_along(const Placed& begin, const Vec3& first, const Placed& end, const Vec3& last) const {
    const std::optional<Vec3> n0 = unit_direction(begin, first), n1 = unit_direction(end, last);
    if (!n0 || !n1) return false;
    double least = std::numeric_limits<double>::infinity();
    for_each_difference(begin, end, [&](const Vec3& x0, const Vec3& x1) {
      least = std::min({least, dot(*n0, x0), dot(*n1, x1), 0.5 * (dot(*n0, x1) + dot(*n1, x0))});
    });
    return least - element_gap_error > separation_;
  }

  MovingElements::Kind kind_;
  double max_time_, time_error_, separation_;
  double tolerance_ = 2 * element_gap_error;
  Vec3 start_[4], motion_[4];  // of the corners
  double relative_motion_ = 0;
  Vectors start_vectors_, motion_of_vectors_;
  double normal_error_, volume_error_;
};

}  // namespace

ElementImpact separation_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  return SeparationSearch(elements, options).run();
}

bool are_certainly_apart(const MovingElements& elements, double max_time) {
  return SeparationSearch(elements, {.max_time = max_time, .time_error = 0, .min_separation = 0}).proves_apart();
}

}  // namespace limber::motion
