// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <utility>

#include "bench/support/report.h"

namespace limber::bench {

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

/// Warm starts, growth with the number of triangles, build times and memory.
void measure_more(const Options& options, const std::filesystem::path& meshes, Checker& checker, Markdown& table);

}  // namespace limber::bench
