// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_template.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "answers/models.h"
#include "command/text.h"
#include "reports/sha256.h"

namespace limber::program {
namespace {

constexpr const char* option_name = "--report";

/// The path, if it names a file.
const std::string& checked(const std::string& path) {
  if (path == "-") throw BadInput(fmt::format("{}: must name a file", option_name));
  return path;
}

/// "2026-11-26 17:05 UTC"
std::string time_of_day() {
  const auto now = std::chrono::floor<std::chrono::minutes>(std::chrono::system_clock::now());
  const auto today = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(today);
  const std::chrono::hh_mm_ss time(now - today);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", int{date.year()}, unsigned{date.month()},
                     unsigned{date.day()}, time.hours().count(), time.minutes().count());
}

/// Name, size and digest of a file; nothing where it cannot be read a second time, as a pipe.
std::optional<Json> described(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << file.rdbuf())) return std::nullopt;
  const std::size_t byte_count = bytes.view().size();
  return Json{{"name", path}, {"bytes", byte_count}, {"sha256", sha256_of(std::move(bytes).str())}};
}

}  // namespace

std::string filled_page(Json data, const std::string& command_line) {
  constexpr std::string_view placeholder = "\"data of the page\"";
  const std::size_t at = viewer_template.find(placeholder);
  if (at == std::string_view::npos) throw std::logic_error("the viewer has no place for its data");
  data["format"] = page_format;
  data["version"] = LIMBER_VERSION;
  data["made_at"] = time_of_day();
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
  CLI::Option* const report = command.add_option(option_name, arguments.path, description)->type_name("FILE");
  command.add_option("--title", arguments.title, "with --report: the title of the page")
      ->type_name("TEXT")
      ->needs(report);
  command.add_option("--unit", arguments.unit, "with --report: the unit of lengths in the page, such as mm")
      ->type_name("NAME")
      ->needs(report);
  return report;
}

ReportFile::ReportFile(const ReportArguments& arguments)
    : arguments_(arguments), file_(option_name, checked(arguments.path)) {
  describe_inputs();
}

void ReportFile::describe_inputs() {
  for (const auto& [path, name] : inputs()) {
    if (!inputs_.contains(path)) inputs_.emplace(path, described(name));
  }
}

void ReportFile::write(Json data) {
  describe_inputs();
  data["title"] = arguments_.title;
  data["unit"] = arguments_.unit;
  Json& files = data["inputs"] = Json::array();
  for (const auto& input : inputs_) {
    if (input.second) files.push_back(*input.second);
  }
  file_.write(filled_page(std::move(data), arguments_.command_line));
}

std::string shown_name(const std::string& argument) {
  return is_scene(argument) ? argument : std::filesystem::path(argument).filename().string();
}

}  // namespace limber::program
