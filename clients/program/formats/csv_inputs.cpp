// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/csv_inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "command/text.h"
#include "formats/csv.h"

namespace limber::program {
namespace {

constexpr std::array<std::string_view, 7> pose_columns = {"tx", "ty", "tz", "qw", "qx", "qy", "qz"};
constexpr std::array<std::string_view, 3> point_columns = {"x", "y", "z"};
constexpr std::array<std::string_view, 16> pair_columns = {
    "model_a",   "model_b",                                                                     //
    "pose_a_tx", "pose_a_ty", "pose_a_tz", "pose_a_qw", "pose_a_qx", "pose_a_qy", "pose_a_qz",  //
    "pose_b_tx", "pose_b_ty", "pose_b_tz", "pose_b_qw", "pose_b_qx", "pose_b_qy", "pose_b_qz"};
constexpr std::array<std::string_view, 9> part_columns = {"model",   "name",    "pose_tx", "pose_ty", "pose_tz",
                                                          "pose_qw", "pose_qx", "pose_qy", "pose_qz"};

Result<Transform> pose_of(const std::array<double, 7>& n) {
  return transform_from_quaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
}

double number_in(const std::string& field, std::string_view column) {
  const std::optional<double> number = parsed_number(field);
  if (!number) throw BadInput(fmt::format("column {}: '{}' is not a number", column, shown(field)));
  return *number;
}

/// The pose whose fields in a row start with `first`, as do their names in `all_columns`.
Transform pose_in(const std::vector<std::string>& fields, std::span<const std::string_view> all_columns,
                  std::size_t first) {
  std::array<double, 7> numbers = {0, 0, 0, 1, 0, 0, 0};
  const std::span own = std::span(fields).subspan(first, numbers.size());
  const std::span columns = all_columns.subspan(first, numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!own[i].empty()) numbers[i] = number_in(own[i], columns[i]);
  }
  const auto quaternion = own.subspan(3);
  const auto missing = std::find(quaternion.begin(), quaternion.end(), "");
  if (missing != quaternion.end() &&
      std::any_of(quaternion.begin(), quaternion.end(), [](const std::string& field) { return !field.empty(); })) {
    throw BadInput(fmt::format("column {}: is empty, but a quaternion has four numbers",
                               columns[3 + static_cast<std::size_t>(missing - quaternion.begin())]));
  }
  return value_or_bad_input(pose_of(numbers), fmt::format("column {} to {}: ", columns.front(), columns.back()));
}

}  // namespace

Result<Transform> parsed_pose(std::string_view text) {
  const std::vector<std::string_view> fields = fields_of(text, ',');
  std::array<double, pose_columns.size()> numbers{};
  if (fields.size() != numbers.size()) {
    return Error{ErrorCode::size_mismatch,
                 fmt::format("a pose is {} numbers {}, not {}", numbers.size(), pose_format, fields.size()),
                 {}};
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = parsed_number(fields[i]);
    if (!number) {
      return Error{ErrorCode::malformed_file,
                   fmt::format("{}: '{}' is not a number", pose_columns[i], shown(fields[i])), i};
    }
    numbers[i] = *number;
  }
  return pose_of(numbers);
}

std::vector<Transform> read_poses(const std::string& path) {
  CsvFormat format{"pose", pose_columns};
  format.hint = fmt::format("; poses are {}", pose_format);
  std::vector<Transform> poses;
  read_csv(path, format, [&](const std::vector<std::string>& fields, std::size_t) {
    poses.push_back(value_or_bad_input(parsed_pose(fmt::format("{}", fmt::join(fields, ",")))));
  });
  return poses;
}

std::vector<Vec3> read_points(const std::string& path) {
  std::vector<Vec3> points;
  read_csv(path, {"point", point_columns}, [&](const std::vector<std::string>& fields, std::size_t) {
    Vec3& point = points.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = number_in(fields[k], point_columns[k]);
      if (std::abs(point[k]) <= max_coordinate) continue;
      throw BadInput(
          fmt::format("column {}: '{}' is not a number of at most 2^200", point_columns[k], shown(fields[k])));
    }
  });
  return points;
}

std::vector<PairRow> read_pairs(const std::string& path) {
  const CsvFormat format{"pair", pair_columns, 2, true, "; the first row names the columns: model_a,model_b"};
  std::vector<PairRow> rows;
  read_csv(path, format, [&](const std::vector<std::string>& fields, std::size_t line) {
    for (const std::size_t c : {0U, 1U}) {
      if (fields[c].empty()) throw BadInput(fmt::format("column {}: is empty", pair_columns[c]));
    }
    rows.push_back({fields[0], fields[1], pose_in(fields, pair_columns, 2), pose_in(fields, pair_columns, 9), line});
  });
  return rows;
}

std::vector<PartRow> read_parts(const std::string& path) {
  const CsvFormat format{"part", part_columns, 1, true, "; the first row names the columns: model"};
  std::vector<PartRow> rows;
  read_csv(path, format, [&](const std::vector<std::string>& fields, std::size_t line) {
    if (fields[0].empty()) throw BadInput("column model: is empty");
    rows.push_back({fields[1], fields[0], pose_in(fields, part_columns, 2), line});
  });
  return rows;
}

}  // namespace limber::program
