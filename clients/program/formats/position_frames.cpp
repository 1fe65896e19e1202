// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/position_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "command/text.h"

namespace limber::program {
namespace {

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

/// What append_differences() has written, one difference for each coordinate.
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
  return {{"low", limber::program::to_json(low_)}, {"step", step_}, {"run", run_length}, {"data", std::move(frames)}};
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
