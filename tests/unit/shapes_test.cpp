// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The factories of shapes: what their cores are, and which arguments they refuse.
#include "limber/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "limber/elements.h"
#include "limber/geometry.h"
#include "limber/motion.h"
#include "limber/points.h"
#include "model/convex_hull.h"
#include "support/random_geometry.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Exactly all points are behind all triangles or on them, none is degenerate, and the surface is closed.
void check_hull(const std::vector<Vec3>& points, const Shape& hull) {
  const Mesh& mesh = hull.model().mesh();
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle face = mesh.triangle(t);
    const bool has_area = orient2d(face.v0, face.v1, face.v2, 0) != 0 || orient2d(face.v0, face.v1, face.v2, 1) != 0 ||
                          orient2d(face.v0, face.v1, face.v2, 2) != 0;
    EXPECT_EQ(has_area, hull.is_solid() || mesh.triangles().size() > 1 || mesh.positions().size() == 3);
    for (const Vec3& p : points) {
      const int side = orient3d(face.v0, face.v1, face.v2, p);
      EXPECT_TRUE(hull.is_solid() ? side <= 0 : side == 0);
    }
  }
  for (const Vec3& p : mesh.positions()) EXPECT_NE(std::find(points.begin(), points.end(), p), points.end());
  if (hull.is_solid()) {
    const auto surface = ClosedSurface::create(hull.model());
    ASSERT_TRUE(surface);
    for (const Vec3& p : points) EXPECT_TRUE(surface->contains(p));
    EXPECT_TRUE(hull.model().mesh().is_closed());
  }
  for (const Vec3& p : points) {
    EXPECT_TRUE(hull.is_solid() || closest_point(Placed(hull.model()), p).closest->distance < 1e-12);
  }
  hull.model().validate().value();
}

Vec3 flattened(const Vec3& p, int dimensions) {
  return dimensions == 3   ? p
         : dimensions == 2 ? Vec3{p.x, p.y, p.x + 2 * p.y}
         : dimensions == 1 ? Vec3{p.x, 2 * p.x, -p.x}
                           : Vec3{1, 2, 3};
}

TEST(ConvexHull, HasAllPointsExactlyBehindItsFaces) {
  Rng rng(7);
  for (int round = 0; round < 400; ++round) {
    const int dimensions = round % 4;
    const std::uint64_t count = 1 + rng.below(round % 3 == 0 ? 8 : 60);
    const bool is_on_lattice = rng.below(2) == 0;
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vec3 p =
          flattened(is_on_lattice || dimensions < 3 ? lattice_point(rng, 5) : uniform_point(rng), dimensions);
      points.push_back(p);
      if (rng.below(4) == 0) points.push_back(dimensions < 3 || rng.below(2) == 0 ? p : nudged(rng, p));
    }
    SCOPED_TRACE(::testing::Message() << "round " << round);
    const Shape hull = Shape::convex_hull(points);
    check_hull(points, hull);
    if (dimensions < 3) {
      EXPECT_FALSE(hull.is_solid());
    }
    if (HasFailure()) return;
  }
}

TEST(ConvexHull, OfPointsInAPlaneIsThePolygonOnce) {
  std::vector<Vec3> points;
  for (int i = 0; i < 25; ++i) points.push_back({static_cast<double>(i % 5), static_cast<double>(i / 5), 1});
  const Shape hull = Shape::convex_hull(points);
  check_hull(points, hull);
  double area = 0;
  for (TriangleId t = 0; t < hull.model().mesh().triangles().size(); ++t) {
    const Triangle face = hull.model().mesh().triangle(t);
    area += 0.5 * length(cross(face.v1 - face.v0, face.v2 - face.v0));
  }
  EXPECT_NEAR(area, 16, 1e-12);
}

TEST(Shapes, OfSolidsAreClosed) {
  const Shape solids[] = {Shape::box({1, 2, 3}), Shape::box({1, 2, 3}, 0.5), Shape::half_space({1, 2, 3}, 4, 100),
                          Shape::cylinder({0, 1, 2}, {1, 5, 2}, 2, 0.01)};
  for (const Shape& solid : solids) {
    EXPECT_TRUE(solid.is_solid());
    const ClosedSurface surface = ClosedSurface::create(solid.model()).value();
    const Sphere sphere = solid.model().bounding_sphere();
    EXPECT_EQ(surface.winding_number(sphere.center), 1);  // so normals point outward
  }
}

TEST(Shapes, CylindersAreInTheirPrismsWithinTheError) {
  for (const double error : {0.5, 0.01, 1e-5}) {
    const Vec3 from{1, 2, 3}, to{2, 4, 5};
    const Shape shape = Shape::cylinder(from, to, 0.75, error);
    EXPECT_LE(shape.deviation(), error + 1e-14);
    const Vec3 along = (to - from) * (1 / length(to - from));
    double least = 10, most = 0;
    for (TriangleId t = 0; t < shape.model().mesh().triangles().size(); ++t) {
      const Triangle face = shape.model().mesh().triangle(t);
      const Vec3 normal = cross(face.v1 - face.v0, face.v2 - face.v0);
      if (std::abs(dot(normal, along)) > 0.5 * length(normal)) continue;  // of an end
      least = std::min(least, dot(normal, face.v0 - from) / length(normal));
    }
    for (const Vec3& p : shape.model().mesh().positions()) most = std::max(most, length(cross(along, p - from)));
    EXPECT_GE(least, 0.75 * (1 - 1e-15));
    EXPECT_LE(most, (0.75 + shape.deviation()) * (1 + 1e-14));
    const std::size_t sides = shape.model().mesh().triangles().size() / 4;
    if (sides <= 3) continue;
    EXPECT_GT(0.75 / std::cos(std::numbers::pi / static_cast<double>(sides - 1)) - 0.75, error);
  }
}

TEST(Shapes, CylindersAreInTheirPrismsFarFromTheOriginToo) {
  for (const double far : {0.0, 1e6, 1e9, 0x1p190}) {
    for (const double radius : {1.0, 1e-3, 1e-8}) {
      const Vec3 from{far, far, 0}, to{far, far, 1};
      const Shape shape = Shape::cylinder(from, to, radius, 0.01 * radius);
      const std::vector<Vec3>& positions = shape.model().mesh().positions();
      const std::size_t sides = positions.size() / 2 - 1;
      for (std::size_t i = 0; i < sides; ++i) {
        // Exact differences: all are close to the axis, or as far away as rounding is coarse.
        const Vec3 p = positions[2 + 2 * i] - from, q = positions[2 + 2 * ((i + 1) % sides)] - from;
        const long double edge_x = static_cast<long double>(q.x) - p.x, edge_y = static_cast<long double>(q.y) - p.y;
        const long double doubled_area = p.x * edge_y - p.y * edge_x, size = std::hypot(edge_x, edge_y);
        EXPECT_GE(doubled_area, radius * size) << far << ' ' << radius;
        EXPECT_LE(std::hypot(static_cast<long double>(p.x), static_cast<long double>(p.y)), radius + shape.deviation());
        EXPECT_LE(p.z, 0);
        EXPECT_GE(positions[3 + 2 * i].z, 1);
      }
    }
  }
}

TEST(Shapes, OfCloudsHaveATriangleForEachPoint) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const Shape cloud = Shape::point_cloud(points, 0.5);
  ASSERT_EQ(cloud.model().mesh().triangles().size(), 3U);
  for (TriangleId i = 0; i < 3; ++i) EXPECT_EQ(cloud.model().mesh().triangle(i).v1, points[i]);
}

TEST(Shapes, OfHeightsAreOverTheGrid) {
  const std::vector<double> heights{0, 1, 2, 3, 4, 5};
  const Shape field = Shape::height_field(heights, 3, 2, 0.5, 2);
  EXPECT_EQ(field.model().mesh().positions()[5], (Vec3{1, 2, 5}));
  EXPECT_EQ(field.model().mesh().triangles().size(), 4U);
  EXPECT_FALSE(field.is_solid());
  double area = 0;
  for (TriangleId t = 0; t < 4; ++t) {
    const Triangle face = field.model().mesh().triangle(t);
    area += 0.5 * cross(face.v1 - face.v0, face.v2 - face.v0).z;  // counter-clockwise from above
  }
  EXPECT_EQ(area, 2);
}

TEST(Shapes, RefuseWhatTheyCannotBe) {
  const std::vector<Vec3> none, bad{{0, 0, 0}, {0, not_a_number, 0}}, one{{0, 0, 0}};
  const Vec3 o, x{1, 0, 0};
  for (const double radius : {-1.0, not_a_number, 0x1p201}) {
    EXPECT_THROW(static_cast<void>(Shape::sphere(radius)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::capsule(o, x, radius)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::box({1, 1, 1}, radius)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::box({1, radius, 1})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::cylinder(o, x, radius, 0.1)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::half_space(x, 0, radius)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::point_cloud(one, radius)), std::invalid_argument);
  }
  for (const Vec3& to : {Vec3{not_a_number, 0, 0}, Vec3{0x1p201, 0, 0}}) {
    EXPECT_THROW(static_cast<void>(Shape::capsule(o, to, 1)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::capsule(to, o, 1)), std::invalid_argument);
  }
  EXPECT_THROW(static_cast<void>(Shape::cylinder(o, o, 1, 0.1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Shape::cylinder(o, x, 0, 0.1)), std::invalid_argument);
  for (const double error : {0.0, not_a_number, std::numeric_limits<double>::infinity(), 1e-12}) {
    EXPECT_THROW(static_cast<void>(Shape::cylinder(o, x, 1, error)), std::invalid_argument);
  }
  EXPECT_THROW(static_cast<void>(Shape::half_space(o, 1, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Shape::half_space(x, not_a_number, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Shape::half_space(x, 0, 0)), std::invalid_argument);
  for (const auto& points : {none, bad}) {
    EXPECT_THROW(static_cast<void>(Shape::convex_hull(points)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Shape::point_cloud(points, 1)), std::invalid_argument);
  }
  const std::vector<double> heights{0, 1, 2, not_a_number};
  const std::size_t sizes[][3] = {{4, 2, 2}, {3, 2, 2}, {3, 3, 1}, {2, std::size_t{1} << 63, 2}, {0, 2, 0}};
  for (const auto& [count, nx, ny] : sizes) {
    EXPECT_THROW(static_cast<void>(Shape::height_field(std::span(heights).first(count), nx, ny, 1, 1)),
                 std::invalid_argument);
  }
}

TEST(Shapes, ModelsMayHaveAMarginToo) {
  const Shape box = Shape::box({1, 1, 1}), padded = Shape::box({1, 1, 1}, 0.25), ball = Shape::sphere(0.5);
  const Body body(box.model(), 0.25);
  EXPECT_EQ(body.radius(), 0.25);
  EXPECT_FALSE(body.is_solid());
  const Placed other(ball, {{}, {2, 0.1, 0.2}});
  EXPECT_EQ(distance(Placed(body), other).upper, distance(Placed(padded), other).upper);
  EXPECT_EQ(distance(Placed(body), other).upper, 0.25);
  for (const double radius : {-1.0, not_a_number, 2 * max_coordinate}) {
    EXPECT_THROW(Body(box.model(), radius), std::invalid_argument) << radius;
  }
}

TEST(Shapes, ErrorsNameTheArgument) {
  const std::vector<Vec3> bad{{0, 0, 0}, {0, not_a_number, 0}};
  EXPECT_TRUE(is_refused([&] { static_cast<void>(Shape::point_cloud(bad, 1)); },
                         {"limber::Shape::point_cloud: point 1 has a coordinate that is not finite, or above 2^200"}));
  EXPECT_TRUE(is_refused([] { static_cast<void>(Shape::sphere(-1)); },
                         {"limber::Shape::sphere: radius must be at least 0 and at most 2^200"}));
  for (const double height : {not_a_number, -2 * max_coordinate}) {
    const std::vector<double> heights{0, 1, 2, height};
    EXPECT_TRUE(is_refused([&] { static_cast<void>(Shape::height_field(heights, 2, 2, 1, 1)); },
                           {"limber::Shape::height_field: height 3 is not finite, or above 2^200 in size"}));
  }
}

TEST(Shapes, LeaveBodiesValidWhenTheyAreMoved) {
  Shape shape = Shape::box({1, 1, 1}, 0.5);
  const Body body(shape);
  const Shape moved = std::move(shape), ball = Shape::sphere(0.25);
  EXPECT_EQ(&body.model(), &moved.model());
  EXPECT_NEAR(distance({body}, {ball, {{}, {3, 0, 0}}}).upper, 1.25, 1e-15);
  EXPECT_TRUE(collide({body}, {ball}).is_yes());
}

TEST(Shapes, AreRefusedWhereTheirRadiusWouldBeLost) {
  const Shape sphere = Shape::sphere(1), box = Shape::box({1, 1, 1});
  EXPECT_THROW(static_cast<void>(closest_point(sphere, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(generalized_winding_number(sphere, {})), std::invalid_argument);
  EXPECT_EQ(closest_point(box, {3, 0, 0}).closest->distance, 2);
  EXPECT_THROW(element_pairs(sphere, box, 1, {}, {}), std::invalid_argument);
  std::vector<double> limits(1, 1.0);
  EXPECT_THROW(limit_displacements(sphere, box, 0, limits, {}), std::invalid_argument);
}

}  // namespace
}  // namespace limber::testing
