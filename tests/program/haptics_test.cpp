// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "program/page_decoding.h"
#include "program/run_program.h"

namespace limber::program_tests {
namespace {

/// A run at 200 Hz over a small tissue.
const std::string small = "haptics --rate 200 --tissue 4000 --tool 1000 ";
const std::string short_run = small + "--seconds 0.2 --jitter-seconds 0.05 ";

TEST(ProgramHaptics, AnswersWithATable) {
  const std::string text = answer_to(short_run);  // without a line of progress outside a terminal
  for (const char* part : {"us ", "p99.99", "\nwhole tick ", "\n  move and deform ", "\n  commit ", "\n  query ",
                           "\n  force ", "\nlate wake-up ", "\nlate wake-up, empty loop ", "\nticks ", "40 at 200 Hz",
                           "\nmissed ticks ", "\nanswers ", "\ntree ", "sleeps until 30 us before a tick"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(ProgramHaptics, AnswersWithJson) {
  const nlohmann::json json = json_of(short_run);
  EXPECT_EQ(json["query"], "haptics");
  EXPECT_EQ(json["rate_hz"], 200);
  EXPECT_EQ(json["ticks"], 40);
  EXPECT_EQ(json["tick_budget_us"], 130);
  EXPECT_LE(json["tissue_triangles"], 4000);
  EXPECT_GE(json["tissue_triangles"], 3000);
  std::uint64_t in_histogram = 0, answers = 0;
  for (const nlohmann::json& bin : json["work_histogram"]) {
    EXPECT_LT(bin["from_us"], bin["to_us"]);
    in_histogram += bin["ticks"].get<std::uint64_t>();
  }
  EXPECT_EQ(in_histogram, 40U);
  for (const auto& [status, count] : json["answers"].items()) answers += count.get<std::uint64_t>();
  EXPECT_EQ(answers, 40U);
  EXPECT_EQ(json["answers"].size(), 5U);
  for (const char* part : {"work_us", "move_us", "commit_us", "query_us", "force_us", "empty_wake_up_us"}) {
    EXPECT_LE(json[part]["median"].get<double>(), json[part]["max"].get<double>()) << part;
  }
  EXPECT_TRUE(json["work_us"].contains("p90"));
  EXPECT_FALSE(json["work_us"].contains("p99"));  // of 40 ticks it would be the largest
  EXPECT_GE(json["work_us"]["max"], json["query_us"]["max"]);
  EXPECT_GT(json["node_tests_over_new_tree"], 0.5);
  EXPECT_LT(json["node_tests_over_new_tree"], 2);
  EXPECT_LE(json["missed"], 40);
}

TEST(ProgramHaptics, ChoosesABudgetThatThePeriodHasRoomFor) {
  const auto budget = [](const std::string& options) {
    return json_of("haptics --seconds 0.01 --tissue 1000 --tool 1000 --jitter-seconds 0 " + options)["tick_budget_us"];
  };
  EXPECT_EQ(budget("--rate 100"), 130);
  EXPECT_EQ(budget("--rate 5000"), 90);
  EXPECT_EQ(budget("--rate 5000 --tick-budget-us 12.5"), 12.5);
}

TEST(ProgramHaptics, MeasuresTheMachineAlone) {
  const nlohmann::json json = json_of(short_run + "--empty");
  EXPECT_EQ(json["ticks"], 40);
  EXPECT_TRUE(json["wake_up_us"].is_null());
  EXPECT_GE(json["empty_wake_up_us"]["max"], 0);
  EXPECT_FALSE(json.contains("work_us"));
  const std::string text = answer_to(short_run + "--empty");
  EXPECT_NE(text.find("\nlate wake-up, empty loop "), std::string::npos);
  EXPECT_EQ(text.find("whole tick"), std::string::npos);
  EXPECT_TRUE(json_of(small + "--seconds 0.2 --jitter-seconds 0")["empty_wake_up_us"].is_null());
}

TEST(ProgramHaptics, WritesARowForEachTick) {
  const Folder folder;
  const std::string path = folder.path("ticks.csv");
  // A pressing takes two seconds. Queries have the whole tick, so that forces do not depend on the machine.
  const nlohmann::json json = json_of(small + "--seconds 2 --jitter-seconds 0 --tick-budget-us 1000000 --out " + path);
  const std::vector<Row> rows = table_of(text_of(path));
  ASSERT_EQ(rows.size(), 400U);
  EXPECT_EQ(table_of(answer_to(short_run + "--out -")).size(), 40U);
  std::uint64_t missed = 0, moved = 0;
  std::map<std::string, int> statuses;
  double slowest = 0, largest_force = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row row = rows[i];
    EXPECT_EQ(row["tick"], std::to_string(i));
    const double parts =
        number(row["move_us"]) + number(row["commit_us"]) + number(row["query_us"]) + number(row["force_us"]);
    EXPECT_GE(number(row["work_us"]), parts - 0.01);
    EXPECT_EQ(row["upper"] == "", row["status"] == "beyond_limit") << row["upper"];
    if (row["upper"] != "") {
      EXPECT_LE(number(row["lower"]), number(row["upper"]));
    }
    missed += row["missed"] == "true" ? 1 : 0;
    moved += std::stoul(row["moved_vertices"]);
    ++statuses[row["status"]];
    slowest = std::max(slowest, number(row["work_us"]));
    largest_force = std::max(largest_force, number(row["force_n"]));
  }
  EXPECT_EQ(json["missed"], missed);
  EXPECT_EQ(json["moved_vertices"], moved);
  EXPECT_GT(moved, 1000U);
  for (const auto& [status, count] : statuses) EXPECT_EQ(json["answers"][status], count) << status;
  EXPECT_GT(statuses.size(), 1U);
  EXPECT_EQ(json["work_us"]["max"], slowest);
  EXPECT_NEAR(json["largest_force_n"].get<double>(), largest_force, 1e-6);
  EXPECT_GT(largest_force, 0.3);
}

TEST(ProgramHaptics, WritesAPageWithItsNumbers) {
  for (const std::string seconds : {"0.005", "1"}) {
    const Report report(small + "--json --jitter-seconds 0.05 --seconds " + seconds);
    const nlohmann::json answer = nlohmann::json::parse(report.outcome.out), &data = report.data["haptics"];
    EXPECT_EQ(report.page.find("<!DOCTYPE html>"), 0U);
    EXPECT_EQ(report.data["command"].get<std::string>().find("limber haptics --rate 200 "), 0U);
    EXPECT_EQ(data["rate_hz"], 200);
    EXPECT_EQ(data["work"][0]["bins"], answer["work_histogram"]);
    EXPECT_EQ(data["work"].size() + data["wake_up"].size(), 4U);
    const std::vector<double> slowest = data["slowest"]["work_us"];
    EXPECT_EQ(slowest.size(), answer["ticks"]);
    EXPECT_EQ(*std::max_element(slowest.begin(), slowest.end()), answer["work_us"]["max"]);
    EXPECT_EQ(data["slowest"]["missed"].size(), answer["missed"]);
    EXPECT_EQ(data["times"].size(), 8U);  // a header, five parts, two late wake-ups
    for (const nlohmann::json& row : data["times"]) EXPECT_EQ(row.size(), 7U);
    EXPECT_EQ(data["summary"][0][0], "ticks");
  }
}

TEST(ProgramHaptics, JoinsTicksThatAScreenCannotTellApart) {
  const Report report("haptics --rate 2500 --seconds 1 --tissue 1000 --tool 1000 --jitter-seconds 0 --json");
  const nlohmann::json answer = nlohmann::json::parse(report.outcome.out), &slowest = report.data["haptics"]["slowest"];
  EXPECT_EQ(slowest["group"], 3);
  const std::vector<double> work = slowest["work_us"];
  EXPECT_EQ(work.size(), 834U);
  EXPECT_EQ(*std::max_element(work.begin(), work.end()), answer["work_us"]["max"]);
}

TEST(ProgramHaptics, TellsMissedTicksByItsExitCodeOnlyWhereAsked) {
  // Hardly a machine does everything in 10 us.
  const std::string missing =
      "haptics --rate 100000 --seconds 0.01 --jitter-seconds 0 --tissue 4000 --tool 4000 --spin-us 1 --json";
  EXPECT_EQ(run(missing).exit_code, 0);
  EXPECT_EQ(run(missing + " --max-missed 1000").exit_code, 0);
  const Outcome strict = run(missing + " --max-missed 0");
  EXPECT_EQ(strict.exit_code, json_lines_of(strict).at(0)["missed"] > 0 ? 3 : 0);
}

TEST(ProgramHaptics, RefusesWhatItCannotDo) {
  for (const std::string value : {"0", "-1", "nan", "inf", "1e6", "fast"}) {
    expect_refused("haptics --rate " + value, "--rate: must be a number from 1 to 100000, not '" + value + "'");
  }
  const std::pair<const char*, const char*> refusals[] = {
      {"--seconds -1", "--seconds: must be a number from 0 to 86400"},
      {"--seconds 86400", "--seconds: 86400 seconds at 1000 Hz are more than 5000000 ticks"},
      {"--jitter-seconds 86400", "--jitter-seconds: 86400 seconds at 1000 Hz are more than"},
      {"--spin-us 1000", "--spin-us: must be less than the period of 1000 us"},
      {"--tick-budget-us 0", "--tick-budget-us: must be a number > 0, at most 1e6, not '0'"},
      {"--tissue 10", "--tissue: must be a whole number from 1000"},
      {"--tool many", "--tool: must be a whole number from 1000"},
      {"--core 1000", "--core: 1000 is no core that may be used; there are "},
      {"--core -1", "--core: must be a whole number from 0"},
      {"--max-missed -1", "--max-missed: must be a whole number from 0"},
      {"--relative-error -1", "--relative-error: must be a finite number >= 0"},
      {"--empty --report no/x.html", "--report: has nothing to tell of --empty"},
      {"--empty --out no/x.csv", "--out: has nothing to tell of --empty"},
      {"--out - --json", "--out: leaves no room on standard output for --json"}};
  for (const auto& [options, error] : refusals) {
    expect_refused(std::string("haptics ") + options, std::string("limber: haptics: ") + error);
  }
}

}  // namespace
}  // namespace limber::program_tests
