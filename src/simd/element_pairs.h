// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "layout/node.h"
#include "limber/math.h"

/// What the kernels read and write that compare elements of leaves, and triangles of one tree with each other.
namespace limber::simd {

using bvh::width;

/// Two leaves of one tree that is compared with itself; both may be the same leaf.
struct SelfPair {
  const bvh::Leaf &a, &b;
};

/// The elements that the triangles of a leaf own: those that they represent (Access::represented_by()). A byte for
/// each slot: bit k is the vertex of corner k, bit 3 + k the edge from corner k to the next. A slot that is not in use
/// owns nothing.
struct OwnedElements {
  static constexpr std::uint64_t is_in_use = 0x40;  ///< set in the byte of every slot that is in use

  std::uint64_t of_slots;
};

/// An element of each of two leaves, as corner * width + slot. A vertex is named by its corner, an edge by the corner
/// where it starts, a face by corner 0.
struct ElementCandidate {
  std::uint8_t a, b;
};

/// Pairs of elements of two leaves that are not pruned.
struct ElementCandidates {
  template <std::size_t room>
  struct List {
    std::uint32_t count;
    ElementCandidate pairs[room + 1];  // one more: kernels write every pair, and count it only if it is not pruned
  };
  List<3 * width * width> vertex_face, face_vertex;
  List<9 * width * width> edge_edge;
};

/// Pairs of moving elements of one kind, by their vectors u, v and w (motion/moving_elements.h) at the start and at the
/// end. Entries that are not in use must be finite.
struct MovingPairs {
  static constexpr std::uint32_t room = 4;
  Vec3 u[2][room]{}, v[2][room]{}, w[2][room]{};
};

/// What a query of two moving models prunes: pairs that are farther apart than `separation` at every time from `begin`
/// to `end`. At any pace: wherever each vertex is on its way, whatever the others do; the times then do not count.
struct MotionLimits {
  double begin, end, separation;
  bool at_any_pace = false;
};

/// Of each child slot, bounds of the times at which it is within a separation of something: none before `first`, none
/// after `last`.
struct MeetingTimes {
  double first[width], last[width];
};

}  // namespace limber::simd
