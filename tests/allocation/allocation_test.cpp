// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries do not touch the heap: this executable counts every allocation.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "limber/model.h"
#include "scenes/scenes.h"

namespace {

std::atomic<std::size_t> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace limber::testing {
namespace {

/// One of each query at every separation, near, touching and overlapping included.
void ask_everything(const Model& square, const Model& ball, Pair& pair) {
  for (const double separation : {8.0, 1.0, 0.01, 0.0, -0.5}) {
    const Placed a{square}, b{ball, scenes::ball_over_square(ball.mesh(), separation, 0)};
    distance(a, b);
    distance(a, b, {.relative_error = 0.1, .absolute_error = 0.01});
    distance(a, b, {.max_distance = 0.5});
    distance(a, b, {}, pair);
    collide(a, b);
    collide(a, b, pair);
    within(a, b, 0.5);
    within(a, b, 0.5, pair);
  }
}

TEST(Allocation, IsSeenByThisTest) {
  const std::size_t before = allocations;
  const Model model(scenes::thesis_ball());
  EXPECT_GT(allocations, before);
}

TEST(Allocation, DoesNotHappenInAWarmQuery) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  Pair pair;
  ask_everything(square, ball, pair);
  const std::size_t before = allocations;
  ask_everything(square, ball, pair);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace limber::testing
