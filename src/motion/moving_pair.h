// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/tree.h"
#include "layout/node.h"
#include "limber/motion.h"
#include "motion/element_impact.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber {

struct MovingModel::Impl {
  const Model* model;
  const MeshEdges* edges = nullptr;  // of the model when the motion was set
  Transform start_pose;
  std::vector<Vec3> start, end;  // positions of all vertices, in the world
  bvh::MovingTree tree;
  bool has_motion = false;
  // Of the model's tree when the motion was set: both are as they were as long as the model has not changed.
  std::uint64_t build_id = 0;
  double displacement = 0;
};

}  // namespace limber

namespace limber::motion {

using pair::index;
using pair::Side;

/// A leaf of a moving model, and what its triangles represent.
struct MovingLeafOf {
  const bvh::Leaf& leaf;
  const bvh::MovingLeaf& moving;
  simd::OwnedElements owned;
};

/// Two elements, by their ids and by their corners.
struct IdentifiedElements {
  ElementPair pair;
  MovingElements elements;
};

/// The two moving models of a query, or one with itself. Constant while the query runs.
class MovingPair {
 public:
  /// Throws   std::invalid_argument unless both models have a valid motion; `function` is named.
  MovingPair(const MovingModel& a, const MovingModel& b, const char* function);
  /// One model with itself.
  MovingPair(const MovingModel& model, const char* function) : MovingPair(model, model, function) { is_self_ = true; }

  bool is_self() const { return is_self_; }
  const MovingModel::Impl& model(Side s) const { return *models_[index(s)]; }
  const bvh::Tree& tree(Side s) const { return *trees_[index(s)]; }
  const bvh::MovingNode& node(Side s, std::uint32_t i) const { return models_[index(s)]->tree.nodes[i]; }

  bvh::MovingBox box(Side s, bvh::SlotId slot) const { return node(s, bvh::node_of(slot)).box(bvh::slot_of(slot)); }
  /// The lengths of all sides of the box of a slot, at both ends. Of two nodes, the one of larger size is expanded.
  double size_of(Side s, bvh::SlotId slot) const;

  /// Pre: the slot has a leaf.
  MovingLeafOf leaf(Side s, bvh::SlotId slot) const;
  /// Pairs of elements of two leaves, by the codes of simd::ElementCandidate. `s` is the side of the vertex.
  IdentifiedElements vertex_face(Side s, const MovingLeafOf& of_vertex, std::uint32_t vertex_code,
                                 const MovingLeafOf& of_face, std::uint32_t face_code) const;
  IdentifiedElements edge_edge(const MovingLeafOf& a, std::uint32_t code_a, const MovingLeafOf& b,
                               std::uint32_t code_b) const;

  /// The elements of a pair by their ids, which must exist; and their vertices, those of the first element first.
  IdentifiedElements elements(const ElementPair& pair) const;
  std::array<VertexId, 4> vertices(const ElementPair& pair) const;

  /// A triangle that has the element of a pair that is of one model.
  TriangleId triangle_of(Side s, const ElementPair& pair) const;

  /// The vertices of a triangle.
  const Corners& corners(Side s, TriangleId triangle) const { return triangles_[index(s)][triangle]; }

 private:
  /// Sets a corner of two elements to a vertex of a model.
  void set_corner(MovingElements& elements, std::size_t corner, Side s, VertexId vertex) const {
    const MovingModel::Impl& model = *models_[index(s)];
    elements.corners[0][corner] = model.start[vertex], elements.corners[1][corner] = model.end[vertex];
  }

  const MovingModel::Impl* models_[2];
  const bvh::Tree* trees_[2];
  std::span<const Corners> triangles_[2];
  bool is_self_ = false;
};

/// The distance of two elements at the start.
double start_distance(const MovingElements& elements);

/// What state_of() promises.
ElementState state_at(const MovingPair& models, const IdentifiedElements& found, double time);

}  // namespace limber::motion
