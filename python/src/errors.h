// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <utility>

#include "limber/base.h"

/// Errors of the library as Python's exceptions.
namespace limber::python {

/// Raises the exception of limber3d.errors that stands for the error.
///
/// Pre      The GIL is held.
[[noreturn]] void raise(const Error& error);

template <typename T>
T value_or_raise(Result<T> result) {
  if (!result) raise(result.error());
  return std::move(result).value();
}

inline void value_or_raise(const Result<void>& result) {
  if (!result) raise(result.error());
}

}  // namespace limber::python
