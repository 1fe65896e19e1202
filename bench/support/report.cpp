// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/support/report.h"

#include <CLI/CLI.hpp>
#include <system_error>
#include <thread>

namespace limber::bench {
namespace {

#if defined(__clang__)
constexpr const char* compiler = "Clang " __clang_version__;
#else
constexpr const char* compiler = "GCC " __VERSION__;
#endif

#if defined(LIMBER_CHECKS)
constexpr bool has_checks = true;
#else
constexpr bool has_checks = false;
#endif

/// A value from the first processor's entry in /proc/cpuinfo, where there is such a file.
std::string processor_info(const std::string& key) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, key.size(), key) != 0) continue;
    if (line.find_first_not_of(" \t", key.size()) != colon) continue;
    const std::size_t value = line.find_first_not_of(' ', colon + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "unknown";
}

}  // namespace

ParsedOptions parse_options(int argc, const char* const* argv, const std::string& question) {
  ParsedOptions parsed;
  std::string out;
  CLI::App app(question);
  app.add_option("--out", out, "Folder to write the tables to; made when missing");
  app.add_flag("--quick", parsed.options.quick, "A few rounds only, to see that all works");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exit_code = app.exit(error) == 0 ? 0 : 2;  // 0: help was asked for and given
    return parsed;
  }
  parsed.options.out = out;
  if (out.empty()) return parsed;
  std::error_code failure;
  std::filesystem::create_directories(parsed.options.out, failure);
  if (failure || !std::filesystem::is_directory(parsed.options.out)) {
    fmt::print(stderr, "cannot make the folder '{}'\n", out);
    parsed.exit_code = 2;
  }
  return parsed;
}

CsvFile::CsvFile(const Options& options, const std::string& name, const std::string& header) {
  if (options.out.empty()) return;
  file_.open(options.out / name);
  if (!file_) throw std::runtime_error("cannot write '" + (options.out / name).string() + "'");
  file_ << header << '\n';
}

void report_machine(const Options& options) {
  if (has_checks) fmt::print(stderr, "This build checks itself while it is timed: the times mean nothing.\n");
  if (options.out.empty()) return;
  std::ofstream file(options.out / "machine.txt");
  file << fmt::format("processor  {}, family {}, model {}\n", processor_info("model name"),
                      processor_info("cpu family"), processor_info("model"));
  file << fmt::format("cores      {} visible, 1 used\n", std::thread::hardware_concurrency());
  file << fmt::format("compiler   {}\n", compiler);
  file << fmt::format("flags      {}\n", LIMBER_BENCH_FLAGS);
  if (has_checks) file << "checks     on: the times mean nothing\n";
}

}  // namespace limber::bench
