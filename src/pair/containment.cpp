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
  TriangleId closest_of_surface() {
    const auto closest = closest_.find(vertex_, std::numeric_limits<double>::infinity(), stats_);
    LIMBER_ASSERT(closest.has_value());
    return closest->triangle;
  }

 private:
  Vec3 center_of(bvh::SlotId slot) const { return model_.pose()(bvh::slot_center(model_.tree(), slot)); }

  bool meets_surface(bvh::SlotId slot) {
    const bvh::Tree& tree = model_.tree();
    const double units = tree.nodes[bvh::node_of(slot)].bounds.radius[bvh::slot_of(slot)];
    const double radius = (tree.unit * units + tree.slack) * (1 + base::rigidity_error) + 2 * error_;
    LIMBER_ASSERT(radius >= 0);
    return closest_.find(center_of(slot), radius, stats_).has_value();
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
  for (const bool is_in_a : {true, false}) {
    if (!(is_in_a ? a : b).body().is_solid()) continue;
    InsideSearch search(is_in_a ? placed_b : placed_a, is_in_a ? placed_a : placed_b, stats);
    const Answer answer = search.run(steps, meter);
    if (answer == Answer::no) continue;
    if (answer == Answer::unknown) return {answer, {}};
    TriangleId of_a = search.closest_of_surface(), of_b = search.triangle();
    if (!is_in_a) std::swap(of_a, of_b);
    return {answer, Witness{search.vertex(), search.vertex(), of_a, of_b}};
  }
  return {};
}

}  // namespace limber::pair
