// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/model.h"
#include "simd/kernels.h"
#include "tree/node.h"

/// Two placed trees, and how each looks from the other.
namespace limber::query {

enum class Side { a, b };
inline Side other(Side s) { return s == Side::a ? Side::b : Side::a; }
inline std::size_t index(Side s) { return s == Side::a ? 0 : 1; }

class PlacedPair {
 public:
  PlacedPair(const Placed& a, const Placed& b);

  const tree::Tree& tree(Side s) const { return *sides_[index(s)].tree; }

  /// At most the distance of the models: a quick look at their roots.
  double root_bound() const;

  /// Triangle of either model in the world.
  Triangle triangle(Side s, TriangleId t) const;

  /// How far apart two triangles are along the search direction, off by at most rounding_of_gap(); negative where they
  /// overlap. Goes by the vertices before they are placed. Pre: is_aimed().
  double gap_along(TriangleId a, TriangleId b) const;
  double rounding_of_gap() const { return 0x1p-4 * error_; }
  /// What placing may have changed such a gap by: nothing where both models stay where they are.
  double rounding_of_placing() const { return is_placed_exactly_ ? 0 : rounding_of_gap(); }

  /// What float64 rounding can change a length between placed points by.
  double error() const { return error_; }

  /// How much further out than the bounds say corners may be, of both models together.
  double slack() const { return tree(Side::a).slack + tree(Side::b).slack; }

  /// Notes that so many steps were due to the slack.
  void pay(double steps) const;

  /// What the other model looks like from side `s`.
  const simd::View& view(Side s) {
    PlacedTree& side = sides_[index(s)];
    if (!side.is_prepared) prepare(s);
    return side.view;
  }

  /// Where b stands, seen from a.
  Transform a_from_b();

  /// At least what moving b, seen from a, can change the distance of any two points by. `error_before` is what error()
  /// was there.
  double most_moved(const Transform& before, double error_before, const Transform& after) const;

  /// From now on views go by this world direction, the way from a to b. Pre: it has length 1.
  void aim(const Vec3& from_a_to_b);
  bool is_aimed() const { return sides_[0].view.has_toward; }

  /// From now on what is at least `cut` apart is of no interest.
  void set_cut(double cut) { sides_[0].view.cut = sides_[1].view.cut = cut; }

 private:
  struct PlacedTree {
    simd::View view;
    const tree::Tree* tree;
    MeshView mesh;
    Transform pose;
    bool is_prepared = false;  // whether what follows from both poses is known: many queries end before it is needed
  };
  const PlacedTree& at(Side s) const { return sides_[index(s)]; }
  void prepare(Side s);

  PlacedTree sides_[2];
  double error_ = 0;
  bool is_placed_exactly_;
  double offset_ = 0;  // of b's origin from a's along the search direction
};

}  // namespace limber::query
