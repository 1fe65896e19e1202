// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pieces of the time are decided one after the other, in order. Take a direction in which the elements are apart at the
// begin of a piece, one at its end, and in between what moves linearly from one to the other. Along it the difference
// of two corners is a quadratic in time, whose Bernstein coefficients bound it. So they bound the gap of the elements,
// which is at most their distance. If that bound is above the separation, so is the distance at all times of the piece;
// otherwise the piece is halved. The error of the bound falls with the square of the piece's length.
#include "motion/separation_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "geometry/primitives.h"

namespace limber::motion {
namespace {

class SeparationSearch {
 public:
  SeparationSearch(const MovingElements& e, const ElementImpactOptions& options)
      : kind_(e.kind), max_time_(options.max_time), time_error_(std::max(options.time_error, shortest_piece)) {
    const Vec3& origin = e.corners[0][0];
    double extent = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      extent = std::max({extent, max_abs(e.corners[0][i] - origin), max_abs(e.corners[1][i] - origin)});
    }
    // In a unit in which the extent is from 1 to 2, so that nothing that matters underflows.
    const int exponent = extent > 0 ? std::ilogb(extent) : 0;
    const auto scaled = [&](const Vec3& p) {
      return Vec3{std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent)};
    };
    for (std::size_t i = 0; i < 4; ++i) {
      start_[i] = scaled(e.corners[0][i] - origin);
      motion_[i] = scaled(e.corners[1][i] - origin) - start_[i];
    }
    separation_ = std::ldexp(options.min_separation, -exponent);
  }

  ElementImpact run() {
    if (is_within(at(0))) return {ImpactStatus::initial_contact, 0, 0};
    End ends[most_halvings + 1];
    std::size_t open = 0;
    ends[open++] = {max_time_, is_within(at(max_time_))};
    double begin = 0;
    for (std::uint64_t pieces = 1; open > 0; ++pieces) {
      if (pieces % many_pieces == 0) tolerance_ *= 2;
      End& end = ends[open - 1];
      if (end.time - begin <= time_error_ && end.is_within) return {ImpactStatus::contact, begin, end.time};
      bool is_clear = end.time - begin <= shortest_piece;
      if (!is_clear) {
        const double middle = begin + 0.5 * (end.time - begin);
        if (is_within(at(middle))) {
          end = {middle, true};
          continue;
        }
        is_clear = are_apart(at(begin), at(end.time));
        if (!is_clear) {
          LIMBER_ASSERT(open <= most_halvings);
          ends[open++] = {middle, false};
          continue;
        }
      }
      // The elements are within the separation at the end of a piece that is clear, if they are so by rounding alone.
      if (end.is_within) return {ImpactStatus::contact, end.time, end.time};
      begin = end.time, --open;
    }
    return {};
  }

 private:
  // In a shorter piece nothing moves by more than the rounding of positions. It is reached by halving.
  static constexpr double shortest_piece = 0x1p-53;
  static constexpr std::size_t most_halvings = 54;
  // Where the distance stays hardly above the separation while elements turn, pieces may be without number: after every
  // so many of them the tolerance doubles.
  static constexpr std::uint64_t many_pieces = 1 << 14;
  // As a part of the extent, the largest coordinate relative to a corner at the start, with u = 2^-53: a placed corner
  // is off by 8 u in each coordinate, a difference of two by 28 u, a distance by 16 u more, a gap by 34 u more.
  static constexpr double error = 2 * 0x1p-47;

  /// The end of a piece of time, and whether the elements are within the separation there.
  struct End {
    double time;
    bool is_within;
  };

  struct Placed {
    Vec3 corners[4];
  };
  Placed at(double t) const {
    Placed placed;
    for (std::size_t i = 0; i < 4; ++i) placed.corners[i] = start_[i] + t * motion_[i];
    return placed;
  }

  bool is_face() const { return kind_ == MovingElements::Kind::vertex_face; }

  ClosestPoints closest_points(const Placed& placed) const {
    const auto& [a, b, c, d] = placed.corners;
    return is_face() ? geometry::closest_points(a, Triangle{b, c, d})
                     : geometry::closest_points(Segment{a, b}, Segment{c, d});
  }

  /// Then they are within the separation, up to rounding.
  bool is_within(const Placed& placed) const { return closest_points(placed).distance <= separation_ + tolerance_; }

  /// Directions in which elements may be apart: that of the closest points, and others that are perpendicular to an
  /// edge or a face up to the rounding of a product, however near the elements are.
  static constexpr std::size_t direction_count = 6;
  Vec3 direction(const Placed& placed, std::size_t which) const {
    const auto& [a, b, c, d] = placed.corners;
    const auto across = [](const Vec3& edge, const Vec3& way) { return cross(cross(edge, way), edge); };
    switch (which) {
      case 0: {
        const ClosestPoints closest = closest_points(placed);
        return closest.point_b - closest.point_a;
      }
      case 1:
        return is_face() ? cross(c - b, d - b) : cross(b - a, d - c);
      case 2:
        return is_face() ? across(c - b, b - a) : across(b - a, c - a);
      case 3:
        return is_face() ? across(d - c, c - a) : across(b - a, d - a);
      case 4:
        return is_face() ? across(b - d, d - a) : across(d - c, c - a);
      default:
        return is_face() ? Vec3{} : across(d - c, c - b);
    }
  }

  /// Calls use() with all differences of a corner of the second element and one of the first.
  template <typename Use>
  void for_each_difference(const Placed& begin, const Placed& end, const Use& use) const {
    const std::size_t first_count = is_face() ? 1 : 2;
    for (std::size_t i = 0; i < first_count; ++i) {
      for (std::size_t k = first_count; k < 4; ++k) {
        use(begin.corners[k] - begin.corners[i], end.corners[k] - end.corners[i]);
      }
    }
  }

  /// Of length 1, and on the side of the second element. Not finite if the direction is 0.
  Vec3 unit_direction(const Placed& placed, std::size_t which) const {
    const Vec3 n = direction(placed, which);
    double sum = 0;
    for_each_difference(placed, placed, [&](const Vec3& x, const Vec3&) { sum += dot(n, x); });
    return ((sum < 0 ? -1 : 1) / length(n)) * n;
  }

  /// Whether some direction shows that the elements are farther apart than the separation from one time to another.
  bool are_apart(const Placed& begin, const Placed& end) const {
    for (std::size_t which = 0; which < direction_count; ++which) {
      const Vec3 n0 = unit_direction(begin, which), n1 = unit_direction(end, which);
      double least = std::numeric_limits<double>::infinity();
      bool is_number = true;
      for_each_difference(begin, end, [&](const Vec3& x0, const Vec3& x1) {
        const double at_begin = dot(n0, x0), at_end = dot(n1, x1), between = 0.5 * (dot(n0, x1) + dot(n1, x0));
        least = std::min({least, at_begin, at_end, between});
        is_number = is_number && !std::isnan(between);
      });
      // In between the direction is not longer than 1.
      if (is_number && least - error > separation_) return true;
    }
    return false;
  }

  MovingElements::Kind kind_;
  double max_time_, time_error_, separation_;
  double tolerance_ = 2 * error;
  Vec3 start_[4], motion_[4];
};

}  // namespace

ElementImpact separation_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  return SeparationSearch(elements, options).run();
}

}  // namespace limber::motion
