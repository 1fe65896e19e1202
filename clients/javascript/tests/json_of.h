// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/gradients.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/motion.h"
#include "limber/path.h"
#include "limber/penetration.h"
#include "limber/points.h"
#include "limber/scene.h"
#include "limber/shapes.h"
#include "limber/solids.h"

/// Results as JSON, with the names of the JavaScript package. Decimals give back the bits of the numbers.
namespace limber::web {

using nlohmann::json;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// JSON has no number for infinity, so a text stands for it.
inline json of(double x) { return std::isfinite(x) ? json(x) : json("Infinity"); }
inline json of(const Vec3& v) { return {v.x, v.y, v.z}; }
inline json of(const Transform& pose) { return matrix_of(pose, MatrixOrder::column_major); }
inline json of(const QueryStats& stats) {
  return {{"nodeTests", stats.node_tests}, {"primitiveTests", stats.primitive_tests}};
}

template <typename Enum, std::size_t count>
const char* name_in(const char* const (&names)[count], Enum value) {
  return names[static_cast<std::size_t>(value)];
}

inline json of(StoppedBy stopped_by) { return name_in({"nothing", "deadline", "maxSteps"}, stopped_by); }

inline json of(const std::optional<Witness>& w) {
  if (!w) return nullptr;
  return {{"pointA", of(w->point_a)},
          {"pointB", of(w->point_b)},
          {"triangleA", w->triangle_a},
          {"triangleB", w->triangle_b}};
}

inline json of(const DistanceResult& r) {
  return {{"lower", of(r.lower)},
          {"upper", of(r.upper)},
          {"status", name_in({"exact", "withinError", "collision", "beyondLimit", "interrupted"}, r.status)},
          {"stoppedBy", of(r.stopped_by)},
          {"witness", of(r.witness)},
          {"stats", of(r.stats)}};
}

inline json of(const CollideResult& r) {
  return {{"answer", name_in({"no", "yes", "undecided"}, r.answer)},
          {"isYes", r.is_yes()},
          {"isNo", r.is_no()},
          {"stoppedBy", of(r.stopped_by)},
          {"witness", of(r.witness)},
          {"stats", of(r.stats)}};
}

inline json of(const Feature& feature) {
  return {{"kind", name_in({"vertex", "edge", "face"}, feature.kind)}, {"index", feature.index}};
}

inline json of(const Contact& c) {
  return {{"distance", of(c.distance)},  {"depth", of(c.depth)},
          {"pointA", of(c.point_a)},     {"pointB", of(c.point_b)},
          {"normal", of(c.normal)},      {"weightsA", of(c.weights_a)},
          {"weightsB", of(c.weights_b)}, {"triangleA", c.triangle_a},
          {"triangleB", c.triangle_b},   {"featureA", of(c.feature_a)},
          {"featureB", of(c.feature_b)}, {"normalSide", name_in({"unknown", "outward", "inward"}, c.normal_side)}};
}

inline json of(ImpactStatus status) { return name_in({"clear", "contact", "initialContact", "undecided"}, status); }

inline json of(const ElementPair& pair) {
  return {{"kind", name_in({"vertexFace", "faceVertex", "edgeEdge"}, pair.kind)}, {"a", pair.a}, {"b", pair.b}};
}

inline json of(const ElementImpact& impact) {
  return {{"status", of(impact.status)}, {"lower", of(impact.lower)}, {"upper", of(impact.upper)}};
}

inline json of(const Impact& impact) { return {{"elements", of(impact.elements)}, {"time", of(impact.time)}}; }

inline json of(const ImpactResult& r) {
  return {{"status", of(r.status)},        {"lower", of(r.lower)},
          {"upper", of(r.upper)},          {"elements", r.elements ? of(*r.elements) : json(nullptr)},
          {"witness", of(r.witness)},      {"normal", of(r.normal)},
          {"stoppedBy", of(r.stopped_by)}, {"stats", of(r.stats)}};
}

inline json of(const PathImpact& r) {
  return {{"status", of(r.status)},        {"time", of(r.time)},
          {"witness", of(r.witness)},      {"distanceCount", r.distance_count},
          {"stoppedBy", of(r.stopped_by)}, {"stats", of(r.stats)},
          {"normal", of(r.normal)}};
}

inline json of(const PathDistance& r) {
  return {{"lower", of(r.lower)},
          {"upper", of(r.upper)},
          {"time", of(r.time)},
          {"witness", of(r.witness)},
          {"distanceCount", r.distance_count},
          {"stoppedBy", of(r.stopped_by)},
          {"stats", of(r.stats)}};
}

inline json of(const SurfacePoint& p) {
  return {{"distance", of(p.distance)},
          {"position", of(p.position)},
          {"triangle", p.triangle},
          {"weights", of(p.weights)},
          {"feature", of(p.feature)}};
}

inline json of(const PointResult& r) {
  return {{"closest", r.closest ? of(*r.closest) : json(nullptr)}, {"stats", of(r.stats)}};
}

inline json of(const SignedDistance& r) {
  return {{"closest", r.closest ? of(*r.closest) : json(nullptr)},
          {"stats", of(r.stats)},
          {"isInside", r.is_inside},
          {"distance", of(r.closest ? r.distance() : infinity)}};
}

inline json of(const SolidRelationResult& r) {
  const char* const relation =
      name_in({"apart", "touching", "overlapping", "aInsideB", "bInsideA", "equal"}, r.relation);
  return {{"relation", relation}, {"witness", of(r.witness)}, {"stats", of(r.stats)}};
}

inline json of(const std::optional<DeepestVertex>& d) {
  if (!d) return nullptr;
  return {{"vertex", d->vertex},
          {"depth", of(d->depth)},
          {"position", of(d->position)},
          {"closest", of(d->closest)},
          {"direction", of(d->direction)}};
}

inline json of(const DeepestPair& d) {
  return {{"ofA", of(d.of_a)}, {"ofB", of(d.of_b)}, {"maxDepth", of(d.max_depth)}};
}

inline json of(const DeepestVertices& d) {
  json described = of(static_cast<const DeepestPair&>(d));
  described["stoppedBy"] = of(d.stopped_by), described["stats"] = of(d.stats);
  return described;
}

inline json of(const SeparatingTranslation& t) {
  return {{"direction", of(t.direction)}, {"lower", of(t.lower)},          {"upper", of(t.upper)},
          {"witness", of(t.witness)},     {"stoppedBy", of(t.stopped_by)}, {"stats", of(t.stats)}};
}

inline json of(const SolidDistance& d) {
  return {{"lower", of(d.lower)},          {"upper", of(d.upper)},
          {"areApart", d.are_apart()},     {"translation", of(d.translation)},
          {"witness", of(d.witness)},      {"deepest", of(d.deepest)},
          {"stoppedBy", of(d.stopped_by)}, {"stats", of(d.stats)}};
}

inline json of(const PoseGradient& gradient) {
  return {{"force", of(gradient.force)}, {"moment", of(gradient.moment)}};
}
inline json of(const std::array<Vec3, 3>& vectors) { return {of(vectors[0]), of(vectors[1]), of(vectors[2])}; }

/// A result of two objects of a scene.
template <typename Found>
requires requires(const Found& found) { found.objects; }
json of(const Found& found) {
  const ObjectPair pair = found.objects;
  return {{"objects", pair.a == no_id ? json(nullptr) : json{pair.a, pair.b}}, {"result", of(found.result)}};
}

inline json of(const ClosestObjectResult& c) {
  return {{"object", c.object == no_id ? json(nullptr) : json(c.object)}, {"result", of(c.result)}};
}

inline json of(const Shape& shape) {
  return {{"radius", shape.radius()}, {"isSolid", shape.is_solid()}, {"deviation", shape.deviation()}};
}

inline json of(const Error& error) {
  const char* const code =
      name_in({"emptyMesh", "nonFinite", "tooLarge", "indexOutOfRange", "sizeMismatch", "notRigid", "unreadableFile",
               "malformedFile", "unsupportedFormat", "changedConnectivity", "brokenInvariant", "notClosed"},
              error.code);
  json described{{"code", code}, {"message", error.text}};
  if (error.where) described["where"] = *error.where;
  return {{"error", described}};
}

/// What is there for each of several things.
template <typename T>
json each(const std::vector<T>& values) {
  json list = json::array();
  for (const T& value : values) list.push_back(of(value));
  return list;
}

/// Positions as float32 has them, if it is to hold them.
inline std::vector<Vec3> rounded(std::vector<Vec3> positions, bool is_float32) {
  if (!is_float32) return positions;
  std::vector<float> numbers;
  for (const Vec3& p : positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(p[axis]));
  }
  PositionsView::packed(numbers).copy_to(positions);
  return positions;
}

/// The numbers of points, one after the other, as an array of JavaScript of that type. A NaN is null.
inline json numbers_of(std::span<const Vec3> points, bool is_float32 = false) {
  json numbers = json::array();
  for (const Vec3& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) numbers.push_back(p[axis]);
  }
  return {{is_float32 ? "Float32Array" : "Float64Array", numbers}};
}

/// The ids of triangles, pairs, ... one after the other.
template <typename T>
json ids_of(const T& values) {
  json ids = json::array();
  for (const auto& several : values) {
    for (const std::uint32_t id : several) ids.push_back(id);
  }
  return ids;
}

}  // namespace limber::web
