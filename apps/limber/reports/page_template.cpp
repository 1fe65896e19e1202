// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_template.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "command/text.h"
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

std::string filled_page(Json data, const std::string& command_line) {
  constexpr std::string_view placeholder = "\"data of the page\"";
  const std::size_t at = viewer_template.find(placeholder);
  if (at == std::string_view::npos) throw std::logic_error("the viewer has no place for its data");
  data["version"] = LIMBER_VERSION;
  data["command"] = command_line;
  std::string filled(viewer_template.substr(0, at));
  for (const char c : to_line(data)) {
    if (c == '<') {
      filled += "\\u003c";  // no name of a file ends the script that the data stands in
    } else {
      filled += c;
    }
  }
  return filled.append(viewer_template.substr(at + placeholder.size()));
}

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
