// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "command/text.h"

namespace limber::program {
namespace {

namespace fs = std::filesystem;

std::ifstream open_regular_file(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (fs::is_directory(status)) throw BadInput(path + ": is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) throw BadInput(path + ": is not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw BadInput(fmt::format("{}: {}", path, std::strerror(errno)));
  const std::uintmax_t size = fs::file_size(path, failed);
  if (!failed && size > max_csv_file_bytes) {
    throw BadInput(fmt::format("{}: has {} bytes, more than the limit of {}", path, size, max_csv_file_bytes));
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

/// The fields of a line that is not blank, or what is wrong with it.
Result<std::vector<std::string>> fields_of_line(std::string_view rest) {
  const auto malformed = [](std::string reason) { return Error{ErrorCode::malformed_file, std::move(reason), {}}; };
  std::vector<std::string> fields;
  while (true) {
    rest = trimmed(rest);
    if (rest.starts_with('"')) {
      const std::optional<std::string> field = take_quoted(rest);
      if (!field) return malformed("a quote is not closed");
      if (!rest.empty() && rest.front() != ',') return malformed("no comma follows a field in quotes");
      fields.push_back(*field);
    } else {
      const std::string_view field = trimmed(rest.substr(0, rest.find(',')));
      if (field.find(';') != std::string_view::npos) {
        return malformed("fields are separated by commas, not by semicolons, and numbers have a decimal point");
      }
      fields.emplace_back(field);
      rest.remove_prefix(std::min(rest.find(','), rest.size()));
    }
    if (rest.empty()) return fields;
    rest.remove_prefix(1);
  }
}

}  // namespace

CsvFile::CsvFile(std::string path)
    : path_(std::move(path)), file_(open_regular_file(path_)), buffer_(max_csv_line_bytes + 1) {}

BadInput CsvFile::error(std::size_t line, const std::string& reason) const {
  return BadInput(fmt::format("{}: line {}: {}", path_, line, reason));
}

std::optional<CsvRow> CsvFile::next() {
  while (file_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()))) {
    ++line_;
    const auto taken = static_cast<std::size_t>(file_.gcount());  // with the line's end, unless the file ends without
    byte_count_ += taken;
    if (byte_count_ > max_csv_file_bytes) throw error(line_, "the file is too long");
    std::string_view line(buffer_.data(), file_.eof() ? taken : taken - 1);
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (line_ == 1 && line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    line = trimmed(line);
    if (line.empty() || line.starts_with('#')) continue;
    Result<std::vector<std::string>> fields = fields_of_line(line);
    if (!fields) throw error(line_, fields.error().text);
    return CsvRow{line_, std::move(fields).value()};
  }
  if (file_.bad()) throw BadInput(path_ + ": cannot be read to its end");
  if (file_.gcount() == static_cast<std::streamsize>(max_csv_line_bytes)) {
    throw error(line_ + 1, fmt::format("is longer than {} bytes", max_csv_line_bytes));
  }
  return std::nullopt;
}

bool is_header(const CsvRow& row) {
  return std::none_of(row.fields.begin(), row.fields.end(), [](const std::string& field) {
    return field.empty() || std::string_view("+-.0123456789").find(field[0]) != std::string_view::npos ||
           parsed_number(field);
  });
}

CsvColumns::CsvColumns(const CsvFile& file, const CsvRow& header, std::span<const std::string_view> known)
    : names_(header.fields) {
  for (const std::string& name : names_) {
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      if (std::count(names_.begin(), names_.end(), name) == 1) continue;
      throw file.error(header.line, fmt::format("column {} comes twice", name));
    }
    std::vector<std::string> missing;
    for (const std::string_view other : known) {
      if (!has(other)) missing.emplace_back(other);
    }
    const std::optional<std::string> meant = nearest(name, missing);
    if (!meant) continue;
    throw file.error(header.line, fmt::format("no column is called '{}'; did you mean {}?", shown(name), *meant));
  }
}

std::optional<std::size_t> CsvColumns::find(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

std::string_view CsvColumns::field(const CsvRow& row, std::string_view name) const {
  const std::optional<std::size_t> column = find(name);
  return column ? std::string_view(row.fields[*column]) : std::string_view{};
}

void CsvColumns::check(const CsvFile& file, const CsvRow& row) const {
  if (row.fields.size() == names_.size()) return;
  throw file.error(row.line, fmt::format("has {} fields, but the header has {}", row.fields.size(), names_.size()));
}

std::string csv_field(std::string_view text) {
  const bool is_plain = text.find_first_of(",;\"\r\n#") == std::string_view::npos && trimmed(text) == text;
  if (is_plain) return std::string(text);
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

}  // namespace limber::program
