// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pose_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "bad_input.h"
#include "number_text.h"

namespace limber::program {
namespace {

constexpr std::size_t pose_length = 7;

bool is_header(std::string_view row) {
  const std::vector<std::string_view> fields = fields_of(row, ',');
  return std::none_of(fields.begin(), fields.end(), [](std::string_view f) { return f.empty() || parsed_number(f); });
}

std::ifstream opened(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw BadInput(path + ": is a folder");
  std::ifstream file(path);
  if (!file) throw BadInput(fmt::format("{}: {}", path, std::strerror(errno)));
  return file;
}

}  // namespace

Result<Transform> parsed_pose(std::string_view text) {
  const std::vector<std::string_view> fields = fields_of(text, ',');
  if (fields.size() != pose_length) {
    return Error{ErrorCode::size_mismatch,
                 fmt::format("a pose is {} numbers {}, not {}", pose_length, pose_format, fields.size()),
                 {}};
  }
  std::array<double, pose_length> n{};
  for (std::size_t i = 0; i < pose_length; ++i) {
    const std::optional<double> number = parsed_number(fields[i]);
    if (!number) return Error{ErrorCode::malformed_file, fmt::format("'{}' is not a number", fields[i]), i};
    n[i] = *number;
  }
  return transform_from_quaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
}

std::vector<Transform> read_poses(const std::string& path) {
  std::ifstream file = opened(path);
  std::vector<Transform> poses;
  bool may_be_header = true;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (number == 1 && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
    const std::string_view row = trimmed(line);
    if (row.empty() || row.starts_with('#')) continue;
    if (std::exchange(may_be_header, false) && is_header(row)) continue;
    poses.push_back(value_or_bad_input(parsed_pose(row), fmt::format("{}: line {}: ", path, number)));
  }
  if (file.bad()) throw BadInput(fmt::format("{}: {}", path, std::strerror(errno)));
  if (poses.empty()) throw BadInput(path + ": has no pose");
  return poses;
}

}  // namespace limber::program
