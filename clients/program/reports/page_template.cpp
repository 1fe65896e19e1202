// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_template.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <stdexcept>

#include "command/text.h"

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

}  // namespace

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
    : arguments_(arguments), file_(option_name, checked(arguments.path)) {}

void ReportFile::write(Json data) {
  constexpr std::string_view placeholder = "\"data of the page\"";
  const std::size_t at = viewer_template.find(placeholder);
  if (at == std::string_view::npos) throw std::logic_error("the viewer has no place for its data");
  data.update({{"title", arguments_.title},
               {"unit", arguments_.unit},
               {"format", page_format},
               {"version", LIMBER_VERSION},
               {"made_at", time_of_day()},
               {"command", arguments_.command_line}});
  std::string filled(viewer_template.substr(0, at));
  for (const char c : to_line(data)) {
    if (c == '<') {
      filled += "\\u003c";  // no name of a file ends the script that the data stands in
    } else {
      filled += c;
    }
  }
  file_.write(filled.append(viewer_template.substr(at + placeholder.size())));
}

}  // namespace limber::program
