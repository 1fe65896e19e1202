// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "layout/node.h"
#include "simd/element_pairs.h"

/// The SIMD kernels, in this order: the types they read and write; their contracts; the table of kernels for each
/// instruction set, and its choice at run time.
///
/// Kernels that compare nodes and leaves work in float32 and only prune: numbers that reach the user come from float64.
/// compare_triangles, compare_segments and the kernels of moving boxes and pairs are float64. Every operation is an
/// IEEE one, no multiplication and addition are fused (no FMA), and SIMD lanes are combined only by minima and maxima.
/// So all instruction sets give equal bits.
///
/// Frames    One of two trees is the kernel's own: that of `node` or of `a`. The other one's slots are brought to its
///           frame.
/// Pruning   Pairs at least the prune distance apart are pruned: PruneLimits::distance, a length. It is the query's
///           cutoff, or slightly more (pair::Pruning). Kernels convert it to their own units. An argument `limit` or
///           `limit_sq` is what a kernel compares its bounds with, in the units of these bounds.
namespace limber::simd {

using bvh::width;

// --- inputs and outputs of the query kernels ---

/// The way from the frame and unit of the other tree to those of a kernel's own tree. Matrices are stored by columns
/// and padded, so that four numbers are worked on at once.
///
/// `error` is an upper bound of how much the rounding of placed points, and the slack of both models, can change a
/// length (Tree::slack). `ratio` and `error_units` are infinite if float32 could not square them; kernels then prune
/// nothing.
struct FrameTransform {
  alignas(32) double from_other[4][4];  ///< three columns of the rotation, then the translation
  alignas(16) float rotation[3][4];     ///< the same rotation, rounded
  float rotation_abs[3][4];             ///< its absolute values
  double unit, per_unit;                ///< of the kernel's own tree; 1 / unit
  double other_unit;
  float ratio;        ///< other_unit / unit
  float error_units;  ///< error / unit, rounded up
  double error;
};

/// The prune distance of queries for which only contacts matter. It is above 0, so that contacts are never pruned.
/// Kernels divide it by about the size of a pair of leaves. Up to a size of 2^62 the quotient is not subnormal:
/// processors take long to compute with subnormal numbers.
inline constexpr double smallest_prune_distance = 0x1p-960;

/// What a query prunes: pairs whose distance is at least `distance`. If there is a search direction, the direction
/// between the closest points found so far, pairs are also pruned by their gap along it.
struct PruneLimits {
  double distance;
  bool has_direction;
  double direction[3];         ///< from the kernel's own model to the other, in the own frame, of length 1
  float direction32[3];        ///< `direction`, rounded
  float other_direction32[3];  ///< from the other model to the own one, in the other's frame, rounded
};

/// A child slot of a node: the subtree or leaf in it, with its bounding volume.
struct SlotRef {
  const bvh::Node* node;
  std::uint32_t slot;
  const bvh::QuantizedTriangles* triangles;   ///< nullptr unless the slot holds a leaf
  std::uint32_t triangle_count = bvh::width;  ///< of that leaf; the last of them fills the slots after it
};

/// The part of its radius that the split priority of a node has beside its extent (docs/algorithms/traversal.md).
inline constexpr float share_of_radius = 0.01F;

/// Children of a node, as bit masks.
struct KeptSlots {
  unsigned all;          ///< the children that are not pruned
  unsigned overlapping;  ///< the children in `all` whose volume may overlap the other one
  unsigned larger;       ///< the children whose split priority is at least that of the other volume
};

/// Two triangles of two leaves that are not pruned.
struct Candidate {
  float bound_sq;  ///< lower bound of (distance * Candidates::scale + Candidates::error)^2: errors not yet subtracted
  std::uint8_t slot_a, slot_b;
};

/// The corners of the triangles of a leaf: [3 * corner + axis][slot].
struct alignas(64) LeafCorners {
  float v[9][width];
};

struct Candidates {
  std::uint32_t count;
  float error;         ///< upper bound of how much rounding and quantization can change a gap, scaled
  double scale;        ///< factor from lengths to scaled ones, a power of two
  float pruned_bound;  ///< lower bound of distance * scale of the pairs that are no candidates: errors subtracted
  Candidate pairs[width * width];
  LeafCorners corners_a, corners_b;  ///< of both leaves, scaled, relative to the center of a; unset if count is 0
};

/// A point to be compared with a tree, in the tree's frame.
///
/// A point is far if float32 cannot resolve how much nearer one part of the model is than another. Then, and only then,
/// it has a direction, and kernels compare heights along that direction over the point `base` of the model.
struct QueryPoint {
  alignas(32) double position[4];  ///< the fourth number is 0
  double unit, per_unit;           ///< of the tree
  double error;       ///< upper bound of how much rounding of placed points and the model's slack can change a length
  float error_units;  ///< error / unit, rounded up; infinite where float32 could not square it
  bool is_far;
  double direction[3];  ///< from the model to the point, of length 1 in the world, so nearly 1 here
  double base[3];
  double height;  ///< of the query point over base; for bound_triangles_along
  float direction32[3];
};

/// Lower bounds of the distances of the children of a node from a point, and the order of the children by them.
struct ChildrenInOrder {
  alignas(32) float bound[width];  ///< squared or not, as the kernel says; infinite for slots without a child
  /// 2^23 + place_of(slot). The mantissa of a float of this size is a whole number, so its last bits are the place.
  alignas(32) float place_in_bits[width];
  float upper;    ///< upper bound, in units, of the distance of the nearest triangle from the point
  unsigned kept;  ///< bit mask: children whose bound is at most the limit

  /// The place of a slot: kept children have places 0, 1, ... in order, the farthest first; the other slots follow.
  std::uint32_t place_of(std::uint32_t slot) const { return std::bit_cast<std::uint32_t>(place_in_bits[slot]) % width; }
};

/// Intervals of the distances of a point from the triangles of a leaf, in quantization steps of the leaf.
struct TriangleIntervals {
  alignas(32) float lower[width];  ///< negative where errors exceed the distance
  float upper;                     ///< upper bound of the distance of the nearest triangle
  unsigned kept;                   ///< bit mask: triangles whose lower bound is at most the limit, and at most `upper`
  double step;                     ///< length of one step
};

/// A ray to be compared with a tree, in the tree's frame.
struct QueryRay {
  alignas(32) double origin[4];  ///< the fourth number is 0
  double unit, per_unit;         ///< of the tree
  double error;                  ///< as in QueryPoint
  float error_units;             ///< as in QueryPoint
  float forward[3];              ///< the direction of the ray, of length 1 up to rounding
  float left[3], up[3];          ///< perpendicular to `forward` and to each other, of length 1
};

// --- kernels ---

/// Compares the children of a node with one slot of the other tree, by lower bounds of squared distances in squared
/// units of the tree of `node`. `transform` and `pruning` are those of that tree.
///
/// returned  The children with a bound below `limit_sq`, less those that the search direction prunes. `limit_sq` is
///           pruning.distance in units, squared and rounded up (pair::SquaredLimits).
/// order     For each slot the bound without the search direction, if positive. Otherwise minus the depth of the
///           overlap of the spheres, as a fraction of the sum of their radii: so the deepest overlap is the least.
/// bound_sq  nullptr, or for each slot the best bound, that along the search direction included.
///
/// The split priority of a volume is how much a bound may gain when its node is opened: where there is a search
/// direction and the spheres are apart, the mean of its support along that direction and of how loose that may be; else
/// half the thickness of its slab; and share_of_radius of its radius.
///
/// Slots without a child get numbers that mean nothing. If pruning.distance is smallest_prune_distance and bound_sq is
/// nullptr, the query only asks whether volumes overlap. A faster way is then taken: positive bounds in `order`
/// are lengths of some gap, not squares, and `larger` is 0.
using BoundChildren = KeptSlots (*)(const bvh::Node& node, const SlotRef& other, const FrameTransform& transform,
                                    const PruneLimits& pruning, float limit_sq, float* order, float* bound_sq);

/// A lower bound, squared, in squared units of the leaf's tree, of the distance between the triangles of a leaf and the
/// volume of a slot of the other tree. `transform` is that of the leaf's tree.
using BoundLeaf = float (*)(const SlotRef& leaf, const SlotRef& other, const FrameTransform& transform);

/// Finds the pairs of triangles of two leaves that are not pruned, in the order of slots. `transform` and `pruning` are
/// those of the tree of `a`. Candidates::pruned_bound means something only if `wants_pruned_bound`.
///
/// `self` is nullptr unless both are leaves of one tree. Then pairs are left out that share a vertex or an edge and
/// certainly meet nowhere else; and in a leaf with itself, each triangle is compared with those after it.
using FindCandidates = void (*)(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                const PruneLimits& pruning, const SelfPair* self, bool wants_pruned_bound,
                                Candidates& candidates);

/// Raises the bounds of candidates that find_candidates() has found: nearly to their distance, less errors.
using RefineCandidates = void (*)(Candidates& candidates);

/// Finds the pairs of elements of two leaves that are not pruned: owned vertices with faces in use, and owned edges
/// with each other. `transform` and `pruning` are those of the tree of `a`; there is no search direction.
///
/// `self` is nullptr unless both are leaves of one tree. Then elements that share a vertex, by id, are no candidates;
/// and in a leaf with itself, the elements of each triangle are compared with those of triangles after it.
using FindCloseElements = void (*)(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                   const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                   const SelfPair* self, ElementCandidates& found);

/// The children of a moving node, as a bit mask, that may come within the separation of a moving box while the limits
/// say, and when. A slot whose first time is after its last one never does.
using FindMeetingChildren = unsigned (*)(const bvh::MovingNode& node, const bvh::MovingBox& other,
                                         const MotionLimits& limits, MeetingTimes& times);

/// As find_close_elements(), for two moving leaves: finds the pairs of elements that may come within the separation
/// while the limits say.
using FindImpactCandidates = void (*)(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b, const MotionLimits& limits,
                                      OwnedElements owned_by_a, OwnedElements owned_by_b, const SelfPair* self,
                                      ElementCandidates& found);

/// A bit mask of the pairs that certainly do not touch while the limits say. The separation must be 0. Others may not
/// touch either. `are_faces` says that they are vertices and faces, otherwise they are edges.
using ExcludeImpacts = unsigned (*)(const MovingPairs& pairs, bool are_faces, const MotionLimits& limits);

/// Bounds of the distances between a point and the children of a node, and the order of the children whose bound is at
/// most `limit`, which is finite. The numbers that are bounds, and `limit`, depend on the kernel:
///
/// bound_children_to_point  Squared distances in squared units. Where one is 0 it gives how deep the point is inside of
///                          the child's sphere, as a fraction of the radius, negative.
/// bound_children_along     For far points: minus the height of the child's highest point over QueryPoint::base, in
///                          units. It keeps its precision however far the point is. `upper` is infinite.
using BoundChildrenToPoint = void (*)(const bvh::Node& node, const QueryPoint& point, float limit,
                                      ChildrenInOrder& children);

/// Intervals of the distances between a point and the triangles of the leaf in a slot of `node`. A triangle that is not
/// kept is farther away than `limit`, which is a length, or than another triangle.
///
/// bound_triangles_along is for far points: lower bounds are 0 and `upper` is infinite, so only `kept` counts.
using BoundTrianglesToPoint = void (*)(const bvh::Node& node, std::uint32_t slot,
                                       const bvh::QuantizedTriangles& triangles, const QueryPoint& point, double limit,
                                       TriangleIntervals& intervals);

/// The children of a node, as a bit mask, that a ray may cross. For the others the ray's three directions prove that it
/// does not: it passes beside their extent along `left` or `up`, or they are behind its origin.
using FindCrossedChildren = unsigned (*)(const bvh::Node& node, const QueryRay& ray);

/// The triangles, as a bit mask, of the leaf in a slot of `node` that a ray may cross.
using FindCrossedTriangles = unsigned (*)(const bvh::Node& node, std::uint32_t slot,
                                          const bvh::QuantizedTriangles& triangles, const QueryRay& ray);

/// Fits a node of the lowest level to the triangles of its leaves, the first node.child_count of `leaves`: origin,
/// radius and bounds of the node, and the quantized corners of the leaves. `unit` is that of the tree. Leaves after
/// these are fetched from memory ahead of time, for the next call. Returns a bound of all the triangles. Without
/// `sides` the intervals of SlabSides are those of the spheres, and nothing is elongated.
using FitLeaves = bvh::MergedBounds (*)(const Vec3* positions, double unit, bvh::Node& node,
                                        std::span<bvh::Leaf> leaves, bool sides);

/// A bounding volume around the children of a node. `sides` as in FitLeaves.
using MergeBounds = bvh::MergedBounds (*)(const bvh::Node& node, bool sides);

struct Displacement {
  double farthest_sq;  ///< the longest displacement of a point, squared; 0 if not is_bounded
  bool is_bounded;     ///< whether all new coordinates are numbers of at most the size that was asked for
};
/// Measures how far points move from `from` to `to`, and whether all coordinates of `to` are numbers of at most
/// `largest` in size.
using MaxDisplacement = Displacement (*)(const Vec3* from, const Vec3* to, std::size_t count, double largest);

/// The least and the greatest coordinates of points.
struct PointBox {
  float low[3], high[3];
};
/// Extends a box by points. Each is four floats, of which the last is not read. Zeros may get either sign.
using ExtendBox = void (*)(const float* points, std::size_t count, PointBox& box);

inline constexpr std::size_t few_points = 64;
/// The n least of a few coordinates, as bit masks. The rank of a coordinate is the number of coordinates less than it.
struct FewLeast {
  std::uint64_t least;     ///< coordinates of rank below n: n of them, or more if the greatest are equal
  std::uint64_t greatest;  ///< the greatest coordinate in `least`, and all that are equal to it
};
/// Finds the n least of the coordinates of points along an axis. Each point is four floats, of which the last is not
/// read. Pre: 0 < n <= count <= few_points.
using LeastOfFew = FewLeast (*)(const float* points, std::size_t axis, std::size_t count, std::size_t n);

/// A row of numbers: a box as its least corner and minus its greatest one, each followed by a number that is not used.
struct alignas(32) BoxRow {
  float least[width];
};
/// The least of each number of some rows: the box around some boxes. Bit k of `which` stands for row k.
/// Pre: `which` is not 0.
using JoinRows = BoxRow (*)(const BoxRow* rows, std::uint64_t which);

/// The boxes, as a bit mask, that have a point in common with the box from `low` to `high`, which are finite.
using OverlappingBoxes = unsigned (*)(const bvh::BoxNode& boxes, const Vec3& low, const Vec3& high);

/// The pairs of boxes that have a point in common once those of `a` are made larger by a margin on all sides. Bit 8 k +
/// i stands for box k of a and box i of b. `around_b` contains all boxes of b. Pre: the margin is finite.
using OverlappingPairs = std::uint64_t (*)(const bvh::BoxNode& a, const bvh::BoxNode& b, const Box& around_b,
                                           double margin);

/// Finds the closest edges of two triangles, and the corners whose foot is in the other one. Pre: coordinates are at
/// most 2^100 in size.
using CompareTriangles = void (*)(const FaceVectors& a, const FaceVectors& b, TriangleFeatures& features);

/// Finds the pairs that cross for certain, and where.
using FindCrossings = void (*)(const TrianglePairs& pairs, Crossings& found);

/// Finds how pairs of triangles that intersect can be parted. Others get numbers that mean nothing.
using FindLeastOverlaps = void (*)(const TrianglePairs& pairs, LeastOverlaps& found);

/// The closest points of all pairs of segments.
using CompareSegments = void (*)(const SegmentPairs& pairs, ClosestOfSegments& found);

/// The list of all kernels, as X(type, name). The function of that name in the namespace of an instruction set is the
/// kernel for it.
#define LIMBER_FOR_ALL_KERNELS(X)                    \
  X(BoundChildren, bound_children)                   \
  X(BoundLeaf, bound_leaf)                           \
  X(FindCandidates, find_candidates)                 \
  X(RefineCandidates, refine_candidates)             \
  X(FindCloseElements, find_close_elements)          \
  X(FindMeetingChildren, find_meeting_children)      \
  X(FindImpactCandidates, find_impact_candidates)    \
  X(ExcludeImpacts, exclude_impacts)                 \
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
  X(JoinRows, join_rows)                             \
  X(OverlappingBoxes, overlapping_boxes)             \
  X(OverlappingPairs, overlapping_pairs)             \
  X(CompareTriangles, compare_triangles)             \
  X(FindCrossings, find_crossings)                   \
  X(FindLeastOverlaps, find_least_overlaps)          \
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

/// All kernels in plain C++, with the same arithmetic, one SIMD lane at a time.
extern const Kernels scalar_kernels;

/// Every set this processor runs, best first, the scalar one last. For tests.
std::span<const Kernels> all_kernels();

/// Makes kernels() return `chosen` from now on; nullptr returns to the best. For tests.
void use_kernels(const Kernels* chosen);

}  // namespace limber::simd
