// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if defined(LIMBER_THREADS)
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>
#endif

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"

/// Work on several threads, over oneTBB; in builds without LIMBER_THREADS, on the caller's alone. Callers arrange that
/// results do not depend on who runs what. Every body runs in the default floating-point environment: the caller's own
/// thread must be in it, and what oneTBB calls is put into it.
namespace limber::base {

/// Whether the calling arena has several threads.
inline bool has_several_threads() {
#if defined(LIMBER_THREADS)
  return oneapi::tbb::this_task_arena::max_concurrency() > 1;
#else
  return false;
#endif
}

/// A body for oneTBB, which calls it in the environment that its pool of threads was started in.
template <typename Body>
auto in_default_environment(const Body& body) {
  return [body](const auto&... arguments) {
    const DefaultFloatEnvironment environment;
    return body(arguments...);
  };
}

/// Calls body(i) for every i below `count`. A task has at least about half of `grain` of them; no more than `grain` are
/// not divided.
template <typename Body>
void parallel_for(std::size_t count, [[maybe_unused]] std::size_t grain, const Body& body) {
#if defined(LIMBER_THREADS)
  if (count > grain) {
    const auto body_of_range = in_default_environment([&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
    return oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, grain), body_of_range);
  }
#endif
  for (std::size_t i = 0; i < count; ++i) body(i);
}

/// Calls body(begin, end) for ranges of `size` numbers, the last one shorter, that together are those below `count`.
template <typename Body>
void parallel_for_ranges(std::size_t count, std::size_t size, const Body& body) {
  LIMBER_ASSERT(size > 0);
  parallel_for((count + size - 1) / size, 1, [&](std::size_t i) { body(i * size, std::min(count, (i + 1) * size)); });
}

/// Calls body(state, i) for every i below `count`. Each thread has a state of its own, make(), and takes the next i
/// that is left, so that none is idle while others have many.
template <typename Make, typename Body>
void parallel_for_with(std::size_t count, const Make& make, const Body& body) {
  std::atomic<std::size_t> next = 0;
  const auto take_all = [&](std::size_t) {
    std::size_t i = next++;
    if (i >= count) return;
    for (auto state = make(); i < count; i = next++) body(state, i);
  };
  std::size_t threads = 1;
#if defined(LIMBER_THREADS)
  threads = static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency());
#endif
  parallel_for(std::min(count, threads), 1, take_all);
}

/// Calls make(i, made) for every i below `count`, several at a time, and then take(made) one after the other, in order,
/// while others are made. Each `made` is worth a task, and used again and again: take() leaves it as make() wants it.
template <typename Made, typename Make, typename Take>
void parallel_in_order(std::size_t count, const Make& make, const Take& take) {
#if defined(LIMBER_THREADS)
  if (count > 1 && has_several_threads()) {
    // At most `places` calls are under way, with consecutive numbers, so no two of them share a place. There are four
    // for each thread: a slow one does not leave the others idle.
    const std::size_t places = 4 * static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency());
    std::vector<Made> made(places);
    std::size_t next = 0;
    const auto start = [&](oneapi::tbb::flow_control& control) {
      if (next == count) control.stop();
      return next++;
    };
    const auto make_one = in_default_environment([&](std::size_t i) {
      make(i, made[i % places]);
      return i;
    });
    const auto take_one = in_default_environment([&](std::size_t i) { take(made[i % places]); });
    using oneapi::tbb::filter_mode, oneapi::tbb::make_filter;
    const auto filters = make_filter<void, std::size_t>(filter_mode::serial_in_order, start) &
                         make_filter<std::size_t, std::size_t>(filter_mode::parallel, make_one) &
                         make_filter<std::size_t, void>(filter_mode::serial_in_order, take_one);
    return oneapi::tbb::parallel_pipeline(places, filters);
  }
#endif
  Made made;
  for (std::size_t i = 0; i < count; ++i) {
    make(i, made);
    take(made);
  }
}

/// Calls both, at the same time if either is worth a task.
template <typename First, typename Second>
void parallel_invoke([[maybe_unused]] bool is_worth_a_task, const First& first, const Second& second) {
#if defined(LIMBER_THREADS)
  if (is_worth_a_task) {
    return oneapi::tbb::parallel_invoke(in_default_environment(first), in_default_environment(second));
  }
#endif
  first();
  second();
}

}  // namespace limber::base
