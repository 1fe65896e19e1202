// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// All kernels for one instruction set, and their table.

#if defined(LIMBER_SIMD_ALL_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_ALL_INL_H
#undef LIMBER_SIMD_ALL_INL_H
#else
#define LIMBER_SIMD_ALL_INL_H
#endif

#include "kernels/bound_children-inl.h"
#include "kernels/bound_point-inl.h"
#include "kernels/close_elements-inl.h"
#include "kernels/compare_triangles-inl.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/find_crossings-inl.h"
#include "kernels/find_impact_candidates-inl.h"
#include "kernels/fit_leaves-inl.h"
#include "kernels/merge_bounds-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

constexpr Kernels table(const char* name) {
#define LIMBER_ENTRY(Type, kernel) .kernel = (kernel),
  return {.name = name, LIMBER_FOR_ALL_KERNELS(LIMBER_ENTRY)};
#undef LIMBER_ENTRY
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
