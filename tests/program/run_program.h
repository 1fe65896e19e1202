// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "limber/mesh.h"

/// Runs the built program as users do: arguments in; standard output, standard error and exit code out.
namespace limber::program_tests {

using Words = std::vector<std::string>;

struct Outcome {
  int exit_code = -1;  ///< 128 + the signal's number when a signal ended it
  std::string out, err;
};

/// Runs the program with neither stream on a terminal.
Outcome run(const Words& arguments);

/// The same with standard output going to a file or device, so that `out` stays empty.
Outcome run_into(const std::string& file, const Words& arguments);

/// The one line of JSON that a successful run prints; fails the test on anything else.
nlohmann::json json_of(const Outcome& outcome);

/// The objects of an answer with one in each line, whatever the exit code.
std::vector<nlohmann::json> json_lines_of(const Outcome& outcome);

/// Everything that may be typed wrongly must end with exit code 2, one line that names the place, and no answer.
void expect_refused(const Words& arguments, const std::string& part_of_the_line);

/// The text of a file; empty where there is none.
std::string text_of(const std::string& file);

std::size_t count_of(const std::string& part, const std::string& text);
std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> cells_of(const std::string& csv_line);

/// The rows of CSV by the names in its first line. No cell has a comma.
using Row = std::map<std::string, std::string>;
std::vector<Row> table_of(const std::string& csv);

/// A number as the program writes it.
double number(const std::string& text);

/// A folder for one test, empty at first and removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// Stores a text and returns the file's path.
  std::string store(const std::string& name, const std::string& text) const;

  /// Stores a mesh as OBJ, all digits of it, and returns the file's path.
  std::string store(const std::string& name, MeshView mesh) const;

 private:
  std::filesystem::path path_;
};

/// The words that follow one frame after the other of two lists of files.
inline Words track(const Words& a, const Words& b, const Words& options) {
  Words words = {"track", "--a"};
  words.insert(words.end(), a.begin(), a.end());
  words.emplace_back("--b");
  words.insert(words.end(), b.begin(), b.end());
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

/// A point that the program has written as three numbers.
inline Vec3 point_of(const nlohmann::json& json) { return {json.at(0), json.at(1), json.at(2)}; }

}  // namespace limber::program_tests
