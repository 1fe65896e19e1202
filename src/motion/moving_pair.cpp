// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion/moving_pair.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/rigid.h"
#include "mesh/updates.h"
#include "model/model_impl.h"

namespace limber {
namespace {

/// Fewer vertices are not worth a task.
constexpr std::size_t vertices_per_task = 4096;

void place(std::span<const Vec3> positions, const Transform& pose, std::vector<Vec3>& placed) {
  placed.resize(positions.size());
  const bool stays = pose == Transform{};
  base::parallel_for_ranges(positions.size(), vertices_per_task, [&](std::size_t begin, std::size_t end) {
    if (stays) {
      std::copy_n(positions.data() + begin, end - begin, placed.data() + begin);
    } else {
      for (std::size_t i = begin; i < end; ++i) placed[i] = pose(positions[i]);
    }
  });
}

}  // namespace

MovingModel::MovingModel(const Model& model) : impl_(std::make_unique<Impl>()) {
  LIMBER_REQUIRE(model.is_valid(), "limber::MovingModel: the model has been moved from");
  impl_->model = &model;
}
MovingModel::MovingModel(MovingModel&&) noexcept = default;
MovingModel& MovingModel::operator=(MovingModel&&) noexcept = default;
MovingModel::~MovingModel() = default;

const MovingModel::Impl& MovingModel::impl() const {
  LIMBER_REQUIRE(impl_ != nullptr, "limber::MovingModel: the object has been moved from");
  return *impl_;
}

Result<void> MovingModel::set_motion(std::span<const Vec3> end_positions, const Transform& start_pose,
                                     const Transform& end_pose) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(impl_ != nullptr, "limber::MovingModel::set_motion: the object has been moved from");
  const Model& model = *impl_->model;
  LIMBER_REQUIRE(model.is_committed(),
                 "limber::MovingModel::set_motion: the model has moves without a commit(), "
                 "or has been moved from");
  geometry::require_rigid(start_pose, "limber::MovingModel::set_motion: start_pose");
  geometry::require_rigid(end_pose, "limber::MovingModel::set_motion: end_pose");
  if (auto valid = check_update_of_all(model.mesh(), end_positions); !valid) return valid;
  const bvh::Tree& tree = Access::impl(model).tree;
  impl_->has_motion = false;
  impl_->edges = &model.edges();
  impl_->start_pose = start_pose;
  place(model.mesh().positions(), start_pose, impl_->start);
  place(end_positions, end_pose, impl_->end);
  bvh::fit(impl_->tree, tree, impl_->start, impl_->end);
  impl_->build_id = tree.build_id, impl_->displacement = tree.displacement, impl_->has_motion = true;
  return {};
}

}  // namespace limber

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

namespace {

using PairKind = ElementPair::Kind;

/// A vector of length about 1 in the same direction; 0 if there is none.
Vec3 about_unit(const Vec3& v) { return v == Vec3{} ? v : geometry::near_unit(v); }

/// Closest points of a vertex, which comes first, and a face, or of two edges; and a direction perpendicular to the
/// face or to both edges.
struct Closest {
  ClosestPoints points;
  std::array<double, 4> weights;
  Vec3 perpendicular;
};
Closest closest(MovingElements::Kind kind, const Vec3 (&p)[4]) {
  if (kind == MovingElements::Kind::vertex_face) {
    const Triangle face{p[1], p[2], p[3]};
    const Vec3 weights = geometry::closest_on(face, p[0]).weights;
    return {geometry::closest_points(p[0], face),
            {1, weights.x, weights.y, weights.z},
            cross(about_unit(p[2] - p[1]), about_unit(p[3] - p[1]))};
  }
  const Segment a{p[0], p[1]}, b{p[2], p[3]};
  const auto [distance, s, t] = geometry::closest_on(a, b);
  return {
      geometry::closest_points(a, b), {1 - s, s, 1 - t, t}, cross(about_unit(p[1] - p[0]), about_unit(p[3] - p[2]))};
}

/// The elements of a pair, whose ids are checked.
IdentifiedElements checked_elements(const MovingPair& models, const ElementPair& pair, double time,
                                    const char* function) {
  require(time >= 0 && time <= 1, function, "the time is not in [0, 1]");
  const MeshEdges &edges_a = *models.model(Side::a).edges, &edges_b = *models.model(Side::b).edges;
  const auto count = [&](const MeshEdges& edges, PairKind of_vertex) {
    return pair.kind == PairKind::edge_edge ? edges.size()
           : pair.kind == of_vertex         ? edges.vertex_count()
                                            : edges.triangle_count();
  };
  require(pair.a < count(edges_a, PairKind::vertex_face) && pair.b < count(edges_b, PairKind::face_vertex), function,
          "there is no element of that id");
  return models.elements(pair);
}

}  // namespace

double start_distance(const MovingElements& elements) {
  return closest(elements.kind, elements.corners[0]).points.distance;
}

ElementState state_at(const MovingPair& models, const IdentifiedElements& found, double time) {
  // Relative to the first corner: elements that are far from the origin keep their digits.
  const auto& [starts, ends] = found.elements.corners;
  Vec3 at[4], way[4];
  double extent = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 start = starts[i] - starts[0], end = ends[i] - ends[0];
    at[i] = (1 - time) * start + time * end, way[i] = end - start;
    extent = std::max({extent, max_abs(start), max_abs(end)});
  }
  const Vec3 origin = (1 - time) * starts[0] + time * ends[0];
  const Closest closest_now = closest(found.elements.kind, at);
  const auto& [points, weights, perpendicular] = closest_now;
  const std::size_t count = found.elements.kind == MovingElements::Kind::vertex_face ? 1 : 2;
  Vec3 approach;  // of the first element, seen from the second
  for (std::size_t i = 0; i < 4; ++i) approach += (i < count ? weights[i] : -weights[i]) * way[i];
  const Vec3 towards = dot(perpendicular, about_unit(approach)) < 0 ? -perpendicular : perpendicular;
  const bool are_apart = points.distance > base::placed_elements_error * extent;
  const Vec3 direction = about_unit(are_apart ? points.point_b - points.point_a : towards);
  const double size = length(direction);

  ElementState state;
  state.vertices = models.vertices(found.pair), state.count_of_a = count;
  state.weights = weights, state.point_a = origin + points.point_a, state.point_b = origin + points.point_b;
  if (size > 0) state.normal = (1 / size) * direction;
  if (found.pair.kind == PairKind::face_vertex) {  // so far the vertex was the first
    state.count_of_a = 3;
    std::rotate(state.weights.begin(), state.weights.begin() + 1, state.weights.end());
    std::swap(state.point_a, state.point_b);
    state.normal = -state.normal;
  }
  return state;
}

}  // namespace limber::motion

namespace limber {

ElementState state_of(const MovingModel& a, const MovingModel& b, const ElementPair& elements, double time) {
  const base::DefaultFloatEnvironment environment;
  const motion::MovingPair models(a, b, "limber::state_of");
  return motion::state_at(models, motion::checked_elements(models, elements, time, "limber::state_of"), time);
}

ElementState self_state_of(const MovingModel& model, const ElementPair& elements, double time) {
  const base::DefaultFloatEnvironment environment;
  const motion::MovingPair models(model, "limber::self_state_of");
  return motion::state_at(models, motion::checked_elements(models, elements, time, "limber::self_state_of"), time);
}

}  // namespace limber
