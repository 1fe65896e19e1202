// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bvh/boxes.h"
#include "bvh/node.h"
#include "limber/geometry.h"

/// The SIMD kernels: bounds, and what they prune. Numbers that reach the user come from float64 routines.
///
/// Every operation is an IEEE one, none is fused, and SIMD lanes do not mix except in minima and maxima of numbers, so
/// all instruction sets give the same bits.
namespace limber::simd {

using bvh::width;

// --- inputs and outputs of the query kernels ---

/// How to get from the other model's frame and unit to this one's. Matrices are stored by columns and padded, so that
/// four numbers are worked on at once.
struct FrameTransform {
  alignas(32) double from_other[4][4];  ///< the columns of the rotation, then the translation
  alignas(16) float rotation[3][4];     ///< the same rotation, rounded
  float rotation_abs[3][4];
  double unit, per_unit, other_unit;
  float ratio;        ///< other_unit / unit; infinite where float32 could not square it
  float error_units;  ///< `error` in units; infinite where float32 could not square it
  double error;       ///< most that rounding of placed points and the slack of both models change a length by
};

/// The least distance from which on pairs are pruned: where only contacts matter. It is above 0, so that contacts are
/// never pruned; and so far above the smallest number that scaling it to a pair of leaves gives no subnormal one, which
/// processors take long to compute with.
inline constexpr double smallest_cutoff = 0x1p-960;

/// What a query prunes: pairs at least `distance` apart. It measures that along a search direction too, if there is
/// one: the direction in which the closest pair so far is apart.
struct PruneLimits {
  double distance;
  bool has_direction;
  double direction[3];    ///< from this model to the other, in this frame, of length 1
  float normal[3];        ///< the same, rounded
  float other_normal[3];  ///< the opposite direction, in the other's frame
};

/// A child slot of a tree, or its leaf, to be compared with slots of the other tree.
struct SlotRef {
  const bvh::Node* node;
  std::uint32_t slot;
  const bvh::QuantizedTriangles* triangles;  ///< nullptr unless it is a leaf
};

/// Child slots, as bit masks.
struct KeptSlots {
  unsigned all;          ///< those that are not pruned
  unsigned overlapping;  ///< of these, those whose bound is 0
};

/// Two triangles of two leaves that are not pruned.
struct Candidate {
  float bound_sq;  ///< at most (their distance * Candidates::scale + Candidates::error)^2
  std::uint8_t slot_a, slot_b;
};

struct Candidates {
  std::uint32_t count;
  float error;   ///< more than rounding and quantization can change any gap by
  double scale;  ///< from lengths to those of bounds and error, a power of two
  float apart;   ///< at most distance * scale of every pair that is not a candidate
  Candidate pairs[width * width];
};

/// A point to be compared with a tree, in the tree's frame.
struct QueryPoint {
  alignas(32) double position[4];  ///< the fourth number is 0
  double unit, per_unit;           ///< of the tree
  double error;       ///< most that rounding of placed points and the slack of the model change a length by
  float error_units;  ///< the same in units; infinite where float32 could not square it
  bool is_far;        ///< next to the size of the model; only then there is a direction
  /// From the model to the point: heights along it are measured from `base`. `height` is that of the point itself. In
  /// the world the direction has length 1.
  double direction[3], base[3], height;
  float normal[3];  ///< the direction, rounded
};

/// How far the children of a node are from a point at least.
struct ChildrenInOrder {
  alignas(32) float bound[width];   ///< in the measure of the kernel; infinite for slots without a child
  alignas(32) float behind[width];  ///< see place_of()
  float upper;                      ///< there is a triangle within that distance, in units
  unsigned kept;                    ///< bit mask: children whose bound is at most the limit

  /// The place of a slot when the kept children are lined up, the nearest last; behind them for those not kept. Every
  /// slot has a place of its own.
  std::uint32_t place_of(std::uint32_t slot) const { return std::bit_cast<std::uint32_t>(behind[slot]) % width; }
};

/// Intervals of the distances of a point from the triangles of a leaf, in quantization steps of the leaf.
struct TriangleIntervals {
  alignas(32) float lower[width];
  float upper;    ///< of the nearest: at least one of the triangles is at most that far away
  unsigned kept;  ///< bit mask: triangles whose lower bound is at most the limit, and at most `upper`
  double step;    ///< length of one step
};

/// A triangle with vectors across its edges, in its plane, towards the third corner.
struct FaceVectors {
  Triangle corner;
  std::array<Vec3, 3> edge;    ///< edge k goes from corner k to the next
  std::array<Vec3, 3> inward;  ///< inward[k] is across edge k
};

/// Features of two triangles that may be closest.
struct TriangleFeatures {
  double distance_sq;            ///< of the closest edges; infinite if no distance is a number
  double at_a, at_b;             ///< where on the two edges, from 0 to 1
  std::uint32_t edge_a, edge_b;  ///< of equally close pairs the first, in the order of edges of a
  unsigned feet_of_a;            ///< bit mask: corners of a whose foot on the plane of b is in b
  unsigned feet_of_b;            ///< bit mask: the other way round
};

/// Pairs of segments, of which not all need to be of use; what is not is finite.
struct SegmentPairs {
  static constexpr std::uint32_t room = 16;
  Vec3 start_a[room]{}, end_a[room]{}, start_b[room]{}, end_b[room]{};
};

/// What geometry::closest_on() gives for pairs of segments, to the bit: of those whose bit in `are_ordinary` is set.
/// The others are so large, small or close that they need another unit.
struct ClosestOfSegments {
  double distance[SegmentPairs::room], s[SegmentPairs::room], t[SegmentPairs::room];
  unsigned are_ordinary;
};

/// A ray to be compared with a tree, in the tree's frame.
struct QueryRay {
  alignas(32) double origin[4];  ///< the fourth number is 0
  double unit, per_unit;         ///< of the tree
  double error;                  ///< as QueryPoint::error
  float error_units;             ///< as QueryPoint::error_units
  float forward[3];              ///< the direction of the ray, of length 1 up to rounding
  float left[3], up[3];          ///< normal to it and to each other, of length 1
};

// --- kernels ---

/// Lower bounds of the distances between the children of a node and one slot of the other tree.
///
/// `transform` and `pruning` are those of the tree of `node`. Returns the children whose squared bound is below
/// `limit_sq` and that the search direction does not prune. Writes to order[slot] the squared bound where that is above
/// 0, otherwise how deep the spheres overlap, as a fraction of the sum of their radii, negative. Writes to
/// bound_sq[slot], unless that is nullptr, the best squared bound, the one along the search direction included. Both
/// are written for all slots, those without a child included. Where only contacts matter, at the smallest prune
/// distance and without bound_sq, order[slot] is some positive gap instead of a squared bound.
using BoundChildren = KeptSlots (*)(const bvh::Node& node, const SlotRef& other, const FrameTransform& transform,
                                    const PruneLimits& pruning, float limit_sq, float* order, float* bound_sq);

/// Two leaves of one tree, which is compared with itself, or one leaf twice.
struct SelfPair {
  const bvh::Leaf &a, &b;
};

/// The pairs of triangles of two leaves that are not pruned, in the order of slots. `transform` and `pruning` are those
/// of the tree of `a`. Candidates::apart is written if `wants_pruned_bound`.
///
/// `self` is nullptr unless both are leaves of one tree. Then triangles are no candidates if they share a vertex or an
/// edge and certainly have nothing else in common; and of a leaf and itself, triangles are compared with those after
/// them.
using FindCandidates = void (*)(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                const PruneLimits& pruning, const SelfPair* self, bool wants_pruned_bound,
                                Candidates& candidates);

/// The elements that the triangles of a leaf own (MeshEdges), a byte for each slot: bit k is the vertex of corner k,
/// bit 3 + k the edge from corner k to the next, bit 6 is set if the slot is in use. A slot that is not owns nothing.
struct OwnedElements {
  std::uint64_t of_slots;
};

/// An element of each of two leaves, as corner * width + slot: a vertex, or the edge that starts there; of a face the
/// corner is 0.
struct ElementCandidate {
  std::uint8_t a, b;
};

/// Pairs of elements of two leaves that are not pruned.
struct ElementCandidates {
  template <std::size_t room>
  struct List {
    std::uint32_t count;
    ElementCandidate pairs[room + 1];  // the last is never counted
  };
  List<3 * width * width> vertex_face, face_vertex;
  List<9 * width * width> edge_edge;
};

/// The pairs of owned vertices and of faces in use, and of owned edges, of two leaves that are not pruned. `transform`
/// and `pruning` are those of the tree of `a`; there is no search direction.
///
/// `self` is nullptr unless both are leaves of one tree. Then elements that share a vertex, by id, are no candidates;
/// and of a leaf and itself, the elements of each triangle are compared with those of triangles after it.
using FindCloseElements = void (*)(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                   const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                   const SelfPair* self, ElementCandidates& found);

/// Bounds of the distances between a point and the children of a node, and the order of those whose bound is at
/// most `limit`, which is finite.
///
/// bound_children_to_point gives squared distances in squared units; for children that may hold the point how deep it
/// is inside their sphere, as a fraction of the radius, negative. bound_children_along, for points far away, gives how
/// far the highest points of the children are under QueryPoint::base, in units, so large distances take no precision
/// away; its `upper` is infinite.
using BoundChildrenToPoint = void (*)(const bvh::Node& node, const QueryPoint& point, float limit,
                                      ChildrenInOrder& children);

/// Intervals of the distances between a point and the triangles of a leaf, which is the child of a slot of `node`. The
/// triangles that are not kept are farther away than `limit`, a length, or than another one.
///
/// bound_triangles_along, for points far away, has 0 for all lower bounds and an infinite upper one.
using BoundTrianglesToPoint = void (*)(const bvh::Node& node, std::uint32_t slot,
                                       const bvh::QuantizedTriangles& triangles, const QueryPoint& point, double limit,
                                       TriangleIntervals& intervals);

/// The children of a node, as a bit mask, that a ray may cross: their boxes along the ray's three directions do.
using FindCrossedChildren = unsigned (*)(const bvh::Node& node, const QueryRay& ray);

/// The triangles of a leaf, which is the child of a slot of `node`, that a ray may cross.
using FindCrossedTriangles = unsigned (*)(const bvh::Node& node, std::uint32_t slot,
                                          const bvh::QuantizedTriangles& triangles, const QueryRay& ray);

/// Fits a node of the lowest level to the triangles of its leaves, the first node.child_count of `leaves`: origin,
/// radius and bounds of the node, and the quantized corners of the leaves. `unit` is that of the tree. The leaves that
/// follow are those that will be fitted next. Returns a bound of all the triangles.
using FitLeaves = bvh::MergedBounds (*)(const Vec3* positions, double unit, bvh::Node& node,
                                        std::span<bvh::Leaf> leaves);

/// A bound around the children of a node.
using MergeBounds = bvh::MergedBounds (*)(const bvh::Node& node);

struct Displacement {
  double farthest_sq;  ///< the longest displacement of a point, squared; 0 unless is_bounded
  bool is_bounded;     ///< whether all new coordinates are numbers of at most a given size
};
/// The displacements of points from `from` to `to`, and whether all coordinates of `to` are at most `most` in size.
using MaxDisplacement = Displacement (*)(const Vec3* from, const Vec3* to, std::size_t count, double most);

/// The least and the greatest coordinates of points.
struct PointBox {
  float low[3], high[3];
};
/// Extends a box by points of four numbers each, the last of which is not used. Zeros may get either sign.
using ExtendBox = void (*)(const float* points, std::size_t count, PointBox& box);

inline constexpr std::size_t few_points = 64;
/// The n least of a few coordinates, as bit masks.
struct FewLeast {
  std::uint64_t least;     ///< those with fewer than n less than them: n, or more if the greatest are equal
  std::uint64_t greatest;  ///< the greatest of these, one or several that are equal
};
/// Finds the n least of the coordinates of points along an axis, and those equal to the greatest of them. Points are of
/// four numbers each, the last of which is not used. Pre: 0 < n <= count <= few_points.
using LeastOfFew = FewLeast (*)(const float* points, std::size_t axis, std::size_t count, std::size_t n);

/// Which of some boxes have a point in common with the box from `low` to `high`, as a bit mask. Pre: these are finite.
using OverlappingBoxes = unsigned (*)(const bvh::BoxNode& boxes, const Vec3& low, const Vec3& high);

/// Which boxes of `a`, made larger by a margin on all sides, have points in common with which of `b`, whose boxes are
/// all inside of `around_b`: bit 8 k + i stands for box k of a and box i of b. Pre: the margin is finite.
using OverlappingPairs = std::uint64_t (*)(const bvh::BoxNode& a, const bvh::BoxNode& b, const Box& around_b,
                                           double margin);

/// Compares the edges of two triangles, and their corners with the other's face. Pre: coordinates are at most 2^100 in
/// size.
using CompareTriangles = void (*)(const FaceVectors& a, const FaceVectors& b, TriangleFeatures& features);

/// The closest points of all pairs of segments.
using CompareSegments = void (*)(const SegmentPairs& pairs, ClosestOfSegments& found);

/// The list of all kernels, as X(type, name). A kernel has its name in the namespace of each instruction set too.
#define LIMBER_FOR_ALL_KERNELS(X)                    \
  X(BoundChildren, bound_children)                   \
  X(FindCandidates, find_candidates)                 \
  X(FindCloseElements, find_close_elements)          \
  X(BoundChildrenToPoint, bound_children_to_point)   \
  X(BoundChildrenToPoint, bound_children_along)      \
  X(BoundTrianglesToPoint, bound_triangles_to_point) \
  X(BoundTrianglesToPoint, bound_triangles_along)    \
  X(FindCrossedChildren, find_crossed_children)      \
  X(FindCrossedTriangles, find_crossed_triangles)    \
  X(FitLeaves, fit_leaves)                           \
  X(MergeBounds, merge_bounds)                       \
  X(MaxDisplacement, max_displacement)               \
  X(ExtendBox, extend_box)                           \
  X(LeastOfFew, least_of_few)                        \
  X(OverlappingBoxes, overlapping_boxes)             \
  X(OverlappingPairs, overlapping_pairs)             \
  X(CompareTriangles, compare_triangles)             \
  X(CompareSegments, compare_segments)

/// The kernels for one instruction set.
struct Kernels {
  const char* name;
#define LIMBER_MEMBER(Type, kernel) Type kernel;
  LIMBER_FOR_ALL_KERNELS(LIMBER_MEMBER)
#undef LIMBER_MEMBER
};

/// The best set this processor runs.
///
/// Threads  Safe; chosen once.
const Kernels& kernels();

/// The same arithmetic in plain C++, one SIMD lane at a time.
extern const Kernels scalar_kernels;

/// Every set this processor runs, best first, the scalar one last. For tests.
std::span<const Kernels> all_kernels();

/// Makes kernels() return `chosen` from now on; nullptr returns to the best. For tests.
void use_kernels(const Kernels* chosen);

}  // namespace limber::simd
