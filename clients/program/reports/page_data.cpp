// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_data.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limber::program {

constexpr std::uint32_t largest_quantum = (1U << 24U) - 1;

std::string base64_of(std::span<const std::uint8_t> bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8U | (j < count ? bytes[i + j] : 0U);
    for (std::size_t j = 0; j < 4; ++j) text += j <= count ? digits[group >> (18U - 6U * j) & 63U] : '=';
  }
  return text;
}

void append_count(Bytes& bytes, std::uint64_t count) {
  for (; count >= 128; count >>= 7U) bytes.push_back(static_cast<std::uint8_t>(count | 128U));
  bytes.push_back(static_cast<std::uint8_t>(count));
}

Json quantized(std::span<const double> numbers) {
  const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
  const double step = (*high - *low) / largest_quantum;
  Bytes bytes;  // 3 for each, the lowest first
  bytes.reserve(3 * numbers.size());
  for (const double number : numbers) {
    const double quanta = step > 0 ? (number - *low) / step : 0;
    const auto k = static_cast<std::uint32_t>(std::clamp(std::round(quanta), 0.0, double{largest_quantum}));
    for (const unsigned shift : {0U, 8U, 16U}) bytes.push_back(static_cast<std::uint8_t>(k >> shift));
  }
  return {{"low", *low}, {"step", step}, {"data", base64_of(bytes)}};
}

Json quantized(std::span<const Vec3> points) {
  Json json = {{"low", Json::array()}, {"step", Json::array()}, {"data", Json::array()}};
  std::vector<double> coordinates(points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), coordinates.begin(), [axis](const Vec3& p) { return p[axis]; });
    const Json of_axis = quantized(coordinates);
    for (const auto& [key, value] : of_axis.items()) json[key].push_back(value);
  }
  return json;
}

Json increasing_ids(std::span<const std::uint32_t> ids) {
  Bytes bytes;
  std::uint32_t previous = 0;
  for (const std::uint32_t id : ids) {
    append_count(bytes, id - previous);
    previous = id;
  }
  return base64_of(bytes);
}

Json flat_witness(const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  const auto& [a, b, triangle_a, triangle_b] = witness->witness;
  return {a.x, a.y, a.z, b.x, b.y, b.z, triangle_a, triangle_b, witness->face_a, witness->face_b};
}

Json settings_of(const DistanceOptions& options, const std::optional<double>& min_clearance) {
  return {{"min_clearance", to_json(min_clearance)},
          {"max_distance", std::isfinite(options.max_distance) ? Json(options.max_distance) : Json(nullptr)},
          {"relative_error", options.relative_error},
          {"absolute_error", options.absolute_error}};
}

PageTriangles::PageTriangles(MeshView mesh) {
  std::vector<std::uint32_t> number_of(mesh.positions.size(), no_id);
  for (const Corners& triangle : mesh.triangles) {
    for (const VertexId v : triangle) {
      if (number_of[v] == no_id) {
        append_count(corners, 0);
        number_of[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(v);
      } else {
        append_count(corners, vertices.size() - number_of[v]);
      }
    }
  }
}

}  // namespace limber::program
