// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The work of a tick: what it promises about forces, memory and system calls.
#include "haptics/haptic_scene.h"

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <oneapi/tbb/global_control.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <vector>

#include "allocation/heap.h"
#include "haptics/haptic_models.h"

namespace limber::program {
namespace {

constexpr std::chrono::seconds long_enough{10};

HapticOptions small_scene() {
  HapticOptions options;
  options.tissue_triangles = 10'000;
  options.tool_triangles = 1000;
  options.rate_hz = 250;
  options.tick_budget = long_enough;
  return options;
}

TEST(HapticScene, GivesForcesOnlyInContactAndNeverMeets) {
  HapticScene scene(small_scene());
  double largest = 0;
  int free_ticks = 0;
  for (std::uint64_t n = 0; n < 500; ++n) {
    const Transform device = scene.device(n);
    const Transform tool_pose{device.rotation, scene.proxy().place()};
    TickSample sample;
    scene.tick(n, sample);
    // The interval is that of the tool at the place that the proxy had, over the tissue as it is now.
    const double truth = distance({scene.tissue()}, {scene.tool(), tool_pose}).upper;
    EXPECT_LE(sample.lower, truth * (1 + 1e-6));
    EXPECT_GE(sample.upper, truth * (1 - 1e-6));
    ASSERT_NE(sample.status, DistanceStatus::collision) << n;
    const Vec3 tip = tip_at(device);
    const double height = tip.z - resting_height(tip.x, tip.y);
    if (height > 1.5) {
      ++free_ticks;
      EXPECT_EQ(sample.force_n, 0) << n;
    }
    if (height < -2.9) {
      EXPECT_GT(sample.force_n, stiffness_n_per_mm * 0.9);  // a third of 3 mm, without the waves
    }
    largest = std::max(largest, static_cast<double>(sample.force_n));
  }
  EXPECT_GT(free_ticks, 150);
  EXPECT_LT(largest, 1.5);
}

TEST(HapticScene, DeformsTissueByTheNumberOfTheTickAlone) {
  HapticOptions hasty = small_scene();
  hasty.tick_budget = std::chrono::nanoseconds(1);
  HapticScene scene(small_scene()), hurried(hasty);
  std::uint64_t interrupted = 0;
  EXPECT_EQ(scene.warm_up(), hurried.warm_up());
  for (std::uint64_t n = 500; n < 800; ++n) {
    TickSample sample;
    scene.tick(n, sample);
    EXPECT_NE(sample.status, DistanceStatus::interrupted);
    hurried.tick(n, sample);
    if (sample.status == DistanceStatus::interrupted) ++interrupted;
  }
  EXPECT_GT(interrupted, 50U);
  EXPECT_EQ(scene.tissue().mesh().positions(), hurried.tissue().mesh().positions());
  EXPECT_NE(scene.tissue().mesh().positions(), HapticScene(small_scene()).tissue().mesh().positions());
}

TEST(HapticScene, ComparesItsTreeWithANewOne) {
  HapticScene scene(small_scene());
  EXPECT_NEAR(node_tests_over_new_tree(scene), 1, 1e-12);
  HapticOptions options = small_scene();
  options.tissue_model.rebuild_policy = RebuildPolicy::off;
  HapticScene refitted(options);
  TickSample sample;
  std::uint64_t n = 0;
  while (tip_at(refitted.device(n)).z > -2) ++n;
  refitted.tick(n, sample);
  EXPECT_NE(node_tests_over_new_tree(refitted), 1);
}

/// Allocations of a commit of a model that is not rebuilt: those of its own checks, where they are on.
std::uint64_t allocations_of_commit(const Mesh& mesh) {
  Model model(mesh, {.rebuild_policy = RebuildPolicy::off});
  const auto allocations_after_move = [&model](double z) {
    model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{0, 0, z}}).value();
    const std::uint64_t before = testing::allocation_count();
    model.commit();
    return testing::allocation_count() - before;
  };
  allocations_after_move(1);
  return allocations_after_move(2);
}

TEST(HapticTick, AllocatesNothing) {
  HapticScene scene(small_scene());
  const std::uint64_t first = scene.warm_up(), of_commit = allocations_of_commit(scene.tissue().mesh());
#ifndef LIMBER_CHECKS
  EXPECT_EQ(of_commit, 0U);
#endif
  std::vector<TickSample> samples(500);
  TickProgress progress;
  const TickWork tick = [&scene](std::uint64_t n, TickSample& s) { scene.tick(n, s); };
  const std::uint64_t before = testing::allocation_count();
  run_ticks({std::chrono::microseconds(200), {}}, first, tick, samples, progress);
  const std::uint64_t during = testing::allocation_count() - before;
  EXPECT_LE(during, samples.size() * of_commit);
  std::uint64_t moved = 0;
  for (const TickSample& sample : samples) moved += sample.moved_vertices;
  EXPECT_GT(moved, 3000U);
}

constexpr int cannot_filter = 77;

/// From now on, any system call but those of a tick ends the process with the signal SIGSYS.
bool allow_only_system_calls_of_a_tick() {
  constexpr std::array allowed = {__NR_clock_nanosleep, __NR_clock_gettime, __NR_restart_syscall, __NR_exit_group};
  std::vector<sock_filter> filter;
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
  for (const int number : allowed) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(number), 0, 1));
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  }
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS));
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// How a child process ends that runs 500 ticks of this work under the filter, as waitpid() says it.
int end_of_filtered(std::uint64_t first, const TickWork& work) {
  std::vector<TickSample> samples(500);
  TickProgress progress;
  const pid_t child = fork();
  if (child == 0) {
    if (!allow_only_system_calls_of_a_tick()) _exit(cannot_filter);
    run_ticks({std::chrono::microseconds(500), std::chrono::microseconds(20)}, first, work, samples, progress);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(HapticTick, MakesNoSystemCallsButTheClockAndTheSleep) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers make system calls of their own";
#endif
  using oneapi::tbb::global_control;
  const global_control one_thread(global_control::max_allowed_parallelism, 1);
  HapticScene scene(small_scene());
  const std::uint64_t first = scene.warm_up();
  const TickWork tick = [&scene](std::uint64_t n, TickSample& s) { scene.tick(n, s); };
  const int status = end_of_filtered(first, tick);
  if (WIFEXITED(status) && WEXITSTATUS(status) == cannot_filter) GTEST_SKIP() << "this kernel has no seccomp filters";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "ended by signal " << WTERMSIG(status);
  const int of_another = end_of_filtered(0, [](std::uint64_t n, TickSample&) {
    if (n == 250) syscall(__NR_getpid);
  });
  EXPECT_TRUE(WIFSIGNALED(of_another) && WTERMSIG(of_another) == SIGSYS);
}

}  // namespace
}  // namespace limber::program
