// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>

#include "base/check.h"
#include "bvh/tree.h"
#include "limber/model.h"

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

}  // namespace limber::pair
