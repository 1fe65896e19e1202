// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>

#include "run_program.h"

namespace limber::program_tests {
namespace {

TEST(ProgramUses, TheCommandsOfThePageRun) {
  const Folder folder;
  std::string script = "set -e\ncd '" + folder.path("") + "'\nlimber() { '" LIMBER_PROGRAM "' \"$@\"; }\n";
  bool is_command = false;
  for (const std::string& line : lines_of(text_of(LIMBER_SOURCE_DIR "/docs/guide/uses.md"))) {
    if (line.starts_with("```")) {
      is_command = line == "```sh";
    } else if (is_command) {
      script += line + "\n";
    }
  }
  EXPECT_GE(count_of("\nlimber ", script), 6U) << script;
  const std::string command = "sh '" + folder.store("uses.sh", script) + "' >'" + folder.path("out") + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << text_of(folder.path("out"));
}

}  // namespace
}  // namespace limber::program_tests
