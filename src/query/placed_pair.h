// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/model.h"
#include "simd/kernels.h"
#include "tree/node.h"

/// Two placed trees, and how the nodes of one look from the other.
///
/// Float64 finds where a node's centre lies relative to the local origin it is compared at; from there on float32
/// resolves everything that matters, however far the models are from the world's origin. All errors on the way, the
/// rounding of the placed vertices included, are added to the bounds of the node that is brought over.
namespace limber::query {

enum class Side { a, b };
inline Side other(Side s) { return s == Side::a ? Side::b : Side::a; }
inline std::size_t index(Side s) { return s == Side::a ? 0 : 1; }

/// The way from a to b along which the models were last found closest, and how close a pair must be to matter.
struct Heading {
  bool known = false;
  Vec3 in_a, in_b;                 // unit, from a to b, in either model's frame
  float out_of_a[3], out_of_b[3];  // from either model to the other, in its own frame
  double offset = 0;               // of b's origin from a's, along the way

  const float* out_of(Side s) const { return s == Side::a ? out_of_a : out_of_b; }
};

class PlacedPair {
 public:
  PlacedPair(const Placed& a, const Placed& b);

  const tree::Tree& tree(Side s) const { return *sides_[index(s)].tree; }

  /// At most the distance of the models: a quick look at their roots.
  double root_bound() const;

  /// Triangle of either model in the world.
  Triangle triangle(Side s, TriangleId t) const;

  /// What float64 rounding can change a length between placed points by.
  double error() const { return error_; }

  /// A world direction as a heading. Pre: `from_a_to_b` has length 1.
  Heading heading(const Vec3& from_a_to_b) const;

  /// `node` of the other side as seen by the lanes of `block`, of side `s`.
  simd::Facing facing(Side s, const tree::Block& block, tree::NodeId node);

  /// The limit along a heading for the lanes of `block`, of side `s`, facing `node`, which reaches `reach` towards
  /// them.
  simd::Toward toward(Side s, const tree::Block& block, tree::NodeId node, double reach, const Heading& heading,
                      double cut) const;

  /// How far a node of side `s` reaches towards the other side along a heading, from its centre, at least.
  double reach(Side s, tree::NodeId node, const Heading& heading) const;
  /// The same for a leaf's triangles themselves.
  double leaf_reach(Side s, tree::NodeId node, std::uint32_t leaf, const Heading& heading,
                    const simd::Kernels& kernels) const;

  /// The gap between two nodes along a heading, given how far they reach.
  double gap(tree::NodeId a, double reach_a, tree::NodeId b, double reach_b, const Heading& heading) const {
    return heading.offset + dot(heading.in_b, tree::model_center(tree(Side::b), b)) - reach_b -
           dot(heading.in_a, tree::model_center(tree(Side::a), a)) - reach_a - error_;
  }

  /// Two leaves, given by their nodes, and the factor from lengths to theirs.
  simd::LeafPair leaf_pair(tree::NodeId a, tree::NodeId b, const Heading& heading, double cut, double& scale);

 private:
  struct PlacedTree {
    const tree::Tree* tree;
    MeshView mesh;
    Transform pose;
    double per_unit;           // 1 / tree->unit
    bool is_prepared = false;  // whether what follows is known: many queries end before it is needed
    Transform from_other;      // this model's frame from the other's
    float rotation[9];         // of from_other, by rows
    float ratio;               // other tree's unit / this one's
    float error_units;
  };
  const PlacedTree& at(Side s) const { return sides_[index(s)]; }
  void prepare(Side s);

  PlacedTree sides_[2];
  double error_ = 0;
};

}  // namespace limber::query
