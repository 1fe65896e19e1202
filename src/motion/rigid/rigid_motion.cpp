// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/rigid.h"
#include "limber/path.h"

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
