// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run_program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace limber::program_tests {

Outcome run(const std::string& line) {
  const Folder folder;
  const std::string out = folder.store("out", "");
  Outcome outcome = run_into(out, line);
  outcome.out = text_of(out);
  return outcome;
}

Outcome run_into(const std::string& file, const std::string& line) {
  const Folder folder;
  const std::string err = folder.store("err", "");
  const std::string command = std::string(LIMBER_PROGRAM) + ' ' + line + " </dev/null >'" + file + "' 2>'" + err + "'";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, {}, text_of(err)};
}

std::string answer_to(const std::string& line) {
  const Outcome outcome = run(line);
  EXPECT_EQ(outcome.exit_code, 0) << line << '\n' << outcome.err;
  EXPECT_EQ(outcome.err, "") << line;
  return outcome.out;
}

nlohmann::json json_of(const std::string& line) {
  const std::string answer = answer_to(line + " --json");
  EXPECT_EQ(lines_of(answer).size(), 1U) << answer;
  nlohmann::json json = nlohmann::json::parse(answer, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << answer;
  return json;
}

std::vector<nlohmann::json> json_lines_of(const Outcome& outcome) {
  std::vector<nlohmann::json> rows;
  for (const std::string& line : lines_of(outcome.out)) rows.push_back(nlohmann::json::parse(line));
  return rows;
}

std::vector<nlohmann::json> json_rows_of(const std::string& line) {
  const Outcome outcome = run(line + " --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return json_lines_of(outcome);
}

void expect_refused(const std::string& line, const std::string& part_of_the_error) {
  SCOPED_TRACE("limber " + line);
  const Outcome outcome = run(line);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  ASSERT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
  EXPECT_EQ(outcome.err.find("limber: "), 0U) << outcome.err;
  EXPECT_EQ(outcome.err.back(), '\n');
  EXPECT_NE(outcome.err.find(part_of_the_error), std::string::npos) << outcome.err;
}

void expect_all_refused(const std::string& start, const Refusals& refusals) {
  for (const auto& [rest, part] : refusals) expect_refused(start + rest, part);
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Words lines_of(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Words keys_of(const nlohmann::json& json) {
  Words keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

std::string joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<Row> table_of(const std::string& csv) {
  const auto cells_of = [](const std::string& line) {
    Words cells;
    std::istringstream stream(line + ',');
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const Words lines = lines_of(csv);
  const Words names = lines.empty() ? Words() : cells_of(lines.front());
  std::vector<Row> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words cells = cells_of(lines[i]);
    EXPECT_EQ(cells.size(), names.size()) << lines[i];
    Row& row = rows.emplace_back();
    for (std::size_t c = 0; c < std::min(cells.size(), names.size()); ++c) row[names[c]] = cells[c];
  }
  return rows;
}

void expect_same(const Row& row, const nlohmann::json& json, const std::string& prefix) {
  static const std::map<std::string, std::array<std::string, 3>> names_of_three = {
      {"point", {"x", "y", "z"}},
      {"position", {"closest_x", "closest_y", "closest_z"}},
      {"weights", {"weight_0", "weight_1", "weight_2"}}};
  for (const auto& [key, value] : json.items()) {
    SCOPED_TRACE(prefix + key);
    const std::string name = prefix + key;
    if (value.is_object()) {
      const bool has_no_name = key == "witness" || key == "pair" || key == "closest";
      expect_same(row, value, has_no_name ? prefix : name + '_');
    } else if (value.is_array()) {
      const auto found = names_of_three.find(key);
      const auto names =
          found != names_of_three.end() ? found->second : std::array{name + "_x", name + "_y", name + "_z"};
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(number(row.at(names[k])), value.at(k).get<double>());
    } else if (value.is_null()) {
      const auto cell = row.find(name);
      EXPECT_TRUE(cell == row.end() || cell->second.empty());  // an object that is not there has no cell of its own
    } else if (key.ends_with("_us")) {
      EXPECT_FALSE(row.at(name).empty());  // another time in another run
    } else if (value.is_number()) {
      EXPECT_EQ(number(row.at(name)), value.get<double>());
    } else {
      EXPECT_EQ(row.at(name), value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
}

double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

Folder::Folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "limber-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a folder for a test");
  path_ = pattern;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string Folder::store(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path(name);
}

std::string Folder::store(const std::string& name, MeshView mesh) const {
  std::ostringstream text;
  text.precision(17);
  for (const Vec3& p : mesh.positions) text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const Corners& c : mesh.triangles) text << "f " << c[0] + 1 << ' ' << c[1] + 1 << ' ' << c[2] + 1 << '\n';
  return store(name, text.str());
}

Report::Report(const std::string& line) {
  const std::string path = folder.path("page.html");
  outcome = run(line + " --report " + path);
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << line << '\n' << outcome.err;
  page = text_of(path);
  const std::string start = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(start) + start.size();
  data = nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin), nullptr, false);
  EXPECT_TRUE(data.is_object()) << page.substr(begin, 100);
}

}  // namespace limber::program_tests
