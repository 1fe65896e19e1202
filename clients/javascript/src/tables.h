// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/motion.h"
#include "limber/path.h"
#include "limber/points.h"

/// How answers go to JavaScript: as tables of columns, one column after the other, each at a multiple of eight bytes.
/// What is listed here is the only list of columns: JavaScript reads it from the module, and names arrays as it does.
namespace limber::web {

/// A column: its name in JavaScript, and which part of an answer it has.
template <typename Part>
struct Column {
  const char* name;
  Part part;
};
template <typename Part>
Column(const char*, Part) -> Column<Part>;

// The numbers that stand for a part of an answer, all of one kind.

inline std::array<double, 1> numbers_of(double number) { return {number}; }
inline std::array<double, 1> numbers_of(std::uint64_t count) { return {static_cast<double>(count)}; }
inline std::array<double, 3> numbers_of(const Vec3& v) { return {v.x, v.y, v.z}; }
inline std::array<std::uint32_t, 1> numbers_of(std::uint32_t id) { return {id}; }
inline std::array<std::uint8_t, 2> numbers_of(const Feature& feature) {
  return {static_cast<std::uint8_t>(feature.kind), feature.index};
}
template <typename T>
requires(std::is_enum_v<T> || std::is_same_v<T, bool>) std::array<std::uint8_t, 1> numbers_of(T value) {
  return {static_cast<std::uint8_t>(value)};
}

// --- the columns of each kind of answer ---

/// The work done.
template <typename Answer>
constexpr auto stats_columns() {
  return std::tuple{Column{"nodeTests", [](const Answer& r) { return r.stats.node_tests; }},
                    Column{"primitiveTests", [](const Answer& r) { return r.stats.primitive_tests; }}};
}

/// Where a query has found something. Without a witness points are 0 and triangles are no_id.
template <typename Answer>
constexpr auto witness_columns() {
  const auto of = [](auto part) { return [part](const Answer& r) { return r.witness.value_or(Witness{}).*part; }; };
  return std::tuple_cat(
      std::tuple{Column{"pointsA", of(&Witness::point_a)}, Column{"pointsB", of(&Witness::point_b)},
                 Column{"trianglesA", of(&Witness::triangle_a)}, Column{"trianglesB", of(&Witness::triangle_b)},
                 Column{"stoppedBys", &Answer::stopped_by}},
      stats_columns<Answer>());
}

constexpr auto columns_of(const DistanceResult*) {
  using Answer = DistanceResult;
  return std::tuple_cat(std::tuple{Column{"lowers", &Answer::lower}, Column{"uppers", &Answer::upper},
                                   Column{"statuses", &Answer::status}},
                        witness_columns<Answer>());
}

constexpr auto columns_of(const CollideResult*) {
  return std::tuple_cat(std::tuple{Column{"answers", &CollideResult::answer}}, witness_columns<CollideResult>());
}

constexpr auto columns_of(const Contact*) {
  return std::tuple{Column{"distances", &Contact::distance},    Column{"depths", &Contact::depth},
                    Column{"pointsA", &Contact::point_a},       Column{"pointsB", &Contact::point_b},
                    Column{"normals", &Contact::normal},        Column{"weightsA", &Contact::weights_a},
                    Column{"weightsB", &Contact::weights_b},    Column{"trianglesA", &Contact::triangle_a},
                    Column{"trianglesB", &Contact::triangle_b}, Column{"featuresA", &Contact::feature_a},
                    Column{"featuresB", &Contact::feature_b},   Column{"normalSides", &Contact::normal_side}};
}

inline double distance_of(const PointResult& r) { return r.closest->distance; }
inline double distance_of(const SignedDistance& r) { return r.distance(); }

/// Where nothing was found, the distance is infinite, other numbers are 0 and the triangle is no_id.
template <typename Answer>
constexpr auto point_columns() {
  constexpr double nowhere = std::numeric_limits<double>::infinity();
  const auto of = [](auto part) {
    return [part](const Answer& r) { return r.closest.value_or(SurfacePoint{}).*part; };
  };
  return std::tuple_cat(
      std::tuple{Column{"distances", [](const Answer& r) { return r.closest ? distance_of(r) : nowhere; }},
                 Column{"positions", of(&SurfacePoint::position)}, Column{"weights", of(&SurfacePoint::weights)},
                 Column{"triangles", of(&SurfacePoint::triangle)}, Column{"features", of(&SurfacePoint::feature)}},
      stats_columns<Answer>());
}

constexpr auto columns_of(const PointResult*) { return point_columns<PointResult>(); }

constexpr auto columns_of(const SignedDistance*) {
  return std::tuple_cat(point_columns<SignedDistance>(), std::tuple{Column{"insides", &SignedDistance::is_inside}});
}

/// Without elements their ids are no_id.
constexpr auto columns_of(const ImpactResult*) {
  using Answer = ImpactResult;
  const auto of = [](auto part) {
    return [part](const Answer& r) { return r.elements.value_or(ElementPair{}).*part; };
  };
  return std::tuple_cat(std::tuple{Column{"statuses", &Answer::status}, Column{"lowers", &Answer::lower},
                                   Column{"uppers", &Answer::upper}, Column{"normals", &Answer::normal},
                                   Column{"kinds", of(&ElementPair::kind)}, Column{"elementsA", of(&ElementPair::a)},
                                   Column{"elementsB", of(&ElementPair::b)}},
                        witness_columns<Answer>());
}

constexpr auto columns_of(const PathImpact*) {
  using Answer = PathImpact;
  return std::tuple_cat(
      std::tuple{Column{"statuses", &Answer::status}, Column{"times", &Answer::time},
                 Column{"normals", &Answer::normal}, Column{"distanceCounts", &Answer::distance_count}},
      witness_columns<Answer>());
}

// --- what is done with them ---

template <typename Answer, typename Part>
using NumbersOf = decltype(numbers_of(std::invoke(std::declval<Part>(), std::declval<const Answer&>())));

constexpr std::size_t padded(std::size_t bytes) {
  return (bytes + sizeof(double) - 1) / sizeof(double) * sizeof(double);
}

/// The bytes of a table with so many answers.
template <typename Answer>
constexpr std::size_t table_bytes(std::size_t count) {
  const auto all = [count]<typename... Parts>(const Column<Parts>&...) {
    return (padded(count * sizeof(NumbersOf<Answer, Parts>)) + ...);
  };
  return std::apply(all, columns_of(static_cast<const Answer*>(nullptr)));
}

template <typename Answer>
void write_table(std::span<const Answer> answers, std::byte* to) {
  const auto write = [&]<typename Part>(const Column<Part>& column) {
    std::byte* at = to;
    for (const Answer& answer : answers) {
      const auto numbers = numbers_of(std::invoke(column.part, answer));
      std::memcpy(at, numbers.data(), sizeof(numbers));
      at += sizeof(numbers);
    }
    to += padded(answers.size() * sizeof(NumbersOf<Answer, Part>));
  };
  std::apply([&](const auto&... columns) { (write(columns), ...); }, columns_of(answers.data()));
}

/// A list of JSON: name, kind of array and numbers per answer of each column.
template <typename Answer>
std::string description_of(const char* table) {
  std::string text = '"' + std::string(table) + "\":[";
  const auto add = [&]<typename Part>(const Column<Part>& column) {
    using Numbers = NumbersOf<Answer, Part>;
    constexpr std::size_t size = sizeof(typename Numbers::value_type);
    const char* const kind = size == 8 ? "Float64Array" : size == 4 ? "Uint32Array" : "Uint8Array";
    if (text.back() != '[') text += ',';
    text +=
        "[\"" + std::string(column.name) + "\",\"" + kind + "\"," + std::to_string(std::tuple_size_v<Numbers>) + ']';
  };
  std::apply([&](const auto&... columns) { (add(columns), ...); }, columns_of(static_cast<const Answer*>(nullptr)));
  return text + ']';
}

}  // namespace limber::web
