// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "limber/base.h"

namespace limber::program {

/// Bad usage or bad input: the program says the text on one line and exits with 2.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The value, or its error as BadInput, after `prefix`.
template <typename T>
T value_or_bad_input(Result<T> result, const std::string& prefix = {}) {
  if (!result) throw BadInput(prefix + result.error().text);
  return std::move(result).value();
}
inline void value_or_bad_input(const Result<void>& result, const std::string& prefix = {}) {
  if (!result) throw BadInput(prefix + result.error().text);
}

}  // namespace limber::program
