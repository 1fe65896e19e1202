// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "command/text.h"

namespace limber::program {
namespace {

constexpr std::uint32_t largest_quantum = (1U << 24U) - 1;
constexpr std::size_t run_length = 32;
constexpr double steps_of_diagonal = 1 << 15;
constexpr double most_steps = 0x1p40;  // pages count in float64

void append_differences(Bytes& bytes, const std::vector<std::int64_t>& steps,
                        const std::vector<std::int64_t>& expected) {
  std::uint64_t zeros = 0;
  const auto end_zeros = [&] {
    if (zeros == 0) return;
    append_count(bytes, 0);
    append_count(bytes, std::exchange(zeros, 0));
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::int64_t difference = steps[i] - expected[i];
    if (difference == 0) {
      ++zeros;
      continue;
    }
    end_zeros();
    append_count(bytes, static_cast<std::uint64_t>(difference > 0 ? 2 * difference : -2 * difference - 1));
  }
  end_zeros();
}

std::uint64_t read_count(const Bytes& bytes, std::size_t& at) {
  std::uint64_t count = 0;
  for (unsigned shift = 0;; shift += 7) {
    const std::uint8_t byte = bytes[at++];
    count |= std::uint64_t{byte & 127U} << shift;
    if (byte < 128) return count;
  }
}

/// Reads `count` differences of coordinates from the bytes that append_differences() has written.
std::vector<std::int64_t> differences_in(const Bytes& bytes, std::size_t count) {
  std::vector<std::int64_t> differences;
  differences.reserve(count);
  for (std::size_t at = 0; at < bytes.size();) {
    const auto code = static_cast<std::int64_t>(read_count(bytes, at));
    if (code == 0) {
      differences.resize(differences.size() + read_count(bytes, at));
    } else {
      differences.push_back(code % 2 == 0 ? code / 2 : -(code + 1) / 2);
    }
  }
  return differences;
}

}  // namespace

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

PositionFrames::PositionFrames(std::span<const Vec3> first) : low_(first.front()) {
  Vec3 high = low_;
  for (const Vec3& p : first) {
    low_ = min(low_, p);
    high = max(high, p);
  }
  const double diagonal = length(high - low_);
  const double size = diagonal > 0 ? diagonal : max_abs(low_);  // of a mesh that is a point, something
  if (size > 0) step_ = size / steps_of_diagonal;
}

PositionFrames::Steps PositionFrames::steps_of(std::span<const Vec3> positions) const {
  Steps steps;
  steps.reserve(3 * positions.size());
  for (const Vec3& p : positions) {
    const Vec3 off = p - low_;
    if (!(max_abs(off) < most_steps * step_)) {
      throw BadInput("--report: a frame lies too far from the first one to be drawn with it");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) steps.push_back(std::llround(off[axis] / step_));
  }
  return steps;
}

PositionFrames::Steps PositionFrames::expected(const Steps& steps) const {
  if (frames_.size() % run_length != 0) return last_;
  Steps before(steps.size());
  std::copy(steps.begin(), steps.end() - 3, before.begin() + 3);
  return before;
}

void PositionFrames::add(std::span<const Vec3> positions) { append(steps_of(positions)); }

void PositionFrames::append(const Steps& steps) {
  Bytes bytes;
  append_differences(bytes, steps, expected(steps));
  byte_count_ += bytes.size();
  frames_.push_back(std::move(bytes));
  last_ = steps;
}

void PositionFrames::drop_every_second() {
  const std::vector<Bytes> all = std::exchange(frames_, {});
  Steps steps(last_.size());
  byte_count_ = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Steps differences = differences_in(all[i], steps.size());
    const bool is_whole = i % run_length == 0;
    for (std::size_t c = 0; c < steps.size(); ++c) {
      const std::int64_t before = !is_whole ? steps[c] : c < 3 ? 0 : steps[c - 3];
      steps[c] = before + differences[c];
    }
    if (i % 2 == 0) append(steps);
  }
}

Json PositionFrames::to_json() const {
  Json frames = Json::array();
  for (const Bytes& frame : frames_) frames.push_back(base64_of(frame));
  return {{"low", program::to_json(low_)}, {"step", step_}, {"run", run_length}, {"data", std::move(frames)}};
}

Json poses_json(std::span<const Transform> poses) {
  Bytes bytes;
  for (const Transform& pose : poses) {
    const auto& [rotation, translation] = pose;
    for (const Vec3& row : {rotation.row0, rotation.row1, rotation.row2, translation}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bits = std::bit_cast<std::uint64_t>(row[axis]);
        for (unsigned shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
      }
    }
  }
  return base64_of(bytes);
}

}  // namespace limber::program
