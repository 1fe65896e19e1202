// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "command/stopwatch.h"

namespace limber::program {

/// A bar on standard error that shows how many of something are done, if that is a terminal; otherwise silent.
class ProgressBar {
 public:
  /// `unit` is their name in the plural.
  ProgressBar(std::size_t count, const char* unit);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Removes the bar, so that a line can be written in its place.
  void clear();

  /// Draws the bar unless it was drawn a moment ago and still stands.
  void draw(std::size_t done);

 private:
  std::size_t count_;
  const char* unit_;
  bool is_shown_;  // whether there is a terminal
  bool stands_ = false;
  Stopwatch since_drawn_;
};

}  // namespace limber::program
