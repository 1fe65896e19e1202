// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

/// What every fuzz target defines: runs one input, and ends the process when a property does not hold.
///
/// libFuzzer calls it with inputs of its making, replay_main.cpp with files. The name is libFuzzer's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace limber::fuzz {

/// Ends the process, with `text` and what is only known at run time on standard error, when a property does not hold.
inline void require(bool holds, const char* text, const std::string& detail = "") {
  if (holds) return;
  if (!detail.empty()) std::fprintf(stderr, "%s\n", detail.c_str());
  std::fprintf(stderr, "property violated: %s\n", text);
  std::abort();
}

/// Whether a message is one line of text.
inline bool is_one_line(const std::string& text) {
  const std::string forbidden("\n\r\0", 3);
  return !text.empty() && text.find_first_of(forbidden) == std::string::npos;
}

}  // namespace limber::fuzz
