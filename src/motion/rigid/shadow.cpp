// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion/rigid/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/primitives.h"

namespace limber::motion {
namespace {

// The rounding of a shadow's coordinates in some 20 operations, as a part of the largest coordinate.
constexpr double shadow_error = 0x1p-46;
// How far a motion strays from a turn about one axis, as a part of the radius. rigid_motion.cpp allows 10^-12.
constexpr double turn_error = 0x1p-38;

struct Point2 {
  double x, y;
};

/// The convex hull of six points, but for rounding: writes its corners in order, and returns their number.
std::size_t convex_hull(std::array<Point2, 6> points, std::array<Point2, 12>& hull) {
  std::sort(points.begin(), points.end(),
            [](const Point2& p, const Point2& q) { return p.x != q.x ? p.x < q.x : p.y < q.y; });
  std::size_t size = 0;
  const auto append = [&](const Point2& p, std::size_t least) {
    const auto turns_left = [&] {
      const Point2 &o = hull[size - 2], &q = hull[size - 1];
      return (q.x - o.x) * (p.y - o.y) > (q.y - o.y) * (p.x - o.x);
    };
    while (size >= least + 2 && !turns_left()) --size;
    hull[size++] = p;
  };
  for (const Point2& p : points) append(p, 0);
  const std::size_t lower = size - 1;
  for (std::size_t i = 5; i-- > 0;) append(points[i], lower);
  return std::max<std::size_t>(size - 1, 1);
}

/// Appends triangles that cover the image of one as seen about an axis through the origin: x is the distance from the
/// axis, y the shortened place along it.
///
/// The distance of a triangle's point from the axis is at most what those of the corners interpolate to, and at least
/// its coordinate in any direction across the axis; that of the point nearest to the axis is tight. So the image is in
/// the convex hull of the corners' images and of their coordinates in that direction.
void append_turned(const Triangle& triangle, const Vec3& axis, double shortened, std::vector<Vec3>& positions,
                   std::vector<Corners>& triangles) {
  Vec3 across[3];
  double along[3];
  for (std::size_t i = 0; i < 3; ++i) {
    along[i] = dot(triangle[i], axis), across[i] = triangle[i] - along[i] * axis;
  }
  const Vec3 nearest = geometry::closest_points(Vec3{}, Triangle{across[0], across[1], across[2]}).point_b;
  const double least = length(nearest);
  const Vec3 direction = least > 0 ? (1 / least) * nearest : Vec3{};
  std::array<Point2, 6> points;
  for (std::size_t i = 0; i < 3; ++i) {
    points[i] = {length(across[i]), shortened * along[i]};
    points[3 + i] = {dot(across[i], direction), shortened * along[i]};
  }
  std::array<Point2, 12> hull;
  const std::size_t count = convex_hull(points, hull);
  const auto first = static_cast<VertexId>(positions.size()), last = first + static_cast<VertexId>(count) - 1;
  for (std::size_t i = 0; i < count; ++i) positions.push_back({hull[i].x, hull[i].y, 0});
  for (VertexId k = first + 1; k < std::max(last, first + 2); ++k) {
    triangles.push_back({first, std::min(k, last), std::min(k + 1, last)});
  }
}

}  // namespace

double turning_speed(const Body& body, const RigidMotion& motion) {
  const Sphere sphere = body.model().bounding_sphere();
  const double radius = (length(sphere.center - motion.center()) + sphere.radius) * base::outward;
  return RigidMotion({motion.start().rotation, {}}, {motion.end().rotation, {}}).speed(radius);
}

Shadow::Shadow(const MovingBodies& bodies, double time, double straight_speed)
    : bodies_(&bodies), time_(time), straight_(bodies.motion_b.displacement() - bodies.motion_a.displacement()) {
  const double turning_a = turning_speed(bodies.a, bodies.motion_a),
               turning_b = turning_speed(bodies.b, bodies.motion_b);
  const auto center = [&](const RigidMotion& motion) { return motion.at(time)(motion.center()); };
  const auto error_of = [](const Body& body, const RigidMotion& motion) {
    const Sphere sphere = body.model().bounding_sphere();
    return turn_error * (length(sphere.center - motion.center()) + sphere.radius);
  };
  const double straight = length(straight_);
  prefer(false, center(bodies.motion_a), straight > 0 ? (1 / straight) * straight_ : Vec3{}, turning_a + turning_b,
         straight_speed);
  if (turning_a > 0) {
    prefer(true, center(bodies.motion_a), bodies.motion_a.axis(), turning_b + error_of(bodies.a, bodies.motion_a),
           straight_speed);
  }
  if (turning_b > 0) {
    prefer(true, center(bodies.motion_b), bodies.motion_b.axis(), turning_a + error_of(bodies.b, bodies.motion_b),
           straight_speed);
  }
}

void Shadow::prefer(bool is_about_axis, const Vec3& origin, const Vec3& axis, double others_speed,
                    double straight_speed) {
  const double along = std::abs(dot(straight_, axis)), across = length(straight_ - dot(straight_, axis) * axis);
  const double shortened = along > straight_speed ? straight_speed / along : 1;
  const double speed = (across + shortened * along + others_speed) * base::outward;
  if (!(speed < speed_)) return;
  speed_ = speed, is_about_axis_ = is_about_axis, origin_ = origin, axis_ = axis, shortened_ = shortened;
}

std::optional<Model> Shadow::image(const Body& body, const Transform& pose, double& size) const {
  const Mesh& mesh = body.model().mesh();
  std::vector<Vec3> positions;
  for (const Vec3& p : mesh.positions()) {
    positions.push_back(pose(p) - origin_);
    size = std::max({size, max_abs(origin_), max_abs(positions.back())});
  }
  std::vector<Corners> triangles;
  if (is_about_axis_) {
    std::vector<Vec3> hulls;
    for (const auto& [i, j, k] : mesh.triangles()) {
      append_turned({positions[i], positions[j], positions[k]}, axis_, shortened_, hulls, triangles);
    }
    positions = std::move(hulls);
  } else {
    for (Vec3& p : positions) p -= ((1 - shortened_) * dot(p, axis_)) * axis_;
    triangles = mesh.triangles();
  }
  Result<Mesh> image = Mesh::create(std::move(positions), std::move(triangles));
  if (!image) return std::nullopt;
  return std::optional<Model>(std::in_place, std::move(image.value()));
}

std::optional<double> Shadow::distance(const DistanceOptions& options, QueryStats& stats) const {
  double size = 0;
  const std::optional<Model> a = image(bodies_->a, bodies_->motion_a.at(time_), size);
  const std::optional<Model> b = image(bodies_->b, bodies_->motion_b.at(time_), size);
  if (!a || !b || size < 0x1p-400) return std::nullopt;  // smaller ones have no squares
  const DistanceResult found = limber::distance(*a, *b, options);
  stats += found.stats;
  return found.lower - shadow_error * size;
}

}  // namespace limber::motion
