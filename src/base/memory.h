// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace limber::base {

/// For vectors whose new elements are written before they are read: resize() leaves them as they are, instead of
/// setting them to zeros. So the threads that write them are the first to touch their memory.
template <typename T>
struct UninitializedAllocator : std::allocator<T> {
  UninitializedAllocator() = default;
  template <typename U>
  UninitializedAllocator(const UninitializedAllocator<U>&) noexcept {}

  template <typename U>
  void construct(U* place) noexcept {
    static_assert(std::is_trivially_default_constructible_v<U>);
    ::new (static_cast<void*>(place)) U;
  }
  template <typename U, typename... Args>
  void construct(U* place, Args&&... args) {
    ::new (static_cast<void*>(place)) U(std::forward<Args>(args)...);
  }
};

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
