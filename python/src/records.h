// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings.h"
#include "limber/limber.h"

/// Answers as arrays of NumPy: many of them are one array of records.
namespace limber::python {

/// One answer of distance(), as an array holds it.
struct DistanceRecord {
  double lower, upper;
  Vec3 point_a, point_b;  // not a number without a witness
  TriangleId triangle_a, triangle_b;
  std::uint8_t status, stopped_by;
};

/// One answer of collide() or within().
struct CollideRecord {
  Vec3 point_a, point_b;  // not a number without a witness
  TriangleId triangle_a, triangle_b;
  bool is_yes;
  std::uint8_t answer, stopped_by;
};

/// One answer of closest_objects().
struct ClosestObjectsRecord {
  DistanceRecord result;
  ObjectId object_a, object_b;  // no_id without a witness
};

/// One answer of any_within().
struct AnyWithinRecord {
  Vec3 point_a, point_b;  // not a number without a witness
  TriangleId triangle_a, triangle_b;
  ObjectId object_a, object_b;
  bool is_yes;
  std::uint8_t answer, stopped_by;
};

/// One answer of time_of_impact() of rigid bodies.
struct PathImpactRecord {
  double time;
  Vec3 point_a, point_b;  // not a number without a witness
  Vec3 normal;            // 0 without one
  std::uint64_t distance_count;
  TriangleId triangle_a, triangle_b;
  ImpactStatus status;
};

/// One answer of min_distance().
struct PathDistanceRecord {
  double lower, upper, time;
  Vec3 point_a, point_b;
  std::uint64_t distance_count;
  TriangleId triangle_a, triangle_b;
};

/// One answer of closest_point() or signed_distance().
struct SurfacePointRecord {
  double distance;  // infinite if nothing is that close
  Vec3 position;
  Vec3 weights;
  TriangleId triangle;
  Feature feature;
  bool is_inside;  // of signed distances only
};

/// One answer of solid_relation().
struct SolidRelationRecord {
  Vec3 point_a, point_b;  // not a number without a witness
  TriangleId triangle_a, triangle_b;
  std::uint8_t relation;
};

DistanceRecord record_of(const DistanceResult& result);
CollideRecord record_of(const CollideResult& result);
ClosestObjectsRecord record_of(const ClosestObjectsResult& closest);
AnyWithinRecord record_of(const AnyWithinResult& close);
PathImpactRecord record_of(const PathImpact& result);
PathDistanceRecord record_of(const PathDistance& result);
SurfacePointRecord record_of(const PointResult& result);
SurfacePointRecord record_of(const SignedDistance& signed_distance);
SolidRelationRecord record_of(const SolidRelationResult& result);

/// The element types of such arrays, as NumPy describes them. They live as long as the process.
struct Dtypes {
  nb::handle distance, collide, surface_point, signed_distance, contact, vertex_face, edge_edge, feature_pair,
      element_pair, impact, solid_relation;
};
const Dtypes& dtypes();

/// What the fields of such records are, as the end of a docstring.
std::string contact_fields();
std::string surface_point_fields();
std::string distance_fields();
std::string collide_fields();
std::string solid_relation_fields();
std::string vertex_face_fields();
std::string edge_edge_fields();
std::string feature_pair_fields();
std::string element_pair_fields();
std::string impact_fields();

/// A result of several members: an object of the class of limber3d.results.
template <typename... Members>
nb::object result(const char* class_name, Members&&... members) {
  return nb::module_::import_("limber3d.results").attr(class_name)(std::forward<Members>(members)...);
}
/// A result with records, and what the search for them did.
nb::object found(const char* class_name, const nb::object& records, const PairCount& count);

/// A new array of that shape and element type, not initialised.
nb::object new_array(nb::handle dtype, std::initializer_list<std::size_t> shape);
/// The first element of an array that may be written, with packed elements.
///
/// Throws   nb::value_error if it is no such array, or has fewer than `bytes`.
void* memory_of(nb::handle array, std::size_t bytes);

/// Contacts that come from Python: an array of records with the fields of contact_dtype, or one record.
struct GivenContacts {
  nb::object array;  // a copy, packed; the call's own
  std::span<Contact> contacts;
};
/// `axes` says how many axes the array must have, for messages also as a shape; any number without it.
///
/// Throws   nb::value_error if the fields or the number of axes are others.
GivenContacts contacts_from(nb::handle object, std::optional<std::size_t> axes = std::nullopt);

/// A copy of numbers as an array of that shape. Pre: as many bytes as the shape has elements of the type.
template <typename T>
nb::object array_of(std::span<const T> values, nb::handle dtype, std::initializer_list<std::size_t> shape) {
  static_assert(std::is_trivially_copyable_v<T>);
  nb::object array = new_array(dtype, shape);
  auto* const out = static_cast<unsigned char*>(memory_of(array, values.size_bytes()));
  in_pieces(values.size(), [&](std::size_t begin, std::size_t end) {
    std::memcpy(out + begin * sizeof(T), values.data() + begin, (end - begin) * sizeof(T));
  });
  return array;
}

/// Records as an array of one axis.
template <typename T>
RecordArray array_of(std::span<const T> records, nb::handle dtype) {
  return array_of(records, dtype, {records.size()});
}

/// An array of what a search has found. A deque holds that, as it grows without copies, which take seconds when large.
template <typename T>
nb::object array_of(const std::deque<T>& found, nb::handle dtype, std::initializer_list<std::size_t> shape) {
  nb::object array = new_array(dtype, shape);
  auto* const out = static_cast<T*>(memory_of(array, found.size() * sizeof(T)));
  in_pieces(found.size(), [&](std::size_t begin, std::size_t end) {
    std::copy_n(found.begin() + static_cast<std::ptrdiff_t>(begin), end - begin, out + begin);
  });
  return array;
}
template <typename T>
RecordArray array_of(const std::deque<T>& records, nb::handle dtype) {
  return array_of(records, dtype, {records.size()});
}

/// The first elements of an array.
inline nb::object first(const nb::object& array, std::size_t count) {
  return array[nb::slice(nb::int_(0), nb::int_(count), nb::int_(1))];
}

/// What __reduce__() returns of an object that is made with arguments, and then gets a state by _restore().
inline nb::tuple restored_by(nb::handle type, const nb::tuple& arguments, const nb::object& state) {
  return nb::make_tuple(nb::module_::import_("limber3d.results").attr("restored"),
                        nb::make_tuple(type, arguments, state));
}

/// The array of a property: writing to what a property returns would be lost.
template <typename Array>
Array read_only(Array array) {
  array.attr("setflags")("write"_a = false);
  return array;
}

/// Three coordinates.
inline FloatArray array_of(const Vec3& vector) {
  return array_of(std::span<const Vec3>(&vector, 1), nb::str("float64"), {3});
}
/// A pose as a matrix of 4 x 4.
inline FloatArray array_of(const Transform& pose) {
  const auto matrix = matrix_of(pose, MatrixOrder::row_major);
  return array_of(std::span<const double>(matrix), nb::str("float64"), {4, 4});
}
/// Rows of three coordinates.
FloatArray array_of(std::span<const Vec3> vectors);
/// Rows of ids.
template <std::size_t width>
IdArray array_of(std::span<const std::array<std::uint32_t, width>> rows) {
  return array_of(rows, nb::str("uint32"), {rows.size(), width});
}
IdArray array_of(std::span<const std::uint32_t> ids);

}  // namespace limber::python
