// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "limber/distance.h"

/// All output of the program goes through these functions.
namespace limber::program {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

/// Thrown when an answer cannot be written. The text is empty when the reader is gone: then nobody needs it.
class OutputFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes to standard output. Errors: OutputFailed.
void write(std::string_view text);

/// The same, formatted and with a line end.
template <typename... Args>
void write_line(fmt::format_string<Args...> format, Args&&... args) {
  write(fmt::vformat(fmt::string_view(format), fmt::make_format_args(args...)) + '\n');
}

/// Hands over what has been written so far. Errors: OutputFailed.
void flush();

/// The name of standard output among the outputs of a run.
inline constexpr const char* standard_output = "/dev/stdout";

/// Refuses to write where it would destroy something: `path` must not be one of the files that the run reads or writes
/// besides, under whatever name.
///
/// Errors   BadInput naming the option and the file.
void check_output(const std::string& option, const std::string& path, const Names& inputs, const Names& other_outputs);

/// The file that an option names, or standard output where it names "-".
class OutputFile {
 public:
  /// Opens and empties the file, after check_output().
  ///
  /// Errors   BadInput as check_output(), and where the file cannot be written.
  OutputFile(const std::string& option, const std::string& path, const Names& inputs, const Names& other_outputs);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  bool is_terminal() const;

  /// Writes and hands over. Errors: OutputFailed.
  void write(std::string_view text);

 private:
  std::FILE* stream_ = nullptr;
};

/// One line on standard error about an answer that may not mean what it seems to.
void warn(const std::string& verb, const std::string& text);

/// One line of JSON, all numbers in the fewest digits that read back as the same float64.
///
/// Pre      All numbers are finite.
std::string to_line(const Json& json);

Json to_json(const Vec3& point);
/// Null without a value.
template <typename T>
Json to_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}
const char* to_text(Status status);

/// The text without line ends or other control characters, so that it stays on one line.
std::string on_one_line(std::string_view text);

}  // namespace limber::program
