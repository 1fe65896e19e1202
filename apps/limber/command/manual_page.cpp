// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/manual_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>
#include <vector>

#include "command/text.h"

namespace limber::program {
namespace {

/// A line of text in which nothing is a request to the formatter.
std::string escaped(std::string_view line) {
  std::string result = line.starts_with('.') || line.starts_with('\'') ? "\\&" : "";
  for (const char c : line) {
    if (c == '\\') {
      result += "\\(rs";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

std::string bold(std::string_view text) { return "\\fB" + escaped(text) + "\\fR"; }

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return capitals;
}

std::string entry(const std::string& tag, std::string_view meaning) {
  return fmt::format(".TP\n{}\n{}\n", tag, escaped(meaning));
}

using Block = std::vector<std::string>;  // lines

/// What stands between blank lines.
std::vector<Block> blocks_of(const std::string& text) {
  std::vector<Block> blocks(1);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) {
      blocks.back().push_back(line);
    } else if (!blocks.back().empty()) {
      blocks.emplace_back();
    }
  }
  if (blocks.back().empty()) blocks.pop_back();
  return blocks;
}

bool is_heading(const Block& block) { return block.size() == 1 && block[0].ends_with(':'); }

/// Where the gap between an indented word and its meaning starts, if there is one.
std::size_t gap_in(std::string_view line) { return line.find("  ", line.find_first_not_of(' ')); }

std::string formatted(const Block& block) {
  std::string text;
  if (!block[0].starts_with(' ')) {
    text = ".PP\n";
    for (const std::string& line : block) text += escaped(line) + '\n';
    return text;
  }
  const auto is_entry = [](std::string_view line) { return gap_in(line) != std::string_view::npos; };
  if (std::all_of(block.begin(), block.end(), is_entry)) {
    for (const std::string_view line : block) {
      text += entry(bold(trimmed(line.substr(0, gap_in(line)))), trimmed(line.substr(gap_in(line))));
    }
    return text;
  }
  const std::size_t indent = block[0].find_first_not_of(' ');
  text = ".PP\n.RS 4\n.nf\n";
  for (const std::string& line : block) text += escaped(line.substr(std::min(indent, line.size()))) + '\n';
  return text + ".fi\n.RE\n";
}

/// The words of help for arguments and options, without its columns.
class Words : public CLI::Formatter {
 public:
  Words() { label("SUBCOMMAND", "VERB"); }

  /// "limber distance [OPTIONS] A B", with the command in bold and what stands for something else in italics.
  std::string usage(const CLI::App& command, const std::string& name) const {
    const std::string line(trimmed(make_usage(&command, name)));
    const std::string_view after_name = std::string_view(line).substr(line.find(name) + name.size());
    std::string text = bold(name);
    bool is_name = false;
    for (const char c : after_name) {
      if ((std::isupper(static_cast<unsigned char>(c)) != 0) != is_name) {
        is_name = !is_name;
        text += is_name ? "\\fI" : "\\fR";
      }
      text += c;
    }
    return text + (is_name ? "\\fR" : "");
  }

  /// The arguments of a command, then its options.
  std::string entries(const CLI::App& command) const {
    std::string text;
    for (const bool is_argument : {true, false}) {
      for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional() != is_argument || option->get_group().empty()) continue;
        const std::string tag = bold(make_option_name(option, is_argument)) + escaped(make_option_opts(option));
        text += entry(tag, option->get_description());
      }
    }
    return text;
  }
};

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& version) {
  const Words words;
  const std::string& name = app.get_name();
  const std::vector<const CLI::App*> verbs = app.get_subcommands({});
  std::string page = fmt::format(".TH {} 1 \"\" \"{}\" \"User Commands\"\n.nh\n.ad l\n", in_capitals(name), version);
  page += fmt::format(".SH NAME\n{} \\- {}\n", name, escaped(app.get_description()));
  page += ".SH SYNOPSIS\n" + words.usage(app, name) + '\n';
  for (const CLI::App* verb : verbs) page += ".br\n" + words.usage(*verb, name + ' ' + verb->get_name()) + '\n';

  const std::vector<Block> blocks = blocks_of(app.get_footer());
  const auto sections = std::find_if(blocks.begin(), blocks.end(), is_heading);
  page += ".SH DESCRIPTION\n";
  for (auto block = blocks.begin(); block != sections; ++block) page += formatted(*block);
  page += ".SH OPTIONS\n" + words.entries(app);
  page += ".SH VERBS\n";
  for (const CLI::App* verb : verbs) {
    page += fmt::format(".SS {}\n{}.\n", verb->get_name(), escaped(verb->get_description()));
    page += words.entries(*verb);
    for (const Block& block : blocks_of(verb->get_footer())) page += formatted(block);
  }
  for (auto block = sections; block != blocks.end(); ++block) {
    if (is_heading(*block)) {
      const std::string& heading = block->front();
      page += ".SH " + in_capitals(heading.substr(0, heading.size() - 1)) + '\n';
    } else {
      page += formatted(*block);
    }
  }
  return page;
}

}  // namespace limber::program
