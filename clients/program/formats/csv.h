// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Files of comma-separated values, as spreadsheets and Python write them.
///
/// Blank lines and those that start with # are skipped, a byte order mark and carriage returns too. Fields are trimmed.
/// A field may stand in double quotes, with "" for a quote; it cannot span lines. Numbers have a decimal point. A first
/// row of names alone is a header: it names the columns, in any order, and others may stand between them, unless the
/// format is complete.
namespace limber::program {

struct CsvFormat {
  const char* entry;                            ///< what a row is: "pose"
  std::span<const std::string_view> columns;    ///< that are known
  std::size_t required_count = columns.size();  ///< so many of them must be there
  bool has_header = false;                      ///< whether there must be one; without it a row has numbers alone
  std::string hint = {};                        ///< added where a column is missing, or unknown
  bool is_complete = false;                     ///< whether other columns are errors
};

/// A row: the fields under the known columns, empty where there is no such column, and its line, counted from 1.
using CsvTaker = std::function<void(const std::vector<std::string>& fields, std::size_t line)>;

/// Reads a file row by row; one line of it is in memory at a time. What is wrong with a row, `take` throws as BadInput.
///
/// Errors   BadInput naming the file and, where there is one, the line: where the file has no row, a known column comes
///          twice or is misspelt, a complete format has another, or a row is too short or too long. Pipes and devices,
///          which might never end, are refused, and so are files of more than 2^28 bytes.
void read_csv(const std::string& path, const CsvFormat& format, const CsvTaker& take);

}  // namespace limber::program
