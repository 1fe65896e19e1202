// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "geometry/local_frame.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "simd/kernels.h"

namespace limber::pair {

enum class Side { a, b };
inline Side other(Side s) { return s == Side::a ? Side::b : Side::a; }
inline std::size_t index(Side s) { return s == Side::a ? 0 : 1; }

/// The two models of a query and where they are. Constant while the query runs.
class PlacedPair {
 public:
  /// Throws   std::invalid_argument unless both models are committed and both poses are rigid.
  PlacedPair(const Placed& a, const Placed& b);

  const bvh::Tree& tree(Side s) const { return *sides_[index(s)].tree; }
  const MeshView& mesh(Side s) const { return sides_[index(s)].mesh; }
  const Transform& pose(Side s) const { return sides_[index(s)].pose; }

  /// Whether a model is a single triangle, as the core of a sphere is.
  bool is_triangle(Side s) const { return sides_[index(s)].mesh.triangles.size() == 1; }
  bool has_triangle(Side s, TriangleId t) const { return t < sides_[index(s)].mesh.triangles.size(); }
  /// A triangle in the frame of its model, and in the world. Pre: has_triangle(s, t).
  Triangle local_triangle(Side s, TriangleId t) const {
    LIMBER_ASSERT(has_triangle(s, t));
    return sides_[index(s)].mesh.triangle(t);
  }
  Triangle triangle(Side s, TriangleId t) const { return placed(s, local_triangle(s, t)); }
  /// A triangle given by its vertices, in the frame of its model, and in the world.
  Triangle local_triangle(Side s, const Corners& corners) const {
    const std::span<const Vec3> positions = sides_[index(s)].mesh.positions;
    return {positions[corners[0]], positions[corners[1]], positions[corners[2]]};
  }
  Triangle triangle(Side s, const Corners& corners) const { return placed(s, local_triangle(s, corners)); }
  /// A vertex in the frame of its model, and in the world. Pre: a triangle has it.
  const Vec3& local_position(Side s, VertexId v) const { return sides_[index(s)].mesh.positions[v]; }
  Vec3 position(Side s, VertexId v) const { return pose(s)(local_position(s, v)); }
  /// Some triangle.
  TriangleId first_triangle(Side s) const { return tree(s).leaves[0].triangle[0]; }

  /// A lower bound of the distance of the models, from the bounds of their roots; any that is `enough`, or the best.
  double root_bound(double enough = std::numeric_limits<double>::infinity()) const;

  /// What float64 rounding can change a length between placed points by.
  double error() const { return error_; }
  /// Whether both poses are the identity, so that placing does not round.
  bool is_placed_exactly() const { return is_placed_exactly_; }
  /// Whether placing may round by about as much as error() says. Not where it does not round, and not where a motion
  /// margin has let vertices go so far that the models may be much smaller than error() assumes.
  bool is_error_tight() const { return is_error_tight_; }

  /// How far vertices of both models together may be outside of the bounds.
  double slack() const { return tree(Side::a).slack + tree(Side::b).slack; }

  /// An upper bound of what a motion of b, seen from a, can change the distance of any two points by: from the pose
  /// `before`, where error() was `error_before`, to the pose `after`.
  double max_displacement(const Transform& before, double error_before, const Transform& after) const;

 private:
  struct PlacedTree {
    const bvh::Tree* tree;
    MeshView mesh;
    Transform pose;
  };
  const PlacedTree& at(Side s) const { return sides_[index(s)]; }
  Triangle placed(Side s, const Triangle& local) const;

  PlacedTree sides_[2];
  double error_;
  bool is_placed_exactly_, is_error_tight_;
};

/// What the radii of two bodies make of the distances and points of their cores, the triangles. Searches are about
/// cores: what matters at a distance does so at core_limit() of it. Without radii, everything stays as it is, to the
/// bit.
class Radii {
 public:
  Radii(double radius_a, double radius_b) : radius_a_(radius_a), radius_b_(radius_b), radius_(radius_a + radius_b) {
    LIMBER_ASSERT(radius_a >= 0 && radius_b >= 0 && radius_ <= 2 * max_coordinate);
  }
  Radii(const Placed& a, const Placed& b) : Radii(a.body().radius(), b.body().radius()) {}

  /// Both radii together.
  double radius() const { return radius_; }
  bool has_radius() const { return radius_ > 0; }

  /// The distance of bodies whose cores are that far apart.
  double distance(double of_cores) const { return std::max(0.0, of_cores - radius_); }
  /// The largest distance of cores whose bodies are at most `distance` apart, as distance() computes it.
  double core_limit(double distance) const {
    if (!has_radius() || distance == 0 || distance >= std::numeric_limits<double>::max()) return radius_ + distance;
    double limit = radius_ + distance;
    while (this->distance(limit) > distance) limit = std::nextafter(limit, 0);
    for (;;) {
      const double next = std::nextafter(limit, std::numeric_limits<double>::infinity());
      if (this->distance(next) > distance) return limit;
      limit = next;
    }
  }

  /// Points of the bodies, for the closest points of their cores and the distance of these. Where the bodies meet, it
  /// is one common point, which divides the way from one core to the other as the radii do.
  template <typename Points>
  void move_points(Points& points, double of_cores) const {
    const Vec3 between = points.point_b - points.point_a;
    if (of_cores <= radius_) {
      points.point_a += between * (has_radius() ? radius_a_ / radius_ : 0);
      points.point_b = points.point_a;
      return;
    }
    if (!has_radius() || max_abs(between) == 0) return;  // cores that rounding has put in one place
    const Vec3 near = geometry::near_unit(between), direction = near * (1 / length(near));
    points.point_a += radius_a_ * direction, points.point_b -= radius_b_ * direction;
  }

  /// The contact of two swept triangles, for that of the triangles.
  template <typename Contact>
  Contact contact(Contact of_cores) const {
    const double distance = of_cores.distance;
    if (!has_radius()) return of_cores;
    of_cores.distance = this->distance(distance);
    if (distance <= radius_) of_cores.depth += radius_ - distance;
    move_points(of_cores, distance);
    return of_cores;
  }

 private:
  double radius_a_, radius_b_, radius_;
};

/// The transforms between the frames of two models, as the kernels need them. Computed when they are first asked for.
class Frames {
 public:
  explicit Frames(const PlacedPair& placed) : placed_(placed) {}

  /// To the frame of model `s` from that of the other.
  const simd::FrameTransform& of(Side s) {
    if (!is_known_[index(s)]) compute(s);
    return transforms_[index(s)];
  }

  /// The pose of b in the frame of a.
  Transform a_from_b();

 private:
  void compute(Side s);

  simd::FrameTransform transforms_[2];
  const PlacedPair& placed_;
  bool is_known_[2] = {false, false};
};

/// A triangle in the world.
struct PlacedTriangle {
  TriangleId id;
  Triangle corners;
};

/// Pre: placed.has_triangle(s, t).
inline PlacedTriangle placed_triangle(const PlacedPair& placed, Side s, TriangleId t) {
  return {t, placed.triangle(s, t)};
}

/// The triangles of a leaf in the world, each placed when it is first asked for.
class PlacedLeaf {
 public:
  PlacedLeaf(const PlacedPair& placed, Side side) : placed_(placed), side_(side) {}

  /// Goes on to a leaf. What is known of it stays if it is the same as before. Pre of all that follows: there is one.
  void take(const bvh::Leaf& leaf) {
    if (&leaf == leaf_) return;
    leaf_ = &leaf;
    placed_slots_ = supported_slots_ = 0;
    has_support_ = false;
  }

  TriangleId id(std::uint32_t slot) const { return leaf_->triangle[slot]; }
  /// The support of a triangle along a direction of its model's frame, computed when it is first asked for, until
  /// another direction comes: each has its own number.
  double support(std::uint32_t slot, const Vec3& direction, std::uint32_t number) {
    if (number != direction_number_) direction_number_ = number, supported_slots_ = 0, has_support_ = false;
    if ((supported_slots_ >> slot & 1) == 0) {
      supported_slots_ |= 1U << slot;
      supports_[slot] = support_of(slot, direction);
    }
    return supports_[slot];
  }
  /// The support of the whole leaf, which is the largest of its triangles' supports.
  double support(const Vec3& direction, std::uint32_t number) {
    if (number == direction_number_ && has_support_) return support_;
    direction_number_ = number, supported_slots_ = (1U << bvh::width) - 1, has_support_ = true;
    for (std::uint32_t slot = 0; slot < bvh::width; ++slot) supports_[slot] = support_of(slot, direction);
    support_ = *std::max_element(supports_, supports_ + bvh::width);
    return support_;
  }
  const PlacedTriangle& at(std::uint32_t slot) {
    PlacedTriangle& triangle = triangles[slot];
    if ((placed_slots_ >> slot & 1) == 0) {
      placed_slots_ |= 1U << slot;
      triangle = {leaf_->triangle[slot], placed_.triangle(side_, leaf_->vertices[slot])};
    }
    return triangle;
  }

 private:
  double support_of(std::uint32_t slot, const Vec3& direction) const {
    // Vertices where they are: copies would go through memory.
    const auto height = [&](VertexId v) { return dot(direction, placed_.local_position(side_, v)); };
    const std::array<VertexId, 3>& v = leaf_->vertices[slot];
    return std::max(std::max(height(v[0]), height(v[1])), height(v[2]));
  }

  const PlacedPair& placed_;
  Side side_;
  const bvh::Leaf* leaf_ = nullptr;
  unsigned placed_slots_ = 0, supported_slots_ = 0;  // bit masks
  std::uint32_t direction_number_ = 0;
  bool has_support_ = false;
  double support_ = 0;
  double supports_[bvh::width];
  union {
    PlacedTriangle triangles[bvh::width];  // uninitialized until they are placed
  };
};

/// A query needs one of these to be certain of the triangles below two slots of one model.
enum class Apart {
  triangles,  ///< two triangles have nothing in common but the vertices, and the edge, that all of them share
  elements    ///< also, a vertex and a face, or two edges, that share no vertex are farther apart than a margin
};

/// Whether all triangles below two slots of one model share a vertex or an edge, as in a fan or a book, and those of
/// one slot are certainly apart from those of the other. Bounding volumes cannot tell, since all of them contain what
/// is shared.
///
/// Promise  True only if it is so, whatever rounding does.
/// Pre      Both models of `placed` are one, and placed alike.
/// Cost     O(1) if they share nothing, else O(triangles below both).
bool share_and_are_apart(const PlacedPair& placed, bvh::SlotId a, bvh::SlotId b, Apart what, double margin);

}  // namespace limber::pair
