// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

/// The heap of this executable: operator new counts allocations and can be told to fail. The heap of oneTBB is not
/// included.
namespace limber::testing {

/// Allocations by all threads so far, failed ones included.
std::uint64_t allocation_count();

enum class Failing {
  once,    ///< one allocation fails
  always,  ///< it and all that follow fail
};

/// While an object lives, allocation `first` (0 is the next one) by any thread throws std::bad_alloc. There may be one
/// object at a time.
class FailingHeap {
 public:
  FailingHeap(std::int64_t first, Failing failing);
  FailingHeap(const FailingHeap&) = delete;
  FailingHeap& operator=(const FailingHeap&) = delete;
  ~FailingHeap();

  /// Whether an allocation has failed.
  bool has_failed() const;
};

}  // namespace limber::testing
