// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "command/output.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// `--report`: an answer as one page to hand on.
namespace limber::program {

/// Where to, and what the page says about its making.
struct ReportArguments {
  std::string path;  ///< empty: no report is asked for
  std::string command_line;
};

CLI::Option* add_report(CLI::App& command, ReportArguments& arguments, const std::string& description);

/// The file of a report. It is opened before the models are asked, so that a path that cannot be written is told at
/// once.
class ReportFile {
 public:
  /// `inputs` are models and files as the user has named them.
  ///
  /// Errors   BadInput where the path is "-" or one of the inputs, or cannot be written.
  ReportFile(const ReportArguments& arguments, const Names& inputs);

  /// Fills the page and writes it.
  ///
  /// Errors   OutputFailed.
  void write(Json data);

 private:
  std::string command_line_;
  OutputFile file_;
};

/// A name of a model as a page shows it: without its folders.
std::string shown_name(const std::string& argument);

}  // namespace limber::program
