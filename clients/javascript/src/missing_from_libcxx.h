// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the library uses of C++20 and libc++ 13, that of Debian's Emscripten, does not have. Included before everything
// else that is compiled to WebAssembly, so that the sources of the library need not know.

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <type_traits>

namespace std {

#if !defined(__cpp_lib_bit_cast)
template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
#endif

#if !defined(__cpp_lib_smart_ptr_for_overwrite)
template <typename Array>
unique_ptr<Array> make_unique_for_overwrite(size_t count) {
  return unique_ptr<Array>(new remove_extent_t<Array>[count]);
}
#endif

#if _LIBCPP_VERSION < 14000
/// Pre: the format is `general`.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format, int precision) {
  const int size = snprintf(first, static_cast<size_t>(last - first), "%.*g", precision, value);
  return size < last - first ? to_chars_result{first + size, {}} : to_chars_result{last, errc::value_too_large};
}
#endif

}  // namespace std
