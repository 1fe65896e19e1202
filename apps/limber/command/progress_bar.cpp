// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace limber::program {
namespace {

constexpr std::size_t bar_width = 40;
constexpr double bar_redraw_s = 0.1;

void show(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

ProgressBar::ProgressBar(std::size_t count, const char* unit)
    : count_(count), unit_(unit), is_shown_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (!stands_) return;
  show("\r\033[K");
  stands_ = false;
}

void ProgressBar::draw(std::size_t done) {
  if (!is_shown_ || (stands_ && done < count_ && since_drawn_.seconds() < bar_redraw_s)) return;
  const std::size_t filled = bar_width * done / count_;
  show(fmt::format("\r[{:#<{}}{:.<{}}] {}/{} {}", "", filled, "", bar_width - filled, done, count_, unit_));
  stands_ = true;
  since_drawn_ = Stopwatch();
}

}  // namespace limber::program
