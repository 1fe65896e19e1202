// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

TEST(ProgramReport, HasTheAnswerOfTheSameRun) {
  const std::string question = "distance scene:soup:1 scene:soup:2 --pose-b 3,0,0,1,2,3,4 --json";
  for (const std::string options :
       {"", " --relative-error 0.3", " --min-clearance 2.5", " --min-clearance 0.001", " --max-distance 0.01"}) {
    const Report report(question + options);
    const nlohmann::json json = nlohmann::json::parse(report.outcome.out);
    const nlohmann::json &rows = report.data["rows"], &pair = report.data["pair"];
    for (const char* key :
         {"status", "lower", "upper", "too_close", "inside", "clash", "solids", "depth", "query_us"}) {
      EXPECT_EQ(rows[key][0], json[key]) << key;
    }
    EXPECT_EQ(pair["node_tests"], json["node_tests"]);
    EXPECT_EQ(report.outcome.exit_code, json["too_close"] == true ? 3 : 0);
    EXPECT_EQ(rows["witness"][0].is_null(), json["witness"].is_null());
    EXPECT_EQ(pair["intersections"], 0);
    EXPECT_EQ(report.data["command"].get<std::string>().find("limber distance scene:soup:1 scene:soup:2 --pose-b"), 0U);
  }
}

TEST(ProgramReport, MeshesOf200000TrianglesTakeLessThan8Megabytes) {
  const Folder folder;
  const Mesh sheet = scenes::wave_sheet(250, 200, 1);  // 100 000 triangles
  const std::string file = folder.store("sheet.obj", sheet);
  const Report report("distance " + file + ' ' + file + " --pose-b 0,0,40,0.9,0.1,0.2,0.3");
  EXPECT_EQ(report.outcome.exit_code, 0) << report.outcome.err;
  EXPECT_EQ(report.data["models"][0]["triangles"], 100000);
  EXPECT_GT(report.page.size(), 1'000'000U);
  EXPECT_LT(report.page.size(), 8'000'000U);
}

TEST(ProgramReport, NeedsNothingButItselfAndHasTheLicensesOfWhatIsInside) {
  const std::string page = Report("distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0").page;
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  for (const char* part : {" src=\"", "@import", "href=\"http", "fetch(\"http", "importScripts"}) {
    EXPECT_EQ(page.find(part), std::string::npos) << part;
  }
  // Code is known by a mark that only one library has.
  const std::string notices = page.substr(page.find("id=\"notices\""));
  for (const auto& [mark, owner] : {std::pair("__THREE__", "three.js authors"), std::pair("u-legend", "Leon Sorokin"),
                                    std::pair("limber", "The limber authors")}) {
    EXPECT_NE(page.find(mark), std::string::npos) << mark;
    EXPECT_NE(notices.find(owner), std::string::npos) << owner;
  }
  EXPECT_EQ(count_of("to permit persons to", notices), 2U);
}

TEST(ProgramReport, HasDataOfTheFormatThatThePageReads) {
  const Report report("distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0");
  const std::string format = report.data["format"].dump();
  EXPECT_NE(report.page.find("<meta name=\"limber-data\" content=\"" + format + "\">"), std::string::npos) << format;
}

TEST(ProgramReport, NamesOfFilesAreOnlyText) {
  const Folder folder;
  folder.store("<!--<script>'$.obj", scenes::ball(8, 5));
  const std::string in_shell = '\'' + folder.path("<!--<script>'\\''$.obj") + '\'';
  const Report report("distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0");
  EXPECT_EQ(report.data["models"][0]["name"], "<!--<script>'$.obj");
  EXPECT_EQ(report.page.find("<!--<script>"), std::string::npos);
  const std::string typed = report.data["command"];
  EXPECT_EQ(typed.find("limber distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0 --report"), 0U) << typed;
}

}  // namespace
}  // namespace limber::program_tests
