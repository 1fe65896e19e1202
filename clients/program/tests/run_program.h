// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "formats/scenes.h"
#include "limber/mesh.h"

/// Runs the built program as users do: a command line in; standard output, standard error and exit code out.
///
/// Lines are those of a shell, without the name of the program.
namespace limber::program_tests {

namespace scenes = program::scenes;

using Words = std::vector<std::string>;

struct Outcome {
  int exit_code = -1;  ///< of the program, or -1
  std::string out, err;
};

/// Runs the program with neither stream on a terminal.
Outcome run(const std::string& line);

/// Runs the program with standard output going to a file or device, so that `out` stays empty.
Outcome run_into(const std::string& file, const std::string& line);

/// What a run without warnings prints.
std::string answer_to(const std::string& line);

/// The one line of JSON that such a run prints; fails the test on anything else. The line is run with --json.
nlohmann::json json_of(const std::string& line);

/// The objects of an answer with one in each line, whatever the exit code.
std::vector<nlohmann::json> json_lines_of(const Outcome& outcome);

/// The objects of a run that must succeed. The line is run with --json.
std::vector<nlohmann::json> json_rows_of(const std::string& line);

/// Everything that may be typed wrongly must end with exit code 2, one line that names the place, and no answer.
void expect_refused(const std::string& line, const std::string& part_of_the_error);

/// Pairs of arguments, which follow the `start` of expect_all_refused(), and a part of the error that they give.
using Refusals = std::vector<std::pair<std::string, std::string>>;
void expect_all_refused(const std::string& start, const Refusals& refusals);

/// The text of a file; empty where there is none.
std::string text_of(const std::string& file);

std::size_t count_of(const std::string& part, const std::string& text);
Words lines_of(const std::string& text);
Words keys_of(const nlohmann::json& json);  // in alphabetical order

/// The words with blanks between them.
std::string joined(const Words& words);

/// The rows of CSV by the names in its first line. No cell has a comma.
using Row = std::map<std::string, std::string>;
std::vector<Row> table_of(const std::string& csv);

/// A row of CSV has the values of an object: cells of an array x, y, z start with its name, those of an object have the
/// names of its values, and cells of null are empty. Times are those of other runs.
void expect_same(const Row& row, const nlohmann::json& json, const std::string& prefix = {});

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

/// A run that must succeed, and the page that it has written. What stands in the page as bytes, meshes and poses, is
/// looked at by clients/pages/tests/data.test.mjs.
struct Report {
  Folder folder;
  Outcome outcome;
  std::string page;
  nlohmann::json data;

  /// Completes the line by `--report` and the path.
  explicit Report(const std::string& line);
};

/// A point that the program has written as three numbers.
inline Vec3 point_of(const nlohmann::json& json) { return {json.at(0), json.at(1), json.at(2)}; }

}  // namespace limber::program_tests
