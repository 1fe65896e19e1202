// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/check.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>

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

AssertHandler assert_handler() { return current_handler.load(); }

#ifdef LIMBER_LAYOUT
const char LIMBER_LAYOUT = 0;
#endif

BadResult::BadResult(Error error) : std::runtime_error(error.text), error_(std::move(error)) {}
BadResult::~BadResult() = default;

void throw_bad_result(const Error& error) { throw BadResult(error); }

namespace base {

void throw_invalid_argument(const char* text) { throw std::invalid_argument(text); }

void throw_invalid_entry(const char* list, std::size_t index, const char* text) {
  throw std::invalid_argument(std::string(list) + "[" + std::to_string(index) + "] " + text);
}

}  // namespace base
}  // namespace limber
