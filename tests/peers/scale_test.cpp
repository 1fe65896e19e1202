// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers that were wrong because of the size, number or place of triangles, or after a mesh had moved; triangles
// without area, edges without length, numbers that are none.
#include <functional>
#include <stdexcept>

#include "limber/elements.h"
#include "limber/points.h"
#include "peers.h"
#include "simd/kernels.h"

namespace limber::testing {
namespace {

// svenstaro/bvh #159, toolbox-rs #580: the shape with the nearest box, or corner of a box, is taken for the nearest
// shape. Unity hair #98: a point inside a box counts as far from it.
TEST(ScaleAndPlace, NearestTriangleIsNotTheOneWithTheNearestBox) {
  // Diagonal triangles whose boxes hold the point, and a small one beside all boxes that is closest.
  std::vector<Triangle> triangles;
  for (int i = 0; i < 40; ++i) {
    const double s = 10 + i;
    triangles.push_back({{s, 0.1, 0.1}, {0.1, s, 0.1}, {0.1, 0.1, s}});
    triangles.push_back({{-s, s, 0.1}, {s, 0.2, -s}, {0.2, s, s}});
  }
  triangles.push_back({{-1, -1, -1}, {-1.1, -1, -1}, {-1, -1.1, -1}});
  const Model model(triangles_of(triangles)),
      probe(triangles_of({{{0.2, 0.2, 0.2}, {0.3, 0.2, 0.2}, {0.2, 0.3, 0.2}}}));
  const SurfacePoint found = closest_point({model}, {0.2, 0.2, 0.2}).closest.value();
  EXPECT_EQ(found.triangle, triangles.size() - 1);
  EXPECT_NEAR(found.distance, 1.2 * std::sqrt(3), 1e-15);
  EXPECT_NEAR(agreed_distance({model}, {probe}, 1e-14), 1.2 * std::sqrt(3), 1e-14);
}

// exotica #153: distances are wrong when triangles are large. ShapeWorks #812: the triangle is sought among those of
// the nearest vertices, which a huge one has far away.
TEST(ScaleAndPlace, HugeTrianglesAreAsNearAsTheirPointsAre) {
  for (const double size : {1e3, 1e6, 1e9}) {
    std::vector<Triangle> triangles{{{-size, -size, 0}, {size, -size, 0}, {0, 2 * size, 0}}};
    for (int i = 0; i < 200; ++i) {  // small ones with many vertices near the probe, but farther than the large one
      const Vec3 p{0.1 * (i % 15), 0.1 * (i / 15.0), -0.5};
      triangles.push_back({p, p + Vec3{0.05, 0, 0}, p + Vec3{0, 0.05, 0}});
    }
    const Model floor(triangles_of(triangles)), tool(scenes::ball(12, 8));
    const Transform pose = at(0.6, 0.5, 1.25);
    const DistanceResult found = distance({floor}, {tool, pose});
    EXPECT_NEAR(found.upper, 0.25, 0x1p-44 * size);
    EXPECT_EQ(found.witness->triangle_a, 0U);
    EXPECT_NEAR(found.witness->point_a.x, 0.6, 1e-6 + 0x1p-44 * size);
    const SurfacePoint point = closest_point({floor}, {0.6, 0.5, 0.25}).closest.value();
    EXPECT_EQ(point.triangle, 0U);
    EXPECT_NEAR(point.distance, 0.25, 0x1p-44 * size);
    EXPECT_FALSE(collide({floor}, {tool, at(0.6, 0.5, 1.0000001)}).is_yes());
    EXPECT_TRUE(collide({floor}, {tool, at(0.6, 0.5, 0.9999999)}).is_yes());
  }
}

// Scalable-CCD #8: in float32 the promise to miss nothing is lost. Bodies far from the origin, whose gap or overlap no
// float32 can tell, are decided exactly on every instruction set.
TEST(ScaleAndPlace, ContactsBelowTheResolutionOfFloat32AreNotMissed) {
  const Model ball(scenes::ball(8, 6)), brick(box({1, 1, 1}));
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    for (const double far : {0.0, 0x1p20, 0x1p30}) {
      for (const int bits : {20, 22}) {
        for (const int sign : {-1, 1}) {
          const double gap = sign * std::ldexp(1.0, -bits);
          const Placed a{brick, at(far, far, far)}, b{ball, at(far + 2 + gap, far, far)};
          const double found = agreed_distance(a, b, 0x1p-44 * (1 + far));
          EXPECT_EQ(found == 0, sign < 0) << far << ' ' << bits;
          if (sign > 0) {
            EXPECT_NEAR(found, gap, 0x1p-44 * (1 + far));
          }
        }
      }
    }
  }
  simd::use_kernels(nullptr);
}

/// Moves all vertices to where a function puts them, and commits.
void deform(Model& model, const Mesh& rest, const std::function<Vec3(const Vec3&)>& motion) {
  std::vector<Vec3> positions = rest.positions();
  for (Vec3& p : positions) p = motion(p);
  model.move_all(positions).value();
  model.commit();
}

// Newton PR #3828, #3846: contacts are sought in a tree of an earlier pose: layers of cloth that lie apart at rest and
// were moved together have none. Here the question is refused until the tree is right.
TEST(Updates, AreNeverForgottenByAQuery) {
  const Mesh sheet = scenes::grid(8, 8, 0, 0, 0.1, 0.1);
  std::vector<Vec3> positions = sheet.positions();
  std::vector<Corners> triangles = sheet.triangles();
  const auto layer = static_cast<VertexId>(positions.size());
  const std::size_t faces = triangles.size();
  for (VertexId v = 0; v < layer; ++v) positions.push_back(positions[v] + Vec3{0, 0, 1});
  for (std::size_t f = 0; f < faces; ++f) {
    triangles.push_back({triangles[f][0] + layer, triangles[f][1] + layer, triangles[f][2] + layer});
  }
  Model cloth(Mesh::create(positions, triangles).value());
  EXPECT_EQ(self_contacts(cloth, 0.01, {}).count, 0U);
  for (std::size_t v = layer; v < positions.size(); ++v) positions[v].z = 0.005;
  cloth.move_all(positions).value();
  EXPECT_THROW(self_contacts(cloth, 0.01, {}), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(self_collide(cloth)), std::invalid_argument);
  const Model other(box({1, 1, 1}));
  EXPECT_THROW(static_cast<void>(distance({cloth}, {other})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(distance({other}, {cloth})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(collide({other}, {cloth})), std::invalid_argument);
  EXPECT_THROW(contacts({other}, {cloth}, 0.1, {}), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(closest_point({cloth}, {})), std::invalid_argument);
  cloth.commit();
  EXPECT_EQ(self_contacts(cloth, 0.01, {}).count, reference::self_contacts(cloth.mesh(), 0.01).size());
  EXPECT_GT(self_contacts(cloth, 0.01, {}).count, faces);
}

// mitsuba2 #526, #531, #276, #383: positions are replaced, the tree is not, and geometry vanishes over some frames.
// UPBGE #703, PR #835: the physics of a deformed mesh is that of the mesh at rest. Embree #389: a wall of a moved ball
// stays where it was. fluid-engine-dev PR #271: an update does not reach the tree; a rebuild in each frame is feared.
TEST(Updates, FollowABodyThroughManyFramesWithoutRebuildingItAll) {
  const Mesh rest = scenes::ball(24, 16);
  const Model wall(scenes::grid(10, 10, -1, -1, 0.2, 0.2));
  Model body(rest, {.rebuild_policy = RebuildPolicy::off});
  for (int frame = 0; frame < 30; ++frame) {
    const double z = 3 - 0.2 * frame;
    deform(body, rest, [&](const Vec3& p) { return Vec3{p.x, p.y, p.z + z}; });
    const double found = distance({wall}, {body}).upper;
    if (std::abs(z) > 1) {
      EXPECT_NEAR(found, std::abs(z) - 1, 1e-15) << frame;
    } else {
      EXPECT_EQ(found, 0) << frame;
    }
    EXPECT_NEAR(closest_point({body}, {0, 0, 9}).closest->distance, 8 - z, 1e-14) << frame;
  }
  EXPECT_EQ(body.maintenance_stats().rebuilt_triangles, 0U);
  EXPECT_LE(body.maintenance_stats().refits, 30 * body.tree_stats().nodes);
}

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
