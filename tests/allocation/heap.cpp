// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "heap.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace limber::testing {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

std::atomic<std::uint64_t> allocations{0};
std::atomic<std::int64_t> until_failure{never};
std::atomic<bool> fails_always{false};
std::atomic<bool> failed{false};

bool fails_now() {
  if (until_failure.load() == never) return false;
  const std::int64_t left = until_failure.fetch_sub(1);
  const bool fails = left == 0 || (left < 0 && fails_always);
  if (fails) failed = true;
  return fails;
}

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  if (fails_now()) throw std::bad_alloc();
  void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

std::uint64_t allocation_count() { return allocations; }

FailingHeap::FailingHeap(std::int64_t first, Failing failing) {
  failed = false;
  fails_always = failing == Failing::always;
  until_failure = first;
}
FailingHeap::~FailingHeap() { until_failure = never; }

bool FailingHeap::has_failed() const { return failed; }

}  // namespace limber::testing

void* operator new(std::size_t size) { return limber::testing::allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return limber::testing::allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
