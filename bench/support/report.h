// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

/// The command line, the checks and the output of all benchmarks.
namespace limber::bench {

struct Options {
  std::filesystem::path out;  ///< folder for results; empty: only the console
  bool quick = false;         ///< few rounds: shows that everything works, not how fast
};

/// The options, or the exit code when the program has to end.
///
/// Errors   A folder that cannot be made, and mistakes in the command line, are reported on the console.
struct ParsedOptions {
  Options options;
  std::optional<int> exit_code;
};
ParsedOptions parse_options(int argc, const char* const* argv, const std::string& question);

/// Counts and prints wrong answers. A benchmark that has any prints no times and ends with exit code 1.
class Checker {
 public:
  template <typename... Args>
  bool check(bool right, fmt::format_string<Args...> what_is_wrong, Args&&... args) {
    if (!right) {
      ++wrong_;
      fmt::print(stderr, "WRONG: {}\n", fmt::format(what_is_wrong, std::forward<Args>(args)...));
    }
    return right;
  }
  bool all_right() const { return wrong_ == 0; }

 private:
  int wrong_ = 0;
};

/// A table as comma-separated values; writes nothing when there is no folder to write to.
class CsvFile {
 public:
  CsvFile(const Options& options, const std::string& name, const std::string& header);

  template <typename... Args>
  void row(fmt::format_string<Args...> format, Args&&... args) {
    if (file_.is_open()) file_ << fmt::format(format, std::forward<Args>(args)...) << '\n';
  }

 private:
  std::ofstream file_;
};

/// Lines of Markdown to the console and, if there is a folder for results, into a file.
class Markdown {
 public:
  Markdown(const Options& options, const std::string& name) {
    if (!options.out.empty()) file_.open(options.out / name);
  }
  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    const std::string text = fmt::format(format, std::forward<Args>(args)...);
    fmt::print("{}\n", text);
    std::fflush(stdout);
    if (file_.is_open()) file_ << text << '\n';
  }

 private:
  std::ofstream file_;
};

/// Processor, compiler and flags into `machine.txt`; warns on the console when the build checks itself while timed.
void report_machine(const Options& options);

}  // namespace limber::bench
