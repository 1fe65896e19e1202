// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion/element_state.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"

namespace limber {
namespace motion {
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
  const auto require = [&](bool holds, const char* what) {
    LIMBER_REQUIRE(holds, (std::string(function) + ": " + what).c_str());
  };
  require(time >= 0 && time <= 1, "the time is not in [0, 1]");
  const MeshEdges &edges_a = *models.model(Side::a).edges, &edges_b = *models.model(Side::b).edges;
  const auto count = [&](const MeshEdges& edges, PairKind of_vertex) {
    return pair.kind == PairKind::edge_edge ? edges.size()
           : pair.kind == of_vertex         ? edges.vertex_count()
                                            : edges.triangle_count();
  };
  require(pair.a < count(edges_a, PairKind::vertex_face) && pair.b < count(edges_b, PairKind::face_vertex),
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

}  // namespace motion

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
