// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <tuple>

#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/motion.h"
#include "limber/scene.h"

/// What pairs and answers say as tuples, so that lists can be sorted, and compared to the bit.
namespace limber::testing {

inline std::array<std::uint64_t, 3> bits_of(const Vec3& v) { return std::bit_cast<std::array<std::uint64_t, 3>>(v); }

// --- which triangles or elements a pair is of ---

inline auto ids_of(const TrianglePair& p) { return std::tuple(p.a, p.b); }
inline auto ids_of(const Contact& c) { return std::tuple(c.triangle_a, c.triangle_b); }
inline auto ids_of(const VertexFacePair& p) { return std::tuple(p.is_vertex_of_b, p.vertex, p.triangle); }
inline auto ids_of(const EdgeEdgePair& p) { return std::tuple(p.a, p.b); }
inline auto ids_of(const FeaturePair& p) { return std::tuple(p.kind_a, p.a, p.kind_b, p.b); }
inline auto ids_of(const ElementPair& p) { return std::tuple(p.kind, p.a, p.b); }
inline auto ids_of(const Impact& i) { return ids_of(i.elements); }

// --- all that is said ---

inline auto key_of(const TrianglePair& p) { return ids_of(p); }
inline auto key_of(const VertexFacePair& p) { return std::tuple(ids_of(p), p.distance, bits_of(p.weights)); }
inline auto key_of(const EdgeEdgePair& p) { return std::tuple(ids_of(p), p.distance, p.parameter_a, p.parameter_b); }
inline auto key_of(const FeaturePair& p) {
  return std::tuple(ids_of(p), p.multiplicity, p.distance, bits_of(p.point_a), bits_of(p.point_b), bits_of(p.normal),
                    bits_of(p.weights_a), bits_of(p.weights_b), p.vertices_a, p.vertices_b);
}
inline auto key_of(const Contact& c) {
  return std::tuple(ids_of(c), bits_of({c.distance, c.depth, 0}), bits_of(c.point_a), bits_of(c.point_b),
                    bits_of(c.normal), bits_of(c.weights_a), bits_of(c.weights_b), c.feature_a, c.feature_b,
                    c.normal_side);
}
inline auto key_of(const ElementPair& p) { return ids_of(p); }
inline auto key_of(const Impact& i) { return std::tuple(ids_of(i), i.time.status, i.time.lower, i.time.upper); }
inline auto key_of(const QueryStats& s) { return std::tuple(s.node_tests, s.primitive_tests); }
inline auto key_of(const std::optional<Witness>& found) {
  const Witness w = found.value_or(Witness{});
  return std::tuple(found.has_value(), bits_of(w.point_a), bits_of(w.point_b), w.triangle_a, w.triangle_b);
}
/// All that a first impact says but its statistics.
inline auto key_of(const ImpactResult& r) {
  return std::tuple(r.status, r.lower, r.upper, ids_of(r.elements.value_or(ElementPair{})), r.elements.has_value(),
                    key_of(r.witness), bits_of(r.normal), r.stopped_by);
}
inline auto key_of(const DistanceResult& r) {
  return std::tuple(bits_of({r.lower, r.upper, 0}), r.status, r.stopped_by, key_of(r.witness), key_of(r.stats));
}
inline auto key_of(const CollideResult& r) {
  return std::tuple(r.answer, r.stopped_by, key_of(r.witness), key_of(r.stats));
}
inline auto key_of(const ClosestObjectsResult& r) { return std::tuple(r.objects, key_of(r.result)); }
inline auto key_of(const AnyWithinResult& r) { return std::tuple(r.objects, key_of(r.result)); }

}  // namespace limber::testing
