// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
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

/// A bar on standard error that shows how many of something are done, if that is a terminal; otherwise silent.
class ProgressBar {
 public:
  /// `unit` is their name in the plural.
  ProgressBar(std::size_t count, const char* unit);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Removes the bar, so that a line can be written in its place.
  void clear();

  /// Draws the bar unless it was drawn a moment ago and still stands.
  void draw(std::size_t done);

 private:
  std::size_t count_;
  const char* unit_;
  bool is_shown_;  // whether there is a terminal
  bool stands_ = false;
  Stopwatch since_drawn_;
};

/// Writes to standard error at once, whether or not somebody reads it.
void show(const std::string& text);

/// One line on standard error about an answer that may not mean what it seems to.
void warn(const std::string& verb, const std::string& text);

/// One line of JSON, all numbers in the fewest digits that read back as the same float64.
///
/// Pre      All numbers are finite.
std::string to_line(const Json& json);

/// A JSON object as a line of CSV: all values in their order, those of arrays and objects too. Null leaves cells empty:
/// as many as a `witness`, `pair`, `touch` or `closest` has, or one.
std::string csv_line(const Json& json);

/// Names between commas, with a space after each comma.
std::string spaced(const std::string& columns);

Json to_json(const Vec3& point);
/// Null without a value.
template <typename T>
Json to_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}
inline constexpr std::array<std::pair<DistanceStatus, const char*>, 5> status_words = {
    {{DistanceStatus::exact, "exact"},
     {DistanceStatus::within_error, "within_error"},
     {DistanceStatus::collision, "collision"},
     {DistanceStatus::beyond_limit, "beyond_limit"},
     {DistanceStatus::interrupted, "interrupted"}}};
const char* to_text(DistanceStatus status);

/// The text without line ends or other control characters, so that it stays on one line.
std::string on_one_line(std::string_view text);

}  // namespace limber::program
