// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_close_elements.

#if defined(LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#undef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#else
#define LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#endif

#include "base/check.h"
#include "kernels/close_elements-inl.h"
#include "kernels/project-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

LIMBER_KERNEL void find_close_elements(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                       const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                       const SelfPair* self, ElementCandidates& found) {
  LIMBER_ASSERT(!pruning.has_direction);
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  const ProjectedLeaves pair = self != nullptr ? project_leaves<true>(a, b, transform, pruning)
                                               : project_leaves<false>(a, b, transform, pruning);
  LeafCorners ca[1], cb[1];
  unpack(*a.triangles, pair.step_a, ca[0]);
  if (self != nullptr) {
    unpack(*b.triangles, pair.step_b, cb[0]);
    shift_corners(cb[0], pair.offset, cb[0]);
  } else {
    unpack(*b.triangles, pair.step_b, transform, pair.offset, cb[0]);
  }
  find_elements(ca, cb, pair.prune_distance + pair.error, owned_by_a, owned_by_b, self, found);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
