// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

/// What a loop asks of the operating system. Systems other than Linux have one core here, number 0, which stands for
/// all of them, and grant nothing.
namespace limber::program {

/// The cores that the calling thread runs on, in ascending order. Cores that the kernel keeps free are not among them.
std::vector<int> allowed_cores();

/// Lets the calling thread, and those that it starts, run on these cores only. Returns whether it may.
bool run_on(const std::vector<int>& cores);

/// Whether the calling thread may be told to run on a core, be it kept free.
bool may_run_on(int core);

/// An empty reason where something was granted; otherwise why it was not.
struct Granted {
  std::string refusal;
  explicit operator bool() const { return refusal.empty(); }
};

inline constexpr int fifo_priority = 80;  ///< above the interrupt threads of a real-time kernel, which have 50

/// While an object lives, what the process has mapped stays in memory, its code and stacks included, and the calling
/// thread has the scheduling policy SCHED_FIFO, where both are granted. In any case its sleeps end on time: the kernel
/// lets ordinary threads sleep up to 50 us longer, to wake several at once.
class RealTime {
 public:
  RealTime();
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  Granted priority, locked_memory;
};

}  // namespace limber::program
