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
#include <istream>
#include <system_error>
#include <utility>

#include "bad_input.h"
#include "number_text.h"

namespace limber::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t pose_length = 7;

/// A field as it may appear in a message: short and printable.
std::string shown(std::string_view field) {
  constexpr std::size_t longest = 30;
  std::string text(field.substr(0, longest));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text + (field.size() > longest ? "..." : "");
}

/// Whether every field is a name rather than a number.
bool is_header(std::string_view row) {
  const std::vector<std::string_view> fields = fields_of(row, ',');
  return std::none_of(fields.begin(), fields.end(), [](std::string_view field) {
    return field.empty() || std::string_view("+-.0123456789").find(field[0]) != std::string_view::npos ||
           parsed_number(field);
  });
}

Error malformed(std::size_t line, const std::string& reason) {
  return {ErrorCode::malformed_file, fmt::format("line {}: {}", line, reason), line};
}

/// Opens a regular file. A pipe or device might never end.
std::ifstream open_regular_file(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (fs::is_directory(status)) throw BadInput(path + ": is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) throw BadInput(path + ": is not a regular file");
  std::ifstream file(path, std::ios::binary);
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
    if (!number) return Error{ErrorCode::malformed_file, fmt::format("'{}' is not a number", shown(fields[i])), i};
    n[i] = *number;
  }
  return transform_from_quaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
}

Result<std::vector<Transform>> parsed_poses(std::istream& rows) {
  std::vector<Transform> poses;
  std::vector<char> buffer(max_pose_line_bytes + 1);
  std::uint64_t byte_count = 0;
  bool may_be_header = true;
  std::size_t number = 1;
  for (; rows.getline(buffer.data(), static_cast<std::streamsize>(buffer.size())); ++number) {
    const auto taken = static_cast<std::size_t>(rows.gcount());  // with the line's end, unless the file ends without
    byte_count += taken;
    if (byte_count > max_pose_file_bytes) return malformed(number, "the file is too long");
    std::string_view line(buffer.data(), rows.eof() ? taken : taken - 1);
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (number == 1 && line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    const std::string_view row = trimmed(line);
    if (row.empty() || row.starts_with('#')) continue;
    if (row.find(';') != std::string_view::npos) {
      return malformed(number, fmt::format("fields are separated by commas, as in {}, not by semicolons", pose_format));
    }
    if (std::exchange(may_be_header, false) && is_header(row)) continue;
    const Result<Transform> pose = parsed_pose(row);
    if (!pose) return malformed(number, pose.error().text);
    poses.push_back(*pose);
  }
  if (rows.bad()) return Error{ErrorCode::unreadable_file, "cannot be read to its end", {}};
  if (rows.gcount() == static_cast<std::streamsize>(max_pose_line_bytes)) {
    return malformed(number, fmt::format("is longer than {} bytes", max_pose_line_bytes));
  }
  if (poses.empty()) return Error{ErrorCode::malformed_file, "has no pose", {}};
  return poses;
}

std::vector<Transform> read_poses(const std::string& path) {
  std::ifstream file = open_regular_file(path);
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (!failed && size > max_pose_file_bytes) {
    throw BadInput(
        fmt::format("{}: has {} bytes, more than the limit of {} for poses", path, size, max_pose_file_bytes));
  }
  return value_or_bad_input(parsed_poses(file), path + ": ");
}

}  // namespace limber::program
