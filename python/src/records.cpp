// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "records.h"
#include "limber/distance.h"

#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "docstrings.h"

namespace limber::python {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr Vec3 nowhere{not_a_number, not_a_number, not_a_number};

Dtypes all_dtypes;

/// A type of records, field by field. Places are read off an object, as the compiler has laid it out.
class RecordType {
 public:
  template <typename Record>
  explicit RecordType(const Record& record)
      : record_(reinterpret_cast<const unsigned char*>(&record)), bytes_(sizeof record) {}

  template <typename Field>
  RecordType& field(const char* name, nb::object format, const Field& place) {
    names_.append(name);
    formats_.append(format);
    offsets_.append(reinterpret_cast<const unsigned char*>(&place) - record_);
    return *this;
  }
  template <typename Field>
  RecordType& field(const char* name, const char* format, const Field& place) {
    return field(name, nb::str(format), place);
  }

  nb::object dtype() const {
    nb::dict description;
    description["names"] = names_;
    description["formats"] = formats_;
    description["offsets"] = offsets_;
    description["itemsize"] = bytes_;
    return nb::module_::import_("numpy").attr("dtype")(description);
  }

 private:
  const unsigned char* record_;
  std::size_t bytes_;
  nb::list names_, formats_, offsets_;
};

nb::object feature_dtype() {
  const Feature f;
  return RecordType(f).field("kind", "u1", f.kind).field("index", "u1", f.index).dtype();
}

nb::object distance_dtype() {
  const DistanceRecord r{};
  return RecordType(r)
      .field("lower", "f8", r.lower)
      .field("upper", "f8", r.upper)
      .field("point_a", "(3,)f8", r.point_a)
      .field("point_b", "(3,)f8", r.point_b)
      .field("triangle_a", "u4", r.triangle_a)
      .field("triangle_b", "u4", r.triangle_b)
      .field("status", "u1", r.status)
      .field("stopped_by", "u1", r.stopped_by)
      .dtype();
}

nb::object collide_dtype() {
  const CollideRecord r{};
  return RecordType(r)
      .field("is_yes", "?", r.is_yes)
      .field("point_a", "(3,)f8", r.point_a)
      .field("point_b", "(3,)f8", r.point_b)
      .field("triangle_a", "u4", r.triangle_a)
      .field("triangle_b", "u4", r.triangle_b)
      .dtype();
}

nb::object surface_point_dtype(bool is_signed) {
  const SurfacePointRecord r{};
  RecordType type(r);
  type.field("distance", "f8", r.distance)
      .field("position", "(3,)f8", r.position)
      .field("barycentric", "(3,)f8", r.barycentric)
      .field("triangle", "u4", r.triangle)
      .field("feature", feature_dtype(), r.feature);
  if (is_signed) type.field("is_inside", "?", r.is_inside);
  return type.dtype();
}

nb::object contact_dtype() {
  const Contact c;
  return RecordType(c)
      .field("distance", "f8", c.distance)
      .field("depth", "f8", c.depth)
      .field("point_a", "(3,)f8", c.point_a)
      .field("point_b", "(3,)f8", c.point_b)
      .field("normal", "(3,)f8", c.normal)
      .field("feature_a", feature_dtype(), c.feature_a)
      .field("feature_b", feature_dtype(), c.feature_b)
      .field("normal_side", "u1", c.normal_side)
      .field("triangle_a", "u4", c.triangle_a)
      .field("triangle_b", "u4", c.triangle_b)
      .dtype();
}

nb::object vertex_face_dtype() {
  const VertexFacePair p;
  return RecordType(p)
      .field("vertex", "u4", p.vertex)
      .field("triangle", "u4", p.triangle)
      .field("is_vertex_of_b", "?", p.is_vertex_of_b)
      .field("distance", "f8", p.distance)
      .field("weights", "(3,)f8", p.weights)
      .dtype();
}

nb::object edge_edge_dtype() {
  const EdgeEdgePair p;
  return RecordType(p)
      .field("a", "u4", p.a)
      .field("b", "u4", p.b)
      .field("distance", "f8", p.distance)
      .field("parameter_a", "f8", p.parameter_a)
      .field("parameter_b", "f8", p.parameter_b)
      .dtype();
}

/// The end of a docstring: fields and what they are.
std::string fields(std::initializer_list<std::array<const char*, 2>> lines) {
  std::string text;
  for (const auto& [name, meaning] : lines) text.append("\n\n").append(name).append(": ").append(meaning);
  return text;
}

constexpr const char* feature_text = "kind, a FeatureKind, and index, as those of Feature";

CollideRecord collide_record(const std::optional<Witness>& witness, bool is_yes) {
  const Witness w = witness.value_or(Witness{nowhere, nowhere, no_id, no_id});
  return {w.point_a, w.point_b, w.triangle_a, w.triangle_b, is_yes};
}

}  // namespace

DistanceRecord record_of(const DistanceResult& result) {
  const Witness w = result.witness.value_or(Witness{nowhere, nowhere, no_id, no_id});
  return {result.lower,
          result.upper,
          w.point_a,
          w.point_b,
          w.triangle_a,
          w.triangle_b,
          static_cast<std::uint8_t>(result.status),
          static_cast<std::uint8_t>(result.stopped_by)};
}

CollideRecord record_of(const CollideResult& result) { return collide_record(result.witness, result.is_yes()); }

SurfacePointRecord record_of(const std::optional<SurfacePoint>& closest) {
  if (!closest) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return {infinite, nowhere, {not_a_number, not_a_number, not_a_number}, no_id, {}, false};
  }
  return {closest->distance, closest->position, closest->barycentric, closest->triangle, closest->feature, false};
}

SurfacePointRecord record_of(const SignedDistance& signed_distance) {
  SurfacePointRecord record = record_of(signed_distance.closest);
  record.is_inside = signed_distance.is_inside;
  if (signed_distance.closest) record.distance = signed_distance.distance();
  return record;
}

const Dtypes& dtypes() { return all_dtypes; }

std::string contact_fields() {
  return fields({{"distance", docs::TriangleContact_distance},
                 {"depth", docs::TriangleContact_depth},
                 {"point_a, point_b", docs::TriangleContact_point_a},
                 {"normal", docs::TriangleContact_normal},
                 {"feature_a, feature_b", feature_text},
                 {"normal_side", "a NormalSide: whether the normal points the way that parts bodies"},
                 {"triangle_a, triangle_b", docs::Witness_triangle_a}});
}

std::string surface_point_fields() {
  return fields({{"distance", docs::SurfacePoint_distance},
                 {"position", "the point of the model, in the world"},
                 {"barycentric", docs::SurfacePoint_barycentric},
                 {"triangle", "the triangle that it lies on"},
                 {"feature", feature_text}});
}

std::string distance_fields() {
  return fields({{"lower", docs::DistanceResult_lower},
                 {"upper", docs::DistanceResult_upper},
                 {"point_a, point_b", "the points of the witness; not numbers without one"},
                 {"triangle_a, triangle_b", "their triangles; 2^32 - 1 without a witness"},
                 {"status", "a Status"},
                 {"stopped_by", "a StoppedBy"}});
}

std::string vertex_face_fields() {
  return fields({{"vertex, triangle", "ids in each model's own mesh"},
                 {"is_vertex_of_b", docs::VertexFacePair_is_vertex_of_b},
                 {"distance", "of the two elements"},
                 {"weights", docs::VertexFacePair_weights}});
}

std::string edge_edge_fields() {
  return fields({{"a, b", "ids of MeshEdges of each model"},
                 {"distance", "of the two elements"},
                 {"parameter_a, parameter_b", docs::EdgeEdgePair_parameter_a}});
}

void bind_records(nb::module_& module) {
  const auto keep = [&module](const char* name, nb::object dtype) {
    module.attr(name) = dtype;
    return dtype.release();
  };
  all_dtypes = {.distance = keep("distance_dtype", distance_dtype()),
                .collide = keep("collide_dtype", collide_dtype()),
                .surface_point = keep("surface_point_dtype", surface_point_dtype(false)),
                .signed_distance = keep("signed_distance_dtype", surface_point_dtype(true)),
                .contact = keep("contact_dtype", contact_dtype()),
                .vertex_face = keep("vertex_face_dtype", vertex_face_dtype()),
                .edge_edge = keep("edge_edge_dtype", edge_edge_dtype())};
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

nb::object array_of(const Vec3& vector) { return array_of(std::span<const Vec3>(&vector, 1), nb::str("float64"), {3}); }

nb::object array_of(const std::array<double, 3>& numbers) {
  return array_of(std::span<const double>(numbers), nb::str("float64"), {3});
}

nb::object array_of(std::span<const Vec3> vectors) {
  return array_of(vectors, nb::str("float64"), {vectors.size(), 3});
}

nb::object array_of(std::span<const std::uint32_t> ids) { return array_of(ids, nb::str("uint32"), {ids.size()}); }

}  // namespace limber::python
