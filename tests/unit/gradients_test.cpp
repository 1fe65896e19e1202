// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Derivatives of distances: known answers, differences of distances after small motions of poses and vertices, also
// where several pairs of points are equally close, and mistakes of callers.
#include "limber/gradients.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

constexpr double difference_step = 1e-6;

/// Compares a derivative with what the distance becomes a step forward and a step back.
///
/// The distance is the least over pairs of points, so it is never above the straight line of one closest pair, but for
/// its curvature. Where there is one closest pair, it is on the line.
struct Slopes {
  double forward, back;

  void expect_derivative(double derivative, double curvature, double rounding) const {
    const double tolerance = curvature * difference_step + rounding / difference_step;
    EXPECT_LE(forward, derivative + tolerance);
    EXPECT_GE(back, derivative - tolerance);
    const bool is_smooth = std::abs(forward - back) <= 2 * tolerance;
    (is_smooth ? smooth : kinks) += 1;
    EXPECT_TRUE(!is_smooth || std::abs(0.5 * (forward + back) - derivative) <= 2 * tolerance);
  }
  static inline int smooth = 0, kinks = 0;
};

/// The slopes of distance(t) at 0.
template <typename Distance>
Slopes slopes_of(double now, const Distance& distance) {
  return {(distance(difference_step) - now) / difference_step, (now - distance(-difference_step)) / difference_step};
}

Vec3 axis_of(std::size_t i) {
  Vec3 v;
  v[i] = 1;
  return v;
}

/// A pose after a rotation by `angle` about an axis through `center`.
Transform turned(const Transform& pose, std::size_t axis, const Vec3& center, double angle) {
  const std::size_t j = (axis + 1) % 3, k = (axis + 2) % 3;
  std::array<Vec3, 3> rows;
  rows[axis] = axis_of(axis);
  rows[j] = std::cos(angle) * axis_of(j) - std::sin(angle) * axis_of(k);
  rows[k] = std::sin(angle) * axis_of(j) + std::cos(angle) * axis_of(k);
  return Transform{{}, center} * Transform{{rows[0], rows[1], rows[2]}, {}} * Transform{{}, -center} * pose;
}

void check_poses(const Placed& a, const Placed& b, const TriangleContact& contact, double now, double rounding) {
  const Vec3 center_a{0.3, -0.2, 0.1}, center_b = b.pose.translation;
  const PoseGradient by_a = pose_gradient_a(contact, center_a), by_b = pose_gradient_b(contact, center_b);
  const double curvature = 40 / now + 40;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto moved = [&](Transform pose, double t) {
      pose.translation += t * axis_of(i);
      return pose;
    };
    slopes_of(now, [&](double t) {
      return distance({a.model(), moved(a.pose, t)}, b).upper;
    }).expect_derivative(by_a.force[i], curvature, rounding);
    slopes_of(now, [&](double t) {
      return distance(a, {b.model(), moved(b.pose, t)}).upper;
    }).expect_derivative(by_b.force[i], curvature, rounding);
    slopes_of(now, [&](double t) {
      return distance({a.model(), turned(a.pose, i, center_a, t)}, b).upper;
    }).expect_derivative(by_a.moment[i], curvature, rounding);
    slopes_of(now, [&](double t) {
      return distance(a, {b.model(), turned(b.pose, i, center_b, t)}).upper;
    }).expect_derivative(by_b.moment[i], curvature, rounding);
  }
}

/// Checks the derivatives by the three corners of the triangle of one of the models.
void check_vertices(const Placed& a, const Placed& b, bool of_a, TriangleId triangle,
                    const std::array<Vec3, 3>& gradients, double now, double rounding) {
  const Placed& placed = of_a ? a : b;
  const Mesh& mesh = placed.model().mesh();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId v = mesh.triangles()[triangle][corner];
      slopes_of(now, [&](double t) {
        std::vector<Vec3> positions = mesh.positions();
        positions[v] += t * (transpose(placed.pose.rotation) * axis_of(i));  // the gradient is in the world
        const Model changed(Mesh::create(positions, mesh.triangles()).value());
        return of_a ? distance({changed, a.pose}, b).upper : distance(a, {changed, b.pose}).upper;
      }).expect_derivative(gradients[corner][i], 40 / now + 40, rounding);
    }
  }
}

/// Unconnected triangles, so that a vertex belongs to one alone.
Mesh some_triangles(Rng& rng, bool on_lattice) {
  std::vector<Triangle> triangles(4 + rng.below(8));
  for (Triangle& t : triangles) t = on_lattice ? lattice_triangle(rng) : uniform_triangle(rng);
  return soup(triangles);
}

TEST(Gradients, AreDifferencesOfDistances) {
  Rng rng(1701);
  int checked = 0;
  Slopes::smooth = Slopes::kinks = 0;
  while (checked < 60 && !HasFailure()) {
    SCOPED_TRACE(checked);
    const bool on_lattice = rng.below(4) == 0;  // ties: parallel faces and edges, equally close corners
    const Model model_a(some_triangles(rng, on_lattice)), model_b(some_triangles(rng, on_lattice));
    const Transform pose_a = on_lattice ? Transform{} : random_pose(rng, 1);
    Transform pose_b = on_lattice ? Transform{} : random_pose(rng, 1);
    pose_b.translation += on_lattice ? Vec3{0, 0, 5} : 3 * uniform_point(rng);
    const Placed a{model_a, pose_a}, b{model_b, pose_b};
    const DistanceResult found = distance(a, b);
    if (found.upper < 0.05) continue;
    ++checked;
    const TriangleContact contact = contact_of(a, b, *found.witness);
    EXPECT_EQ(contact.distance, found.upper);
    const double rounding = 1e-14 * (1 + max_abs(pose_b.translation));
    check_poses(a, b, contact, found.upper, rounding);
    check_vertices(a, b, true, found.witness->triangle_a, vertex_gradients_a(contact), found.upper, rounding);
    check_vertices(a, b, false, found.witness->triangle_b, vertex_gradients_b(contact), found.upper, rounding);
  }
  EXPECT_GT(Slopes::smooth, 1000);
  EXPECT_GT(Slopes::kinks, 20);
}

TEST(Gradients, KnownValues) {
  const Model floor(scenes::grid(1, 1, -2, -2, 4, 4));
  const Model corner(soup({{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}}}));
  const Placed a{floor}, b{corner, {{}, {1, -0.5, 0.25}}};
  const TriangleContact contact = contact_of(a, b, *distance(a, b).witness);
  EXPECT_EQ(pose_gradient_b(contact, {}).force, (Vec3{0, 0, 1}));
  EXPECT_EQ(pose_gradient_b(contact, {}).moment, (Vec3{-0.5, -1, 0}));
  EXPECT_EQ(pose_gradient_b(contact, b.pose.translation).moment, (Vec3{}));
  EXPECT_EQ(pose_gradient_a(contact, {}).force, (Vec3{0, 0, -1}));
  EXPECT_EQ(pose_gradient_a(contact, {}).moment, (Vec3{0.5, 1, 0}));
  EXPECT_EQ(vertex_gradients_b(contact), (std::array<Vec3, 3>{Vec3{0, 0, 1}, Vec3{}, Vec3{}}));
  Vec3 sum;
  for (const Vec3& g : vertex_gradients_a(contact)) sum += g;
  EXPECT_LE(length(sum - Vec3{0, 0, -1}), 1e-15);
}

TEST(Gradients, OfOneModelWithItselfAreThoseOfItsTriangles) {
  const Model sheet(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0.25, 0.25, 0.5}, {1, 1, 2}, {1, 0, 2}}}));
  const DistanceResult near = self_distance(sheet);
  const TriangleContact contact = contact_of({sheet}, {sheet}, *near.witness);
  EXPECT_EQ(contact.distance, 0.5);
  EXPECT_EQ(vertex_gradients_b(contact)[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(vertex_gradients_a(contact)[0], (Vec3{0, 0, -0.5}));
}

TEST(Gradients, RefuseTrianglesThatAreNotThere) {
  const Model ball(scenes::ball(6, 4));
  EXPECT_THROW(static_cast<void>(contact_of({ball}, {ball}, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(contact_of({ball}, {ball}, {{}, {}, 0, 1000})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(contact_of({ball}, {ball, {{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}}, {{}, {}, 0, 0})),
               std::invalid_argument);
}

}  // namespace
}  // namespace limber::testing
