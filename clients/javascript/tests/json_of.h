// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "limber/limber.h"

/// Arguments and results as JSON, with the names of the JavaScript package. Decimals give back the bits of the numbers.
namespace limber::web {

using nlohmann::json;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// --- arguments ---

/// The numbers of points, one after the other, as an array of JavaScript of that type.
inline json numbers_of(std::span<const Vec3> points, bool is_float32 = false) {
  json numbers = json::array();
  for (const Vec3& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) numbers.push_back(p[axis]);
  }
  return {{is_float32 ? "Float32Array" : "Float64Array", numbers}};
}

inline json uint32s(const json& ids) { return {{"Uint32Array", ids}}; }

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

// --- results ---

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

inline json of(const Witness& w) {
  return {
      {"pointA", of(w.point_a)}, {"pointB", of(w.point_b)}, {"triangleA", w.triangle_a}, {"triangleB", w.triangle_b}};
}

inline json of(const Feature& feature) {
  return {{"kind", name_in({"vertex", "edge", "face"}, feature.kind)}, {"index", feature.index}};
}

inline json of(const ElementPair& pair) {
  return {{"kind", name_in({"vertexFace", "faceVertex", "edgeEdge"}, pair.kind)}, {"a", pair.a}, {"b", pair.b}};
}

inline json of(const SurfacePoint& p) {
  return {{"distance", of(p.distance)},
          {"position", of(p.position)},
          {"triangle", p.triangle},
          {"weights", of(p.weights)},
          {"feature", of(p.feature)}};
}

template <typename T>
json or_null(const std::optional<T>& value) {
  return value ? of(*value) : json(nullptr);
}

/// A result that has a witness and statistics, with what else it has.
template <typename Found>
json with_witness(const Found& r, json others) {
  others["witness"] = or_null(r.witness), others["stats"] = of(r.stats);
  others["stoppedBy"] = name_in({"nothing", "deadline", "maxSteps"}, r.stopped_by);
  return others;
}

inline json of(const DistanceResult& r) {
  const char* const status = name_in({"exact", "withinError", "collision", "beyondLimit", "interrupted"}, r.status);
  return with_witness(r, {{"lower", of(r.lower)}, {"upper", of(r.upper)}, {"status", status}});
}

inline json of(const CollideResult& r) {
  const char* const answer = name_in({"no", "yes", "undecided"}, r.answer);
  return with_witness(r, {{"answer", answer}, {"isYes", r.is_yes()}, {"isNo", r.is_no()}});
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

inline json of(const ImpactResult& r) {
  return with_witness(r, {{"status", of(r.status)},
                          {"lower", of(r.lower)},
                          {"upper", of(r.upper)},
                          {"elements", or_null(r.elements)},
                          {"normal", of(r.normal)}});
}

inline json of(const PathImpact& r) {
  return with_witness(
      r,
      {{"status", of(r.status)}, {"time", of(r.time)}, {"distanceCount", r.distance_count}, {"normal", of(r.normal)}});
}

inline json of(const PointResult& r) { return {{"closest", or_null(r.closest)}, {"stats", of(r.stats)}}; }

inline json of(const SignedDistance& r) {
  return {{"closest", or_null(r.closest)},
          {"stats", of(r.stats)},
          {"isInside", r.is_inside},
          {"distance", of(r.closest ? r.distance() : infinity)}};
}

inline json of(const ClosestObjectsResult& found) {
  const ObjectPair pair = found.objects;
  return {{"objects", pair.a == no_id ? json(nullptr) : json{pair.a, pair.b}}, {"result", of(found.result)}};
}

/// What is there for each of several things.
template <typename T>
json each(const std::vector<T>& values) {
  json list = json::array();
  for (const T& value : values) list.push_back(of(value));
  return list;
}

/// All contacts that visit(visitor) finds.
template <typename Visit>
json contacts_of(const Visit& visit) {
  std::vector<Contact> found;
  const PairCount count = visit([&](const Contact& contact) { return found.push_back(contact), true; });
  return {{"count", found.size()}, {"isComplete", true}, {"all", each(found)}, {"stats", of(count.stats)}};
}

}  // namespace limber::web
