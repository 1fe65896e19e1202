// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if defined(LIMBER_THREADS)
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_arena.h>
#endif

#include <algorithm>
#include <cstddef>

#include "base/float_environment.h"

/// Work on several threads, over oneTBB; in builds without LIMBER_THREADS, on the caller's alone. Callers arrange that
/// results do not depend on who runs what. Every body runs in the default floating-point environment, which a pool of
/// threads need not have been started in.
namespace limber::base {

/// Whether the calling arena has several threads.
inline bool has_several_threads() {
#if defined(LIMBER_THREADS)
  return oneapi::tbb::this_task_arena::max_concurrency() > 1;
#else
  return false;
#endif
}

/// Calls body(i) for every i below `count`, in chunks of about `grain`.
template <typename Body>
void parallel_for(std::size_t count, [[maybe_unused]] std::size_t grain, const Body& body) {
#if defined(LIMBER_THREADS)
  if (count > grain) {
    return oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      const DefaultFloatEnvironment environment;
      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
  }
#endif
  for (std::size_t i = 0; i < count; ++i) body(i);
}

/// Calls body(begin, end) for ranges of `size` numbers, the last one shorter, that together are those below `count`.
template <typename Body>
void parallel_for_ranges(std::size_t count, std::size_t size, const Body& body) {
  parallel_for((count + size - 1) / size, 1, [&](std::size_t i) { body(i * size, std::min(count, (i + 1) * size)); });
}

/// Calls both, at the same time if `worthwhile`.
template <typename First, typename Second>
void parallel_invoke([[maybe_unused]] bool worthwhile, const First& first, const Second& second) {
#if defined(LIMBER_THREADS)
  const auto in_default_environment = [](const auto& body) {
    return [&body] {
      const DefaultFloatEnvironment environment;
      body();
    };
  };
  if (worthwhile) {
    return oneapi::tbb::parallel_invoke(in_default_environment(first), in_default_environment(second));
  }
#endif
  first();
  second();
}

}  // namespace limber::base
