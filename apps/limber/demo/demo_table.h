// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "command/stopwatch.h"
#include "demo/demo_run.h"

namespace limber::program {

/// Shows a running demonstration on standard output: on a terminal a table redrawn in place, otherwise a line now and
/// then.
class DemoTable {
 public:
  explicit DemoTable(std::size_t frame_count);

  void show(const std::vector<DemoFrame>& frames);

 private:
  void redraw(const std::vector<DemoFrame>& frames);

  std::size_t frame_count_;
  bool on_terminal_;
  bool stands_ = false;
  Stopwatch since_drawn_;
};

/// The summary of a run, as pairs of a name and a text with units.
std::vector<std::pair<std::string, std::string>> summary_rows(const DemoRun& run);

}  // namespace limber::program
