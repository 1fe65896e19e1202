// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "page_decoding.h"
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

TEST(ProgramDemo, ThePageOfTheUsualRunIsSmall) {
  const Report demo = played("--no-check");
  EXPECT_EQ(demo.data["stride"], 1);
  EXPECT_LT(demo.page.size(), 4'000'000U);
}

TEST(ProgramDemo, MoreFramesThanFitAreThinnedOut) {
  const Report demo = played("--frames 300 --dents-per-frame 60 --no-check");
  EXPECT_EQ(demo.outcome.err, "");
  const std::size_t stride = demo.data["stride"];
  EXPECT_GE(stride, 2U);
  EXPECT_LT(demo.page.size(), 8'000'000U);
  EXPECT_EQ(demo.data["rows"]["upper"].size(), 300U);
  for (std::size_t r = 0; r < 300; ++r) {
    EXPECT_EQ(demo.data["rows"]["witness"][r].is_null(), r % stride != 0) << r;  // only what is shown has points
  }
}

TEST(ProgramDemo, IsTheSameForEveryMargin) {
  const Folder folder;
  const std::string line = "demo --frames 20 --no-check --report " + folder.path("x.html");
  const nlohmann::json tight = json_of(line), loose = json_of(line + " --motion-margin 0.5");
  EXPECT_GT(tight["min_distance"], 0);
  EXPECT_NEAR(tight["min_distance"].get<double>(), loose["min_distance"].get<double>(), 1e-12);
  EXPECT_EQ(tight["moved_vertices"], loose["moved_vertices"]);
  EXPECT_GT(loose["absorbed"], tight["absorbed"]);
  EXPECT_EQ(loose["motion_margin"], 0.5);
  EXPECT_NE(tight["moved_vertices"], json_of(line + " --seed 8")["moved_vertices"]);
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

TEST(ProgramDemo, TimesHaveOneUnit) {
  // Without dents updates take less than a microsecond; with many, milliseconds.
  for (const std::string options : {"--dents-per-frame 0", "--dents-per-frame 300"}) {
    const Report demo = played("--frames 20 --no-check " + options);
    const std::regex other_unit(R"(\b[0-9.]+ ?[mn]s\b|milli|nano)");
    EXPECT_FALSE(std::regex_search(demo.outcome.out, other_unit)) << demo.outcome.out;
    EXPECT_FALSE(std::regex_search(demo.data["demo"].dump(), other_unit)) << options;
  }
}

TEST(ProgramDemo, OnlyManyFramesHavePercentiles) {
  for (const std::string frames : {"3", "99", "100"}) {
    const bool has_percentiles = frames == "100";
    const Report demo = played("--no-check --frames " + frames);
    EXPECT_EQ(count_of("p99", demo.outcome.out), has_percentiles ? 3U : 0U) << demo.outcome.out;
    EXPECT_EQ(count_of("p99", demo.data["demo"]["summary"].dump()), has_percentiles ? 3U : 0U) << frames;
    EXPECT_EQ(count_of(", max ", demo.outcome.out), 3U) << demo.outcome.out;
    const std::string check = has_percentiles ? "" : " --no-check";  // which takes a while
    const nlohmann::json json = json_of("demo --frames " + frames + " --report " + demo.folder.path("x.html") + check);
    EXPECT_EQ(json["query"], "demo");
    EXPECT_EQ(json["frames"], std::stoi(frames));
    EXPECT_EQ(json["brute_force"], has_percentiles ? "equal" : "skipped");
    for (const char* count : {"moved_vertices", "refits"}) EXPECT_GT(json[count], 0) << count;
    for (const char* key : {"update_us", "query_us", "rough_query_us"}) {
      EXPECT_EQ(json[key].contains("p99"), has_percentiles) << frames;
      EXPECT_LE(json[key]["median"], json[key]["max"]) << key;
      if (!has_percentiles) continue;
      EXPECT_LE(json[key]["median"], json[key]["p99"]) << key;
      EXPECT_LE(json[key]["p99"], json[key]["max"]) << key;
    }
  }
}

}  // namespace
}  // namespace limber::program_tests
