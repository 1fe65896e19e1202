// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "run_program.h"

namespace limber::program_tests {

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

}  // namespace limber::program_tests
