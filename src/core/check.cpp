// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/check.h"

#include <atomic>
#include <stdexcept>
#include <string>

#include "limber/base.h"

namespace limber {
namespace {

void throw_violation(const char* expression, const char* file, int line) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": precondition violated: " + expression);
}

std::atomic<AssertHandler> current_handler{throw_violation};

}  // namespace

AssertHandler set_assert_handler(AssertHandler handler) {
  return current_handler.exchange(handler != nullptr ? handler : throw_violation);
}

namespace core {

void report_violation(const char* expression, const char* file, int line) {
  current_handler.load()(expression, file, line);
}

void throw_invalid_argument(const char* text) { throw std::invalid_argument(text); }

}  // namespace core
}  // namespace limber
