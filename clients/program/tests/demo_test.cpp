// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <utility>
#include <vector>

#include "run_program.h"

namespace limber::program_tests {
namespace {

/// A run whose page has been read.
Report played(const std::string& options) { return Report("demo " + options); }

TEST(ProgramDemo, WritesAPageAndASummary) {
  const Report demo = played("--frames 30");
  const std::string text = demo.outcome.out, path = demo.folder.path("page.html");
  EXPECT_EQ(demo.outcome.err, "");  // no progress bar outside a terminal
  EXPECT_NE(text.find("checked against brute force: equal"), std::string::npos) << text;
  EXPECT_NE(text.find(path), std::string::npos);
  EXPECT_EQ(demo.page.find("<!DOCTYPE html>"), 0U);
  // The page says what the terminal says.
  const nlohmann::json& rows = demo.data["demo"]["summary"];
  EXPECT_GE(rows.size(), 9U);
  for (const nlohmann::json& row : rows) {
    std::string line = row[0];
    line.resize(22, ' ');
    EXPECT_NE(text.find('\n' + line + row[1].get<std::string>() + '\n'), std::string::npos) << row;
  }
  EXPECT_EQ(demo.data["command"], "limber demo --frames 30 --report " + path);
}

TEST(ProgramDemo, ASeedGivesTheSameFramesAndBothQueriesAgree) {
  const std::string options = "--frames 40 --dents-per-frame 3 --no-check --seed ";
  const nlohmann::json data = played(options + '5').data, again = played(options + '5').data;
  EXPECT_EQ(data["models"][0]["triangles"], 20000);
  EXPECT_EQ(data["models"], again["models"]);
  EXPECT_EQ(data["parts"], again["parts"]);
  EXPECT_EQ(data["rows"]["witness"], again["rows"]["witness"]);
  EXPECT_NE(data["rows"]["upper"], played(options + '6').data["rows"]["upper"]);
  EXPECT_EQ(data["rows"]["lower"], data["rows"]["upper"]);
  const nlohmann::json& rough = data["demo"]["rough"];
  for (std::size_t f = 0; f < 40; ++f) {
    const double exact = data["rows"]["upper"][f];
    EXPECT_LE(rough["lower"][f].get<double>(), exact + 1e-12) << f;
    EXPECT_GE(rough["upper"][f].get<double>(), exact - 1e-12) << f;
    EXPECT_LE(rough["upper"][f].get<double>(), 1.1 * exact + 1e-12) << f;
  }
}

TEST(ProgramDemo, ThePageOfTheUsualRunIsSmallAndMoreFramesThanFitAreThinnedOut) {
  const Report usual = played("--no-check"), thinned = played("--frames 300 --dents-per-frame 60 --no-check");
  EXPECT_EQ(usual.data["stride"], 1);
  EXPECT_LT(usual.page.size(), 4'000'000U);
  EXPECT_EQ(thinned.outcome.err, "");
  const std::size_t stride = thinned.data["stride"];
  EXPECT_GE(stride, 2U);
  EXPECT_LT(thinned.page.size(), 8'000'000U);
  EXPECT_EQ(thinned.data["rows"]["upper"].size(), 300U);
  for (std::size_t r = 0; r < 300; ++r) {
    EXPECT_EQ(thinned.data["rows"]["witness"][r].is_null(), r % stride != 0) << r;  // only what is shown has points
  }
}

TEST(ProgramDemo, IsTheSameForEveryMargin) {
  const auto distances = [](const std::string& options) {
    const Report demo = played("--frames 20 --no-check" + options);
    return std::pair(demo.data["rows"]["upper"].get<std::vector<double>>(), demo.outcome.out);
  };
  const auto [tight, tight_text] = distances("");
  const auto [loose, loose_text] = distances(" --motion-margin 0.5");
  for (std::size_t f = 0; f < 20; ++f) EXPECT_NEAR(tight[f], loose[f], 1e-12);
  EXPECT_NE(tight_text.find(", 0 moves absorbed (motion margin 0)"), std::string::npos) << tight_text;
  EXPECT_EQ(loose_text.find(", 0 moves absorbed"), std::string::npos) << loose_text;
}

TEST(ProgramDemo, SmallestRunsMakeSoundPages) {
  for (const std::string frames : {"1", "2"}) {
    for (const std::string dents : {"0", "1"}) {
      const Report demo = played("--no-check --relative-error 0.5 --frames " + frames + " --dents-per-frame " + dents);
      EXPECT_EQ(demo.data["frame_count"], std::stoi(frames));
      EXPECT_EQ(demo.data["relative_error"], 0.5);
      EXPECT_EQ(demo.data["models"][0]["frames"]["data"].size(), std::stoul(frames));
    }
  }
}

TEST(ProgramDemo, PrintsWhereThePageIs) {
  const Folder folder;
  const std::string page = folder.path("demo.html"), other = folder.path("other.html");
  const std::string relative = std::filesystem::relative(page).string();
  ASSERT_NE(relative, page);
  const Words lines = lines_of(answer_to("demo --frames 1 --no-check --report " + other + " --report " + relative));
  ASSERT_EQ(lines.back().find("page "), 0U) << lines.back();
  const std::filesystem::path printed = lines.back().substr(lines.back().find('/'));
  EXPECT_TRUE(printed.is_absolute());
  EXPECT_TRUE(std::filesystem::equivalent(printed, page)) << printed;
  EXPECT_FALSE(std::filesystem::exists(other));  // of two, the last counts
}

TEST(ProgramDemo, TimesHaveOneUnitAndOnlyManyFramesHavePercentiles) {
  // Without dents updates take less than a microsecond; with many, milliseconds.
  const std::regex other_unit(R"(\b[0-9.]+ ?[mn]s\b|milli|nano)");
  for (const auto& [options, percentiles] : {std::pair{"--frames 20 --dents-per-frame 0", 0U},
                                             {"--frames 20 --dents-per-frame 300", 0U},
                                             {"--frames 99", 0U},
                                             {"--frames 100", 3U}}) {
    const Report demo = played(std::string("--no-check ") + options);
    const std::string text = demo.outcome.out, summary = demo.data["demo"]["summary"].dump();
    for (const std::string& where : {text, summary}) {
      EXPECT_FALSE(std::regex_search(where, other_unit)) << where;
      EXPECT_EQ(count_of("p99", where), percentiles) << where;
      EXPECT_EQ(count_of(", max ", where), 3U) << where;
    }
  }
}

}  // namespace
}  // namespace limber::program_tests
