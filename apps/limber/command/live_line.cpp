// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/live_line.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include "command/text.h"
#include "verbs/real_time.h"

namespace limber::program {
namespace {

constexpr std::chrono::milliseconds redraw{500};

void show(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

LiveLine::LiveLine(std::vector<Loop> loops, int core)
    : loops_(std::move(loops)), core_(core), thread_([this](const std::stop_token& stops) { run(stops); }) {}

LiveLine::~LiveLine() {
  thread_.request_stop();
  thread_.join();
  show("\r\033[K");
}

void LiveLine::run(const std::stop_token& stops) {
  std::vector<int> others = allowed_cores();
  std::erase(others, core_);
  if (!others.empty()) run_on(others);
  std::unique_lock lock(mutex_);
  while (!stops.stop_requested()) {
    draw();
    stopped_.wait_for(lock, stops, redraw, [] { return false; });
  }
}

void LiveLine::draw() {
  const Loop* now = nullptr;
  for (const Loop& loop : loops_) {
    if (loop.tick_count == 0) continue;
    if (now == nullptr || loop.progress->done.load(std::memory_order_relaxed) > 0) now = &loop;
  }
  if (now == nullptr) return;
  const double longest_us = 1e-3 * now->progress->longest_work.exchange(0, std::memory_order_relaxed);
  show(fmt::format("\r\033[K{}: tick {} of {}, {} missed, longest work of late {}", now->name,
                   grouped(now->progress->done.load(std::memory_order_relaxed)), grouped(now->tick_count),
                   grouped(now->progress->missed.load(std::memory_order_relaxed)), duration_text(longest_us)));
}

}  // namespace limber::program
