// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "command/output.h"
#include "command/run_files.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The page with a view in 3D, which is built from clients/pages into clients/program/pages and is part of the program.
namespace limber::program {

extern const std::string_view viewer_template;

/// What the data consist of. The page says which it reads, in clients/pages/build.mjs; both are raised when what
/// clients/pages/viewer/data.ts names changes.
inline constexpr int page_format = 3;

/// `--report`: where to, and what the page says about itself and its making.
struct ReportArguments {
  std::string path;  ///< empty: no report is asked for
  std::string title, unit;
  std::string command_line;
};

/// `--report`, `--title`, `--unit`. Returns the first.
CLI::Option* add_report(CLI::App& command, ReportArguments& arguments, const std::string& description);

/// The file of a report. It is opened before the models are asked, so that a path that cannot be written is told at
/// once. The page has its data in place: answers in rows, as Study and Replay give them, with the program's version,
/// the time and the command line.
class ReportFile {
 public:
  /// Errors   BadInput as OutputFile, and where the path is "-".
  explicit ReportFile(const ReportArguments& arguments);

  /// Errors   OutputFailed. Pre: all numbers are finite.
  void write(Json data);

 private:
  ReportArguments arguments_;
  OutputFile file_;
};

}  // namespace limber::program
