// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/containment.h"

#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::pair {
namespace {

/// Searches the tree of one model for a part that is inside of another model's closed surface.
class InsideSearch {
 public:
  InsideSearch(const point::PlacedModel& model, const point::PlacedModel& solid, QueryStats& stats)
      : model_(model),
        solid_(solid),
        closest_(solid),
        stats_(stats),
        center_of_solid_(bvh::slot_center(solid.tree(), bvh::root_slot)),
        radius_of_solid_(bvh::root_radius(solid.tree())),
        error_(base::placement_error * (model.magnitude() + solid.magnitude())) {}

  /// Whether a vertex has been found; unknown if the budget has been spent first.
  Answer run(std::uint64_t& steps, BudgetMeter& meter) {
    const bvh::Tree& tree = model_.tree();
    bvh::SlotStack waiting;
    waiting.start(0);
    for (bvh::SlotStack::Entry next; waiting.take(0, next);) {
      const Vec3 center = model_.center_of(next.slot);
      const double radius = model_.radius_of(next.slot) + 2 * error_;
      if (is_off_solid(center, radius)) continue;
      if (meter.is_spent(steps)) return Answer::undecided;
      ++steps;
      // A volume as large as the solid that is next to it most likely meets its surface.
      if (radius < radius_of_solid_ && !meets_surface(center, radius)) {
        if (!is_inside(center)) continue;
        take(bvh::first_leaf(tree, next.slot).leaf, 0);
        return Answer::yes;
      }
      if (!bvh::has_leaf(tree, next.slot)) {
        const std::uint32_t n = bvh::child_of(tree, next.slot);
        waiting.add(n, (1U << tree.nodes[n].child_count) - 1);
        continue;
      }
      const bvh::Leaf& leaf = bvh::leaf_of(tree, next.slot);
      for (std::uint32_t k = 0; k < bvh::width; ++k) {
        if (!leaf.is_in_use(k)) continue;
        const Vec3 corner = model_.position(leaf.vertices[k][0]);
        if (is_off_solid(corner, 0)) continue;
        if (meter.is_spent(steps)) return Answer::undecided;
        ++steps;
        if (!is_inside(corner)) continue;
        take(leaf, k);
        return Answer::yes;
      }
    }
    return Answer::no;
  }

  /// Pre: run() has answered yes.
  const Vec3& vertex() const { return vertex_; }
  TriangleId triangle() const { return triangle_; }

  /// Whether the first vertex of the tree is inside: the answer where all of the model is.
  bool begins_inside() {
    const bvh::Leaf& leaf = bvh::first_leaf(model_.tree(), 0).leaf;
    if (!is_inside(model_.position(leaf.vertices[0][0]))) return false;
    take(leaf, 0);
    return true;
  }

 private:
  /// Whether a ball certainly misses the box around the solid, or its slab: then it is outside.
  bool is_off_solid(const Vec3& center, double radius) {
    ++stats_.node_tests;
    const Vec3 point = solid_.in_model(center) - center_of_solid_;
    const double rounding = (bvh::sum_of_coordinates(point) + radius) * base::root_error + error_;
    return bvh::root_gap(solid_.tree(), point) > radius + rounding;
  }
  bool meets_surface(const Vec3& center, double radius) {
    return closest_.find(center, radius, stats_, radius).has_value();
  }
  bool is_inside(const Vec3& point) { return point::surrounding_of(solid_, point, stats_).is_inside_or_on(); }
  void take(const bvh::Leaf& leaf, std::uint32_t k) {
    vertex_ = model_.position(leaf.vertices[k][0]), triangle_ = leaf.triangle[k];
  }

  const point::PlacedModel &model_, &solid_;
  point::ClosestPointSearch closest_;
  QueryStats& stats_;
  Vec3 center_of_solid_;  // of the box around it, in its own frame
  double radius_of_solid_, error_;
  Vec3 vertex_;
  TriangleId triangle_ = no_id;
};

}  // namespace

Containment find_containment(const Placed& a, const Placed& b, std::uint64_t steps, BudgetMeter& meter,
                             QueryStats& stats) {
  LIMBER_ASSERT(has_solid(a, b));
  const point::PlacedModel placed_a(a), placed_b(b);
  const auto is_solid = [&](bool is_a) { return (is_a ? a : b).body().is_solid(); };
  InsideSearch searches[] = {{placed_b, placed_a, stats}, {placed_a, placed_b, stats}};
  // Which triangle of the surface around it is named does not matter.
  const auto found = [](const InsideSearch& search, bool is_in_a) {
    const TriangleId of_a = is_in_a ? 0 : search.triangle(), of_b = is_in_a ? search.triangle() : 0;
    return Containment{Answer::yes, Witness{search.vertex(), search.vertex(), of_a, of_b}};
  };
  // Where one is inside of the other as a whole, its first vertex tells; to look at all of the outer one may take long.
  // A core in one piece is inside as a whole or not at all, since the surfaces do not meet: its first vertex is enough.
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a)) continue;
    if (meter.is_spent(steps)) return {Answer::undecided, {}};
    ++steps;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    if (search.begins_inside()) return found(search, is_in_a);
  }
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a) || Access::is_in_one_piece((is_in_a ? b : a).body())) continue;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    const Answer answer = search.run(steps, meter);
    if (answer == Answer::yes) return found(search, is_in_a);
    if (answer == Answer::undecided) return {answer, {}};
  }
  return {};
}

}  // namespace limber::pair
