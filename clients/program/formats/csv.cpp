// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
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

/// Where in a row the known columns are; the number of names where there is no such column.
std::vector<std::size_t> places_of(const CsvFormat& format, const std::vector<std::string>& names) {
  std::vector<std::size_t> places;
  std::vector<std::string> missing;
  for (const std::string& column : format.columns) {
    const auto found = std::find(names.begin(), names.end(), column);
    places.push_back(static_cast<std::size_t>(found - names.begin()));
    if (found == names.end()) missing.push_back(column);
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
    if (places[c] == names.size())
      throw BadInput(fmt::format("there is no column {}{}", format.columns[c], format.hint));
  }
  return places;
}

const std::vector<std::string> pose_columns = {"tx", "ty", "tz", "qw", "qx", "qy", "qz"};
constexpr std::size_t pose_size = 7;

Result<Transform> pose_of(const std::array<double, pose_size>& n) {
  return transform_from_quaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
}

double number_in(const std::string& field, std::string_view column) {
  const std::optional<double> number = parsed_number(field);
  if (!number) throw BadInput(fmt::format("column {}: '{}' is not a number", column, shown(field)));
  return *number;
}

/// The pose whose fields in a row start with `first`, as do their names in `all_columns`.
Transform pose_in(const std::vector<std::string>& fields, const std::vector<std::string>& all_columns,
                  std::size_t first) {
  std::array<double, pose_size> numbers = {0, 0, 0, 1, 0, 0, 0};
  const std::span own = std::span(fields).subspan(first, pose_size);
  const std::span columns = std::span(all_columns).subspan(first, pose_size);
  for (std::size_t i = 0; i < pose_size; ++i) {
    if (!own[i].empty()) numbers[i] = number_in(own[i], columns[i]);
  }
  const auto quaternion = own.subspan(3);
  const auto missing = std::find(quaternion.begin(), quaternion.end(), "");
  if (missing != quaternion.end() && std::count(quaternion.begin(), quaternion.end(), "") < 4) {
    throw BadInput(fmt::format("column {}: is empty, but a quaternion has four numbers",
                               columns[3 + static_cast<std::size_t>(missing - quaternion.begin())]));
  }
  return value_or_bad_input(pose_of(numbers), fmt::format("column {} to {}: ", columns.front(), columns.back()));
}

}  // namespace

void read_csv(const std::string& path, const CsvFormat& format, const CsvTaker& take) {
  CsvFile file(path);
  std::vector<std::string> names;   // of the header, or as the format has them
  std::vector<std::size_t> places;  // of the known columns among them
  bool is_named = false;
  std::size_t row_count = 0;
  while (const std::optional<std::string_view> line = file.next()) {
    try {
      const std::vector<std::string> fields = fields_of_line(*line);
      if (names.empty()) {
        is_named = format.has_header || is_header(fields);
        names = is_named ? fields : format.columns;
        places = places_of(format, names);
        if (is_named) continue;
      }
      if (fields.size() != names.size()) {
        throw BadInput(is_named ? fmt::format("has {} fields, but the header has {}", fields.size(), names.size())
                                : fmt::format("a {} is {} numbers {}, not {}", format.entry, names.size(),
                                              fmt::join(names, ","), fields.size()));
      }
      std::vector<std::string> ordered;
      ordered.reserve(places.size());
      for (const std::size_t place : places) ordered.push_back(place < fields.size() ? fields[place] : std::string());
      take(ordered, file.line_number());
      ++row_count;
    } catch (const BadInput& error) {
      throw file.error(file.line_number(), error.what());
    }
  }
  if (format.has_header && names.empty()) throw BadInput(path + ": is empty");
  if (row_count == 0) throw BadInput(fmt::format("{}: has no {}", path, format.entry));
}

Result<Transform> parsed_pose(std::string_view text) {
  const std::vector<std::string_view> fields = fields_of(text, ',');
  std::array<double, pose_size> numbers{};
  if (fields.size() != pose_size) {
    return Error{ErrorCode::size_mismatch,
                 fmt::format("a pose is {} numbers {}, not {}", pose_size, pose_format, fields.size()),
                 {}};
  }
  for (std::size_t i = 0; i < pose_size; ++i) {
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
  const CsvFormat format{"point", {"x", "y", "z"}};
  std::vector<Vec3> points;
  read_csv(path, format, [&](const std::vector<std::string>& fields, std::size_t) {
    Vec3& point = points.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = number_in(fields[k], format.columns[k]);
      if (std::abs(point[k]) <= max_coordinate) continue;
      throw BadInput(
          fmt::format("column {}: '{}' is not a number of at most 2^200", format.columns[k], shown(fields[k])));
    }
  });
  return points;
}

std::vector<ModelRow> read_models(const std::string& path, const std::vector<std::string>& suffixes) {
  const std::size_t count = suffixes.size();
  CsvFormat format{count > 1 ? "pair" : "part", {}, count, true};
  for (const std::string& suffix : suffixes) format.columns.push_back("model" + suffix);
  format.hint = fmt::format("; the first row names the columns: {}", fmt::join(format.columns, ","));
  for (const std::string& suffix : suffixes) {
    for (const std::string& column : pose_columns) format.columns.push_back(fmt::format("pose{}_{}", suffix, column));
  }
  if (count == 1) format.columns.emplace_back("name");
  std::vector<ModelRow> rows;
  read_csv(path, format, [&](const std::vector<std::string>& fields, std::size_t line) {
    for (std::size_t i = 0; i < count; ++i) {
      if (fields[i].empty()) throw BadInput(fmt::format("column {}: is empty", format.columns[i]));
      rows.push_back({format.columns[i], fields[i], count == 1 ? fields.back() : std::string(),
                      pose_in(fields, format.columns, count + pose_size * i), line});
    }
  });
  return rows;
}

}  // namespace limber::program
