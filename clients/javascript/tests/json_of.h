// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <tuple>
#include <vector>

#include "limber/limber.h"
#include "tables.h"

/// Arguments and answers as JSON, with the names of the JavaScript package. Decimals give back the bits of the numbers.
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

// --- answers ---

/// JSON has no number for infinity, so a text stands for it.
inline json of(double x) { return std::isfinite(x) ? json(x) : json("Infinity"); }
inline json of(const Vec3& v) { return {v.x, v.y, v.z}; }
inline json of(const Transform& pose) { return matrix_of(pose, MatrixOrder::column_major); }
inline json of(std::uint32_t id) { return id; }
inline json of(std::uint8_t number) { return number; }

/// Answers as the tables that JavaScript reads, by the names of their columns.
template <typename Answer>
json columns(std::span<const Answer> answers) {
  json table;
  const auto add = [&](const auto& column) {
    json& numbers = table[column.name] = json::array();
    for (const Answer& answer : answers) {
      for (const auto number : numbers_of(std::invoke(column.part, answer))) numbers.push_back(of(number));
    }
  };
  std::apply([&](const auto&... all) { (add(all), ...); }, columns_of(static_cast<const Answer*>(nullptr)));
  return table;
}

template <typename Answer>
json each(const std::vector<Answer>& answers) {
  return columns(std::span<const Answer>(answers));
}

/// One answer: a table of one row.
template <typename Answer>
json of(const Answer& answer) {
  return columns(std::span(&answer, 1));
}

inline json of(const ClosestObjectsResult& found) {
  const ObjectPair pair = found.objects;
  return {{"objects", pair.a == no_id ? json(nullptr) : json{pair.a, pair.b}}, {"result", of(found.result)}};
}

/// All contacts that visit(visitor) finds.
template <typename Visit>
json contacts_of(const Visit& visit) {
  std::vector<Contact> found;
  const PairCount count = visit([&](const Contact& contact) { return found.push_back(contact), true; });
  json table = each(found);
  table["count"] = found.size(), table["isComplete"] = true;
  table["stats"] = {{"nodeTests", count.stats.node_tests}, {"primitiveTests", count.stats.primitive_tests}};
  return table;
}

}  // namespace limber::web
