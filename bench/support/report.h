// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

namespace CLI {
class App;
}

/// The command line, the checks and the output of all benchmarks.
namespace limber::bench {

struct Options {
  std::filesystem::path out;     ///< folder for results; empty: only the console
  std::filesystem::path meshes;  ///< folder with mesh files; empty: only generated scenes
  bool quick = false;            ///< few rounds: shows that everything works, not how fast
};

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

/// Lines to the console and, if there is a folder for results, to a file.
class Table {
 public:
  Table(const Options& options, const std::string& name);

  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    write(fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  void write(const std::string& text);

  std::ofstream file_;
};

/// The main function of a benchmark: reads the options, those that `add_options` knows too, and runs it. Ends the
/// program, without destructors of global objects. Its exit code is 1 for wrong answers, 2 for what was thrown or asked
/// wrongly.
int run_bench(int argc, const char* const* argv, const std::string& question,
              const std::function<void(const Options&, Checker&)>& run,
              const std::function<void(CLI::App&)>& add_options = {});

}  // namespace limber::bench
