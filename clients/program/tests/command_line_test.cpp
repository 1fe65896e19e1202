// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "run_program.h"

namespace limber::program_tests {
namespace {

const Words verbs = {"info", "distance", "collide", "within", "contacts", "self", "points", "track", "demo", "help"};

TEST(ProgramHelp, IsTheSameWhicheverWayItIsAskedFor) {
  const std::string help = answer_to("--help");
  EXPECT_NE(help.find("Usage: limber [OPTIONS] VERB\n"), std::string::npos) << help;
  EXPECT_EQ(answer_to("help"), help);
  EXPECT_EQ(answer_to("-h"), help);
  for (const std::string& verb : verbs) {
    EXPECT_NE(help.find("\n  " + verb + "  "), std::string::npos) << verb;
    const std::string text = answer_to(verb + " --help");
    EXPECT_EQ(answer_to("help " + verb), text) << verb;
    EXPECT_NE(text.find("Usage: limber " + verb + " "), std::string::npos) << text;
  }
}

TEST(ProgramHelp, TellsExitCodesAndFitsIntoATerminal) {
  EXPECT_NE(answer_to("help").find("\n  3  there is an answer, and something was found"), std::string::npos);
  for (const std::string verb : {"distance", "collide", "within", "contacts", "self"}) {
    EXPECT_NE(answer_to("help " + verb).find("exit with 3 instead of 0 when"), std::string::npos) << verb;
  }
  for (const std::string& verb : verbs) {
    for (const std::string& line : lines_of(answer_to("help " + verb))) EXPECT_LE(line.size(), 80U) << line;
  }
}

TEST(ProgramHelp, IsAManualPageToo) {
  const std::string page = answer_to("help --man");
  const std::regex request("[.](TH|SH|nf|in)( .*)?");
  for (const std::string& line : lines_of(page)) {
    EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; })) << line;
    EXPECT_TRUE(!line.starts_with('.') || std::regex_match(line, request)) << line;
  }
  for (const std::string section : {"NAME", "SYNOPSIS", "DESCRIPTION"}) {
    EXPECT_NE(page.find("\n.SH " + section + '\n'), std::string::npos) << section;
  }
  for (const std::string& verb : verbs) {
    std::string help = answer_to("help " + verb);
    for (std::size_t at = 0; (at = help.find('-', at)) != std::string::npos; at += 2) help.insert(at, "\\");
    EXPECT_NE(page.find(".SH limber " + verb + "\n.nf\n.in 0\n" + help), std::string::npos) << verb;
  }
  expect_refused("help --man info", "limber: help: --man: leaves no room for VERB\n");
}

TEST(ProgramVersion, IsOneLine) {
  const std::string version = answer_to("--version");
  EXPECT_EQ(version.find("limber "), 0U) << version;
  EXPECT_EQ(lines_of(version).size(), 1U);
  EXPECT_EQ(answer_to("-v"), version);
}

}  // namespace
}  // namespace limber::program_tests
