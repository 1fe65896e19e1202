// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/points_csv.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "command/text.h"
#include "formats/csv.h"

namespace limber::program {
namespace {

constexpr std::array<std::string_view, 3> axes = {"x", "y", "z"};

CsvColumns point_columns(const CsvFile& file, const CsvRow& header) {
  CsvColumns columns(file, header, axes);
  for (const std::string_view axis : axes) {
    if (!columns.has(axis)) throw file.error(header.line, fmt::format("there is no column {}", axis));
  }
  return columns;
}

Vec3 point_of(const CsvFile& file, const CsvRow& row, const std::optional<CsvColumns>& columns) {
  if (columns) {
    columns->check(file, row);
  } else if (row.fields.size() != axes.size()) {
    throw file.error(row.line, fmt::format("a point is 3 numbers x,y,z, not {}", row.fields.size()));
  }
  Vec3 point;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::string_view field = columns ? columns->field(row, axes[k]) : std::string_view(row.fields[k]);
    const std::optional<double> number = parsed_number(field);
    if (!number) throw file.error(row.line, fmt::format("column {}: '{}' is not a number", axes[k], shown(field)));
    if (!(std::abs(*number) <= max_coordinate)) {
      throw file.error(row.line,
                       fmt::format("column {}: '{}' is not a number of at most 2^200", axes[k], shown(field)));
    }
    point[k] = *number;
  }
  return point;
}

}  // namespace

std::vector<Vec3> read_points(const std::string& path) {
  CsvFile file(path);
  std::vector<Vec3> points;
  std::optional<CsvColumns> columns;
  while (const std::optional<CsvRow> row = file.next()) {
    if (points.empty() && !columns && is_header(*row)) {
      columns = point_columns(file, *row);
      continue;
    }
    points.push_back(point_of(file, *row, columns));
  }
  if (points.empty()) throw BadInput(path + ": has no point");
  return points;
}

}  // namespace limber::program
