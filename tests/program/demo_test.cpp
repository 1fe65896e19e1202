// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <utility>

#include "program/run_program.h"

namespace limber::program_tests {
namespace {

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

/// The first group of every match. Not for long matches: std::regex recurses.
std::vector<std::string> all_matches(const std::string& text, const std::string& pattern) {
  std::vector<std::string> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) found.push_back((*it)[1]);
  return found;
}

/// Every part of the text from a `begin` to the `end` that follows, both left out.
std::vector<std::string> parts_between(const std::string& begin, const std::string& end, const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    parts.push_back(text.substr(at, text.find(end, at) - at));
  }
  return parts;
}

std::vector<double> numbers_in(const std::string& text, const std::string& pattern) {
  std::vector<double> numbers;
  for (const std::string& match : all_matches(text, pattern)) numbers.push_back(std::stod(match));
  return numbers;
}

std::string section_of(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find("<section id=\"" + id + "\">");
  EXPECT_NE(begin, std::string::npos) << id;
  if (begin == std::string::npos) return {};
  return page.substr(begin, page.find("</section>", begin) - begin);
}

/// What a reader sees of a page: no style sheet, no tags.
std::string words_of(const std::string& page) {
  std::string words;
  for (const std::string& part : parts_between(">", "<", page.substr(page.find("</style>")))) words += part + ' ';
  return words;
}

/// A chart as it is drawn.
struct DrawnChart {
  std::vector<double> values;  ///< labels of the vertical axis, from its lower to its upper end
  std::vector<std::string> frames;
  double height = 0;                         ///< of the plot
  std::vector<std::vector<double>> heights;  ///< of each curve's points above the lower end, as parts of the plot's
};

DrawnChart chart_in(const std::string& section) {
  DrawnChart chart;
  chart.values = numbers_in(section, "class='value'[^>]*>([^<]*)<");
  chart.frames = all_matches(section, "class='frame'[^>]*>([^<]*)<");
  chart.height = numbers_in(section, "viewBox='0 0 [0-9]+ ([0-9]+)' preserveAspectRatio='none'").at(0);
  for (const std::string& polyline : parts_between("<polyline", "/>", section)) {
    std::vector<double> heights;
    for (const double y : numbers_in(polyline, ",([^ ]+) ")) heights.push_back(1 - y / chart.height);
    chart.heights.push_back(heights);
  }
  return chart;
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

/// The value at a height of a chart with a logarithmic axis.
double value_at(double height, const DrawnChart& chart) {
  return chart.values.front() * std::pow(chart.values.back() / chart.values.front(), height);
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
  expect_sound_page(text_of(page));
  EXPECT_NE(text_of(page).find("checked against brute force: equal"), std::string::npos);
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
      expect_sound_page(text_of(page));
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

TEST(ProgramDemo, TextsAreReadableOnNarrowAndWideScreens) {
  const Folder folder;
  const std::string path = folder.path("demo.html");
  for (const std::string frames : {"30", "600"}) {
    ASSERT_EQ(run({"demo", "--frames", frames, "--no-check", "--out", path}).exit_code, 0);
    const std::string page = text_of(path);
    EXPECT_NE(page.find("width=device-width"), std::string::npos);
    // What a view box scales with the page holds no text; the sizes of all others are pixels.
    for (const std::string& picture : parts_between("<svg", "</svg>", page)) {
      if (picture.substr(0, picture.find('>')).find("viewBox") == std::string::npos) continue;
      EXPECT_EQ(picture.find("<text"), std::string::npos) << picture.substr(0, 200);
    }
    const std::string style = parts_between("<style>", "</style>", page).at(0);
    const std::vector<double> sizes = numbers_in(style, "font(?:-size)?: *([0-9.]+)px");
    EXPECT_GE(sizes.size(), 6U);
    for (const double size : sizes) EXPECT_GE(size, 12);
    EXPECT_EQ(count_of("font-size", style) + count_of("font:", style), sizes.size());  // no other units
    // At 400 pixels about 280 are left to the plot; a digit is 9 wide at most, and numbers need a gap.
    for (const char* id : {"distance", "update", "query"}) {
      const DrawnChart chart = chart_in(section_of(page, id));
      std::size_t width = 0;
      for (const std::string& label : chart.frames) width += 9 * (label.size() + 1);
      EXPECT_GE(chart.frames.size(), 4U) << id;
      EXPECT_LE(width, 280U) << id;
      EXPECT_GE(chart.values.size(), 2U) << id;
      EXPECT_LE(chart.values.size(), 12U) << id;
    }
  }
}

TEST(ProgramDemo, AxesReachTheLargestValue) {
  const Folder folder;
  const std::string path = folder.path("demo.html");
  const nlohmann::json json = json_of(run({"demo", "--frames", "150", "--json", "--no-check", "--out", path}));
  const std::string page = text_of(path);
  for (const char* id : {"distance", "update", "query"}) {
    const DrawnChart chart = chart_in(section_of(page, id));
    for (const std::vector<double>& heights : chart.heights) {
      EXPECT_EQ(heights.size(), 150U) << id;
      EXPECT_LE(largest(heights), 1) << id;
      EXPECT_GE(*std::min_element(heights.begin(), heights.end()), 0) << id;
    }
  }
  const auto expect_shown = [&](const char* id, std::size_t curve, const char* key) {
    const DrawnChart chart = chart_in(section_of(page, id));
    const double expected = json[key]["max"];
    EXPECT_GE(chart.values.back(), expected) << key;
    EXPECT_NEAR(value_at(largest(chart.heights.at(curve)), chart), expected, 0.01 * expected) << key;
  };
  expect_shown("update", 0, "update_us");
  expect_shown("query", 0, "query_us");
  expect_shown("query", 1, "rough_query_us");
}

TEST(ProgramDemo, TimesHaveOneUnit) {
  const Folder folder;
  const std::string path = folder.path("demo.html");
  // Without dents updates take less than a microsecond; with many, in the classic engine, milliseconds.
  for (const auto& [engine, dents] : {std::pair{"fast", "0"}, std::pair{"fast", "2"}, std::pair{"classic", "50"}}) {
    const Outcome outcome =
        run({"demo", "--frames", "20", "--no-check", "--engine", engine, "--dents-per-frame", dents, "--out", path});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string page = text_of(path);
    const std::regex other_unit("[0-9](?: |&nbsp;)?[mn]s[^a-z]|milli|nano");
    EXPECT_FALSE(std::regex_search(outcome.out, other_unit)) << outcome.out;
    EXPECT_FALSE(std::regex_search(words_of(page), other_unit)) << engine;
    const std::vector<std::string> tiles = all_matches(page, "<div><b>([^<]*)</b>");
    EXPECT_EQ(tiles.size(), 4U);
    for (const std::string& tile : tiles) {
      EXPECT_TRUE(std::regex_match(tile, std::regex("[0-9.]+(?:&nbsp;[0-9]+)*&nbsp;&micro;s"))) << tile;
    }
    for (const char* id : {"update", "query"}) {
      EXPECT_NE(section_of(page, id).find("class='unit'>&micro;s, logarithmic<"), std::string::npos) << id;
    }
  }
}

TEST(ProgramDemo, FewFramesHaveNoPercentiles) {
  const Folder folder;
  const std::string path = folder.path("demo.html");
  const auto play = [&](const std::string& frames, bool json) {
    std::vector<std::string> arguments = {"demo", "--frames", frames, "--no-check", "--out", path};
    if (json) arguments.emplace_back("--json");
    return run(arguments);
  };
  for (const std::string frames : {"3", "99", "100"}) {
    const bool has_percentiles = frames == "100";
    const Outcome outcome = play(frames, false);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(count_of("p99", outcome.out), has_percentiles ? 3U : 0U) << outcome.out;
    EXPECT_EQ(count_of("p99", text_of(path)), has_percentiles ? 6U : 0U) << frames;  // in the charts and the summary
    EXPECT_EQ(count_of(", max ", outcome.out), 3U) << outcome.out;
    const nlohmann::json json = json_of(play(frames, true));
    for (const char* key : {"update_us", "query_us", "rough_query_us"}) {
      EXPECT_EQ(json[key].contains("p99"), has_percentiles) << frames;
    }
  }
}

}  // namespace
}  // namespace limber::program_tests
