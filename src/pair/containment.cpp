// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/containment.h"

#include <utility>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/slot_stack.h"
#include "point/closest_point.h"
#include "point/placed_model.h"
#include "point/ray_crossings.h"

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
        error_(base::placement_error * (model.magnitude() + solid.magnitude())) {}

  /// Whether a vertex has been found; unknown if the budget has been spent first.
  Answer run(std::uint64_t& steps, BudgetMeter& meter) {
    const bvh::Tree& tree = model_.tree();
    bvh::SlotStack waiting;
    waiting.start(0);
    for (bvh::SlotStack::Entry next; waiting.take(0, next);) {
      if (meter.is_spent(steps)) return Answer::unknown;
      ++steps;
      if (!meets_surface(next.slot)) {
        const Vec3 center = center_of(next.slot);
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
        if (k > 0 && leaf.triangle[k] == leaf.triangle[k - 1]) continue;  // the slot is not in use
        if (meter.is_spent(steps)) return Answer::unknown;
        ++steps;
        if (!is_inside(model_.position(leaf.vertices[k][0]))) continue;
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
  Vec3 center_of(bvh::SlotId slot) const { return model_.pose()(bvh::slot_center(model_.tree(), slot)); }

  bool meets_surface(bvh::SlotId slot) {
    const bvh::Tree& tree = model_.tree();
    const double units = tree.nodes[bvh::node_of(slot)].bounds.radius[bvh::slot_of(slot)];
    const double radius = (tree.unit * units + tree.slack) * (1 + base::rigidity_error) + 2 * error_;
    LIMBER_ASSERT(radius >= 0);
    return closest_.find(center_of(slot), radius, stats_, radius).has_value();
  }
  bool is_inside(const Vec3& point) {
    const point::Surrounding surrounding = point::surrounding_of(solid_, point, stats_);
    return surrounding.is_on || surrounding.winding_number != 0;
  }
  void take(const bvh::Leaf& leaf, std::uint32_t k) {
    vertex_ = model_.position(leaf.vertices[k][0]), triangle_ = leaf.triangle[k];
  }

  const point::PlacedModel &model_, &solid_;
  point::ClosestPointSearch closest_;
  QueryStats& stats_;
  double error_;
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
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a)) continue;
    if (meter.is_spent(steps)) return {Answer::unknown, {}};
    ++steps;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    if (search.begins_inside()) return found(search, is_in_a);
  }
  for (const bool is_in_a : {true, false}) {
    if (!is_solid(is_in_a)) continue;
    InsideSearch& search = searches[is_in_a ? 0 : 1];
    const Answer answer = search.run(steps, meter);
    if (answer == Answer::yes) return found(search, is_in_a);
    if (answer == Answer::unknown) return {answer, {}};
  }
  return {};
}

}  // namespace limber::pair
