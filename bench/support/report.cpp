// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/support/report.h"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <stdexcept>

namespace limber::bench {
namespace {

int exit_code_of(int argc, const char* const* argv, const std::string& question,
                 const std::function<void(const Options&, Checker&)>& run,
                 const std::function<void(CLI::App&)>& add_options) {
  Options options;
  CLI::App app(question);
  app.add_option("--out", options.out, "Folder to write the tables to; made when missing");
  app.add_option("--meshes", options.meshes, "Folder with mesh files; without it, generated scenes only");
  app.add_flag("--quick", options.quick, "A few rounds only, to see that all works");
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
    if (!options.out.empty()) std::filesystem::create_directories(options.out);
#if defined(LIMBER_CHECKS)
    fmt::print(stderr, "This build checks itself while it is timed: the times mean nothing.\n");
#endif
    Checker checker;
    run(options, checker);
    return checker.all_right() ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // 0: help was asked for and given
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}

}  // namespace

Table::Table(const Options& options, const std::string& name) {
  if (options.out.empty()) return;
  file_.open(options.out / name);
  if (!file_) throw std::runtime_error("cannot write '" + (options.out / name).string() + "'");
}

void Table::write(const std::string& text) {
  if (file_.is_open()) file_ << text << '\n';
  fmt::print("{}\n", text);
  std::fflush(stdout);
}

int run_bench(int argc, const char* const* argv, const std::string& question,
              const std::function<void(const Options&, Checker&)>& run,
              const std::function<void(CLI::App&)>& add_options) {
  const int code = exit_code_of(argc, argv, question, run, add_options);
  // FCL and Coal bring two versions of OctoMap, with global objects of one name, which both destroy at the end.
  std::fflush(nullptr);
  std::_Exit(code);
}

}  // namespace limber::bench
