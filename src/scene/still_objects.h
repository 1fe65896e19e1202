// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scene/box_tree.h"
#include "scene/scene_impl.h"

namespace limber::scene {

/// The objects of a scene that stay where they are in many configurations: what is found out about them once, and then
/// read by all threads. The scene is committed, and stays as it is.
struct StillObjects {
  StillObjects(const Scene::Impl& all, std::span<const ObjectId> ids_of_moving);

  bool moves(ObjectId id) const { return slots[id] != no_id; }

  const Scene::Impl& scene;
  std::vector<ObjectId> moving;      // ascending, each once; their places here are slots
  std::vector<std::uint32_t> slots;  // by id, no_id where an object stays
  BoxTree tree;                      // of those that stay
  std::optional<HilbertGrid> grid;   // in which the tree is ordered; none if a few stay
  std::vector<std::uint32_t> cells;  // of that grid, by rank
};

/// One configuration: the other objects, where they have moved to. It finds pairs of objects of which at least one
/// moves, and the lower bounds of their distances, as the tree of all objects would.
class MovedObjects {
 public:
  using PairVisitor = FunctionRef<void(const ObjectPair&, double bound)>;

  /// Refers to `still`.
  explicit MovedObjects(const StillObjects& still);
  /// Moves to a configuration: object ids[j] to poses[j].
  void place(std::span<const ObjectId> ids, std::span<const Transform> poses);

  const Scene::Impl& scene() const { return still_.scene; }
  std::size_t size() const { return still_.tree.size() + movers_.ids.size(); }
  const Placed& placed(ObjectId id) const {
    return still_.moves(id) ? movers_.placed(still_.slots[id]) : still_.scene.placed(id);
  }
  /// Visits the pairs that follow each other in the order of the tree of all objects.
  void visit_neighbors(PairVisitor visit);
  /// Visits the pairs that may be within a margin. Pre: the margin comes from margin_with_error().
  void visit_pairs(double margin, PairVisitor visit) const;

 private:
  const WorldBounds& bounds(ObjectId id) const {
    return still_.moves(id) ? movers_.bounds[still_.slots[id]] : still_.scene.bounds[id];
  }

  const StillObjects& still_;
  Scene::Impl movers_;  // whose ids are slots
  HilbertOrder order_;
  std::vector<ObjectId> near_;  // which visit_neighbors() fills, and their centers
  std::vector<Vec3> centers_;
};

/// The closest objects of a configuration, without tasks: what find_closest() answers, to the bit, if no two objects
/// that stay count. None if more pairs than can wait may be the closest. Sets `margin` to that within which it has
/// looked.
std::optional<ClosestObjectsResult> find_closest_of_moved(MovedObjects& moved, const SceneDistanceOptions& options,
                                                          double& margin);

}  // namespace limber::scene
