// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles without area, edges without length, numbers that are none.
#include "geometry/primitives.h"
#include "limber/elements.h"
#include "limber/points.h"
#include "peers.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

Vec3 small_lattice_point(scenes::Rng& rng) {
  const auto x = static_cast<double>(rng.below(3)), y = static_cast<double>(rng.below(3));
  return {x, y, static_cast<double>(rng.below(3))};
}

/// A triangle that is a point, a segment in one of its ways, a sliver, or has an area.
Triangle degenerate(scenes::Rng& rng) {
  const Vec3 p = small_lattice_point(rng), q = small_lattice_point(rng), r = small_lattice_point(rng);
  const double height = std::ldexp(1.0, -static_cast<int>(rng.below(1040)));
  switch (rng.below(7)) {
    case 0:
      return {p, p, p};
    case 1:
      return {p, p, q};
    case 2:
      return {q, p, p};
    case 3:
      return {p, q, 0.5 * (p + q)};
    case 4:
      return {p, p + 3.0 * (q - p), q};
    case 5:
      return {p, q, 0.5 * (p + q) + height * r};
    default:
      return {p, q, r};
  }
}

// FCL #293: a simplex without volume gives points that are no numbers. CGAL #1278: a tree of triangles with edges of
// length 0 crashes.
TEST(DegenerateTriangles, HaveExactDistancesAndFiniteAnswers) {
  scenes::Rng rng(293);
  for (int i = 0; i < 600; ++i) {
    const Triangle t = degenerate(rng), u = degenerate(rng);
    const Model a(triangles_of({t})), b(triangles_of({u}));
    const exact::Fraction truth = exact::squared_distance(t, u);
    const double found = agreed_distance({a}, {b}, 0x1p-26);
    ASSERT_EQ(found == 0, truth == 0) << i;
    expect_exact(found, truth, 0x1p-47);
    for (const Contact& c : all_contacts({a}, {b}, 10)) {
      ASSERT_TRUE(is_finite(c)) << i;
      EXPECT_NEAR(length(c.normal), 1, 1e-15) << i;
    }
  }
}

// libigl #226: an assertion about leaves fails, and answers are wrong; #905: one about edges without length fails.
// trimesh #741: the search near a triangle without size throws.
TEST(DegenerateTriangles, MakeTreesThatAnswerEveryQuery) {
  scenes::Rng rng(226);
  for (const std::size_t count : {1U, 2U, 3U, 8U, 9U, 64U, 65U, 200U}) {
    for (const int kind : {0, 1, 2}) {
      std::vector<Triangle> triangles;
      for (std::size_t i = 0; i < count; ++i) {
        triangles.push_back(kind == 0   ? Triangle{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}  // one point, again and again
                            : kind == 1 ? Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}
                                        : degenerate(rng));
      }
      const Model model(triangles_of(triangles)), probe(box({0.25, 0.25, 0.25}));
      ASSERT_TRUE(static_cast<bool>(model.validate()));
      for (const Vec3& p : {Vec3{1, 2, 3}, Vec3{0.25, 0.25, 0}, Vec3{-3, 0.5, 1.5}, Vec3{0, 0, 1e-300}}) {
        const PointResult found = closest_point({model}, p);
        const PointResult truth = reference::closest_point({model.mesh()}, p);
        EXPECT_EQ(found.closest->distance, truth.closest->distance);
        EXPECT_EQ(found.closest->position, truth.closest->position);
      }
      agreed_distance({model}, {probe, at(0.1, 0.1, 0.1)}, 1e-13);
      agreed_distance({model}, {probe, at(5, 5, 5)}, 1e-13);
      EXPECT_EQ(self_intersections(model, {}).count, reference::self_intersections(model.mesh()).size());
      const ElementPairCount elements = self_element_pairs(model, 0.5, {}, {});
      const reference::ElementPairs truth = reference::self_element_pairs(model.mesh(), 0.5);
      EXPECT_EQ(elements.vertex_face, truth.vertex_face.size());
      EXPECT_EQ(elements.edge_edge, truth.edge_edge.size());
    }
  }
}

// FCL PR #401: a robust distance of point and triangle, never merged. axom #1307: there are no tests of it.
TEST(DegenerateTriangles, AreAsFarFromPointsAsExactArithmeticSays) {
  scenes::Rng rng(401);
  for (int i = 0; i < 3000; ++i) {
    const Triangle t = degenerate(rng);
    const Vec3 p = i % 2 == 0 ? small_lattice_point(rng) + 1e-7 * random_point(rng, 1) : small_lattice_point(rng);
    const ClosestPoints found = closest_points(p, t);
    const Rational truth = squared_distance(Triangle{p, p, p}, t);
    expect_exact(found.distance, exact::Fraction(truth), 0x1p-47);
    EXPECT_NEAR(length(found.point_b - p), found.distance, 0x1p-47);
  }
}

// Parry #76: 0 for a point that is 0.171 away from a triangle without area. Parry #310, PR #358: no number for
// collinear corners. JOML #119: points that are not on the triangle.
TEST(DegenerateTriangles, OfTwoCornersAreTheSegmentBetweenThem) {
  const Vec3 p{1.10000002, -7.9000001, 16.5879993}, a{2.27699995, -7.9000001, 16.3180008},
      b{-0.569999993, -8.10000038, 16.6070004};
  const double truth = closest_points(Segment{p, p}, Segment{a, b}).distance;
  EXPECT_NEAR(truth, 0.17147861, 1e-6);  // as reported, in float32
  for (const Triangle& t : {Triangle{a, b, b}, Triangle{b, a, b}, Triangle{b, b, a}, Triangle{a, a, b},
                            Triangle{a, b, 0.5 * (a + b)}, Triangle{a, b, 0.25 * a + 0.75 * b}}) {
    EXPECT_NEAR(closest_points(p, t).distance, truth, 1e-14);
    const Model model(triangles_of({t})), point(triangles_of({{p, p, p}}));
    EXPECT_NEAR(closest_point({model}, p).closest->distance, truth, 1e-14);
    EXPECT_NEAR(agreed_distance({model}, {point}, 1e-14), truth, 1e-14);
  }
}

/// Whether all corners are in the sphere, in exact arithmetic.
bool holds(const Sphere& sphere, const Triangle& t) {
  const Rational radius(sphere.radius);
  for (std::size_t i = 0; i < 3; ++i) {
    const RationalVec off = minus(rational(t[i]), rational(sphere.center));
    if (dot(off, off) > radius * radius) return false;
  }
  return true;
}

// scalismo #262: collinear corners give bounding spheres that are no numbers, and the search finds wrong points.
TEST(DegenerateTriangles, HaveBoundingSpheresThatHoldThem) {
  scenes::Rng rng(262);
  for (int round = 0; round < 30; ++round) {
    std::vector<Triangle> triangles;
    for (int i = 0; i < 60; ++i) {
      const Triangle t = degenerate(rng);
      const double scale = round % 3 == 0 ? 1e-160 : round % 3 == 1 ? 1 : 1e50;
      triangles.push_back({scale * t.v0, scale * t.v1, scale * t.v2});
    }
    const Model model(triangles_of(triangles));
    for (std::uint32_t level = 0; level < model.tree_stats().levels; ++level) {
      for (const Sphere& s : model.node_spheres(level)) {
        ASSERT_TRUE(limber::is_finite(s.center) && std::isfinite(s.radius) && s.radius >= 0);
      }
    }
    const Sphere whole = model.bounding_sphere();
    for (const Triangle& t : triangles) {
      EXPECT_TRUE(holds(whole, t));
      EXPECT_TRUE(holds(geometry::enclosing_sphere(t), t));
    }
    const double size = whole.radius;
    for (int i = 0; i < 10; ++i) {
      const Vec3 p = whole.center + random_point(rng, 2 * size);
      EXPECT_EQ(closest_point({model}, p).closest->distance,
                reference::closest_point({model.mesh()}, p).closest->distance);
    }
  }
}

// Bullet PR #4321: triangles of a soft body that are nearly flat divide by zero. Bullet PR #940, #935: spheres on
// triangles without area.
TEST(DegenerateTriangles, ThatACollapsingBodyPassesThroughStayRight) {
  const Mesh rest = scenes::ball(12, 8);
  const Model floor(scenes::grid(4, 4, -2, -2, 1, 1));
  Model body(rest);
  for (const double height : {1.0, 1e-3, 1e-8, 1e-17, 1e-100, 1e-308, 5e-324, 0.0, 1e-8, 1.0}) {
    std::vector<Vec3> positions = rest.positions();
    for (Vec3& p : positions) p.z *= height;
    body.move_all(positions).value();
    body.commit();
    ASSERT_TRUE(static_cast<bool>(body.validate()));
    for (const double z : {0.0, 0.5, 1.25}) {
      const Placed there{body, at(0.1, 0.2, z)};
      const double found = agreed_distance({floor}, there, 1e-15);
      EXPECT_NEAR(found, std::max(0.0, z - height), 1e-15) << height;
      for (const Contact& c : all_contacts({floor}, there, 0.6)) ASSERT_TRUE(is_finite(c));
    }
    EXPECT_EQ(self_intersections(body, {}).count, reference::self_intersections(body.mesh()).size()) << height;
  }
}

// CloudCompare #2247: distances of points next to a triangle are no numbers, in every fifth run. #2311: for good.
TEST(DegenerateTriangles, NextToAPointNeverGiveWhatIsNoNumber) {
  const Model model(Mesh::create({{0, 0, 0}, {0, 0.5, 0}, {0.5, 0, 0}}, {{2, 1, 0}}).value());
  for (int run = 0; run < 10; ++run) {
    EXPECT_EQ(closest_point({model}, {0, 0, 0.000008}).closest->distance, 0.000008);
    EXPECT_EQ(closest_point({model}, {0, 0.5, 0}).closest->distance, 0);
    EXPECT_EQ(closest_point({model}, {0.5, 0, 0}).closest->distance, 0);
  }
  scenes::Rng rng(2247);
  for (int i = 0; i < 2000; ++i) {
    const double u = rng.uniform(), v = rng.uniform() * (1 - u),
                 height = std::ldexp(1.0, -static_cast<int>(rng.below(1074)));
    const Vec3 p{0.5 * u, 0.5 * v, height};
    EXPECT_NEAR(closest_point({model}, p).closest->distance, height, 0x1p-50);
  }
}

}  // namespace
}  // namespace limber::testing
