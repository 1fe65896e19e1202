// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/real_time.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

namespace limber::program {

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

bool may_run_on(int core) {
  const std::vector<int> before = allowed_cores();
  const bool may = run_on({core});
  if (may) run_on(before);
  return may;
}

bool run_on(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(core, &set);
  return sched_setaffinity(0, sizeof(set), &set) == 0;
}

RealTimePriority::RealTimePriority() {
  constexpr unsigned long least_slack_ns = 1;
  prctl(PR_SET_TIMERSLACK, least_slack_ns);
  sched_param parameters{};
  parameters.sched_priority = fifo_priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) granted_.refusal = std::strerror(errno);
}

RealTimePriority::~RealTimePriority() {
  const sched_param parameters{};
  if (granted_) sched_setscheduler(0, SCHED_OTHER, &parameters);
  prctl(PR_SET_TIMERSLACK, 0UL);  // what the thread started with
}

MemoryLock::MemoryLock() {
  if (mlockall(MCL_CURRENT) != 0) granted_.refusal = std::strerror(errno);
}

MemoryLock::~MemoryLock() {
  if (granted_) munlockall();
}

}  // namespace limber::program
