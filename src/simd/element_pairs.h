// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "layout/node.h"
#include "limber/geometry.h"
#include "limber/math.h"

/// What the kernels read and write that compare elements of leaves, triangles of one tree with each other, and
/// triangles and segments without a tree.
namespace limber::simd {

using bvh::width;

/// Two leaves of one tree that is compared with itself; both may be the same leaf.
struct SelfPair {
  const bvh::Leaf &a, &b;
  bool is_one_leaf() const { return &a == &b; }
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

/// Pairs of moving elements of one kind, by their vectors u, v and w (motion/element_impact.h) at the start and at the
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

/// A triangle with its edges, and for each edge a vector in the triangle's plane that is perpendicular to the edge and
/// points to the third corner. Vectors are not normalized. geometry::Face is derived from this.
struct FaceVectors {
  Triangle corner;             ///< all three corners
  std::array<Vec3, 3> edge;    ///< edge k goes from corner k to the next
  std::array<Vec3, 3> inward;  ///< inward[k] is perpendicular to edge k
};

/// Features of two triangles that may be closest: the closest pair of edges, and corners with the other face. The foot
/// of a corner is its projection on the plane of the other triangle.
struct TriangleFeatures {
  double distance_sq;            ///< of the closest edges; infinite if no distance is a number
  double at_a, at_b;             ///< the parameters of their closest points, from 0 to 1
  std::uint32_t edge_a, edge_b;  ///< the closest edges; of equally close pairs that with the least (edge_a, edge_b)
  unsigned feet_of_a;            ///< bit mask: corners of a whose foot is in triangle b
  unsigned feet_of_b;            ///< bit mask: corners of b whose foot is in triangle a
};

/// Pairs of triangles: corners by corner and pair. Entries that are not in use must be finite.
struct TrianglePairs {
  static constexpr std::uint32_t room = 4;
  Vec3 a[3][room]{}, b[3][room]{};
  double has_outside_a[room]{}, has_outside_b[room]{};  ///< 1 or 0
};

/// A point that two triangles share is on both within this part of the extent, where it is found the fast way: half of
/// what users are promised.
inline constexpr double shared_point_tolerance = 0x1p-49;

/// Where pairs of triangles cross, as geometry::closest_features() says, to the bit: the edge of one that crosses the
/// face of the other. Numbers of pairs that are not certain mean nothing.
struct Crossings {
  unsigned are_certain = 0;  ///< bit mask: these cross in the middle of edge and face, whatever rounding does
  unsigned are_of_a = 0;     ///< bit mask: the edge is one of a, and the face is b
  Vec3 point[TrianglePairs::room], weights_in_face[TrianglePairs::room];
  double edge[TrianglePairs::room], parameter[TrianglePairs::room];  ///< which edge, and where the point is on it
};

/// Two triangles hardly overlap where one reaches less behind the other than a 32nd of the smaller one's longest edge.
inline constexpr double shallow_part_sq = 1.0 / (32 * 32);

/// Normals and depths of geometry::contact(), of pairs of triangles that intersect. Numbers of pairs that are not
/// ordinary mean nothing.
struct LeastOverlaps {
  unsigned are_ordinary;  ///< bit mask: neither huge nor tiny, and no slivers; it does not depend on which is a
  unsigned are_outward;   ///< bit mask: the normal tells outside from inside
  Vec3 normal[TrianglePairs::room];
  double depth[TrianglePairs::room];
};

/// Pairs of segments. Entries that are not in use must be finite.
struct SegmentPairs {
  static constexpr std::uint32_t room = 16;
  Vec3 start_a[room]{}, end_a[room]{}, start_b[room]{}, end_b[room]{};
};

/// What geometry::closest_on() gives for pairs of segments, to the bit, if the pair's bit in `are_ordinary` is set.
/// Other pairs are so large, small or close that they have to be scaled (geometry::LocalFrame).
struct ClosestOfSegments {
  double distance[SegmentPairs::room], s[SegmentPairs::room], t[SegmentPairs::room];
  unsigned are_ordinary;
};

}  // namespace limber::simd
