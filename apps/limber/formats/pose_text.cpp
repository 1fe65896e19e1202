// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/pose_text.h"

#include <fmt/format.h>

#include <optional>

#include "command/text.h"
#include "formats/csv.h"

namespace limber::program {
namespace {

/// The header of a file of poses, which names all of their columns.
CsvColumns pose_columns(const CsvFile& file, const CsvRow& header) {
  CsvColumns columns(file, header, pose_numbers);
  for (const std::string_view name : pose_numbers) {
    if (columns.has(name)) continue;
    throw file.error(header.line, fmt::format("there is no column {}; poses are {}", name, pose_format));
  }
  return columns;
}

/// The numbers of a row as one text.
std::string numbers_of(const CsvFile& file, const CsvRow& row, const std::optional<CsvColumns>& columns) {
  if (!columns) return fmt::format("{}", fmt::join(row.fields, ","));
  columns->check(file, row);
  std::array<std::string_view, pose_numbers.size()> fields;
  for (std::size_t i = 0; i < fields.size(); ++i) fields[i] = columns->field(row, pose_numbers[i]);
  return fmt::format("{}", fmt::join(fields, ","));
}

}  // namespace

Result<Transform> parsed_pose(std::string_view text) {
  const std::vector<std::string_view> fields = fields_of(text, ',');
  std::array<double, pose_numbers.size()> numbers{};
  if (fields.size() != numbers.size()) {
    return Error{ErrorCode::size_mismatch,
                 fmt::format("a pose is {} numbers {}, not {}", numbers.size(), pose_format, fields.size()),
                 {}};
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = parsed_number(fields[i]);
    if (!number) {
      return Error{ErrorCode::malformed_file,
                   fmt::format("{}: '{}' is not a number", pose_numbers[i], shown(fields[i])), i};
    }
    numbers[i] = *number;
  }
  return pose_of(numbers);
}

Result<Transform> pose_of(const std::array<double, 7>& numbers) {
  const auto& n = numbers;
  return transform_from_quaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
}

std::vector<Transform> read_poses(const std::string& path) {
  CsvFile file(path);
  std::vector<Transform> poses;
  std::optional<CsvColumns> columns;
  while (const std::optional<CsvRow> row = file.next()) {
    if (poses.empty() && !columns && is_header(*row)) {
      columns = pose_columns(file, *row);
      continue;
    }
    const Result<Transform> pose = parsed_pose(numbers_of(file, *row, columns));
    if (!pose) throw file.error(row->line, pose.error().text);
    poses.push_back(*pose);
  }
  if (poses.empty()) throw BadInput(path + ": has no pose");
  return poses;
}

}  // namespace limber::program
