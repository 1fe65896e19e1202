// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "limber/contacts.h"
#include "limber/model.h"

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
using ObjectPairFilter = FunctionRef<bool(ObjectId a, ObjectId b)>;

struct ObjectPairOptions {
  std::optional<ObjectPairFilter> filter = std::nullopt;  ///< all pairs count without one
};

/// The two objects of a scene that are closest to each other.
struct ClosestObjects {
  ObjectPair objects;     ///< no_id exactly when the result has no witness
  DistanceResult result;  ///< of a and b, in this order
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
  Impl& impl();

 private:
  std::size_t max_pairs_;
  std::unique_ptr<Impl> impl_;
};

/// How many pairs are asked the same question of yes or no.
struct SceneQueryOptions {
  SceneCache* cache = nullptr;  ///< what the last frame has found, to start from; null for none
};

/// How good distances must be, as DistanceOptions says.
struct SceneDistanceOptions {
  double relative_error = 0, absolute_error = 0;
  double max_distance = std::numeric_limits<double>::infinity();
  SceneCache* cache = nullptr;  ///< what the last frame has found, to start from; null for none
};

/// How good the distance of the closest objects must be, as DistanceOptions says, and which pairs count.
struct ClosestObjectsOptions {
  double relative_error = 0, absolute_error = 0;
  double max_distance = std::numeric_limits<double>::infinity();
  std::optional<ObjectPairFilter> filter = std::nullopt;  ///< all pairs count without one
  SceneCache* cache = nullptr;                            ///< what the last frame has found, to start from
};

/// Many models, each with a pose.
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
  LIMBER_API ObjectId add(const Placed& object);

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
                                             const ObjectPairOptions& options = {}) const;
  LIMBER_API PairCount candidate_pairs(double margin, std::span<ObjectPair> pairs,
                                       const ObjectPairOptions& options = {}) const;

  /// Asks collide(), within() or distance() of each pair: results[i] is that of pairs[i].
  ///
  /// Promise  The same results, to the bit, on any number of threads. Without a cache they are those of the functions
  ///          for two models.
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

  /// The clearance of the scene: the shortest distance of any two objects that the filter lets through.
  ///
  /// Promise  lower <= shortest distance <= upper, as distance() promises for two models. The same result, to the bit,
  ///          on any number of threads. Which of several equally close pairs is named is not defined beyond that.
  /// Limit    If no two objects are as close as max_distance, or there are none, the status is `beyond_limit`.
  /// Throws   As candidate_pairs(), and distance() for its options.
  /// Cost     Distances of the few pairs whose bounds are closer than the closest pair, on the threads of the calling
  ///          oneTBB arena, and that of candidate_pairs(). Allocates some kB.
  LIMBER_API ClosestObjects closest_objects(const ClosestObjectsOptions& options = {}) const;

  /// For the library's own use.
  struct Impl;

 private:
  const Impl& impl(const char* function) const;
  Impl& impl(const char* function);

  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
