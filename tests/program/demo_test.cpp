// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <utility>

#include "limber/distance.h"
#include "limber/model.h"
#include "program/page_decoding.h"
#include "program/run_program.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

/// A run whose page has been read.
struct Played {
  Folder folder;
  Outcome outcome;
  std::string page;
  nlohmann::json data;

  explicit Played(Words options) {
    options.insert(options.begin(), {"demo", "--out", folder.path("demo.html")});
    outcome = run(options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    page = text_of(folder.path("demo.html"));
    data = page_data(page);
  }
};

/// The sheet in every frame, by the documented draws of the dents.
std::vector<std::vector<Vec3>> dented_sheets(std::uint64_t seed, std::size_t frames, int dents) {
  std::vector<std::vector<Vec3>> sheets;
  Mesh sheet = scenes::thesis_sheet();
  scenes::Rng rng(seed);
  for (std::size_t f = 0; f < frames; ++f) {
    for (int d = 0; d < dents; ++d) {
      const scenes::VertexMoves moves = scenes::dent_moves(scenes::random_dent(rng), sheet.positions());
      for (std::size_t i = 0; i < moves.ids.size(); ++i) {
        sheet.set_position(moves.ids[i], moves.positions[i]).value();
      }
    }
    sheets.push_back(sheet.positions());
  }
  return sheets;
}

/// Lists have an entry for every frame.
void expect_count(const nlohmann::json& lists, const Words& names, std::size_t count) {
  for (const std::string& name : names) EXPECT_EQ(lists[name].size(), count) << name;
}

TEST(ProgramDemo, WritesAPageAndASummary) {
  const Played played({"--frames", "30"});
  const Outcome& outcome = played.outcome;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out.find('\033'), std::string::npos);  // no live table outside a terminal
  EXPECT_EQ(count_of("\nframe ", "\n" + outcome.out), 10U) << outcome.out;
  EXPECT_NE(outcome.out.find("checked against brute force: equal"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(played.folder.path("demo.html")), std::string::npos);
  EXPECT_EQ(played.page.find("<!DOCTYPE html>"), 0U);
  // The page says what the terminal says.
  const nlohmann::json& rows = played.data["demo"]["summary"];
  EXPECT_GE(rows.size(), 9U);
  for (const nlohmann::json& row : rows) {
    std::string line = row[0];
    line.resize(22, ' ');
    EXPECT_NE(outcome.out.find('\n' + line + row[1].get<std::string>() + '\n'), std::string::npos) << row;
  }
  EXPECT_EQ(played.data["command"], "limber demo --out " + played.folder.path("demo.html") + " --frames 30");
}

TEST(ProgramDemo, ThePagePlaysTheDentsAndTheBall) {
  const Played played({"--frames", "40", "--dents-per-frame", "3", "--seed", "5", "--no-check"});
  const nlohmann::json& sheet = played.data["models"][0];
  EXPECT_EQ(sheet["triangles"], 20000);
  EXPECT_EQ(played.data["stride"], 1);
  const std::vector<VertexId> order = page_order(scenes::thesis_sheet());
  const auto found = frames_of(sheet["frames"], order.size());
  const auto expected = dented_sheets(5, 40, 3);
  ASSERT_EQ(found.size(), expected.size());
  const double half_step = 0.50001 * sheet["frames"]["step"].get<double>();
  EXPECT_LT(half_step, 0.003);  // of 100 units a side
  for (std::size_t f = 0; f < found.size(); ++f) {
    for (std::size_t v = 0; v < order.size(); ++v) {
      ASSERT_LE(max_abs(found[f][v] - expected[f][order[v]]), half_step) << f << ' ' << v;
    }
  }
  const std::vector<Transform> poses = poses_of(played.data["models"][1]["poses"]);
  ASSERT_EQ(poses.size(), 40U);
  expect_count(played.data["rows"], {"lower", "upper", "status", "update_us", "query_us", "witness"}, 40);
  expect_count(played.data["demo"]["rough"], {"lower", "upper", "query_us"}, 40);
  const Model ball(scenes::thesis_ball());
  for (std::size_t f = 0; f < 40; ++f) {
    Mesh dented = scenes::thesis_sheet();
    for (VertexId v = 0; v < expected[f].size(); ++v) dented.set_position(v, expected[f][v]).value();
    const Model sheet_now(std::move(dented));
    const double exact = distance({sheet_now, {}}, {ball, poses[f]}).upper;
    EXPECT_NEAR(played.data["rows"]["upper"][f].get<double>(), exact, 1e-12) << f;
    EXPECT_EQ(played.data["rows"]["lower"][f], played.data["rows"]["upper"][f]) << f;
    const nlohmann::json& rough = played.data["demo"]["rough"];
    EXPECT_LE(rough["lower"][f].get<double>(), exact + 1e-12) << f;
    EXPECT_GE(rough["upper"][f].get<double>(), exact - 1e-12) << f;
    EXPECT_LE(rough["upper"][f].get<double>(), 1.1 * exact + 1e-12) << f;
  }
}

TEST(ProgramDemo, ThePageOfTheUsualRunIsSmall) {
  const Played played({"--no-check"});
  EXPECT_EQ(played.data["stride"], 1);
  EXPECT_LT(played.page.size(), 4'000'000U);
}

TEST(ProgramDemo, MoreFramesThanFitAreThinnedOut) {
  const Played played({"--frames", "300", "--dents-per-frame", "60", "--no-check"});
  EXPECT_EQ(played.outcome.err, "");
  const std::size_t stride = played.data["stride"];
  EXPECT_GE(stride, 2U);
  EXPECT_LT(played.page.size(), 8'000'000U);
  EXPECT_EQ(played.data["rows"]["upper"].size(), 300U);
  for (std::size_t r = 0; r < 300; ++r) {
    EXPECT_EQ(played.data["rows"]["witness"][r].is_null(), r % stride != 0) << r;  // only what is shown has points
  }
}

TEST(ProgramDemo, SummaryAsJson) {
  const Folder folder;
  const nlohmann::json json =
      json_of(run({"demo", "--frames", "100", "--dents-per-frame", "3", "--out", folder.path("x.html"), "--json"}));
  EXPECT_EQ(json["query"], "demo");
  EXPECT_EQ(json["frames"], 100);
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
  const nlohmann::json fast = play({}), loose_bounds = play({"--motion-margin", "0.01"});
  const nlohmann::json by_depth = play({"--engine", "classic"});
  const nlohmann::json immediate = play({"--engine", "classic", "--mode", "immediate"});
  const nlohmann::json loose = play({"--engine", "classic", "--extra-radius", "0.2"});
  EXPECT_NEAR(fast["min_distance"].get<double>(), by_depth["min_distance"].get<double>(), 1e-12);
  EXPECT_NEAR(loose_bounds["min_distance"].get<double>(), by_depth["min_distance"].get<double>(), 1e-12);
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
  for (const std::string frames : {"1", "2"}) {
    for (const std::string dents : {"0", "1"}) {
      const Played played({"--frames", frames, "--dents-per-frame", dents, "--no-check", "--relative-error", "0.5"});
      EXPECT_EQ(played.data["frame_count"], std::stoi(frames));
      EXPECT_EQ(played.data["relative_error"], 0.5);
      EXPECT_EQ(frames_of(played.data["models"][0]["frames"], 10201).size(), std::stoul(frames));
    }
  }
}

TEST(ProgramDemo, PrintsWhereThePageIs) {
  const Folder folder;
  const std::string page = folder.path("demo.html");
  const std::string relative = std::filesystem::relative(page).string();
  ASSERT_NE(relative, page);
  const Outcome outcome =
      run({"demo", "--frames", "1", "--no-check", "--out", folder.path("other.html"), "--out", relative});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  const std::string last_line = lines.back();
  ASSERT_EQ(last_line.find("page "), 0U) << outcome.out;
  const std::filesystem::path printed = last_line.substr(last_line.find('/'));
  EXPECT_TRUE(printed.is_absolute());
  EXPECT_TRUE(std::filesystem::equivalent(printed, page)) << printed;
  EXPECT_FALSE(std::filesystem::exists(folder.path("other.html")));  // of two, the last counts
}

TEST(ProgramDemo, TimesHaveOneUnit) {
  // Without dents updates take less than a microsecond; with many, in the classic engine, milliseconds.
  for (const auto& [engine, dents] : {std::pair{"fast", "0"}, std::pair{"fast", "2"}, std::pair{"classic", "50"}}) {
    const Played played({"--frames", "20", "--no-check", "--engine", engine, "--dents-per-frame", dents});
    const std::regex other_unit("[0-9] ?[mn]s[^a-z]|milli|nano");
    EXPECT_FALSE(std::regex_search(played.outcome.out, other_unit)) << played.outcome.out;
    EXPECT_FALSE(std::regex_search(played.data["demo"].dump(), other_unit)) << engine;
  }
}

TEST(ProgramDemo, FewFramesHaveNoPercentiles) {
  for (const std::string frames : {"3", "99", "100"}) {
    const bool has_percentiles = frames == "100";
    const Played played({"--frames", frames, "--no-check"});
    EXPECT_EQ(count_of("p99", played.outcome.out), has_percentiles ? 3U : 0U) << played.outcome.out;
    EXPECT_EQ(count_of("p99", played.data["demo"]["summary"].dump()), has_percentiles ? 3U : 0U) << frames;
    EXPECT_EQ(count_of(", max ", played.outcome.out), 3U) << played.outcome.out;
    const nlohmann::json json =
        json_of(run({"demo", "--frames", frames, "--no-check", "--out", played.folder.path("x.html"), "--json"}));
    for (const char* key : {"update_us", "query_us", "rough_query_us"}) {
      EXPECT_EQ(json[key].contains("p99"), has_percentiles) << frames;
    }
  }
}

}  // namespace
}  // namespace limber::program_tests
