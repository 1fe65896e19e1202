// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/geometry.h"
#include "limber/mesh.h"
#include "limber/model.h"

/// Continuous collision: whether, and when, two elements or two models touch first. An element is a vertex, an edge or
/// a face; a vertex and a face may touch, or two edges.
///
/// Time goes from 0, the start, to 1, the end. Vertices move on straight lines at constant speed: at time t a vertex is
/// at (1 - t) start + t end, in exact arithmetic. Elements are closed sets. They may be degenerate or stand still.
/// Two triangles that are apart at the start touch first where a vertex of one touches the other's face, or where two
/// of their edges touch.
///
/// No function depends on the caller's floating-point environment. Few pairs of elements are left to exact arithmetic,
/// which allocates where its numbers are long.
///
/// Threads  Every function is reentrant; any number of calls may share models.
namespace limber {

struct MovingPoint {
  Vec3 start, end;
};

struct MovingSegment {
  Segment start, end;
};

struct MovingTriangle {
  Triangle start, end;
};

enum class ImpactStatus : std::uint8_t {
  clear,            ///< they do not touch up to and including the largest time
  contact,          ///< they are apart at the start and touch later
  initial_contact,  ///< they touch at the start
  undecided,        ///< a query of models has spent its budget before it could tell; never without a budget
};

/// When two elements touch first.
struct [[nodiscard]] ElementImpact {
  ImpactStatus status = ImpactStatus::clear;
  /// The first time at which they touch is in [lower, upper]. Both are 0 for `initial_contact`, and infinite for
  /// `clear`.
  double lower = std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct ElementImpactOptions {
  double max_time = 1;    ///< a first contact after this time does not count; from 0 to 1. `upper` may be after it
  double time_error = 0;  ///< how far `upper` may be above `lower`; never less than the rounding of a time, 2^-53
  /// Elements that are this far apart, or less, touch. 0 asks for exact contact. A greater number may be rounded up, at
  /// each time in another way: by up to 2^-44 of the extent, the largest coordinate of a corner relative to the first
  /// corner at the start. By more for slivers, short edges and nearly parallel edges that are about that near: the
  /// search doubles its tolerance until it ends.
  double min_separation = 0;
};

/// The first time at which a vertex touches a face.
///
/// Promise  With min_separation 0 the status is exact, for every input: no contact is missed, not even one at a single
///          instant, and a reported one is real. Otherwise nothing nearer than the separation is missed. lower <= time
///          <= upper, and upper - lower <= max(time_error, 2^-53). Coordinates and min_separation that are all
///          multiplied by one power of two give the same bits, as long as that rounds none of them.
/// Throws   std::invalid_argument if a coordinate is not finite or above `max_coordinate`, 2^200, in size, if max_time
///          is not in [0, 1], time_error is negative or not a number, or min_separation is not in [0, 2^200].
///          std::bad_alloc from exact arithmetic.
/// Cost     Up to 0.5 us where a filter in float64 decides that nothing touches; 1 to 2 us for a contact in general
///          position; 2 to 40 us on average for degenerate pairs; tens of milliseconds where coordinates span hundreds
///          of binary digits.
///          With a min_separation some 4 us if the elements are clear, 30 us if not; milliseconds for slivers.
/// Source   docs/algorithms/impact.md; compare [WangFerguson2021].
LIMBER_API ElementImpact time_of_impact(const MovingPoint& point, const MovingTriangle& triangle,
                                        const ElementImpactOptions& options = {});

/// The first time at which two edges touch. All else as above.
LIMBER_API ElementImpact time_of_impact(const MovingSegment& a, const MovingSegment& b,
                                        const ElementImpactOptions& options = {});

/// A model in one step of time: each vertex moves on a straight line at constant speed, from its committed position,
/// placed by one pose, to another position, placed by another pose.
///
/// Keeps a pointer: the model must outlive it. Changing the model, moving its vertices included, ends the motion: it
/// has to be set again.
///
/// Cost     48 bytes a vertex and some 100 bytes a triangle, allocated by the first motion; and the Model::edges().
/// Threads  Const functions, queries included, may run concurrently on one object.
class MovingModel {
 public:
  /// Throws   std::invalid_argument if the model has been moved from; std::bad_alloc.
  LIMBER_API explicit MovingModel(const Model& model);
  explicit MovingModel(const Model&&) = delete;  // would point to a temporary
  LIMBER_API MovingModel(MovingModel&&) noexcept;
  LIMBER_API MovingModel& operator=(MovingModel&&) noexcept;
  LIMBER_API ~MovingModel();

  /// Sets the motion of one step.
  ///
  /// Frame    `end_positions` are in the model's own frame, one for each vertex.
  /// Errors   `size_mismatch`, `non_finite`, `too_large` with the entry's index; the motion is then as before.
  /// Throws   std::invalid_argument unless the model is committed and both poses are rigid; as Model::edges();
  ///          std::bad_alloc, and then there is no motion.
  /// Cost     O(n), on the threads of the calling oneTBB arena; some four times as much as a commit that moves all
  ///          vertices.
  LIMBER_API Result<void> set_motion(std::span<const Vec3> end_positions, const Transform& start_pose = {},
                                     const Transform& end_pose = {});

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  const Impl& impl() const;

  std::unique_ptr<Impl> impl_;
};

/// Two elements, the first of model a and the second of model b, or two of one model.
struct ElementPair {
  enum class Kind : std::uint8_t {
    vertex_face,  ///< a vertex of a and a face of b
    face_vertex,  ///< a face of a and a vertex of b; never of one model
    edge_edge,    ///< two edges; of one model, the one of smaller id first
  };

  Kind kind = Kind::vertex_face;
  std::uint32_t a = no_id, b = no_id;  ///< a VertexId, a TriangleId or an EdgeId (Model::edges()), as the kind says

  friend bool operator==(const ElementPair&, const ElementPair&) = default;
};

/// Which pairs count: called with pairs that may touch, before they are compared.
using ElementPairFilter = FunctionRef<bool(const ElementPair&)>;

/// Alias    Refers to the filter, which must live until the query returns: a variable, or a lambda in the call itself.
struct ImpactOptions {
  double max_time = 1;        ///< as in ElementImpactOptions
  double time_error = 0;      ///< as in ElementImpactOptions
  double min_separation = 0;  ///< as in ElementImpactOptions
  /// Elements nearer than the separation at the start may come as near as this fraction of their distance then.
  /// With 0 they touch at the start. From 0 to below 1; a solver that keeps a separation from step to step needs it, as
  /// rounding and its own response bring elements nearer.
  double separation_fraction = 0;
  /// Whether models that cross at the start may go on: only elements that touch count, a vertex and a face or two
  /// edges, as solvers with a constraint for each take them. Otherwise triangles that intersect at the start are an
  /// `initial_contact`.
  bool ignore_crossings = false;
  /// Whether any contact up to max_time will do, not the first one: for "is it free until then?".
  bool any_contact = false;
  /// All pairs of elements count without one. It has no say in what crosses at the start.
  std::optional<ElementPairFilter> filter = std::nullopt;
  /// When the query has to end. Its steps count for the test for crossings and for the rest, each.
  QueryBudget budget = {};
  /// Whether to search on all threads of the calling oneTBB arena: for large models. Answers, pairs and their order
  /// stay the same, but `stats` of a first impact count work that one thread would save. The calling thread visits
  /// pairs, after all have been found and stored. Several threads call the filter, also for pairs that one thread would
  /// leave out. A query with a budget stays on one thread.
  bool parallel = false;
};

/// When two models touch first.
struct [[nodiscard]] ImpactResult {
  ImpactStatus status = ImpactStatus::undecided;
  /// As in ElementImpact. With `undecided`, no contact is before `lower`. With any_contact, the contact that was found
  /// is at `upper` or before, and the first one may be anywhere between the two.
  double lower = 0;
  double upper = std::numeric_limits<double>::infinity();
  /// The elements that touch in that interval. None if nothing does, or if triangles cross at the start.
  std::optional<ElementPair> elements;
  /// The closest points of these elements at the time `upper`, in the world, and a triangle of each; or a point that
  /// two triangles share at the start. None if nothing touches.
  std::optional<Witness> witness;
  /// As in ElementState.
  Vec3 normal;
  StoppedBy stopped_by = StoppedBy::nothing;  ///< which limit, if the status is `undecided`
  QueryStats stats{};                         ///< `primitive_tests` counts the pairs of elements that may touch
};

/// The first time at which two moving models touch.
///
/// Promise  As time_of_impact() of elements, for vertices as placed (distance.h): the first contact is in
///          [lower, upper], and upper - lower <= max(time_error, 2^-53) unless the budget was spent or any_contact is
///          set. No contact is missed.
/// Throws   std::invalid_argument unless both models have a motion that is still valid, and the options are what those
///          of elements have to be; std::bad_alloc from exact arithmetic; whatever the filter throws.
/// Cost     Output-sensitive in practice, O(n m) at worst. 60 kB of stack. Allocates only in exact arithmetic, and if
///          it is parallel. Where many elements touch at the same time, in one plane above all, each takes up to 50 us,
///          unless a time_error says that they need not be told apart.
/// Budget   If it is spent first, the status is `undecided`: nothing touches before `lower`, and if `upper` is finite,
///          the elements do touch by then. The test of one model for crossings at the start has no budget.
/// Source   docs/algorithms/impact.md, "Models".
LIMBER_API ImpactResult time_of_impact(const MovingModel& a, const MovingModel& b, const ImpactOptions& options = {});

/// The first time at which a moving model touches itself: two of its elements that share no vertex, by id. What crosses
/// at the start is what self_collide() finds. All else as above.
LIMBER_API ImpactResult self_time_of_impact(const MovingModel& model, const ImpactOptions& options = {});

/// Two elements that touch.
struct Impact {
  ElementPair elements;
  ElementImpact time;
};

/// Two elements at a time of a motion, as the response of a solver takes them.
///
/// Frame    World.
struct [[nodiscard]] ElementState {
  /// The vertices of the first element, then those of the second: 1 and 3, 3 and 1, or 2 and 2.
  std::array<VertexId, 4> vertices{no_id, no_id, no_id, no_id};
  std::size_t count_of_a = 0;       ///< how many of them are of the first
  std::array<double, 4> weights{};  ///< of closest points: those of each element are >= 0, together 1 up to rounding
  Vec3 point_a, point_b;            ///< closest points
  /// The direction from a to b, of length 1. If the elements are apart, it leads from one closest point to the other.
  /// If they touch, up to the rounding of positions, it is perpendicular to the face or to both edges, and against the
  /// motion of b as seen from a. 0 where there is no such direction.
  Vec3 normal;
};

/// The state of a pair of elements, such as that of an Impact at its upper time.
///
/// Throws   std::invalid_argument unless both models have a motion that is still valid, the ids are those of elements,
///          and the time is from 0 to 1.
/// Cost     O(1).
LIMBER_API ElementState state_of(const MovingModel& a, const MovingModel& b, const ElementPair& elements, double time);
LIMBER_API ElementState self_state_of(const MovingModel& model, const ElementPair& elements, double time);

/// Called for each pair; returns whether to go on.
using ImpactVisitor = FunctionRef<bool(const Impact&)>;

/// All pairs of elements that touch up to max_time, each once, with the first time at which they do. Crossings do not
/// count. They come in no particular order, which depends on the models and their history alone.
///
/// Promise  As time_of_impact(). `ignore_crossings` and `any_contact` make no difference.
/// Throws   As time_of_impact(); whatever the visitor throws.
/// Cost     As time_of_impact(), plus 1 to 50 us for each contact, most where elements stay in one plane.
LIMBER_API PairCount visit_impacts(const MovingModel& a, const MovingModel& b, ImpactVisitor visit,
                                   const ImpactOptions& options = {});
LIMBER_API PairCount visit_self_impacts(const MovingModel& model, ImpactVisitor visit,
                                        const ImpactOptions& options = {});

/// Called for each pair that may touch; returns whether to go on.
using ImpactCandidateVisitor = FunctionRef<bool(const ElementPair&)>;

/// The pairs of elements that may come within min_separation of each other up to max_time, each once, for solvers that
/// compare elements themselves: all that do, and few others. Bounds follow each vertex on its own way, so one that goes
/// far adds no pairs of others.
///
/// Promise  None that does is missed. time_error, `ignore_crossings` and `any_contact` make no difference.
/// Throws   As visit_impacts().
/// Cost     As time_of_impact() without comparing elements. Allocates nothing, unless it is parallel.
LIMBER_API PairCount visit_impact_candidates(const MovingModel& a, const MovingModel& b, ImpactCandidateVisitor visit,
                                             const ImpactOptions& options = {});
LIMBER_API PairCount visit_self_impact_candidates(const MovingModel& model, ImpactCandidateVisitor visit,
                                                  const ImpactOptions& options = {});

// --- steps for solvers ---

/// Limits how far each vertex may go, on whatever path, so that no two elements of a model that share no vertex come
/// nearer than a separation.
///
/// Shape    `displacements` has a number for each vertex: how far it would like to go, from 0 to 2^200. Those that are
///          too large for safety are made smaller, so calls for a model with itself and with others add up. How two
///          vertices share what room there is depends on the order of pairs, so on the model's history, but not on the
///          processor or threads.
/// Promise  If no vertex goes farther than its number says, elements that are at least the separation apart stay so all
///          the way. Vertices of elements that are nearer get 0. Rounded down.
/// Throws   As visit_self_element_pairs(); std::invalid_argument if there are not as many numbers as vertices, one is
///          not what it should be, or the separation is not from 0 to 2^200.
/// Cost     As visit_self_element_pairs() with the separation and twice the largest number as margin: one vertex that
///          would like to go far makes all slow. limit_self_motions() costs less and allows more.
/// Source   The displacement bounds of Offset Geometric Contact [Chen2025], but room that one element does not want is
///          left to the other.
LIMBER_API void limit_self_displacements(const Model& model, double separation, std::span<double> displacements);

/// Limits displacements of two models, as limit_self_displacements() does of one, for pairs of elements of both. A
/// model b without numbers stands still. `of_a` and `of_b` must not overlap.
LIMBER_API void limit_displacements(const Placed& a, const Placed& b, double separation, std::span<double> of_a,
                                    std::span<double> of_b = {});

/// Limits how far each vertex may go along its own motion, at any pace, so that no two elements of a model that share
/// no vertex come nearer than a separation. Moving away, or sideways at the separation, is free.
///
/// Shape    `fractions` has a number for each vertex: how much of its motion it would like to make, from 0 to 1. Those
///          that are too large for safety are made smaller, so calls add up.
/// Promise  Wherever each vertex is between its start and its fraction of the motion, whatever the others do, elements
///          that are at least the separation apart at the start stay so, and nearer ones keep their distance, but for
///          the rounding of positions, 2^-47 of the largest coordinate. Elements that touch stay where they are.
/// Throws   As self_time_of_impact(); std::invalid_argument if there are not as many numbers as vertices, one is not
///          from 0 to 1, or the separation is not from 0 to 2^200.
/// Cost     Twice that of visit_self_impact_candidates(): each vertex is looked at along its own way.
LIMBER_API void limit_self_motions(const MovingModel& model, double separation, std::span<double> fractions);

/// Limits the motions of two models, for pairs of elements of both. A model b without numbers stays at its start.
LIMBER_API void limit_motions(const MovingModel& a, const MovingModel& b, double separation, std::span<double> of_a,
                              std::span<double> of_b = {});

}  // namespace limber
