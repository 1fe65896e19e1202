// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "records.h"

#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "docstrings.h"

namespace limber::python {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr Vec3 nowhere{not_a_number, not_a_number, not_a_number};

Dtypes all_dtypes;

nb::object format_of(double) { return nb::str("f8"); }
nb::object format_of(const Vec3&) { return nb::str("(3,)f8"); }
nb::object format_of(std::uint32_t) { return nb::str("u4"); }
nb::object format_of(const std::array<std::uint32_t, 3>&) { return nb::str("(3,)u4"); }
nb::object format_of(std::uint64_t) { return nb::str("u8"); }
nb::object format_of(bool) { return nb::str("?"); }
template <typename Enum>
requires std::is_enum_v<Enum> nb::object format_of(Enum) {
  static_assert(sizeof(Enum) == 1);
  return nb::str("u1");
}
nb::object format_of(std::uint8_t) { return nb::str("u1"); }
nb::object format_of(const Feature& feature);

/// A type of records. Places of fields are read off a record, as the compiler has laid it out.
template <typename Record, typename... Fields>
nb::object dtype_of(const Record& record, const std::array<const char*, sizeof...(Fields)>& names,
                    const Fields&... fields) {
  const auto place = [&](const auto& field) {
    return reinterpret_cast<const unsigned char*>(&field) - reinterpret_cast<const unsigned char*>(&record);
  };
  nb::dict description;
  nb::list all_names;
  for (const char* const name : names) all_names.append(name);
  description["names"] = all_names;
  description["formats"] = nb::make_tuple(format_of(fields)...);
  description["offsets"] = nb::make_tuple(place(fields)...);
  description["itemsize"] = sizeof record;
  return nb::module_::import_("numpy").attr("dtype")(description);
}

nb::object format_of(const Feature& f) { return dtype_of(f, {"kind", "index"}, f.kind, f.index); }

nb::object distance_dtype() {
  const DistanceRecord r{};
  return dtype_of(r, {"lower", "upper", "point_a", "point_b", "triangle_a", "triangle_b", "status", "stopped_by"},
                  r.lower, r.upper, r.point_a, r.point_b, r.triangle_a, r.triangle_b, r.status, r.stopped_by);
}

nb::object collide_dtype() {
  const CollideRecord r{};
  return dtype_of(r, {"is_yes", "answer", "point_a", "point_b", "triangle_a", "triangle_b", "stopped_by"}, r.is_yes,
                  r.answer, r.point_a, r.point_b, r.triangle_a, r.triangle_b, r.stopped_by);
}

nb::object closest_objects_dtype() {
  const ClosestObjectsRecord c{};
  const DistanceRecord& r = c.result;
  return dtype_of(c,
                  {"object_a", "object_b", "lower", "upper", "point_a", "point_b", "triangle_a", "triangle_b", "status",
                   "stopped_by"},
                  c.object_a, c.object_b, r.lower, r.upper, r.point_a, r.point_b, r.triangle_a, r.triangle_b, r.status,
                  r.stopped_by);
}

nb::object any_within_dtype() {
  const AnyWithinRecord r{};
  return dtype_of(
      r, {"object_a", "object_b", "is_yes", "answer", "point_a", "point_b", "triangle_a", "triangle_b", "stopped_by"},
      r.object_a, r.object_b, r.is_yes, r.answer, r.point_a, r.point_b, r.triangle_a, r.triangle_b, r.stopped_by);
}

nb::object surface_point_dtype() {
  const SurfacePointRecord r{};
  return dtype_of(r, {"distance", "position", "weights", "triangle", "feature"}, r.distance, r.position, r.weights,
                  r.triangle, r.feature);
}

nb::object signed_distance_dtype() {
  const SurfacePointRecord r{};
  return dtype_of(r, {"distance", "position", "weights", "triangle", "feature", "is_inside"}, r.distance, r.position,
                  r.weights, r.triangle, r.feature, r.is_inside);
}

nb::object contact_dtype() {
  const Contact c;
  return dtype_of(c,
                  {"distance", "depth", "point_a", "point_b", "normal", "weights_a", "weights_b", "feature_a",
                   "feature_b", "normal_side", "triangle_a", "triangle_b"},
                  c.distance, c.depth, c.point_a, c.point_b, c.normal, c.weights_a, c.weights_b, c.feature_a,
                  c.feature_b, c.normal_side, c.triangle_a, c.triangle_b);
}

nb::object vertex_face_dtype() {
  const VertexFacePair p;
  return dtype_of(p, {"vertex", "triangle", "is_vertex_of_b", "distance", "weights"}, p.vertex, p.triangle,
                  p.is_vertex_of_b, p.distance, p.weights);
}

nb::object edge_edge_dtype() {
  const EdgeEdgePair p;
  return dtype_of(p, {"a", "b", "distance", "parameter_a", "parameter_b"}, p.a, p.b, p.distance, p.parameter_a,
                  p.parameter_b);
}

nb::object feature_pair_dtype() {
  const FeaturePair p;
  return dtype_of(p,
                  {"distance", "point_a", "point_b", "normal", "weights_a", "weights_b", "a", "b", "vertices_a",
                   "vertices_b", "multiplicity", "kind_a", "kind_b"},
                  p.distance, p.point_a, p.point_b, p.normal, p.weights_a, p.weights_b, p.a, p.b, p.vertices_a,
                  p.vertices_b, p.multiplicity, p.kind_a, p.kind_b);
}

nb::object element_pair_dtype() {
  const ElementPair p;
  return dtype_of(p, {"kind", "a", "b"}, p.kind, p.a, p.b);
}

nb::object impact_dtype() {
  const Impact i{};
  return dtype_of(i, {"kind", "a", "b", "status", "lower", "upper"}, i.elements.kind, i.elements.a, i.elements.b,
                  i.time.status, i.time.lower, i.time.upper);
}

nb::object path_impact_dtype() {
  const PathImpactRecord r{};
  return dtype_of(r, {"status", "time", "point_a", "point_b", "normal", "triangle_a", "triangle_b", "distance_count"},
                  r.status, r.time, r.point_a, r.point_b, r.normal, r.triangle_a, r.triangle_b, r.distance_count);
}

nb::object path_distance_dtype() {
  const PathDistanceRecord r{};
  return dtype_of(r, {"lower", "upper", "time", "point_a", "point_b", "triangle_a", "triangle_b", "distance_count"},
                  r.lower, r.upper, r.time, r.point_a, r.point_b, r.triangle_a, r.triangle_b, r.distance_count);
}

nb::object solid_relation_dtype() {
  const SolidRelationRecord r{};
  return dtype_of(r, {"relation", "point_a", "point_b", "triangle_a", "triangle_b"}, r.relation, r.point_a, r.point_b,
                  r.triangle_a, r.triangle_b);
}

/// The end of a docstring: fields and what they are.
std::string fields(std::initializer_list<std::array<const char*, 2>> lines) {
  std::string text;
  for (const auto& [name, meaning] : lines) text.append("\n\n").append(name).append(": ").append(meaning);
  return text;
}

constexpr const char* feature_text = "kind, a FeatureKind, and index, as those of Feature";

Witness witness_or_nowhere(const std::optional<Witness>& witness) {
  return witness.value_or(Witness{nowhere, nowhere, no_id, no_id});
}

SurfacePointRecord surface_point_record(const std::optional<SurfacePoint>& closest) {
  if (!closest) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return {infinite, nowhere, nowhere, no_id, {}, false};
  }
  return {closest->distance, closest->position, closest->weights, closest->triangle, closest->feature, false};
}

}  // namespace

DistanceRecord record_of(const DistanceResult& r) {
  const Witness w = witness_or_nowhere(r.witness);
  const auto status = static_cast<std::uint8_t>(r.status), stopped_by = static_cast<std::uint8_t>(r.stopped_by);
  return {r.lower, r.upper, w.point_a, w.point_b, w.triangle_a, w.triangle_b, status, stopped_by};
}

CollideRecord record_of(const CollideResult& r) {
  const Witness w = witness_or_nowhere(r.witness);
  const auto answer = static_cast<std::uint8_t>(r.answer), stopped_by = static_cast<std::uint8_t>(r.stopped_by);
  return {w.point_a, w.point_b, w.triangle_a, w.triangle_b, r.is_yes(), answer, stopped_by};
}

ClosestObjectsRecord record_of(const ClosestObjectsResult& c) {
  return {record_of(c.result), c.objects.a, c.objects.b};
}

AnyWithinRecord record_of(const AnyWithinResult& c) {
  const CollideRecord r = record_of(c.result);
  return {r.point_a, r.point_b, r.triangle_a, r.triangle_b, c.objects.a, c.objects.b, r.is_yes, r.answer, r.stopped_by};
}

PathImpactRecord record_of(const PathImpact& r) {
  const Witness w = witness_or_nowhere(r.witness);
  return {r.time, w.point_a, w.point_b, r.normal, r.distance_count, w.triangle_a, w.triangle_b, r.status};
}

PathDistanceRecord record_of(const PathDistance& r) {
  const Witness w = witness_or_nowhere(r.witness);
  return {r.lower, r.upper, r.time, w.point_a, w.point_b, r.distance_count, w.triangle_a, w.triangle_b};
}

SurfacePointRecord record_of(const PointResult& r) { return surface_point_record(r.closest); }

SurfacePointRecord record_of(const SignedDistance& s) {
  SurfacePointRecord record = surface_point_record(s.closest);
  record.is_inside = s.is_inside;
  if (s.closest) record.distance = s.distance();
  return record;
}

SolidRelationRecord record_of(const SolidRelationResult& r) {
  const Witness w = witness_or_nowhere(r.witness);
  return {w.point_a, w.point_b, w.triangle_a, w.triangle_b, static_cast<std::uint8_t>(r.relation)};
}

const Dtypes& dtypes() { return all_dtypes; }

std::string contact_fields() {
  return fields({{"distance", docs::TriangleContact_distance},
                 {"depth", docs::TriangleContact_depth},
                 {"point_a, point_b", docs::TriangleContact_point_a},
                 {"normal", docs::TriangleContact_normal},
                 {"weights_a, weights_b", "of the points, by corner: >= 0, together 1; 0 off the feature"},
                 {"feature_a, feature_b", feature_text},
                 {"normal_side", "a NormalSide: whether the normal points the way that parts bodies"},
                 {"triangle_a, triangle_b", docs::Witness_triangle_a}});
}

std::string surface_point_fields() {
  return fields({{"distance", docs::SurfacePoint_distance},
                 {"position", "the point of the model, in the world"},
                 {"weights", docs::SurfacePoint_weights},
                 {"triangle", "the triangle that it lies on"},
                 {"feature", feature_text}});
}

constexpr const char* witness_points = "the points of the witness; not numbers without one";
constexpr const char* witness_triangles = "their triangles; 2^32 - 1 without a witness";

std::string distance_fields() {
  return fields({{"lower", docs::DistanceResult_lower},
                 {"upper", docs::DistanceResult_upper},
                 {"point_a, point_b", witness_points},
                 {"triangle_a, triangle_b", witness_triangles},
                 {"status", "a DistanceStatus"},
                 {"stopped_by", "a StoppedBy"}});
}

std::string collide_fields() {
  return fields({{"is_yes", "whether the answer is yes; not so where it is undecided, which takes a budget"},
                 {"answer", "an Answer"},
                 {"point_a, point_b", witness_points},
                 {"triangle_a, triangle_b", witness_triangles},
                 {"stopped_by", "a StoppedBy"}});
}

std::string solid_relation_fields() {
  return fields({{"relation", "a SolidRelation"},
                 {"point_a, point_b", witness_points},
                 {"triangle_a, triangle_b", witness_triangles}});
}

std::string vertex_face_fields() {
  return fields({{"vertex, triangle", "ids in each model's own mesh"},
                 {"is_vertex_of_b", docs::VertexFacePair_is_vertex_of_b},
                 {"distance", "of the two elements"},
                 {"weights", docs::VertexFacePair_weights}});
}

std::string edge_edge_fields() {
  return fields({{"a, b", "ids of the edges of each model"},
                 {"distance", "of the two elements"},
                 {"parameter_a, parameter_b", docs::EdgeEdgePair_parameter_a}});
}

std::string feature_pair_fields() {
  return fields({{"distance", "of the two features"},
                 {"point_a, point_b", docs::FeaturePair_point_a},
                 {"normal", docs::FeaturePair_normal},
                 {"weights_a, weights_b", docs::FeaturePair_weights_a},
                 {"a, b", docs::FeaturePair_a},
                 {"vertices_a, vertices_b", docs::FeaturePair_vertices_a},
                 {"multiplicity", docs::FeaturePair_multiplicity},
                 {"kind_a, kind_b", "a FeatureKind"}});
}

std::string element_pair_fields() { return fields({{"kind", "an ElementPairKind"}, {"a, b", docs::ElementPair_a}}); }

std::string impact_fields() {
  return element_pair_fields() + fields({{"status", "an ImpactStatus: contact or initial_contact"},
                                         {"lower, upper", docs::ElementImpact_lower}});
}

void bind_records(nb::module_& module) {
  const auto keep = [&module](const char* name, nb::object dtype) {
    module.attr(name) = dtype;
    return dtype.release();
  };
  all_dtypes = {.distance = keep("distance_dtype", distance_dtype()),
                .collide = keep("collide_dtype", collide_dtype()),
                .surface_point = keep("surface_point_dtype", surface_point_dtype()),
                .signed_distance = keep("signed_distance_dtype", signed_distance_dtype()),
                .contact = keep("contact_dtype", contact_dtype()),
                .vertex_face = keep("vertex_face_dtype", vertex_face_dtype()),
                .edge_edge = keep("edge_edge_dtype", edge_edge_dtype()),
                .feature_pair = keep("feature_pair_dtype", feature_pair_dtype()),
                .element_pair = keep("element_pair_dtype", element_pair_dtype()),
                .impact = keep("impact_dtype", impact_dtype()),
                .solid_relation = keep("solid_relation_dtype", solid_relation_dtype())};
  module.attr("closest_objects_dtype") = closest_objects_dtype();
  module.attr("any_within_dtype") = any_within_dtype();
  module.attr("path_impact_dtype") = path_impact_dtype();
  module.attr("path_distance_dtype") = path_distance_dtype();
}

nb::object found(const char* class_name, const nb::object& records, const PairCount& count) {
  return result(class_name, "records"_a = records, "is_complete"_a = count.is_complete,
                "stopped_by"_a = count.stopped_by, "stats"_a = count.stats);
}

nb::object new_array(nb::handle dtype, std::initializer_list<std::size_t> shape) {
  nb::list sizes;
  for (const std::size_t size : shape) sizes.append(size);
  return nb::module_::import_("numpy").attr("empty")(nb::tuple(sizes), dtype);
}

void* memory_of(nb::handle array, std::size_t bytes) {
  Py_buffer buffer;
  if (PyObject_GetBuffer(array.ptr(), &buffer, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE) != 0) throw nb::python_error();
  void* const memory = buffer.buf;
  const auto available = static_cast<std::size_t>(buffer.len);
  PyBuffer_Release(&buffer);  // the caller holds the array
  if (available < bytes) throw nb::value_error("the array is too small");
  return memory;
}

GivenContacts contacts_from(nb::handle object, std::optional<std::size_t> axes) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object given = numpy.attr("asarray")(object);
  // Arrays that NumPy has put together have the fields at other places; those of another version may have more.
  const nb::object names = given.attr("dtype").attr("names"), wanted = dtypes().contact.attr("names");
  const bool has_fields = !names.is_none() && nb::cast<bool>(nb::set(wanted).attr("issubset")(names));
  if (!has_fields || (axes && nb::cast<std::size_t>(given.attr("ndim")) != *axes)) {
    const nb::object text =
        nb::str("contacts: expected shape {} and the fields of contact_dtype; got shape {} and fields {}")
            .format(axes == 1 ? "(n,)" : "(...)", given.attr("shape"), names);
    throw nb::value_error(nb::cast<std::string>(text).c_str());
  }
  nb::object packed = numpy.attr("empty")(given.attr("shape"), dtypes().contact);
  const auto count = nb::cast<std::size_t>(packed.attr("size"));
  auto* const first = static_cast<Contact*>(memory_of(packed, count * sizeof(Contact)));
  const nb::object all = packed.attr("reshape")(-1), found = given.attr("reshape")(-1);
  in_pieces(
      count,
      [&](std::size_t begin, std::size_t end) {
        const nb::slice piece(nb::int_(begin), nb::int_(end), nb::int_(1));
        all[piece] = found[piece][nb::list(wanted)];
      },
      std::size_t{1} << 13);
  return {std::move(packed), {first, count}};
}

FloatArray array_of(std::span<const Vec3> vectors) {
  return array_of(vectors, nb::str("float64"), {vectors.size(), 3});
}

IdArray array_of(std::span<const std::uint32_t> ids) { return array_of(ids, nb::str("uint32"), {ids.size()}); }

}  // namespace limber::python
