// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/check.h"
#include "limber/scene.h"
#include "scene/box_tree.h"
#include "scene/world_bounds.h"

namespace limber {

struct Scene::Impl {
  struct Object {
    Placed placed;
    scene::LocalBounds local{};
    scene::ModelState state{};  // when `local` was read
    bool exists = true;
    bool is_moved = true;  // since the last commit
  };

  std::vector<Object> objects;             // by id
  std::vector<scene::WorldBounds> bounds;  // by id
  std::vector<ObjectId> free_ids;          // the last one is taken first
  std::vector<ObjectId> ids;               // of the objects in the tree, ascending
  scene::BoxTree tree;
  bool is_changed = false;  // since the last commit

  bool contains(ObjectId id) const { return id < objects.size() && objects[id].exists; }
  bool is_committed() const;
  void set_pose(ObjectId id, const Transform& world_from_model) {
    LIMBER_ASSERT(contains(id));
    objects[id].placed.pose = world_from_model;
    objects[id].is_moved = true;
  }
  void update_bounds(ObjectId id);

  ObjectPair pair_of(std::uint32_t rank_a, std::uint32_t rank_b) const {
    const ObjectId a = tree.id_of(rank_a), b = tree.id_of(rank_b);
    return a < b ? ObjectPair{a, b} : ObjectPair{b, a};
  }
  const Placed& placed(ObjectId id) const {
    LIMBER_ASSERT(contains(id));
    return objects[id].placed;
  }
};

namespace scene {

inline void require_committed(const Scene::Impl& scene, const char* function) {
  LIMBER_REQUIRE(scene.is_committed(),
                 (std::string(function) + ": objects or models have changed since the last commit").c_str());
}

}  // namespace scene
}  // namespace limber
