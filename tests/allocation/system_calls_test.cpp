// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Ticks in real time make no system call but to read the clock, so they take no lock that may wait, either.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

constexpr int cannot_filter = 77;

/// From now on, any system call but those to read the clock and to exit ends the process with the signal SIGSYS.
bool allow_only_the_clock() {
  std::array filter = {sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                       sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clock_gettime, 1, 0),
                       sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_exit_group, 0, 1),
                       sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
                       sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS)};
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// How a child process ends that works under the filter, as waitpid() says it.
template <typename Work>
int end_of_filtered(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    if (!allow_only_the_clock()) _exit(cannot_filter);
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(SystemCalls, AreNotMadeInRealTimeButToReadTheClock) {
#if defined(LIMBER_CHECKS) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "checks of commits allocate, and sanitizers make system calls of their own";
#endif
  Model sheet(scenes::grid(64, 64, 0, 0, 1, 1), ModelOptions::real_time(20));
  const Model ball(scenes::thesis_ball());
  QueryCache cache;
  scenes::Rng rng(9);
  const auto tick = [&] {
    std::array<VertexId, 20> ids;
    std::array<Vec3, 20> positions;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = static_cast<VertexId>(rng.below(sheet.mesh().positions().size()));
      positions[i] = sheet.mesh().positions()[ids[i]] + Vec3{0, 0, rng.uniform(-0.5, 0.5)};
    }
    sheet.move_vertices(ids, positions).value();
    sheet.commit();
    const QueryBudget time{.deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(20)};
    static_cast<void>(distance({sheet}, {ball, {{}, {32, 32, 1.7}}}, {.cache = &cache, .budget = time}));
  };
  tick();
  const int end = end_of_filtered([&] {
    for (int i = 0; i < 2000; ++i) tick();
  });
  if (WIFEXITED(end) && WEXITSTATUS(end) == cannot_filter) GTEST_SKIP() << "this kernel has no seccomp filters";
  EXPECT_TRUE(WIFEXITED(end) && WEXITSTATUS(end) == 0) << "ended by signal " << WTERMSIG(end);
  const int of_another = end_of_filtered([] { syscall(__NR_getpid); });
  EXPECT_TRUE(WIFSIGNALED(of_another) && WTERMSIG(of_another) == SIGSYS);
}

}  // namespace
}  // namespace limber::testing
