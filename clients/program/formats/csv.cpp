// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "command/run_files.h"
#include "command/text.h"

namespace limber::program {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 28U;
constexpr std::size_t max_line_bytes = std::size_t{1} << 14U;

std::ifstream open_regular_file(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (fs::is_directory(status)) throw BadInput(path + ": is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) throw BadInput(path + ": is not a regular file");
  add_input(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw BadInput(fmt::format("{}: {}", path, std::strerror(errno)));
  const std::uintmax_t size = fs::file_size(path, failed);
  if (!failed && size > max_file_bytes) {
    throw BadInput(fmt::format("{}: has {} bytes, more than the limit of {}", path, size, max_file_bytes));
  }
  return file;
}

/// Takes a field in quotes, and blanks after it, from the start of `rest`. Empty: the quotes do not end.
std::optional<std::string> take_quoted(std::string_view& rest) {
  std::string field;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i] != '"') {
      field += rest[i];
    } else if (i + 1 < rest.size() && rest[i + 1] == '"') {
      field += rest[i++];
    } else {
      rest = trimmed(rest.substr(i + 1));
      return field;
    }
  }
  return std::nullopt;
}

/// The fields of a line that is not blank. Throws BadInput without the place.
std::vector<std::string> fields_of_line(std::string_view rest) {
  std::vector<std::string> fields;
  while (true) {
    rest = trimmed(rest);
    if (rest.starts_with('"')) {
      const std::optional<std::string> field = take_quoted(rest);
      if (!field) throw BadInput("a quote is not closed");
      if (!rest.empty() && rest.front() != ',') throw BadInput("no comma follows a field in quotes");
      fields.push_back(*field);
    } else {
      const std::string_view field = trimmed(rest.substr(0, rest.find(',')));
      if (field.find(';') != std::string_view::npos) {
        throw BadInput("fields are separated by commas, not by semicolons, and numbers have a decimal point");
      }
      fields.emplace_back(field);
      rest.remove_prefix(std::min(rest.find(','), rest.size()));
    }
    if (rest.empty()) return fields;
    rest.remove_prefix(1);
  }
}

/// The lines of a file that are not blank.
class CsvFile {
 public:
  explicit CsvFile(std::string path)
      : path_(std::move(path)), file_(open_regular_file(path_)), buffer_(max_line_bytes + 1) {}

  /// The number of the line that came last, counted from 1.
  std::size_t line_number() const { return line_; }

  /// An error that names the file and a line, to be thrown.
  BadInput error(std::size_t line, const std::string& reason) const {
    return BadInput(fmt::format("{}: line {}: {}", path_, line, reason));
  }

  /// Valid until the next call.
  std::optional<std::string_view> next() {
    while (file_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()))) {
      ++line_;
      const auto taken = static_cast<std::size_t>(file_.gcount());  // with the line's end, unless the file ends without
      byte_count_ += taken;
      if (byte_count_ > max_file_bytes) throw error(line_, "the file is too long");
      std::string_view line(buffer_.data(), file_.eof() ? taken : taken - 1);
      constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
      if (line_ == 1 && line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
      line = trimmed(line);
      if (!line.empty() && !line.starts_with('#')) return line;
    }
    if (file_.bad()) throw BadInput(path_ + ": cannot be read to its end");
    if (file_.gcount() == static_cast<std::streamsize>(max_line_bytes)) {
      throw error(line_ + 1, fmt::format("is longer than {} bytes", max_line_bytes));
    }
    return std::nullopt;
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::vector<char> buffer_;
  std::size_t line_ = 0;
  std::uint64_t byte_count_ = 0;
};

/// Whether every field is a name rather than a number.
bool is_header(const std::vector<std::string>& fields) {
  return std::none_of(fields.begin(), fields.end(), [](const std::string& field) {
    return field.empty() || std::string_view("+-.0123456789").find(field[0]) != std::string_view::npos ||
           parsed_number(field);
  });
}

/// Where in a row the known columns are.
class Columns {
 public:
  /// Without a header, in their own order.
  explicit Columns(const CsvFormat& format) : format_(format), count_(format.columns.size()) {
    for (std::size_t c = 0; c < count_; ++c) places_.emplace_back(c);
  }

  Columns(const CsvFormat& format, const std::vector<std::string>& names)
      : format_(format), count_(names.size()), is_named_(true) {
    std::vector<std::string> missing;
    for (const std::string_view column : format.columns) {
      const auto found = std::find(names.begin(), names.end(), column);
      places_.emplace_back(static_cast<std::size_t>(found - names.begin()));
      if (found == names.end()) missing.emplace_back(column);
      if (std::count(names.begin(), names.end(), column) > 1) {
        throw BadInput(fmt::format("column {} comes twice", column));
      }
    }
    for (const std::string& name : names) {
      const bool is_known = std::find(format.columns.begin(), format.columns.end(), name) != format.columns.end();
      if (is_known) continue;
      if (format.is_complete) throw BadInput(fmt::format("no column is called '{}'{}", shown(name), format.hint));
      std::optional<std::string> meant = nearest(name, missing);
      for (const std::string& column : missing) {
        if (!meant && column.ends_with("_" + name)) meant = column;  // tx for pose_tx
      }
      if (meant) throw BadInput(fmt::format("no column is called '{}'; did you mean {}?", shown(name), *meant));
    }
    for (std::size_t c = 0; c < format.required_count; ++c) {
      if (places_[c] == count_) throw BadInput(fmt::format("there is no column {}{}", format.columns[c], format.hint));
    }
  }

  std::vector<std::string> in_order(const std::vector<std::string>& fields) const {
    if (fields.size() != count_) {
      throw BadInput(is_named_ ? fmt::format("has {} fields, but the header has {}", fields.size(), count_)
                               : fmt::format("a {} is {} numbers {}, not {}", format_.entry, count_,
                                             fmt::join(format_.columns, ","), fields.size()));
    }
    std::vector<std::string> ordered;
    for (const std::size_t place : places_) ordered.push_back(place < count_ ? fields[place] : std::string());
    return ordered;
  }

 private:
  CsvFormat format_;
  std::size_t count_;  // of fields in a row
  bool is_named_ = false;
  std::vector<std::size_t> places_;  // by known column; `count_` where there is no such column
};

}  // namespace

void read_csv(const std::string& path, const CsvFormat& format, const CsvTaker& take) {
  CsvFile file(path);
  std::optional<Columns> columns;
  std::size_t row_count = 0;
  while (const std::optional<std::string_view> line = file.next()) {
    try {
      const std::vector<std::string> fields = fields_of_line(*line);
      if (!columns && (format.has_header || is_header(fields))) {
        columns.emplace(format, fields);
        continue;
      }
      if (!columns) columns.emplace(format);
      take(columns->in_order(fields), file.line_number());
      ++row_count;
    } catch (const BadInput& error) {
      throw file.error(file.line_number(), error.what());
    }
  }
  if (format.has_header && !columns) throw BadInput(path + ": is empty");
  if (row_count == 0) throw BadInput(fmt::format("{}: has no {}", path, format.entry));
}

}  // namespace limber::program
