// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "program/run_program.h"

namespace limber::program_tests {
namespace {

std::string page_at(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The last tag without an end tag, or the first end tag that does not match the last start tag.
std::string unbalanced_tag(const std::string& page) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*?(/?)>");
  for (std::sregex_iterator it(page.begin(), page.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (name == "meta" || (*it)[3] == "/") continue;
    if ((*it)[1] == "") {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "/" + name;
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? std::string() : open.back();
}

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

void expect_sound_page(const std::string& page) {
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_EQ(unbalanced_tag(page), "");
  EXPECT_GE(count_of("<svg", page), 5U);
  const std::string without_namespace =
      std::regex_replace(page, std::regex("xmlns='http://www\\.w3\\.org/2000/svg'"), "");
  for (const char* part : {"http://", "https://", "<script", "<link", "@import", "url(", "nan", "inf "}) {
    EXPECT_EQ(without_namespace.find(part), std::string::npos) << part;
  }
}

TEST(ProgramDemo, WritesAPageAndASummary) {
  const Folder folder;
  const std::string page = folder.path("demo.html");
  const Outcome outcome = run({"demo", "--frames", "30", "--out", page});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out.find('\033'), std::string::npos);  // no live table outside a terminal
  EXPECT_EQ(count_of("\nframe ", "\n" + outcome.out), 10U) << outcome.out;
  EXPECT_NE(outcome.out.find("checked against brute force: equal"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(page), std::string::npos);
  expect_sound_page(page_at(page));
  EXPECT_NE(page_at(page).find("checked against brute force: equal"), std::string::npos);
}

TEST(ProgramDemo, SummaryAsJson) {
  const Folder folder;
  const nlohmann::json json =
      json_of(run({"demo", "--frames", "25", "--dents-per-frame", "3", "--out", folder.path("x.html"), "--json"}));
  EXPECT_EQ(json["query"], "demo");
  EXPECT_EQ(json["frames"], 25);
  EXPECT_EQ(json["brute_force"], "equal");
  EXPECT_GT(json["moved_vertices"], 0);
  EXPECT_GT(json["refits"], 0);
  EXPECT_EQ(json["engine"], "fast");
  for (const char* key : {"update_us", "query_us", "rough_query_us"}) {
    EXPECT_LE(json[key]["median"].get<double>(), json[key]["p99"].get<double>()) << key;
    EXPECT_LE(json[key]["p99"].get<double>(), json[key]["max"].get<double>()) << key;
  }
}

TEST(ProgramDemo, IsTheSameForEveryModeAndEveryMargin) {
  const Folder folder;
  const auto play = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"demo", "--frames", "20", "--no-check", "--json", "--out", folder.path("x.html")});
    return json_of(run(options));
  };
  const nlohmann::json fast = play({}), tuned = play({"--motion-margin", "auto"});
  const nlohmann::json by_depth = play({"--engine", "classic"});
  const nlohmann::json immediate = play({"--engine", "classic", "--mode", "immediate"});
  const nlohmann::json loose = play({"--engine", "classic", "--extra-radius", "0.2"});
  EXPECT_NEAR(fast["min_distance"].get<double>(), by_depth["min_distance"].get<double>(), 1e-12);
  EXPECT_NEAR(tuned["min_distance"].get<double>(), by_depth["min_distance"].get<double>(), 1e-12);
  EXPECT_EQ(by_depth["brute_force"], "skipped");
  EXPECT_GT(by_depth["min_distance"], 0);
  EXPECT_EQ(by_depth["min_distance"], immediate["min_distance"]);
  EXPECT_EQ(by_depth["min_distance"], loose["min_distance"]);
  EXPECT_EQ(by_depth["moved_vertices"], immediate["moved_vertices"]);
  EXPECT_GT(immediate["refits"], by_depth["refits"]);
  EXPECT_GT(loose["absorbed"], 0);
  EXPECT_NE(by_depth["moved_vertices"], play({"--seed", "8"})["moved_vertices"]);
}

TEST(ProgramDemo, SmallestRunsMakeSoundPages) {
  const Folder folder;
  const std::string page = folder.path("small.html");
  for (const std::string frames : {"1", "2"}) {
    for (const std::string dents : {"0", "1"}) {
      const Outcome outcome = run({"demo", "--frames", frames, "--dents-per-frame", dents, "--no-check", "--out", page,
                                   "--relative-error", "0.5"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      expect_sound_page(page_at(page));
    }
  }
}

}  // namespace
}  // namespace limber::program_tests
