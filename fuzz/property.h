// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace limber::fuzz {

/// Ends the process, with `text` on standard error, when a property does not hold.
inline void require(bool holds, const char* text) {
  if (holds) return;
  std::fprintf(stderr, "property violated: %s\n", text);
  std::abort();
}

/// The same with a second part that is only known at run time.
inline void require(bool holds, const char* text, const std::string& detail) {
  if (!holds) std::fprintf(stderr, "%s\n", detail.c_str());
  require(holds, text);
}

/// Whether a message is one line of text.
inline bool is_one_line(const std::string& text) {
  const std::string forbidden("\n\r\0", 3);
  return !text.empty() && text.find_first_of(forbidden) == std::string::npos;
}

}  // namespace limber::fuzz
