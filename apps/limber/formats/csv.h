// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "command/bad_input.h"

/// Files of comma-separated values, as spreadsheets and Python write them.
///
/// Blank lines and those that start with # are skipped, a byte order mark and carriage returns too. Fields are trimmed.
/// A field may stand in double quotes, with "" for a quote; it cannot span lines. Numbers have a decimal point.
namespace limber::program {

/// What a file may ask for, in bytes.
inline constexpr std::uint64_t max_csv_file_bytes = std::uint64_t{1} << 28U;
inline constexpr std::size_t max_csv_line_bytes = std::size_t{1} << 14U;

struct CsvRow {
  std::size_t line = 0;  ///< where it stands in the file, counted from 1
  std::vector<std::string> fields;
};

/// Reads a file row by row; one line of it is in memory at a time.
///
/// Errors   BadInput naming the file and, where there is one, the line. Pipes and devices, which might never end, are
///          refused.
class CsvFile {
 public:
  explicit CsvFile(std::string path);

  std::optional<CsvRow> next();

  /// What is wrong with a line, to be thrown.
  BadInput error(std::size_t line, const std::string& reason) const;

 private:
  std::string path_;
  std::ifstream file_;
  std::vector<char> buffer_;
  std::size_t line_ = 0;
  std::uint64_t byte_count_ = 0;
};

/// Whether every field is a name rather than a number.
bool is_header(const CsvRow& row);

/// The columns that a header names, in any order. Columns of other names are left alone.
class CsvColumns {
 public:
  /// Errors   BadInput where a known name comes twice, or a name looks like a known one mistyped.
  CsvColumns(const CsvFile& file, const CsvRow& header, std::span<const std::string_view> known);

  bool has(std::string_view name) const { return find(name).has_value(); }

  /// The field of a row, or an empty text where there is no such column.
  std::string_view field(const CsvRow& row, std::string_view name) const;

  /// Errors   BadInput unless a row has as many fields as the header.
  void check(const CsvFile& file, const CsvRow& row) const;

 private:
  std::optional<std::size_t> find(std::string_view name) const;

  std::vector<std::string> names_;
};

/// A text as one field: in quotes where it must be.
std::string csv_field(std::string_view text);

}  // namespace limber::program
