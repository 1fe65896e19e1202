// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Highway's way of compiling one source for many instruction sets and choosing at run time.
// Differs   Whole kernels are dispatched, through one table, so the traversal exists once.
#include "simd/kernels.h"

#if defined(__GNUC__) && !defined(__clang__) && !defined(__OPTIMIZE__)
#error "GCC 12 loses vectors that functions return unless it optimizes: compile this file with -O1 or more"
#endif

#include <atomic>
#include <vector>

// Every 64-bit ARM processor has the vectors of NEON, so that there is nothing to choose at run time. The macros tell
// Highway so, each on its systems. It would otherwise mark functions by an attribute that compilers do not give to
// constructors that they make.
#if defined(__aarch64__) && defined(__APPLE__)
#define HWY_HAVE_RUNTIME_DISPATCH 0
#elif defined(__aarch64__)
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif
// Vectors whose size is not known cannot be members.
#define LIMBER_UNFIT_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#if defined(LIMBER_FEWER_KERNELS)  // of x86, SSSE3 and AVX2; Highway gives better sets lower bits
#define HWY_DISABLED_TARGETS (LIMBER_UNFIT_TARGETS | (HWY_AVX2 - 1) | HWY_SSE4)
#else
#define HWY_DISABLED_TARGETS LIMBER_UNFIT_TARGETS
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/all-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limber::simd::HWY_NAMESPACE {

const Kernels* kernel_table() {
  static const Kernels set = table(hwy::TargetName(HWY_TARGET));
  return &set;
}

}  // namespace limber::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limber::simd {
namespace {

#if defined(__EMSCRIPTEN__)  // has one instruction set, and nothing to choose at run time
const Kernels& best_kernels() { return *HWY_STATIC_DISPATCH(kernel_table)(); }

std::vector<Kernels> find_all() { return {best_kernels(), scalar_kernels}; }
#else
HWY_EXPORT(kernel_table);

const Kernels& best_kernels() {
  static const Kernels best = *HWY_DYNAMIC_DISPATCH(kernel_table)();
  return best;
}

std::vector<Kernels> find_all() {
  std::vector<Kernels> found;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    found.push_back(*HWY_DYNAMIC_DISPATCH(kernel_table)());
  }
  hwy::SetSupportedTargetsForTest(0);
  found.push_back(scalar_kernels);
  return found;
}
#endif

std::atomic<const Kernels*> chosen_kernels{nullptr};

}  // namespace

const Kernels& kernels() {
  const Kernels* const chosen = chosen_kernels.load(std::memory_order_acquire);
  return chosen != nullptr ? *chosen : best_kernels();
}

std::span<const Kernels> all_kernels() {
  static const std::vector<Kernels> found = find_all();
  return found;
}

void use_kernels(const Kernels* chosen) { chosen_kernels.store(chosen, std::memory_order_release); }

}  // namespace limber::simd
#endif
