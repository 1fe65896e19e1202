// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion/moving_pair.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/access.h"
#include "base/check.h"
#include "model/model_impl.h"

namespace limber::motion {
namespace {

/// The tree of a moving model. Throws std::invalid_argument unless its motion is valid; function and model are named.
const bvh::Tree& checked_tree(const MovingModel& moving, const char* function, const char* name) {
  const MovingModel::Impl& impl = Access::impl(moving);
  const bool is_valid = impl.has_motion && impl.model->is_committed() &&
                        Access::impl(*impl.model).tree.build_id == impl.build_id &&
                        Access::impl(*impl.model).tree.displacement == impl.displacement;
  LIMBER_REQUIRE(is_valid,
                 (std::string(function) + ": " + name + " has no motion, or has changed since it was set").c_str());
  return Access::impl(*impl.model).tree;
}

/// Where codes of simd::ElementCandidate point to.
std::uint32_t slot_of_code(std::uint32_t code) { return code % bvh::width; }
std::uint32_t corner_of_code(std::uint32_t code) { return code / bvh::width; }

}  // namespace

MovingPair::MovingPair(const MovingModel& a, const MovingModel& b, const char* function)
    : models_{&Access::impl(a), &Access::impl(b)},
      trees_{&checked_tree(a, function, &a == &b ? "the model" : "model a"), &checked_tree(b, function, "model b")},
      triangles_{Access::impl(a).model->mesh().triangles(), Access::impl(b).model->mesh().triangles()} {}

double MovingPair::size_of(Side s, bvh::SlotId slot) const {
  const bvh::MovingNode& boxes = node(s, bvh::node_of(slot));
  const std::uint32_t k = bvh::slot_of(slot);
  double sum = 0;
  for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) sum += boxes.high[end][axis][k] - boxes.low[end][axis][k];
  }
  return sum;
}

MovingLeafOf MovingPair::leaf(Side s, bvh::SlotId slot) const {
  LIMBER_ASSERT(bvh::has_leaf(tree(s), slot));
  const std::uint32_t i = bvh::child_of(tree(s), slot);
  const bvh::Leaf& leaf = tree(s).leaves[i];
  std::uint64_t of_slots = 0;
  for (std::uint32_t k = 0; k < bvh::width; ++k) {
    if (!leaf.is_in_use(k)) break;
    of_slots |= (simd::OwnedElements::is_in_use | Access::represented_by(*model(s).edges, leaf.triangle[k])) << (8 * k);
  }
  return {leaf, model(s).tree.leaves[i], {of_slots}};
}

IdentifiedElements MovingPair::vertex_face(Side s, const MovingLeafOf& of_vertex, std::uint32_t vertex_code,
                                           const MovingLeafOf& of_face, std::uint32_t face_code) const {
  const VertexId vertex = of_vertex.leaf.vertices[slot_of_code(vertex_code)][corner_of_code(vertex_code)];
  const TriangleId face = of_face.leaf.triangle[slot_of_code(face_code)];
  if (is_self() || s == Side::a) return elements({ElementPair::Kind::vertex_face, vertex, face});
  return elements({ElementPair::Kind::face_vertex, face, vertex});
}

IdentifiedElements MovingPair::edge_edge(const MovingLeafOf& a, std::uint32_t code_a, const MovingLeafOf& b,
                                         std::uint32_t code_b) const {
  const EdgeId id_a =
      model(Side::a).edges->of_triangles()[a.leaf.triangle[slot_of_code(code_a)]][corner_of_code(code_a)];
  const EdgeId id_b =
      model(Side::b).edges->of_triangles()[b.leaf.triangle[slot_of_code(code_b)]][corner_of_code(code_b)];
  // In one model the edge of smaller id comes first, wherever the leaves are.
  const bool swaps = is_self() && id_b < id_a;
  return elements({ElementPair::Kind::edge_edge, swaps ? id_b : id_a, swaps ? id_a : id_b});
}

IdentifiedElements MovingPair::elements(const ElementPair& pair) const {
  IdentifiedElements found{pair, {MovingElements::Kind::edge_edge, {}}};
  if (pair.kind == ElementPair::Kind::edge_edge) {
    for (std::size_t k = 0; k < 2; ++k) {
      set_corner(found.elements, k, Side::a, model(Side::a).edges->vertices()[pair.a][k]);
      set_corner(found.elements, 2 + k, Side::b, model(Side::b).edges->vertices()[pair.b][k]);
    }
    return found;
  }
  found.elements.kind = MovingElements::Kind::vertex_face;
  const Side of_vertex = pair.kind == ElementPair::Kind::vertex_face ? Side::a : Side::b,
             of_face = pair::other(of_vertex);
  const Corners& face = corners(of_face, of_face == Side::a ? pair.a : pair.b);
  set_corner(found.elements, 0, of_vertex, of_vertex == Side::a ? pair.a : pair.b);
  for (std::size_t k = 0; k < 3; ++k) set_corner(found.elements, 1 + k, of_face, face[k]);
  return found;
}

std::array<VertexId, 4> MovingPair::vertices(const ElementPair& pair) const {
  if (pair.kind == ElementPair::Kind::edge_edge) {
    const auto &a = model(Side::a).edges->vertices()[pair.a], &b = model(Side::b).edges->vertices()[pair.b];
    return {a[0], a[1], b[0], b[1]};
  }
  if (pair.kind == ElementPair::Kind::vertex_face) {
    const Corners& face = corners(Side::b, pair.b);
    return {pair.a, face[0], face[1], face[2]};
  }
  const Corners& face = corners(Side::a, pair.a);
  return {face[0], face[1], face[2], pair.b};
}

TriangleId MovingPair::triangle_of(Side s, const ElementPair& pair) const {
  const MeshEdges& edges = *model(s).edges;
  const std::uint32_t id = s == Side::a ? pair.a : pair.b;
  if (pair.kind == ElementPair::Kind::edge_edge) return edges.representatives()[id];
  const bool is_vertex = (pair.kind == ElementPair::Kind::vertex_face) == (s == Side::a);
  return is_vertex ? edges.vertex_representatives()[id] : id;
}

}  // namespace limber::motion
