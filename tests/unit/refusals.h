// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace limber::testing {

/// Whether a call throws std::invalid_argument, with a text that has these parts.
template <typename Call>
::testing::AssertionResult is_refused(const Call& call, std::initializer_list<std::string> parts) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    for (const std::string& part : parts) {
      if (text.find(part) == std::string::npos) return ::testing::AssertionFailure() << "the text is: " << text;
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace limber::testing
