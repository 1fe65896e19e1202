// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/mesh.h"
#include "limber/model.h"

/// All pairs of triangles that intersect or are close: of two models, and of one model with itself.
///
/// Triangles are as distance.h says: surfaces, closed sets, compared as placed. Whether two of them intersect is exact;
/// distances are rounded as stated there, so a pair whose distance equals the margin up to that rounding may be in or
/// out.
///
/// The triangles of shapes are swept by the radius: a contact has their distance less both radii, and the points that a
/// witness of distance.h would have. Where the swept triangles meet, its depth is by how much the radii exceed the
/// distance of the triangles, plus the depth of these if they intersect. Normal, weights, features and side are those
/// of the triangles. The insides of solids do not count: what is deep in one has no contacts.
///
/// Order    Pairs come in an order that depends on the models, their history and their poses alone: not on the
///          processor, and not on threads. It is not sorted.
/// Threads  Every function is reentrant; any number of calls may share models.
namespace limber {

/// Two triangles, one of each model, or two of one model.
struct TrianglePair {
  TriangleId a = no_id, b = no_id;
  friend bool operator==(const TrianglePair&, const TrianglePair&) = default;
};

/// Two triangles that intersect, or are close.
///
/// Frame    World; for pairs of one model, the model's own frame.
struct Contact : TriangleContact {
  TriangleId triangle_a = no_id, triangle_b = no_id;  ///< index each model's own mesh
};

/// Called for each pair; returns whether to go on. Must not change the models of the query.
using TrianglePairVisitor = FunctionRef<bool(const TrianglePair&)>;
using ContactVisitor = FunctionRef<bool(const Contact&)>;

/// Which pairs count: called with the ids of two triangles whose bounds are close, before they are compared.
using TrianglePairFilter = FunctionRef<bool(TriangleId a, TriangleId b)>;

/// Alias    Refers to the filter, which must live until the query returns: a variable, or a lambda in the call itself.
struct PairOptions {
  std::optional<TrianglePairFilter> filter = std::nullopt;  ///< all pairs count without one
  /// Which model's triangles have an outside, for the normals of contacts. Without it, those of closed meshes do: of
  /// meshes where each edge, by vertex ids, is run through as often in one direction as in the other. For one model
  /// with itself, any but `none` means that its triangles do.
  std::optional<OrientedFaces> oriented_faces = std::nullopt;
  QueryBudget budget = {};  ///< when the query has to end; the default has no limits
  /// Whether to search on all threads of the calling oneTBB arena: for large models with many pairs. The pairs and
  /// their order stay the same, and the calling thread visits them, but after all have been found and stored. Several
  /// threads call the filter. A query with a budget stays on one thread.
  bool parallel = false;
};

/// How many pairs were found.
struct PairCount {
  std::size_t count = 0;    ///< all that were found, whether or not they fitted; of the closest pairs, those written
  bool is_complete = true;  ///< false if the visitor or the budget has ended the query: there may be more
  StoppedBy stopped_by = StoppedBy::nothing;  ///< which limit of the budget, if it was that
  QueryStats stats{};
};

/// All pairs of triangles that intersect.
///
/// Promise  Each intersecting pair exactly once, decided exactly. The second form writes the first pairs.size() of
///          them; count says how many there are.
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid; whatever a visitor or a
///          filter throws.
/// Budget   If it is spent first, the pairs are some of all: each right, none twice. The next call starts anew.
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing, unless it is parallel.
/// Source   docs/algorithms/contacts.md.
LIMBER_API PairCount visit_intersections(const Placed& a, const Placed& b, TrianglePairVisitor visit,
                                         const PairOptions& options = {});
LIMBER_API PairCount intersections(const Placed& a, const Placed& b, std::span<TrianglePair> pairs,
                                   const PairOptions& options = {});

/// All pairs of triangles at most `margin` apart. With a margin of 0, those that intersect.
///
/// Promise  Each pair exactly once. The second form writes the first contacts.size() of them; count says how many there
///          are. Each is the contact() of geometry.h of the two placed triangles, with the outsides that the options
///          say, less the radii of shapes.
/// Room     Where there may be more contacts than room, or not enough time, closest_pairs() with `max_distance` gives
///          the nearest ones.
/// Depth    That of two triangles. It is not the depth of two bodies, and goes to 0 where meshes are refined.
/// Throws   As visit_intersections(); also unless the margin is finite and >= 0. Budget and cost as there.
LIMBER_API PairCount visit_contacts(const Placed& a, const Placed& b, double margin, ContactVisitor visit,
                                    const PairOptions& options = {});
LIMBER_API PairCount contacts(const Placed& a, const Placed& b, double margin, std::span<Contact> contacts,
                              const PairOptions& options = {});

/// Which pairs closest_pairs() looks for. As PairOptions, it refers to the filter.
struct ClosestPairsOptions {
  double max_distance = std::numeric_limits<double>::infinity();  ///< pairs farther apart do not count; >= 0
  std::optional<TrianglePairFilter> filter = std::nullopt;        ///< all pairs count without one
  std::optional<OrientedFaces> oriented_faces = std::nullopt;     ///< as in PairOptions
  QueryBudget budget = {};                                        ///< as in PairOptions
};

/// The closest pairs of triangles, as many as `closest` has room for.
///
/// Promise  Nearest first. The count is that of the pairs written: smaller than the room if there are fewer pairs, or
///          fewer within `max_distance` that the filter lets through. Which of several equally close pairs are among
///          them is not defined.
/// Budget   If it is spent first, the pairs are the closest of those that were compared, each right, none twice. Near
///          pairs of nodes are compared before far ones.
/// Throws   As visit_intersections(); also unless max_distance is >= 0; it may be infinite.
/// Cost     As visit_intersections().
LIMBER_API PairCount closest_pairs(const Placed& a, const Placed& b, std::span<Contact> closest,
                                   const ClosestPairsOptions& options = {});

// --- one model with itself: self_collide() says which pairs meet, and what neighbors are ---

/// Which pairs self_collide() looks for. As PairOptions, it refers to the filter.
struct SelfQueryOptions {
  std::optional<TrianglePairFilter> filter = std::nullopt;  ///< all pairs count without one
  QueryCache* cache = nullptr;                              ///< of the last answer; null for none
  QueryBudget budget = {};                                  ///< when the query has to end
};

/// How good the answer of self_distance() must be, as DistanceOptions says, and which pairs count. As PairOptions, it
/// refers to the filter.
struct SelfDistanceOptions {
  double relative_error = 0, absolute_error = 0;
  double max_distance = std::numeric_limits<double>::infinity();
  std::optional<TrianglePairFilter> filter = std::nullopt;  ///< all pairs count without one
  QueryCache* cache = nullptr;                              ///< of the last answer; null for none
  QueryBudget budget = {};                                  ///< when the query has to end
};

/// Whether a model meets itself: whether any two of its triangles meet. Stops at the first such pair found.
///
/// Pairs    Of all self-queries: two different triangles of the model, each pair once, with a < b. Two triangles are
///          neighbors if they share vertices, by id. Neighbors meet only if they have a point in common beyond what
///          they share by these: a vertex, the edge between two, or all of a triangle. So two triangles of the same
///          three vertices never meet, in whichever order these are. Others meet if they intersect, also at equal
///          positions under different ids. Within a distance or margin, neighbors that do not meet do not count.
/// Frame    Of all self-queries: the model's own; poses do not matter, so there are none.
/// Promise  Decided exactly. The witness names a pair that meets.
/// Cache    The pair of the last answer is compared first: while it meets, it is the answer, for the cost of one pair
///          of triangles. Nothing but that pair is used, so filters may change, and any cache will do, also one that
///          another model or queries of two models have filled. Which pair is the witness may depend on it, no more.
/// Budget   As collide().
/// Throws   std::invalid_argument unless the model is committed; whatever the filter throws.
/// Cost     In practice O(n) for surfaces that do not meet themselves, O(n log n) for triangles around one vertex or
///          edge; O(n^2) at worst. 40 kB of stack; allocates nothing but a cache's memory.
/// Source   docs/algorithms/contacts.md.
LIMBER_API CollideResult self_collide(const Model& model, const SelfQueryOptions& options = {});

/// The shortest distance of two triangles that are no neighbors; 0 if the model meets itself. If there is no pair at
/// most max_distance apart, the status is `beyond_limit`.
///
/// Promise  As distance(), for those pairs. If no error is asked for, upper and status are those of the least distance
///          that closest_points() gives for any of them, smaller id first, to the bit.
/// Cache    The pair of the last answer is compared first and gives an upper bound. What is said there about other
///          caches holds here; where errors are asked for, the interval may depend on it, within these errors.
/// Throws   As self_collide(); also unless the options are what DistanceOptions says. Cost as there.
LIMBER_API DistanceResult self_distance(const Model& model, const SelfDistanceOptions& options = {});

/// All pairs of triangles that meet.
///
/// Promise  As visit_intersections().
/// Throws   As self_collide(); whatever the visitor throws. Cost as there.
LIMBER_API PairCount visit_self_intersections(const Model& model, TrianglePairVisitor visit,
                                              const PairOptions& options = {});
LIMBER_API PairCount self_intersections(const Model& model, std::span<TrianglePair> pairs,
                                        const PairOptions& options = {});

/// All pairs of triangles that meet, or are no neighbors and at most `margin` apart.
///
/// Promise  As visit_contacts(). The normals of neighbors do not keep to the outsides: where a surface is folded, these
///          do not tell which way is out.
/// Throws   As visit_self_intersections(); also unless the margin is finite and >= 0.
/// Cost     As self_collide(), and the pairs within the margin.
LIMBER_API PairCount visit_self_contacts(const Model& model, double margin, ContactVisitor visit,
                                         const PairOptions& options = {});
LIMBER_API PairCount self_contacts(const Model& model, double margin, std::span<Contact> contacts,
                                   const PairOptions& options = {});

/// The closest pairs of triangles that meet or are no neighbors, as many as `closest` has room for, nearest first, as
/// closest_pairs() says.
///
/// Throws   As self_collide(); also unless max_distance is >= 0; it may be infinite.
LIMBER_API PairCount self_closest_pairs(const Model& model, std::span<Contact> closest,
                                        const ClosestPairsOptions& options = {});

/// Which triangles of a mesh are near each other along the surface: a TrianglePairFilter for self-queries, which widens
/// the exclusion of neighbors.
///
///   const limber::NeighborRings rings(cloth.mesh(), 2);
///   limber::self_contacts(cloth, 0.002, found, {.filter = rings});
///
/// Two triangles are near if a vertex of one and a vertex of the other are joined by a path of at most `max_edges`
/// edges of triangles; with 0 edges, if they share a vertex. Vertices are told apart by their ids. Near triangles do
/// not count, not even where they intersect.
///
/// Threads  Const functions may run concurrently.
class NeighborRings {
 public:
  /// Connectivity alone matters, so one object serves all shapes that a model takes.
  ///
  /// Throws   std::invalid_argument if the mesh has been moved from; std::bad_alloc.
  /// Cost     Time in proportion to the pairs of near triangles, 4 bytes for each of them: about 80 bytes a triangle of
  ///          a regular mesh with 1 edge, 150 with 2, 250 with 3. O(n^2) where a vertex belongs to many triangles.
  LIMBER_API NeighborRings(const Mesh& mesh, std::uint32_t max_edges);

  /// Whether two triangles are near. Every triangle is near itself.
  ///
  /// Throws   std::invalid_argument unless the mesh had both triangles.
  /// Cost     O(log of the triangles near one).
  [[nodiscard]] LIMBER_API bool are_near(TriangleId a, TriangleId b) const;

  /// Whether a pair counts: the filter.
  bool operator()(TriangleId a, TriangleId b) const { return !are_near(a, b); }

  /// How many triangles the mesh had; 0 if the object has been moved from.
  std::size_t triangle_count() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Pairs of different triangles that are near, each once.
  std::size_t pair_count() const { return near_.size(); }

 private:
  std::vector<std::size_t> begin_;  // of each triangle's part of near_, and the end
  std::vector<TriangleId> near_;    // those with larger ids, ascending
};

// --- fewer contacts, for solvers of rigid bodies ---

/// Scratch memory of reduce_contacts(), kept from call to call: it grows to what the largest call needs.
///
/// Cost     250 bytes a contact, allocated by calls that need more than those before.
/// Threads  One call at a time. One that has been moved from is as new.
class ReductionMemory {
 public:
  LIMBER_API ReductionMemory();
  LIMBER_API ReductionMemory(ReductionMemory&&) noexcept;
  LIMBER_API ReductionMemory& operator=(ReductionMemory&&) noexcept;
  LIMBER_API ~ReductionMemory();

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  Impl& impl();

  std::unique_ptr<Impl> impl_;
};

/// What a patch is for reduce_contacts(), and how much of it is kept.
struct ReductionOptions {
  double max_angle = 0.5;                   ///< between normals of one patch, in radians; from 0 to pi
  std::size_t max_points = 4;               ///< contacts that are kept of a patch; at least 1
  std::span<std::uint32_t> patch_ids = {};  ///< where the numbers of patches are written
  ReductionMemory* memory = nullptr;        ///< to work in; null to allocate it for the call alone
};

/// Keeps a few contacts of each patch, and moves them to the front. The radius is that of a patch, in the length unit
/// of the meshes.
///
/// The contacts are taken from the deepest to the farthest, by distance - depth. The position of a contact is the
/// middle of its two points. A contact joins the deepest patch whose first contact is at most `radius` away and has a
/// normal within `max_angle`; if there is none, it is the first of a new patch. Of each patch the first contact is
/// kept, then one at a time the one that is farthest from those kept, as seen along the normal of the first. That ends
/// where there are max_points, or where all others are within a quarter of the radius of one that is kept.
///
/// Shape    `contacts` as contacts() and self_contacts() write them, of any number of pairs of models. Returns how many
///          are kept. They are in front, patch by patch, the deepest patch and the first of a patch first. The
///          removed ones are behind them, the deepest first. patch_ids[i] becomes the number of the patch of contact i,
///          from 0, for the kept contacts that there is room for.
/// Promise  Each removed contact is at most `radius` away from a kept one that is at least as deep and whose normal is
///          within `max_angle`. Of any two first contacts of patches, the positions are more than `radius` apart or the
///          normals more than `max_angle`. Both are up to rounding. The result does not depend on the order of the
///          input, but for contacts that are equal in all numbers.
/// Throws   std::invalid_argument unless the radius is finite and above 0, the options are what their comments say, all
///          numbers of the contacts are finite, and no normal is 0 or longer than 1, up to rounding to float32;
///          std::bad_alloc. The contacts are then as they were.
/// Cost     O(n log n) for n contacts, wherever they are and however their normals lie: each is compared with the
///          patches next to it, some hundred at most. Allocates nothing if `memory` has grown to it; else 250 bytes a
///          contact in six pieces.
/// Source   Deepest contact first, then those that span most, as in Bullet, Jolt and Rapier;
///          docs/algorithms/contacts.md.
[[nodiscard]] LIMBER_API std::size_t reduce_contacts(std::span<Contact> contacts, double radius,
                                                     const ReductionOptions& options = {});

}  // namespace limber
