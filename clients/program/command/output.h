// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "limber/distance.h"

/// All output of the program goes through these functions, that to files through OutputFile of run_files.h.
namespace limber::program {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

/// Thrown when an answer cannot be written. The text is empty when the reader is gone: then nobody needs it.
class OutputFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws OutputFailed about what has that name; `reason` is an errno.
[[noreturn]] void fail_to_write(const std::string& name, int reason);

/// Writes to standard output. Errors: OutputFailed.
void write(std::string_view text);

/// Writes a formatted line to standard output, with its line end. Errors: OutputFailed.
template <typename... Args>
void write_line(fmt::format_string<Args...> format, Args&&... args) {
  write(fmt::vformat(fmt::string_view(format), fmt::make_format_args(args...)) + '\n');
}

/// Hands over what has been written so far. Errors: OutputFailed.
void flush();

/// To be called before anything is written: every system then writes the same bytes, and a write fails, instead of a
/// signal ending the program, when the reader is gone or a file as large as it may be.
void prepare_streams();

/// Wall time since it was made.
class Stopwatch {
 public:
  double seconds() const { return 1e-6 * microseconds(); }
  double microseconds() const { return std::chrono::duration<double, std::micro>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// A sum of times without the digits that adding them up has left behind the nanoseconds.
inline double rounded_us(double microseconds) { return std::round(microseconds * 1e3) / 1e3; }

/// One line on standard error about an answer that may not mean what it seems to.
void warn(const std::string& verb, const std::string& text);

/// One line of JSON, all numbers in the fewest digits that read back as the same float64.
///
/// Pre      All numbers are finite.
std::string to_line(const Json& json);

/// The columns of CSV, which are the fields of JSON objects. An object in an object has its name before those of its
/// columns, but for witness, pair and closest; an array of three numbers is three columns.
class AnswerColumns {
 public:
  /// `sample` has all fields that there may be. Those that are null are one column each.
  explicit AnswerColumns(Json sample);

  std::string header() const;  ///< a line of CSV
  std::string help() const;    ///< the names, with a space after each comma

  /// An object as a line of CSV. What it lacks, or is null, leaves cells empty.
  std::string line(const Json& object) const;

 private:
  Json sample_;
  std::vector<std::string> names_;
};

Json to_json(const Vec3& point);
/// Null without a value.
template <typename T>
Json to_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}
const char* to_text(DistanceStatus status);

/// The text without line ends or other control characters, so that it stays on one line.
std::string on_one_line(std::string_view text);

}  // namespace limber::program
