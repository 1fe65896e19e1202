// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/pairs_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "command/text.h"
#include "formats/csv.h"
#include "formats/pose_text.h"

namespace limber::program {
namespace {

constexpr std::array<std::string_view, 16> known_columns = {
    "model_a", "pose_a_tx", "pose_a_ty", "pose_a_tz", "pose_a_qw", "pose_a_qx", "pose_a_qy", "pose_a_qz",
    "model_b", "pose_b_tx", "pose_b_ty", "pose_b_tz", "pose_b_qw", "pose_b_qx", "pose_b_qy", "pose_b_qz"};
constexpr std::array<double, 7> identity = {0, 0, 0, 1, 0, 0, 0};

/// The rows of a file, while it is read.
class PairReader {
 public:
  explicit PairReader(const std::string& path) : file_(path), columns_(columns_of(path)) {}

  std::vector<PairRow> rows() {
    std::vector<PairRow> rows;
    while (const std::optional<CsvRow> row = file_.next()) {
      columns_.check(file_, *row);
      rows.push_back(
          {model(*row, "model_a"), model(*row, "model_b"), pose(*row, "pose_a_"), pose(*row, "pose_b_"), row->line});
    }
    return rows;
  }

 private:
  CsvColumns columns_of(const std::string& path) {
    const std::optional<CsvRow> header = file_.next();
    if (!header) throw BadInput(path + ": is empty");
    CsvColumns columns(file_, *header, known_columns);
    for (const char* const name : {"model_a", "model_b"}) {
      if (columns.has(name)) continue;
      throw file_.error(header->line,
                        fmt::format("there is no column {}; the first row names the columns: model_a,model_b", name));
    }
    return columns;
  }

  [[noreturn]] void refuse(const CsvRow& row, const std::string& column, const std::string& reason) const {
    throw file_.error(row.line, fmt::format("column {}: {}", column, reason));
  }

  std::string model(const CsvRow& row, const std::string& column) const {
    const std::string_view name = columns_.field(row, column);
    if (name.empty()) refuse(row, column, "is empty");
    return std::string(name);
  }

  Transform pose(const CsvRow& row, const std::string& prefix) const {
    std::array<double, 7> numbers = identity;
    std::array<bool, 7> is_given{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::string column = prefix + std::string(pose_numbers[i]);
      const std::string_view field = columns_.field(row, column);
      is_given[i] = !field.empty();
      if (!is_given[i]) continue;
      const std::optional<double> number = parsed_number(field);
      if (!number) refuse(row, column, fmt::format("'{}' is not a number", shown(field)));
      numbers[i] = *number;
    }
    const auto missing = std::find(is_given.begin() + 3, is_given.end(), false);
    const bool is_part =
        missing != is_given.end() && std::find(is_given.begin() + 3, is_given.end(), true) != is_given.end();
    if (is_part) {
      const auto i = static_cast<std::size_t>(missing - is_given.begin());
      refuse(row, prefix + std::string(pose_numbers[i]), "is empty, but a quaternion has four numbers");
    }
    const Result<Transform> pose = pose_of(numbers);
    if (!pose) refuse(row, prefix + "tx to " + prefix + "qz", pose.error().text);
    return *pose;
  }

  CsvFile file_;
  CsvColumns columns_;
};

}  // namespace

std::vector<PairRow> read_pairs(const std::string& path) {
  std::vector<PairRow> rows = PairReader(path).rows();
  if (rows.empty()) throw BadInput(path + ": has no pair");
  return rows;
}

}  // namespace limber::program
