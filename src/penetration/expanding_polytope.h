// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "limber/distance.h"
#include "limber/math.h"
#include "pair/convex_pair.h"

namespace limber::penetration {

/// How far the origin is from the border of the Minkowski difference of two bodies that meet.
///
/// Based on  The expanding polytope algorithm [VanDenBergen2001]: a polytope in the difference, with the origin inside,
///           grows where its surface is nearest to the origin.
/// Differs   What is proven does not depend on the polytope being convex. It stays a closed surface, since a cone over
///           the border takes the place of faces; if all faces have the origin behind them, it winds around the origin,
///           and so around each ball that no face reaches. Such a ball is in the difference. The height of the
///           difference along any direction is an upper bound, once all corners have been looked at.
///
/// Frame     That of the difference, in its units.
class ExpandingPolytope {
 public:
  explicit ExpandingPolytope(pair::ConvexDifference& difference) : difference_(difference) {}

  /// Grows from a simplex that has the origin, up to rounding.
  void run(const pair::Simplex& simplex, double relative_error, QueryStats& stats);

  /// The distance is between these.
  double lower() const { return lower_; }
  double upper() const { return upper_; }
  /// The outer normal of the difference along which `upper` was found.
  const Vec3& normal() const { return normal_; }
  /// The corners of the face that is nearest, and the weights of its nearest point.
  const pair::Simplex& nearest() const { return nearest_; }

 private:
  static constexpr std::uint16_t most_corners = 128, most_faces = 2 * most_corners;

  struct Face {
    std::array<std::uint16_t, 3> corners, next;  // next[i] is the face across the edge from corner i to the one after
    Vec3 normal;
    double distance;  // all of the face is at least so far along the normal
    bool is_sure;     // whether the origin is behind it, whatever rounding does
    bool is_seen;
  };

  struct HorizonEdge {
    std::uint16_t from, to, beyond;
  };

  pair::DifferenceCorner farthest(const Vec3& direction);
  bool start(const pair::Simplex& simplex);
  std::uint16_t add_corner(const pair::DifferenceCorner& corner);
  bool make_face(Face& face, std::uint16_t p, std::uint16_t q, std::uint16_t r) const;
  bool make_faces(std::initializer_list<std::array<std::uint16_t, 3>> faces);
  std::uint16_t nearest_face() const;
  bool has(const pair::DifferenceCorner& corner) const;
  bool grow(std::uint16_t first, const pair::DifferenceCorner& corner);
  void find_horizon(std::uint16_t first, const Vec3& corner);
  void prove_lower();

  pair::ConvexDifference& difference_;
  std::array<pair::DifferenceCorner, most_corners> corners_;
  std::array<Face, most_faces> faces_;
  std::array<std::uint16_t, most_faces> alive_, free_, seen_;
  std::array<HorizonEdge, most_faces> horizon_;
  std::uint16_t corner_count_ = 0, alive_count_ = 0, free_count_ = 0, seen_count_ = 0, horizon_count_ = 0;
  pair::Simplex nearest_;
  Vec3 normal_;
  double lower_ = 0, upper_ = std::numeric_limits<double>::infinity();
};

}  // namespace limber::penetration
