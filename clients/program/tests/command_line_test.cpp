// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "run_program.h"

namespace limber::program_tests {
namespace {

const Words verbs = {"info",   "distance", "collide", "within", "contacts", "self",
                     "points", "track",    "bench",   "demo",   "help",     "version"};

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

TEST(ProgramHelp, IsAManualPageTooWithTheSectionsOfOne) {
  const std::string page = answer_to("help --man");
  const std::regex request("[.](TH|SH|SS|nf|in|br)( .*)?");
  std::string sections, verb_sections;
  for (const std::string& line : lines_of(page)) {
    EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; })) << line;
    EXPECT_TRUE(!line.starts_with('.') || std::regex_match(line, request)) << line;
    if (line.starts_with(".SH ")) sections += line.substr(4) + '\n';
    if (line.starts_with(".SS ")) verb_sections += line.substr(4) + '\n';
  }
  EXPECT_EQ(sections, "NAME\nSYNOPSIS\nDESCRIPTION\nOPTIONS\nVERBS\nEXIT STATUS\nEXAMPLES\nHELP OF EACH VERB\n");
  for (const std::string& verb : verbs) {
    EXPECT_NE(page.find("\n.br\nlimber " + verb + " [OPTIONS]"), std::string::npos) << verb;
    EXPECT_NE(verb_sections.find(verb + '\n'), std::string::npos) << verb;
    std::string help = answer_to("help " + verb);
    for (std::size_t at = 0; (at = help.find('-', at)) != std::string::npos; at += 2) help.insert(at, "\\");
    EXPECT_NE(page.find(".SS " + verb + "\n.nf\n.in 0\n" + help), std::string::npos) << verb;
  }
  expect_refused("help --man info", "limber: help: --man: leaves no room for VERB\n");
}

TEST(ProgramVersion, IsTheSameWhicheverWayItIsAskedFor) {
  const std::string version = answer_to("version");
  EXPECT_EQ(version.find("limber "), 0U) << version;
  EXPECT_EQ(lines_of(version).size(), 1U);
  for (const std::string option : {"--version", "-v", "-V"}) EXPECT_EQ(answer_to(option), version) << option;
}

TEST(ProgramExitCode, TellsTheAnswerOnlyWhereItIsAskedFor) {
  const auto ask = [](const std::string& verb, const std::string& options) {
    const Outcome outcome = run(verb + " scene:ball scene:square " + options);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NE(outcome.out, "");
    return outcome.exit_code;
  };
  const std::string apart = "--pose-a 0,0,3,1,0,0,0 ";  // by 2
  EXPECT_EQ(ask("collide", ""), 0);
  EXPECT_EQ(ask("collide", "--exit-code"), 3);
  EXPECT_EQ(ask("collide", "--exit-code --json"), 3);
  EXPECT_EQ(ask("collide", apart + "--exit-code"), 0);
  EXPECT_EQ(ask("within", apart + "--max-distance 2"), 0);
  EXPECT_EQ(ask("within", apart + "--max-distance 2 --exit-code"), 3);
  EXPECT_EQ(ask("within", apart + "--max-distance 1.9 --exit-code"), 0);
  EXPECT_EQ(ask("distance", apart + "--max-distance 2 --exit-code"), 3);
  EXPECT_EQ(ask("distance", apart + "--max-distance 1.9 --exit-code"), 0);
  EXPECT_EQ(ask("distance", apart + "--min-clearance 2.1"), 3);
  EXPECT_EQ(ask("distance", apart + "--min-clearance 2"), 0);  // as far as asked for
  EXPECT_EQ(ask("distance", apart + "--min-clearance 2 --max-distance 2"), 0);
  EXPECT_EQ(ask("contacts", "--intersections"), 0);
  EXPECT_EQ(ask("contacts", "--intersections --exit-code"), 3);
  EXPECT_EQ(ask("contacts", "--margin 0 --exit-code --json --max-count 0"), 3);
  EXPECT_EQ(ask("contacts", apart + "--intersections --exit-code"), 0);
  EXPECT_EQ(ask("contacts", apart + "--margin 1.9 --exit-code"), 0);
  EXPECT_EQ(ask("contacts", apart + "--margin 2.1 --exit-code"), 3);
  EXPECT_EQ(ask("contacts", apart + "--closest 1 --exit-code"), 3);
  EXPECT_EQ(run("collide scene:ball missing.obj --exit-code").exit_code, 2);
}

TEST(ProgramClearance, IsDecidedExactlyWhateverTheErrors) {
  const std::string question = "distance scene:ball scene:square --pose-a 0.1,0.2,3,1,0,0,0 ";
  EXPECT_TRUE(json_of(question)["too_close"].is_null());
  const auto ask = [&](const std::string& clearance, const std::string& options) {
    const Outcome outcome = run(question + "--json --min-clearance " + clearance + options);
    nlohmann::json answer = json_lines_of(outcome).at(0);
    EXPECT_EQ(outcome.exit_code, answer["too_close"] == true ? 3 : 0);
    return answer;
  };
  const std::string upper = ask("1", "")["upper"].dump();
  const std::string above = std::to_string(number(upper) + 1e-3), below = std::to_string(number(upper) - 1e-3);
  for (const std::string errors :
       {"", " --relative-error 1", " --absolute-error 5", " --relative-error 1 --max-distance 7"}) {
    EXPECT_EQ(ask(above, errors)["too_close"], true);
    EXPECT_EQ(ask(below, errors)["too_close"], false);
    EXPECT_EQ(ask(upper, errors)["too_close"], false);
  }
  // Far from the clearance the errors save work: the answer stays an interval.
  EXPECT_EQ(ask("0.1", " --relative-error 1")["status"], "within_error");
  EXPECT_EQ(ask(below, " --relative-error 1")["status"], "exact");
  EXPECT_NE(run(question + "--min-clearance 2.5").out.find("\nclearance below 2.5\n"), std::string::npos);
  EXPECT_NE(run(question + "--min-clearance 1.5").out.find("\nclearance at least 1.5\n"), std::string::npos);
}

}  // namespace
}  // namespace limber::program_tests
