// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "program/run_program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace limber::program_tests {
namespace {

/// Ends the program's own command line, as posix_spawn wants it.
std::vector<char*> null_ended(std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Outcome run(const Words& arguments) {
  const Folder folder;
  const std::string out = folder.store("out", "");
  Outcome outcome = run_into(out, arguments);
  outcome.out = text_of(out);
  return outcome;
}

Outcome run_into(const std::string& file, const Words& arguments) {
  const Folder folder;
  const std::string err = folder.store("err", "");
  std::vector<std::string> words = {LIMBER_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, file.c_str(), O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY, 0);
  pid_t child = 0;
  const int failure = posix_spawn(&child, LIMBER_PROGRAM, &files, nullptr, null_ended(words).data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failure != 0) throw std::runtime_error(std::string("cannot start ") + LIMBER_PROGRAM);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), {}, text_of(err)};
}

nlohmann::json json_of(const Outcome& outcome) {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(lines_of(outcome.out).size(), 1U) << outcome.out;
  nlohmann::json json = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << outcome.out;
  return json;
}

std::vector<nlohmann::json> json_lines_of(const Outcome& outcome) {
  std::vector<nlohmann::json> rows;
  for (const std::string& line : lines_of(outcome.out)) rows.push_back(nlohmann::json::parse(line));
  return rows;
}

void expect_refused(const Words& arguments, const std::string& part_of_the_line) {
  std::string typed = "limber";
  for (const std::string& word : arguments) typed += ' ' + word;
  SCOPED_TRACE(typed);
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  ASSERT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
  EXPECT_EQ(outcome.err.find("limber: "), 0U) << outcome.err;
  EXPECT_EQ(outcome.err.back(), '\n');
  EXPECT_NE(outcome.err.find(part_of_the_line), std::string::npos) << outcome.err;
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

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& csv_line) {
  std::vector<std::string> cells(1);
  for (const char c : csv_line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<Row> table_of(const std::string& csv) {
  const std::vector<std::string> lines = lines_of(csv);
  std::vector<Row> rows;
  const std::vector<std::string> names = lines.empty() ? std::vector<std::string>{} : cells_of(lines.front());
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cells_of(lines[i]);
    EXPECT_EQ(cells.size(), names.size()) << lines[i];
    Row& row = rows.emplace_back();
    for (std::size_t c = 0; c < std::min(cells.size(), names.size()); ++c) row[names[c]] = cells[c];
  }
  return rows;
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

}  // namespace limber::program_tests
