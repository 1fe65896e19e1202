// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "penetration/deepest_vertex.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "geometry/local_frame.h"
#include "point/placed_model.h"

namespace limber::penetration {

Vec3 way_out(const point::PlacedModel& solid, const Vec3& position, const SurfacePoint& closest) {
  LIMBER_ASSERT(closest.triangle < solid.mesh().triangles.size());
  // Closest points are off by 2^-50 of the extent, so directions between points that are farther apart than this part
  // of it are off by less than 2^-23.
  constexpr double hardly_apart = 0x1p-26;
  const Triangle t = solid.triangle(solid.mesh().triangles[closest.triangle]);
  const Vec3 edge = t.v1 - t.v0, other = t.v2 - t.v0, out = closest.position - position;
  const double extent = std::max({max_abs(t.v0 - position), max_abs(t.v1 - position), max_abs(t.v2 - position)});
  if (max_abs(out) > hardly_apart * extent) return unit(out);
  if (max_abs(edge) > 0 && max_abs(other) > 0) {
    const Vec3 normal = cross(geometry::near_unit(edge), geometry::near_unit(other));
    if (max_abs(normal) > 0) return unit(normal);
  }
  return max_abs(out) > 0 ? unit(out) : Vec3{0, 0, 1};
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Lengths in a model's frame and in the world differ by that factor at most, as rotations are only nearly orthonormal.
constexpr double stretch = 1 + base::rigidity_error;

bool contains(const point::PlacedModel& solid, const Vec3& point, pair::Meter& meter) {
  return point::surrounding_of(solid, point, meter.stats).is_inside_or_on();
}

}  // namespace

DeepestVertexSearch::DeepestVertexSearch(const point::PlacedModel& model, const point::PlacedModel& solid)
    : model_(model),
      solid_(solid),
      closest_(solid),
      error_(base::placement_error * (model.magnitude() + solid.magnitude())),
      is_compared_(model.mesh().positions.size()) {
  // Everything in the solid is in its sphere.
  waiting_.push({bvh::root_radius(solid.tree()) * stretch + error_, bvh::root_slot, false, {}});
}

double DeepestVertexSearch::upper() const {
  double upper = -infinity;
  if (best_) upper = best_->depth;
  if (!waiting_.empty()) upper = std::max(upper, waiting_.next().bound + error_);
  return upper;
}

void DeepestVertexSearch::run(pair::Meter& meter) {
  while (!waiting_.empty() && can_win(waiting_.next().bound) && !meter.is_spent()) {
    const Entry next = waiting_.take();
    const std::optional<Depth> center = depth_at(next, meter);
    if (!center) continue;
    if (bvh::has_leaf(model_.tree(), next.slot)) {
      compare_vertices(next, *center, meter);
    } else {
      add_children(next, *center);
    }
  }
  if (meter.stopped_by() == StoppedBy::nothing) waiting_.clear();
}

double DeepestVertexSearch::radius_of(bvh::SlotId slot) const { return model_.radius_of(slot) + error_; }

/// At least the distance of anything in a volume from a point of the solid's surface: by its box, or its slab.
double DeepestVertexSearch::reach_from(const Vec3& surface, bvh::SlotId slot) const {
  const bvh::Tree& tree = model_.tree();
  const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
  const std::uint32_t k = bvh::slot_of(slot);
  const Vec3 to_center = bvh::slot_center(tree, slot) - model_.in_model(surface);
  const Vec3 d = to_center * (1 / tree.unit);
  const double by_box = length(abs(d) + Vec3{n.half_x[k], n.half_y[k], n.half_z[k]});
  const double units = std::min(by_box, bvh::reach_of(n, k, d).by_slab);
  return (tree.unit * units + tree.slack) * stretch + error_;
}

/// How deep the center of a slot is; nothing if no vertex below it can win.
std::optional<DeepestVertexSearch::Depth> DeepestVertexSearch::depth_at(const Entry& entry, pair::Meter& meter) {
  const Vec3 center = model_.center_of(entry.slot);
  const bool is_inside = entry.is_inside || contains(solid_, center, meter);
  double farthest = infinity;
  if (!is_inside) {
    farthest = radius_of(entry.slot) + error_ - (best_ ? best_->depth : 0);
    if (farthest < 0) return std::nullopt;
  } else if (entry.slot != bvh::root_slot) {
    farthest = geometry::safe_length(center - entry.surface) * base::outward + error_;
  }
  const std::optional<SurfacePoint> closest = closest_.find(center, farthest, meter.stats);
  LIMBER_ASSERT(closest || !is_inside);
  if (!closest) return std::nullopt;
  return Depth{center, is_inside ? closest->distance : -closest->distance, closest->position};
}

void DeepestVertexSearch::add_children(const Entry& entry, const Depth& center) {
  const bvh::Tree& tree = model_.tree();
  const std::uint32_t node = bvh::child_of(tree, entry.slot);
  for (std::uint32_t k = 0; k < tree.nodes[node].child_count; ++k) {
    const bvh::SlotId slot = node * bvh::width + k;
    const double away = geometry::safe_length(model_.center_of(slot) - center.at) * base::outward + radius_of(slot);
    const double bound = std::min({entry.bound, center.depth + away, reach_from(center.surface, slot)});
    if (!can_win(bound)) continue;
    waiting_.push({bound, slot, center.depth > away + error_, center.surface});
  }
}

void DeepestVertexSearch::compare_vertices(const Entry& entry, const Depth& center, pair::Meter& meter) {
  const bvh::Leaf& leaf = bvh::leaf_of(model_.tree(), entry.slot);
  for (const Corners& corners : leaf.vertices) {
    for (const VertexId v : corners) {
      if (is_compared_[v]) continue;
      const Vec3 position = model_.position(v);
      const double away = geometry::safe_length(position - center.at) * base::outward;
      const double from_surface = geometry::safe_length(position - center.surface) * base::outward + error_;
      if (!can_win(std::min(center.depth + away, from_surface))) continue;
      compare(v, position, from_surface, center.depth > away + error_, meter);
    }
  }
}

void DeepestVertexSearch::compare(VertexId v, const Vec3& position, double farthest, bool is_inside,
                                  pair::Meter& meter) {
  is_compared_[v] = true;
  if (!is_inside && !contains(solid_, position, meter)) return;
  const std::optional<SurfacePoint> closest = closest_.find(position, farthest, meter.stats);
  LIMBER_ASSERT(closest.has_value());
  if (best_ && (closest->distance < best_->depth || (closest->distance == best_->depth && v > best_->vertex))) return;
  best_ = DeepestVertex{v, closest->distance, position, *closest, way_out(solid_, position, *closest)};
}

CommonBallsSearch::CommonBallsSearch(const point::PlacedModel& a, const point::PlacedModel& b)
    : a_(a), b_(b), closest_a_(a), closest_b_(b) {}

std::optional<CommonBalls> CommonBallsSearch::at(const Vec3& point, pair::Meter& meter) {
  for (const point::PlacedModel* model : {&a_, &b_}) {
    if (!point::surrounding_of(*model, point, meter.stats).is_inside_or_on()) return std::nullopt;
  }
  const std::optional<SurfacePoint> a = closest_a_.find(point, infinity, meter.stats);
  const std::optional<SurfacePoint> b = closest_b_.find(point, infinity, meter.stats);
  LIMBER_ASSERT(a && b);
  return CommonBalls{point, a->distance + b->distance, way_out(a_, point, *a), way_out(b_, point, *b)};
}

void CommonBallsSearch::climb(const Vec3& start, double reach, pair::Meter& meter) {
  if (meter.is_spent()) return;
  std::optional<CommonBalls> here = at(start, meter);
  if (!here) return;
  // A step makes the radii larger by twice its length at most. Shorter ones than these gain too little.
  constexpr double least_step = 0x1p-8, least_part_of_reach = 0x1p-16;
  double step = std::min(reach, std::max(here->radii, 0.125 * reach));
  while (step > std::max(least_step * here->radii, least_part_of_reach * reach) && !meter.is_spent()) {
    const Vec3 uphill = -(here->out_a + here->out_b);
    if (length_sq(uphill) < least_step * least_step) break;
    const std::optional<CommonBalls> next = at(here->center + step * unit(uphill), meter);
    if (next && next->radii > here->radii + 0.125 * step) {
      here = next;
    } else {
      step *= 0.5;
    }
  }
  if (!best_ || here->radii > best_->radii) best_ = here;
}

}  // namespace limber::penetration
