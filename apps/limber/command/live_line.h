// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "haptics/tick_loop.h"

namespace limber::program {

/// A line on standard error, redrawn twice a second while loops run.
///
/// A thread of its own writes it, on other cores where there are any, and without priority. It only looks at a
/// TickProgress, so a terminal that is slow delays nothing; each look costs a loop one or two cache misses.
class LiveLine {
 public:
  struct Loop {
    const char* name;
    std::size_t tick_count;
    TickProgress* progress;
  };

  /// The loops run one after the other, on `core`. What `loops` points to outlives the line.
  LiveLine(std::vector<Loop> loops, int core);
  /// Removes the line.
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

 private:
  void run(const std::stop_token& stops);
  void draw();

  std::vector<Loop> loops_;
  int core_;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread thread_;
};

}  // namespace limber::program
