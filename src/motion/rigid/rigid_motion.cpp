// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "geometry/rigid.h"
#include "limber/path.h"
#include "motion/rigid/moving_distance.h"

namespace limber {
namespace {

// Rotations may be orthonormal to 1e-14 only, and angles come from them.
constexpr double largest_skew = 1e-14, rotation_error = 1e-12, speed_up = 1 + 1e-12;

/// A turn about an axis of length 1 is v -> v + sine * (axis x v) + versine * (axis x (axis x v)).
struct Turn {
  double sine, versine;  ///< versine: 1 - cosine

  static Turn by(double angle) {
    const double half = std::sin(0.5 * angle);
    return {std::sin(angle), 2 * half * half};
  }

  /// How the turn moves a vector.
  Vec3 displacement(const Vec3& axis, const Vec3& v) const {
    const Vec3 across = cross(axis, v);
    return sine * across + versine * cross(axis, across);
  }
  Mat3 matrix(const Vec3& axis) const {
    const auto& [x, y, z] = axis;
    const double c = 1 - versine, k = versine, s = sine;
    return {{c + k * x * x, k * x * y - s * z, k * x * z + s * y},
            {k * x * y + s * z, c + k * y * y, k * y * z - s * x},
            {k * x * z - s * y, k * y * z + s * x, c + k * z * z}};
  }
};

/// A pose whose rotation is orthonormal up to `largest_skew`. Pre: it is rigid.
Transform without_skew(const Transform& pose) {
  const Mat3 rotation = orthonormalized(pose.rotation).value();
  const auto far = [](const Vec3& a, const Vec3& b) { return max_abs(a - b) > largest_skew; };
  const bool is_off = far(rotation.row0, pose.rotation.row0) || far(rotation.row1, pose.rotation.row1) ||
                      far(rotation.row2, pose.rotation.row2);
  return is_off ? Transform{rotation, pose.translation} : pose;
}

Mat3 operator*(double s, const Mat3& m) { return {s * m.row0, s * m.row1, s * m.row2}; }
Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.row0 + b.row0, a.row1 + b.row1, a.row2 + b.row2}; }

/// The imaginary part of a quaternion of a rotation, times its real part's sign; `real` becomes that part's size.
Vec3 quaternion_of(const Mat3& m, double& real) {
  // From the largest of the four entries, so that nothing is divided by a small one.
  const double xx = m.row0.x, yy = m.row1.y, zz = m.row2.z;
  const double squares[4] = {1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz};
  const auto largest = std::max_element(squares, squares + 4) - squares;
  const double twice = std::sqrt(squares[largest]), part = 0.5 / twice;
  const Vec3 odd{m.row2.y - m.row1.z, m.row0.z - m.row2.x, m.row1.x - m.row0.y};
  const Vec3 even{m.row2.y + m.row1.z, m.row0.z + m.row2.x, m.row1.x + m.row0.y};
  Vec3 v;
  switch (largest) {
    case 0:
      real = 0.5 * twice, v = part * odd;
      break;
    case 1:
      real = part * odd.x, v = {0.5 * twice, part * even.z, part * even.y};
      break;
    case 2:
      real = part * odd.y, v = {part * even.z, 0.5 * twice, part * even.x};
      break;
    default:
      real = part * odd.z, v = {part * even.y, part * even.x, 0.5 * twice};
  }
  if (real < 0) real = -real, v = -v;
  return v;
}

}  // namespace

RigidMotion::RigidMotion(const Transform& start, const Transform& end, const Vec3& center) : center_(center) {
  const base::DefaultFloatEnvironment environment;
  geometry::require_rigid(start, "limber::RigidMotion: start");
  geometry::require_rigid(end, "limber::RigidMotion: end");
  LIMBER_REQUIRE(is_finite(center) && max_abs(center) <= max_coordinate,
                 "limber::RigidMotion: a coordinate of the center is not finite, or above 2^200");
  start_ = without_skew(start), end_ = without_skew(end);
  double real = 1;
  const Vec3 v = quaternion_of(end_.rotation * transpose(start_.rotation), real);
  const double size = length(v);
  angle_ = 2 * std::atan2(size, real);
  if (size > 0) axis_ = (1 / size) * v;
  displacement_ = end.translation - start.translation + Turn::by(angle_).displacement(axis_, start_.rotation * center);
}

RigidMotion RigidMotion::screw(const Transform& start, const Transform& end) {
  const base::DefaultFloatEnvironment environment;
  RigidMotion motion(start, end);
  const double half = 0.5 * motion.angle_;
  if (!(std::sin(half) > 1e-9)) return motion;
  // What the turn about the axis through the point p brings to where it is found: in the world the turn about an axis
  // through 0 misses it by d, of which the part across the axis is (1 - turn) p.
  const Vec3 from = start.translation, axis = motion.axis_;
  const Vec3 d = end.translation - from - Turn::by(motion.angle_).displacement(axis, from);
  const Vec3 across = d - dot(d, axis) * axis;
  const Vec3 on_axis = 0.5 * across + (0.5 * std::cos(half) / std::sin(half)) * cross(axis, across);
  // The point of the axis that is nearest to the model's origin.
  const Vec3 nearest = on_axis + dot(from - on_axis, axis) * axis;
  return {start, end, transpose(motion.start_.rotation) * (nearest - from)};
}

Transform RigidMotion::at(double time) const {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(time >= 0 && time <= 1, "limber::RigidMotion::at: the time is not in [0, 1]");
  if (time == 0 || start_ == end_) return start_;
  if (time == 1) return end_;
  // What is left of the end's rotation without the turn is the start's, but for rounding.
  const Turn whole = Turn::by(angle_), turned = Turn::by(time * angle_);
  const Mat3 unturned = transpose(whole.matrix(axis_)) * end_.rotation;
  const Mat3 rotation = turned.matrix(axis_) * ((1 - time) * start_.rotation + time * unturned);
  // The center's place on its straight way, less where the turn brings it. These cancel for a center far away, so
  // their difference is formed of sines and versines.
  const Turn difference{time * whole.sine - turned.sine, time * whole.versine - turned.versine};
  const Vec3 straight = (1 - time) * start_.translation + time * end_.translation;
  return environment.computed_before_restore(
      Transform{rotation, straight + difference.displacement(axis_, start_.rotation * center_)});
}

double RigidMotion::speed(double radius) const {
  const base::DefaultFloatEnvironment environment;
  if (start_ == end_) return 0;
  return environment.computed_before_restore((length(displacement_) + (angle_ + rotation_error) * radius) * speed_up);
}

}  // namespace limber

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
