// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace limber::base {

/// Prefetches all cache lines of an object. To GCC a function that only prefetches has no effect: it drops calls of it,
/// unless such functions are always inlined.
template <typename T>
[[gnu::always_inline]] inline void prefetch(const T& object) {
  constexpr std::size_t line = 64;
  static_assert((sizeof(T) - 1) % line < alignof(T), "the last bytes may be in a line that is not prefetched");
  const char* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t i = 0; i < sizeof(T); i += line) __builtin_prefetch(bytes + i);
}

}  // namespace limber::base
