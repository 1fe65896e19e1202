// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/still_objects.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/check.h"

namespace limber::scene {

StillObjects::StillObjects(const Scene::Impl& all, std::span<const ObjectId> ids_of_moving)
    : scene(all), moving(ids_of_moving.begin(), ids_of_moving.end()), slots(all.objects.size(), no_id) {
  std::sort(moving.begin(), moving.end());
  moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
  for (std::size_t slot = 0; slot < moving.size(); ++slot) slots[moving[slot]] = static_cast<std::uint32_t>(slot);
  std::vector<ObjectId> others;
  std::copy_if(all.ids.begin(), all.ids.end(), std::back_inserter(others), [&](ObjectId id) { return !moves(id); });
  tree.build(others, all.bounds);
  if (others.size() <= bvh::width) return;
  Vec3 low = all.bounds[others[0]].sphere.center, high = low;
  for (const ObjectId id : others) {
    low = min(low, all.bounds[id].sphere.center), high = max(high, all.bounds[id].sphere.center);
  }
  grid = HilbertGrid::of(low, high);
  for (std::uint32_t rank = 0; grid && rank < tree.size(); ++rank) {
    cells.push_back(grid->cell_of(all.bounds[tree.id_of(rank)].sphere.center));
  }
  LIMBER_ASSERT(std::is_sorted(cells.begin(), cells.end()));
}

MovedObjects::MovedObjects(const StillObjects& still) : still_(still) {
  for (const ObjectId id : still.moving) {
    movers_.ids.push_back(static_cast<ObjectId>(movers_.objects.size()));
    movers_.objects.push_back(still.scene.objects[id]);
    movers_.bounds.push_back(still.scene.bounds[id]);
  }
}

void MovedObjects::place(std::span<const ObjectId> ids, std::span<const Transform> poses) {
  for (std::size_t j = 0; j < ids.size(); ++j) movers_.set_pose(still_.slots[ids[j]], poses[j]);
  for (const ObjectId slot : movers_.ids) movers_.update_bounds(slot);
  movers_.tree.build(movers_.ids, movers_.bounds);
}

void MovedObjects::visit_neighbors(PairVisitor visit) {
  near_.clear();
  const auto is_inside = [&](const WorldBounds& mover) { return still_.grid->contains(mover.sphere.center); };
  const bool has_grid = still_.grid && std::all_of(movers_.bounds.begin(), movers_.bounds.end(), is_inside);
  if (has_grid) {
    // The grid of all objects is that of those that stay. Neighbors of a mover are in its cell, or in the next that has
    // objects.
    const auto& cells = still_.cells;
    const auto add_cell = [&](std::uint32_t cell) {
      const auto [begin, end] = std::equal_range(cells.begin(), cells.end(), cell);
      for (auto i = begin; i < end; ++i)
        near_.push_back(still_.tree.id_of(static_cast<std::uint32_t>(i - cells.begin())));
      return std::pair(begin, end);
    };
    for (const WorldBounds& mover : movers_.bounds) {
      const auto [begin, end] = add_cell(still_.grid->cell_of(mover.sphere.center));
      if (begin > cells.begin()) add_cell(begin[-1]);
      if (end < cells.end()) add_cell(*end);
    }
    near_.insert(near_.end(), still_.moving.begin(), still_.moving.end());
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
  } else {
    near_ = still_.scene.ids;
  }
  centers_.clear();
  for (const ObjectId id : near_) centers_.push_back(bounds(id).sphere.center);
  const std::span<const std::uint32_t> order = order_.sort(centers_, has_grid ? &*still_.grid : nullptr);
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    const auto [a, b] = std::minmax(near_[order[i]], near_[order[i + 1]]);
    if (still_.moves(a) || still_.moves(b)) visit({a, b}, lower_bound(bounds(a), bounds(b)));
  }
}

void MovedObjects::visit_pairs(double margin, PairVisitor visit) const {
  const auto visit_ids = [&](ObjectId s, ObjectId t) {
    const auto [a, b] = std::minmax(s, t);
    visit({a, b}, lower_bound(bounds(a), bounds(b)));
    return true;
  };
  for (std::uint32_t leaf = 0; leaf < movers_.tree.leaf_count(); ++leaf) {
    movers_.tree.visit_pairs(leaf, margin, [&](std::uint32_t rank_a, std::uint32_t rank_b) {
      return visit_ids(still_.moving[movers_.tree.id_of(rank_a)], still_.moving[movers_.tree.id_of(rank_b)]);
    });
  }
  for (std::size_t slot = 0; slot < still_.moving.size(); ++slot) {
    still_.tree.visit_near(movers_.bounds[slot], margin,
                           [&](std::uint32_t rank) { return visit_ids(still_.moving[slot], still_.tree.id_of(rank)); });
  }
}

}  // namespace limber::scene
