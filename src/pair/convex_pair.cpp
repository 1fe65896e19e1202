// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/convex_pair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "geometry/local_frame.h"
#include "pair/query_cache_impl.h"

namespace limber::pair {
namespace {

using model::ConvexParts;

/// A power of two that brings lengths near to 1, where products of six of them could leave float64.
double scale_of(double size) {
  if (size > 0x1p-80 && size < 0x1p80) return 1;
  int exponent = 0;
  std::frexp(size, &exponent);
  return std::ldexp(1.0, -std::max(exponent, -1000));
}

/// Finds the point of a simplex that is nearest to the origin, and leaves the corners that it is between.
class NearestOfSimplex {
 public:
  explicit NearestOfSimplex(Simplex& simplex) : simplex_(simplex) {}

  /// False if the hull has the origin.
  bool reduce() {
    switch (simplex_.count) {
      case 1:
        return take_corner(0);
      case 2:
        return take_edge(0, 1);
      case 3:
        return take_triangle(0, 1, 2);
      default:
        return take_tetrahedron();
    }
  }

 private:
  const Vec3& at(std::size_t i) const { return simplex_.corners[i].way; }
  bool keep(std::initializer_list<std::size_t> corners, std::initializer_list<double> weights, const Vec3& direction,
            double distance) {
    std::array<DifferenceCorner, 4> kept;
    std::size_t n = 0;
    for (const std::size_t i : corners) kept[n++] = simplex_.corners[i];
    std::copy(weights.begin(), weights.end(), simplex_.weights.begin());
    simplex_.corners = kept, simplex_.count = static_cast<std::uint32_t>(n);
    simplex_.direction = direction, simplex_.distance = distance;
    return distance > 0;
  }
  bool take_corner(std::size_t i) {
    const double distance = length(at(i));
    return keep({i}, {1}, distance > 0 ? at(i) * (1 / distance) : Vec3{}, distance);
  }
  bool take_edge(std::size_t i, std::size_t j) {
    const Vec3 edge = at(j) - at(i);
    const double along = -dot(at(i), edge), length_sq = limber::length_sq(edge);
    if (along <= 0) return take_corner(i);
    if (along >= length_sq) return take_corner(j);
    const double part = along / length_sq;
    const Vec3 nearest = at(i) + part * edge;
    const Vec3 across = nearest - (dot(nearest, edge) / length_sq) * edge;
    const double distance = length(across);
    return keep({i, j}, {1 - part, part}, distance > 0 ? across * (1 / distance) : Vec3{}, distance);
  }
  /// [Ericson2005], section 5.1.5.
  bool take_triangle(std::size_t i, std::size_t j, std::size_t k) {
    const Vec3 &p = at(i), &q = at(j), &r = at(k);
    const Vec3 to_q = q - p, to_r = r - p;
    const double q_at_p = -dot(to_q, p), r_at_p = -dot(to_r, p);
    if (q_at_p <= 0 && r_at_p <= 0) return take_corner(i);
    const double q_at_q = -dot(to_q, q), r_at_q = -dot(to_r, q);
    if (q_at_q >= 0 && r_at_q <= q_at_q) return take_corner(j);
    const double q_at_r = -dot(to_q, r), r_at_r = -dot(to_r, r);
    if (r_at_r >= 0 && q_at_r <= r_at_r) return take_corner(k);
    // Twice the areas next to each edge, times that of the triangle, by the normal: products of heights lose more.
    const Vec3 normal = cross(to_q, to_r);
    const double area_sq = length_sq(normal);
    const double of_r = dot(normal, cross(p, q)), of_p = dot(normal, cross(q, r)), of_q = dot(normal, cross(r, p));
    if (of_r <= 0 && q_at_p >= 0 && q_at_q <= 0) return take_edge(i, j);
    if (of_q <= 0 && r_at_p >= 0 && r_at_r <= 0) return take_edge(i, k);
    if (of_p <= 0 && r_at_q - q_at_q >= 0 && q_at_r - r_at_r >= 0) return take_edge(j, k);
    if (!(area_sq > 0)) return take_edge(i, j);
    const double height = dot(normal, p), size = std::sqrt(area_sq), total = 1 / (of_p + of_q + of_r);
    const double distance = std::abs(height) / size;
    return keep({i, j, k}, {of_p * total, of_q * total, of_r * total}, normal * ((height < 0 ? -1 : 1) / size),
                distance);
  }
  /// The corner 3 is the newest: the face of the others hides nothing.
  bool take_tetrahedron() {
    const Simplex whole = simplex_;
    Simplex best;
    bool has_best = false;
    for (const auto& [i, j, k] : {std::array<std::size_t, 3>{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
      const Vec3 normal = cross(whole.corners[j].way - whole.corners[i].way, at_of(whole, 3) - at_of(whole, i));
      const double inside = dot(normal, at_of(whole, k) - at_of(whole, i)), origin = -dot(normal, at_of(whole, i));
      if (inside != 0 && (origin == 0 || (origin > 0) == (inside > 0))) continue;
      simplex_ = whole;
      take_triangle(i, j, 3);
      if (!has_best || simplex_.distance < best.distance) best = simplex_, has_best = true;
    }
    simplex_ = has_best ? best : whole;
    if (!has_best) simplex_.distance = 0;
    return simplex_.distance > 0;
  }
  static const Vec3& at_of(const Simplex& simplex, std::size_t i) { return simplex.corners[i].way; }

  Simplex& simplex_;
};

bool has_corner(const Simplex& simplex, const DifferenceCorner& corner) {
  return std::any_of(simplex.corners.begin(), simplex.corners.begin() + simplex.count,
                     [&](const DifferenceCorner& c) { return c.a == corner.a && c.b == corner.b; });
}

}  // namespace

bool reduce(Simplex& simplex) { return NearestOfSimplex(simplex).reduce(); }

Vec3 point_of(const ConvexParts& parts, const Simplex& simplex, Side side) {
  Vec3 point;
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    point += simplex.weights[i] * parts.position(side == Side::a ? simplex.corners[i].a : simplex.corners[i].b);
  }
  return point;
}

TriangleId triangle_at(const ConvexParts& parts, const Simplex& simplex, Side side) {
  std::array<std::uint32_t, 4> corners{};
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    const std::uint32_t corner = side == Side::a ? simplex.corners[i].a : simplex.corners[i].b;
    const auto end = corners.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::find(corners.begin(), end, corner) == end) corners[count++] = corner;
  }
  return parts.triangle_at(std::span(corners).first(count), point_of(parts, simplex, side));
}

ConvexDifference::ConvexDifference(const PlacedPair& placed, const ConvexParts& a, const ConvexParts& b)
    : a_(a),
      b_(b),
      pose_a_(placed.pose(Side::a)),
      pose_b_(placed.pose(Side::b)),
      back_a_(transpose(pose_a_.rotation)),
      back_b_(transpose(pose_b_.rotation)),
      translation_(pose_b_.translation - pose_a_.translation),
      scale_(scale_of(placed.error() / base::placement_error)),
      // Turning a direction, three products each of a height, and placing a corner: 19 u of 64.
      rounding_(placed.error() / 4 * scale_) {}

DifferenceCorner ConvexDifference::corner(std::uint32_t a, std::uint32_t b) const {
  return {(turned(Side::b, b_.position(b)) - turned(Side::a, a_.position(a)) + translation_) * scale_, a, b};
}

DifferenceCorner ConvexDifference::lowest(const Vec3& direction) {
  last_a_ = a_.support(back_a_ * direction, last_a_).corner;
  last_b_ = b_.support(back_b_ * -direction, last_b_).corner;
  return corner(last_a_, last_b_);
}

double ConvexDifference::least_height(const Vec3& direction) const {
  const double of_a = a_.scan(back_a_ * direction).height, of_b = b_.scan(back_b_ * -direction).height;
  return (dot(direction, translation_) - of_b - of_a) * scale_;
}

Vec3 ConvexDifference::between_centers() const {
  return (turned(Side::b, b_.center()) - turned(Side::a, a_.center()) + translation_) * scale_;
}

void ConvexSearch::prove() {
  const bool is_proven = difference_.parts(Side::a).is_scanned() && difference_.parts(Side::b).is_scanned();
  height_ = std::max(height_, is_proven ? best_height_ : difference_.least_height(best_direction_));
}

void ConvexSearch::run(double enough, const ConvexStart& start, bool may_give_up, QueryStats& stats) {
  constexpr int most_steps = 64;
  // Bodies that overlap along their centers by this part of the distance of these rarely are apart. No answer depends
  // on it.
  constexpr double deep_part = 0.25;
  const ConvexParts &a = difference_.parts(Side::a), &b = difference_.parts(Side::b);
  for (std::uint32_t i = 0; i < start.count; ++i) {
    if (start.a[i] >= a.count() || start.b[i] >= b.count()) continue;
    simplex_.corners[simplex_.count++] = difference_.corner(start.a[i], start.b[i]);
    difference_.start_at(start.a[i], start.b[i]);
  }
  double farthest = std::numeric_limits<double>::infinity();
  for (int step = 0; step < most_steps; ++step) {
    ++stats.node_tests;
    Vec3 direction;
    double deep = std::numeric_limits<double>::infinity();
    if (simplex_.count > 0) {
      if (!reduce(simplex_) || meets() || simplex_.distance >= farthest) break;
      farthest = simplex_.distance, direction = simplex_.direction;
    } else {
      direction = difference_.between_centers();
      if (may_give_up) deep = deep_part * length(direction);
      direction = max_abs(direction) > 0 ? geometry::unit(direction) : Vec3{1, 0, 0};
    }
    const DifferenceCorner lowest = difference_.lowest(direction);
    const double height = dot(direction, lowest.way);
    if (height < -deep) return;
    if (height > best_height_) best_height_ = height, best_direction_ = direction;
    if (best_height_ >= enough) {
      prove();
      if (height_ >= enough) return;
    }
    if (simplex_.count > 0 && (farthest - best_height_ <= difference_.rounding() / 8 || has_corner(simplex_, lowest))) {
      is_over_ = true;
      break;
    }
    simplex_.corners[simplex_.count++] = lowest;
  }
  if (best_height_ > 0) prove();
}

ConvexGap find_gap(const Placed& a, const Placed& b, const PlacedPair& placed, double enough, const QueryBudget& budget,
                   QueryCache* cache, QueryStats& stats) {
  const ConvexParts *parts_a = Access::convex_parts(a.body()), *parts_b = Access::convex_parts(b.body());
  if (parts_a == nullptr || parts_b == nullptr || base::is_limited(budget)) return {};
  if (placed.is_triangle(Side::a) && placed.is_triangle(Side::b)) return {};  // compared at once
  if (const double bound = placed.root_bound(enough); bound > enough) return {.lower = bound};
  ConvexDifference difference(placed, *parts_a, *parts_b);
  ConvexSearch search(difference);
  ConvexStart* const start = cache == nullptr ? nullptr : &Access::impl(*cache).convex_start;
  search.run(difference.units((enough + placed.error()) * base::outward), start == nullptr ? ConvexStart{} : *start,
             true, stats);
  const Simplex& simplex = search.simplex();
  if (start != nullptr) {
    start->count = std::min(simplex.count, 3U);
    for (std::uint32_t i = 0; i < start->count; ++i) {
      start->a[i] = simplex.corners[i].a, start->b[i] = simplex.corners[i].b;
    }
  }
  ConvexGap gap;
  gap.height = difference.from_units(search.height());
  gap.lower = gap.height * base::inward - placed.error();
  gap.rounding = placed.error() / 4;
  if (!search.is_over()) return gap;
  gap.a = triangle_at(*parts_a, simplex, Side::a), gap.b = triangle_at(*parts_b, simplex, Side::b);
  return gap;
}

}  // namespace limber::pair
