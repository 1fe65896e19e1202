// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

/// What the operating system can be asked for by a thread that must not be late. All of it is optional: a refusal is
/// told, not thrown.
namespace limber::program {

/// The cores that the calling thread runs on, in ascending order. Cores that the kernel keeps free are not among them.
std::vector<int> allowed_cores();

/// Whether the calling thread may be told to run on a core, be it kept free.
bool may_run_on(int core);

/// Lets the calling thread, and those that it starts, run on these cores only. Returns whether it may.
bool run_on(const std::vector<int>& cores);

/// An empty reason where something was granted; otherwise why it was not.
struct Granted {
  std::string refusal;
  explicit operator bool() const { return refusal.empty(); }
};

inline constexpr int fifo_priority = 80;  ///< above the interrupt threads of a real-time kernel, which have 50

/// Gives the calling thread the scheduling policy SCHED_FIFO while an object lives, and in any case sleeps that end on
/// time: the kernel lets ordinary threads sleep up to 50 us longer, to wake several at once.
class RealTimePriority {
 public:
  RealTimePriority();
  ~RealTimePriority();
  RealTimePriority(const RealTimePriority&) = delete;
  RealTimePriority& operator=(const RealTimePriority&) = delete;

  const Granted& granted() const { return granted_; }

 private:
  Granted granted_;
};

/// Keeps in memory what the process has mapped, its code and stacks included, while an object lives.
class MemoryLock {
 public:
  MemoryLock();
  ~MemoryLock();
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  const Granted& granted() const { return granted_; }

 private:
  Granted granted_;
};

}  // namespace limber::program
