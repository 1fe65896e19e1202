// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/report_file.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "command/bad_input.h"
#include "reports/page_template.h"
#include "verbs/models.h"

namespace limber::program {
namespace {

constexpr const char* option_name = "--report";

/// The path, if it names a file.
const std::string& checked(const std::string& path) {
  if (path == "-") throw BadInput(fmt::format("{}: must name a file", option_name));
  return path;
}

}  // namespace

CLI::Option* add_report(CLI::App& command, ReportArguments& arguments, const std::string& description) {
  return command.add_option(option_name, arguments.path, description)->type_name("FILE");
}

ReportFile::ReportFile(const ReportArguments& arguments, const Names& inputs)
    : command_line_(arguments.command_line), file_(option_name, checked(arguments.path), inputs, {standard_output}) {}

void ReportFile::write(Json data) { file_.write(filled_page(std::move(data), command_line_)); }

std::string shown_name(const std::string& argument) {
  return is_scene(argument) ? argument : std::filesystem::path(argument).filename().string();
}

}  // namespace limber::program
