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

#include "limber/contacts.h"
#include "limber/model.h"
#include "limber/path.h"

/// The broad phase: many placed models, the pairs of them that may be close, and queries of many pairs on all threads.
namespace limber {

/// Names an object of a scene. It stays the same until the object is removed; then a later object may get it.
using ObjectId = std::uint32_t;

/// Two objects of a scene, a < b.
struct ObjectPair {
  ObjectId a = no_id, b = no_id;
  friend bool operator==(const ObjectPair&, const ObjectPair&) = default;
};

/// Called for each pair; returns whether to go on.
using ObjectPairVisitor = FunctionRef<bool(const ObjectPair&)>;

/// Which pairs count: called for pairs whose bounds are close, with a < b, by the thread that asks, now and then twice.
/// The functions for many configurations call it a few times at most for two objects, close or not.
using ObjectPairFilter = FunctionRef<bool(ObjectId a, ObjectId b)>;

/// Which pairs of objects count, as a symmetric matrix of bits: an ObjectPairFilter. Robots call it the allowed
/// collision matrix, where those pairs are allowed that do not count here.
///
///   limber::ObjectPairMatrix counts(scene.id_bound());
///   counts.set(upper_arm, forearm, false);  // neighbors in a chain
///   counts.set_among(shelf, false);         // the models of one body, as ids
///   scene.closest_objects({.filter = counts});
///
/// Cost     A bit for each two ids. Every function takes O(1) for each pair that it names.
/// Throws   std::invalid_argument if an id is not below size(), or two ids are the same where a pair is named; the
///          matrix is then as before. A filter throws so too: it has to be as large as id_bound() of the scene.
/// Threads  Const functions may run concurrently.
class ObjectPairMatrix {
 public:
  /// All pairs of ids below `size` count, or none does.
  LIMBER_API explicit ObjectPairMatrix(std::size_t size, bool counts = true);

  std::size_t size() const { return size_; }
  /// Takes more ids, or fewer: what is said of ids below both sizes stays, pairs of new ids count or not.
  ///
  /// Throws   std::bad_alloc, whose text says how large it would be; the matrix is then as before. As the constructor.
  LIMBER_API void resize(std::size_t size, bool counts = true);
  LIMBER_API void set(ObjectId a, ObjectId b, bool counts);
  /// Says it of every two different ids of a list.
  LIMBER_API void set_among(std::span<const ObjectId> ids, bool counts);
  /// Says it of every id of one list with every other id of another.
  LIMBER_API void set_between(std::span<const ObjectId> ids_a, std::span<const ObjectId> ids_b, bool counts);

  /// Whether a pair counts: the filter. An object with itself does not.
  LIMBER_API bool operator()(ObjectId a, ObjectId b) const;

 private:
  void require_ids(std::span<const ObjectId> ids, const char* function) const;
  void write(ObjectId a, ObjectId b, bool counts);

  std::size_t size_;
  std::vector<std::uint64_t> bits_;  // of the pairs {1, 0}, {2, 0}, {2, 1}, ...
};

/// Called for each object; returns whether to go on.
using ObjectVisitor = FunctionRef<bool(ObjectId)>;
/// Which objects count next to a placed model: called for those whose bounds are close to its own.
using ObjectFilter = FunctionRef<bool(ObjectId)>;

/// The two objects of a scene that are closest to each other.
struct [[nodiscard]] ClosestObjectsResult {
  ObjectPair objects;     ///< no_id exactly when the result has no witness
  DistanceResult result;  ///< of a and b, in this order
};

/// Two objects of a scene that are within a distance.
struct [[nodiscard]] AnyWithinResult {
  ObjectPair objects;    ///< no_id unless the answer is yes
  CollideResult result;  ///< whether there are two such objects; the witness is of a and b, in this order
};

/// The object of a scene that is closest to a placed model.
struct [[nodiscard]] ClosestObjectResult {
  ObjectId object = no_id;  ///< no_id exactly when the result has no witness
  DistanceResult result;    ///< of the placed model and the object, in this order
};

/// The object of a scene that a moving body touches first.
struct [[nodiscard]] ObjectImpactResult {
  ObjectId object = no_id;  ///< no_id exactly when the result has no witness
  PathImpact result;  ///< of the body and the object, in this order; `distance_count` and `stats` count all objects
};

/// The contacts of many pairs of objects.
struct ObjectContacts {
  std::vector<Contact> contacts;     ///< pair by pair
  std::vector<std::size_t> offsets;  ///< pair i has contacts from offsets[i] to offsets[i + 1]; one more than pairs
};

/// What the queries of a scene have found, for those of the next frame to start from: a QueryCache for each of the
/// pairs asked about last, and the closest objects. Answers do not depend on it beyond rounding and the asked error; a
/// cache that was filled by another scene only costs time.
///
/// Memory   At most 90 kB for each of `max_pairs` pairs, allocated when they are asked about. Where a call is about
///          more pairs, some are asked without. Otherwise those that have not been asked about for longest lose theirs.
/// Cost     Pays where models move by a hundredth of their size between calls, or less; docs/design/scene.md.
/// Threads  One call at a time.
class SceneCache {
 public:
  static constexpr std::size_t usual_max_pairs = 256;

  LIMBER_API explicit SceneCache(std::size_t max_pairs = usual_max_pairs);
  LIMBER_API SceneCache(SceneCache&&) noexcept;
  LIMBER_API SceneCache& operator=(SceneCache&&) noexcept;
  LIMBER_API ~SceneCache();

  /// Makes the next queries start from nothing, and frees the memory.
  LIMBER_API void clear();

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  Impl& impl();

  std::size_t max_pairs_;
  std::unique_ptr<Impl> impl_;
};

/// How questions of yes or no are asked about many pairs.
///
/// Budget   In all options of scenes, the deadline and the flag are those of the whole call, a number of steps is that
///          of each pair. Pairs that are asked after the deadline make one step each.
/// Throws   std::invalid_argument if a filter comes with a list of pairs, or a cache where the call finds the pairs.
struct SceneQueryOptions {
  std::optional<ObjectPairFilter> filter = std::nullopt;  ///< all pairs count without one
  SceneCache* cache = nullptr;  ///< what the last frame has found, to start from; null for none
  QueryBudget budget = {};      ///< when the call has to end; the default has no limits
};

/// How distances are asked of many pairs.
///
/// Throws   std::invalid_argument if `distance` has a cache of its own, or a filter comes with a list of pairs.
struct SceneDistanceOptions {
  DistanceOptions distance = {};                          ///< how good they must be; its budget is as above
  std::optional<ObjectPairFilter> filter = std::nullopt;  ///< all pairs count without one
  SceneCache* cache = nullptr;                            ///< what the last frame has found, to start from
};

/// How the object closest to a placed model is asked for. `distance` takes no cache.
struct ClosestObjectOptions {
  DistanceOptions distance = {};
  std::optional<ObjectFilter> filter = std::nullopt;  ///< all objects count without one
};

/// How the object that a body touches first is asked for. `path` takes no cache.
struct ObjectImpactOptions {
  PathOptions path = {};
  std::optional<ObjectFilter> filter = std::nullopt;  ///< all objects count without one
};

/// Many models, shapes and solids, each with a pose.
///
/// Objects are added, moved and removed one by one. commit() then takes over where they are, and reads the bounds of
/// models that have been committed, rebuilt or reset since the last time. After that the scene may be queried.
///
/// Alias    Keeps a pointer to each model: a model must outlive its objects, at its address. Any number of objects may
///          share one.
/// Threads  Const functions may run concurrently, if nobody commits a model of the scene at that time; other functions
///          need the scene alone. Visitors and filters are called by the thread that asks; they may ask the scene, but
///          not change it.
/// Throws   Functions that allocate throw std::bad_alloc when they cannot. After that, and after
///          std::invalid_argument, the scene is as before the call. A scene that has been moved from may be destroyed
///          and assigned to; every other function throws std::invalid_argument.
/// Source   docs/design/scene.md.
class Scene {
 public:
  LIMBER_API Scene();
  LIMBER_API Scene(Scene&&) noexcept;
  LIMBER_API Scene& operator=(Scene&&) noexcept;
  LIMBER_API ~Scene();

  /// Adds an object, and returns its id: the one that was freed last, otherwise the next number after all others.
  ///
  /// Throws   std::invalid_argument unless the model is committed and the pose is rigid (is_rigid()).
  /// Cost     O(1), amortized.
  [[nodiscard]] LIMBER_API ObjectId add(const Placed& object);

  /// Takes an object out.
  ///
  /// Throws   std::invalid_argument unless `id` names an object of the scene. The same goes for all ids below.
  /// Cost     O(1), amortized.
  LIMBER_API void remove(ObjectId id);

  /// Places an object elsewhere.
  ///
  /// Throws   Also unless the pose is rigid.
  /// Cost     O(1).
  LIMBER_API void set_pose(ObjectId id, const Transform& world_from_model);

  /// Places object `ids[i]` at `poses[i]`; later entries win where an id is repeated.
  ///
  /// Throws   Also unless there are as many poses as ids. If one entry is bad, no object is moved.
  /// Cost     O(entries).
  LIMBER_API void set_poses(std::span<const ObjectId> ids, std::span<const Transform> poses);

  /// Prepares the scene for queries. Does nothing when neither objects nor models have changed.
  ///
  /// Throws   std::invalid_argument unless all models of the scene are committed.
  /// Cost     O(n), and O(n log n) where objects lie in clusters within clusters; on the threads of the calling oneTBB
  ///          arena where there are thousands. Allocates where there are more objects than ever.
  LIMBER_API void commit();
  /// Whether nothing has changed since the last commit(), neither objects nor their models.
  ///
  /// Cost     O(n), of some nanoseconds each.
  LIMBER_API bool is_committed() const;

  LIMBER_API std::size_t size() const;
  /// All ids are less than this.
  LIMBER_API ObjectId id_bound() const;
  LIMBER_API bool contains(ObjectId id) const;
  /// A model and its pose. Valid until objects are added.
  LIMBER_API const Placed& object(ObjectId id) const;
  /// A box that contains the object where it was at the last commit. It is slightly larger than necessary.
  ///
  /// Frame    World.
  /// Throws   Also unless the scene is committed.
  LIMBER_API Box bounding_box(ObjectId id) const;

  /// The pairs of objects whose bounds are at most `margin` apart: boxes along the axes of the world, and spheres.
  ///
  /// Promise  Each such pair once. No pair is missing for which distance() would answer at most `margin`, or within()
  ///          yes. The second form writes the first pairs.size() of them; count says how many there are.
  /// Order    Depends on the objects, their ids and bounds alone: not on the processor, threads, or what was before.
  ///          It is not sorted.
  /// Throws   std::invalid_argument unless the scene is committed and the margin is finite and >= 0; whatever a visitor
  ///          or a filter throws.
  /// Cost     About O(n + pairs), O(n^2) at worst; allocates nothing.
  LIMBER_API PairCount visit_candidate_pairs(double margin, ObjectPairVisitor visit,
                                             std::optional<ObjectPairFilter> filter = std::nullopt) const;
  LIMBER_API PairCount candidate_pairs(double margin, std::span<ObjectPair> pairs,
                                       std::optional<ObjectPairFilter> filter = std::nullopt) const;

  /// Asks collide(), within() or distance() of each pair: results[i] is that of pairs[i]. Takes no filter.
  ///
  /// Promise  The same results, to the bit, on any number of threads, unless time or a flag ends the call. Without a
  ///          cache they are those of the functions for two models.
  /// Throws   std::invalid_argument unless the scene is committed, there are as many results as pairs, both ids of each
  ///          pair name objects of the scene, and options are as those functions say. Whatever is thrown, no result
  ///          counts.
  /// Cost     That of the queries, on the threads of the calling oneTBB arena. A cache adds some 100 ns a pair.
  LIMBER_API void collide(std::span<const ObjectPair> pairs, std::span<CollideResult> results,
                          const SceneQueryOptions& options = {}) const;
  LIMBER_API void within(std::span<const ObjectPair> pairs, double max_distance, std::span<CollideResult> results,
                         const SceneQueryOptions& options = {}) const;
  LIMBER_API void distance(std::span<const ObjectPair> pairs, std::span<DistanceResult> results,
                           const SceneDistanceOptions& options = {}) const;

  /// The contacts of each pair, as visit_contacts() finds them for its two models, in that order. Several threads call
  /// the filter; `parallel` changes nothing.
  ///
  /// found    What was in it is replaced; its memory is used again, so keep it for the next frame.
  ///
  /// Promise  The same contacts, to the bit and in order, on any number of threads.
  /// Budget   If it is spent, `found` has those of the first pairs alone: offsets.size() - 1 pairs are done.
  /// Throws   As collide(), and unless the margin is finite and >= 0; `found` is then empty or unchanged.
  /// Cost     That of the queries, on the threads of the calling oneTBB arena.
  LIMBER_API void contacts(std::span<const ObjectPair> pairs, double margin, ObjectContacts& found,
                           const PairOptions& options = {}) const;

  /// The clearance of the scene: the shortest distance of any two objects that the filter lets through.
  ///
  /// Promise  lower <= shortest distance <= upper, as distance() promises for two models. The same result, to the bit,
  ///          on any number of threads. Which of several equally close pairs is named is not defined beyond that.
  /// Limit    If no two objects are as close as max_distance, or there are none, the status is `beyond_limit`.
  /// Budget   If it is spent first, the status is `interrupted`, as of distance(); without objects if none was asked.
  /// Throws   As candidate_pairs(), and distance() for its options.
  /// Cost     Distances of the few pairs whose bounds are closer than the closest pair, on the threads of the calling
  ///          oneTBB arena, and that of candidate_pairs(). Allocates some kB.
  LIMBER_API ClosestObjectsResult closest_objects(const SceneDistanceOptions& options = {}) const;

  /// Whether any two objects that the filter lets through are at most `max_distance` apart; with 0, whether any two
  /// meet. Stops at the first such pair.
  ///
  /// Promise  As within() for two models. The same result, to the bit, on any number of threads. Which of several such
  ///          pairs is named is not defined beyond that.
  /// Budget   If it is spent before a pair is found, the answer is undecided.
  /// Throws   As candidate_pairs(), and unless max_distance is finite and >= 0.
  /// Cost     That of candidate_pairs() and of asking them, on the threads of the calling oneTBB arena. Allocates some
  ///          kB.
  LIMBER_API AnyWithinResult any_within(double max_distance, const SceneQueryOptions& options = {}) const;

  // --- many configurations ---
  //
  // In configuration k, ids[j] is at poses[k * ids.size() + j]; later entries win where an id is repeated. All other
  // objects are where they were at the last commit. The scene does not change.

  /// Asks closest_objects() of many configurations: results[k] is that of configuration k.
  ///
  /// Promise  results[k] is what closest_objects() would answer, to the bit, had set_poses() and commit() placed the
  ///          objects so. The same results on any number of threads.
  /// Budget   Configurations that are left when the deadline has passed, or the flag is set, have status `interrupted`,
  ///          no objects, lower 0 and upper infinity.
  /// Throws   As set_poses() and closest_objects(); unless there are results.size() poses of each id, and no cache is
  ///          given. Whatever is thrown, no result counts.
  /// Cost     For each configuration distances of the few pairs whose bounds are closer than the closest pair, and
  ///          O(log n) for each object that moves among n, where the filter leaves out pairs of those that stay; where
  ///          it counts any, O(n). Threads of the calling oneTBB arena take one configuration after the other. A filter
  ///          is called before and after, for each pair of which one moves and for close ones of the others; else once
  ///          for every two objects. Allocates a copy of what moves, or of the scene, for each thread.
  LIMBER_API void closest_objects_many(std::span<const ObjectId> ids, std::span<const Transform> poses,
                                       std::span<ClosestObjectsResult> results,
                                       const SceneDistanceOptions& options = {}) const;
  /// Asks any_within() of many configurations, each O(n), with a copy of the scene. A filter is called once for every
  /// two objects. All else as above; those that are left when time is up are undecided.
  LIMBER_API void any_within_many(std::span<const ObjectId> ids, std::span<const Transform> poses, double max_distance,
                                  std::span<AnyWithinResult> results, const SceneQueryOptions& options = {}) const;

  // --- one model next to all objects ---
  //
  // The model need not be in the scene. For an object of the scene, pass object(id) and a filter that leaves it out.

  /// The objects whose bounds are at most `margin` from those of a placed model, of those that the filter lets through.
  /// All else as candidate_pairs(): no object is missing for which distance() would answer at most `margin`.
  ///
  /// Throws   Also unless the model is committed and its pose is rigid.
  /// Cost     About O(log n + objects).
  LIMBER_API PairCount visit_candidates(const Placed& model, double margin, ObjectVisitor visit,
                                        std::optional<ObjectFilter> filter = std::nullopt) const;

  /// The object that is closest to a placed model, of those that the filter lets through. All else as
  /// closest_objects().
  ///
  /// Throws   Also unless the model is committed and its pose is rigid.
  LIMBER_API ClosestObjectResult closest_object(const Placed& model, const ClosestObjectOptions& options = {}) const;

  /// The object that a body touches first on its way, of those that the filter lets through; all objects stand where
  /// they were at the last commit. Other engines call this a sweep or a shape cast.
  ///
  /// Promise  As time_of_impact() of two bodies (path.h): nothing that counts is within the separation before the time.
  ///          Which of several objects that are touched at the same time is named is not defined beyond that.
  /// Budget   If it is spent first, the status is `undecided`, and nothing touches before the time.
  /// Throws   As time_of_impact() of two bodies, and unless the scene is committed; whatever the filter throws.
  /// Cost     For each piece of the way about as long as the body, that of visit_candidates(); that of time_of_impact()
  ///          for each object near the way up to the first impact. On the calling thread. Allocates a bit for each id,
  ///          and 16 bytes for each object near a piece.
  LIMBER_API ObjectImpactResult time_of_impact(const Body& body, const RigidMotion& motion,
                                               const ObjectImpactOptions& options = {}) const;
  LIMBER_API ObjectImpactResult time_of_impact(const Body& body, const RigidPath& path,
                                               const ObjectImpactOptions& options = {}) const;

  /// For the library's own use.
  struct Impl;

 private:
  const Impl& impl(const char* function) const;
  Impl& impl(const char* function);

  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
