// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "limber/base.h"
#include "run_program.h"
#include "verbs/bench_run.h"

namespace limber::program_tests {
namespace {

std::string rows_of(const nlohmann::json& json) {
  std::string text;
  for (const nlohmann::json& row : json["rows"]) {
    text += row["question"].get<std::string>() + " " + row["situation"].get<std::string>() + "\n";
    EXPECT_GT(row["least_us"], 0) << row;
    EXPECT_LE(row["least_us"], row["median_us"]) << row;
  }
  return text;
}

std::string at_gaps(const std::string& question) {
  std::string text;
  for (const char* const gap : {"overlapping", "0.001", "0.05", "1"}) text += question + " " + gap + "\n";
  return text;
}

TEST(ProgramBench, HasARowForEachQuestionAndGap) {
  const nlohmann::json json = json_of("bench scene:ball scene:square --poses 3 --seed 7 --time 1000");
  EXPECT_EQ(json["query"], "bench");
  EXPECT_EQ(json["instruction_set"], instruction_set());
  EXPECT_EQ(json["threads"], 1);
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["a"]["model"], "scene:ball");
  EXPECT_EQ(json["b"]["triangles"], 8192);
  EXPECT_NE(json["processor"], "");
  EXPECT_DOUBLE_EQ(json["size"], std::sqrt(128.0));
  std::string expected;
  for (const char* const question : {"collide", "distance"}) expected += at_gaps(question);
  expected += "distance path\ndistance path with a cache\n";
  for (const char* const question :
       {"distance within 1 %", "within 0.002", "contacts within 0.002", "closest point of A"}) {
    expected += at_gaps(question);
  }
  for (const char* const question : {"build", "refit of all", "refit of 1 %", "self-contacts within 0.001"}) {
    expected += question + std::string(" A\n") + question + " B\n";
  }
  EXPECT_EQ(rows_of(json), expected);
  for (const nlohmann::json& row : json["rows"]) EXPECT_EQ(row["poses"], 3) << row;
}

TEST(ProgramBench, WritesTheSameRowsAsTextAndCsv) {
  const Folder folder;
  const std::string file = folder.path("rows.csv");
  const std::string text = answer_to("bench scene:ball --time 0 --threads 2 --out " + file);
  for (const char* const line : {"\nthreads    2\n", "\nA          scene:ball, 1 024 triangles\n", "\nsize "}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  EXPECT_EQ(text.find("\nB "), std::string::npos);
  const auto rows = table_of(text_of(file));
  EXPECT_EQ(rows.size(), 30U);
  EXPECT_EQ(table_of(answer_to("bench scene:ball --time 0 --out -")).size(), 30U);
  for (const auto& row : rows) {
    EXPECT_EQ(row.at("poses"), "1");
    const std::string question = row.at("question");
    const std::string words = question + std::string(27 - question.size(), ' ') + row.at("situation");
    const std::size_t at = text.find("\n" + words + " ");
    ASSERT_NE(at, std::string::npos) << words << text;
    const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    EXPECT_TRUE(line.ends_with(" " + row.at("median_us"))) << line;
    EXPECT_NE(line.find(" " + row.at("least_us") + " "), std::string::npos) << line;
  }
}

TEST(ProgramBench, RefusesWhatHasNoAnswer) {
  const Folder folder;
  const std::string point = folder.store("point.obj", "v 1 2 3\nf 1 1 1\n");
  expect_refused("bench scene:ball " + point, "bench: a model has no extent");
  expect_refused("bench", "bench: A is required");
  expect_refused("bench scene:ball --poses 0", "--poses: must be a whole number from 1");
  expect_refused("bench scene:ball --time -1", "--time: must be a number from 0");
  expect_refused("bench " + point + " --out " + point, "is one of the inputs");
  expect_refused("bench scene:ball --out - --json", "--out: leaves no room on standard output for --json");
}

TEST(ProgramBench, TellsWhichAnswersDisagree) {
  using program::BenchAnswers;
  const double limit = 0.5, tolerance = 1e-9;
  const BenchAnswers near{0.4, 0.3999, 0.401, false, true, 3, 0.4, 1, 1};
  const BenchAnswers meeting{0, 0, 0, true, true, 3, 0, 1, 1};
  EXPECT_EQ(disagreement(near, limit, tolerance), "");
  EXPECT_EQ(disagreement(meeting, limit, tolerance), "");
  const std::pair<const char*, std::function<void(BenchAnswers&)>> faults[] = {
      {"collide true", [](BenchAnswers& a) { a.collides = true; }},
      {"within 1 % 0.41 to 0.42", [](BenchAnswers& a) { a.rough_lower = 0.41, a.rough_upper = 0.42; }},
      {"within 1 % 0.3 to 0.39", [](BenchAnswers& a) { a.rough_lower = 0.3, a.rough_upper = 0.39; }},
      {"within 1 % 0.39 to 0.405", [](BenchAnswers& a) { a.rough_lower = 0.39, a.rough_upper = 0.405; }},
      {"within 0.5 false", [](BenchAnswers& a) { a.is_within = false; }},
      {"contacts within 0.5 0", [](BenchAnswers& a) { a.contacts = 0; }},
      {"closest point 0.3", [](BenchAnswers& a) { a.witness_distance = 0.3; }},
      {"of a refitted tree 1.1, of a new one 1", [](BenchAnswers& a) { a.refitted = 1.1; }}};
  for (const auto& [told, change] : faults) {
    BenchAnswers answers = near;
    change(answers);
    EXPECT_NE(disagreement(answers, limit, tolerance).find(told), std::string::npos) << told;
  }
  BenchAnswers missed = meeting;
  missed.collides = false;
  EXPECT_EQ(disagreement(missed, limit, tolerance), "distance 0, collide false");
}

}  // namespace
}  // namespace limber::program_tests
