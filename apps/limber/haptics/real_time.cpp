// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/real_time.h"

#if defined(__linux__)
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>
#endif

namespace limber::program {

#if defined(__linux__)

bool run_on(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(core, &set);
  return sched_setaffinity(0, sizeof(set), &set) == 0;
}

std::vector<int> allowed_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cores;
  sched_getaffinity(0, sizeof(set), &set);  // fails on machines of more cores than a set has; then no core is known
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  }
  return cores;
}

RealTime::RealTime() {
  if (mlockall(MCL_CURRENT) != 0) locked_memory.refusal = std::strerror(errno);
  constexpr unsigned long least_slack_ns = 1;
  prctl(PR_SET_TIMERSLACK, least_slack_ns);
  sched_param parameters{};
  parameters.sched_priority = fifo_priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) priority.refusal = std::strerror(errno);
}

RealTime::~RealTime() {
  const sched_param parameters{};
  if (priority) sched_setscheduler(0, SCHED_OTHER, &parameters);
  prctl(PR_SET_TIMERSLACK, 0UL);  // what the thread started with
  if (locked_memory) munlockall();
}

#else

bool run_on(const std::vector<int>& cores) { return cores == std::vector<int>{0}; }

std::vector<int> allowed_cores() { return {0}; }

RealTime::RealTime() { priority.refusal = locked_memory.refusal = "asked for on Linux alone"; }

RealTime::~RealTime() = default;

#endif

bool may_run_on(int core) {
  const std::vector<int> before = allowed_cores();
  const bool may = run_on({core});
  if (may) run_on(before);
  return may;
}

}  // namespace limber::program
