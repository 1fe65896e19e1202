// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Distances of points whose sign was wrong, or whose value on the surface was none.
#include "limber/points.h"
#include "peers.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

std::vector<Triangle> all_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (TriangleId id = 0; id < mesh.triangles().size(); ++id) triangles.push_back(mesh.triangle(id));
  return triangles;
}

/// Signs agree with winding numbers in rational arithmetic, magnitudes with brute force.
void expect_signed_distance(const ClosedSurface& surface, const Vec3& p) {
  const Mesh& mesh = surface.model().mesh();
  const SignedDistance found = surface.signed_distance(p);
  const double truth = reference::closest_point({mesh}, p).closest->distance;
  ASSERT_EQ(std::abs(found.distance()), truth);
  if (truth == 0) {
    EXPECT_FALSE(std::signbit(found.distance()));
    return;
  }
  const int winding = rational_winding(all_triangles(mesh), p);
  ASSERT_EQ(found.is_inside, winding != 0) << p.x << ' ' << p.y << ' ' << p.z;
  EXPECT_EQ(surface.winding_number(p), winding);
}

// Open3D #5105: a point outside a cube is inside, because a ray from it meets an edge.
TEST(Inside, IsRightWhereRaysMeetEdgesAndCorners) {
  const Model cube(box({0, 0, 0}, {1, 1, 1}));
  const ClosedSurface surface = ClosedSurface::create(cube).value();
  EXPECT_EQ(surface.signed_distance({-1, -1, 0}).distance(), std::sqrt(2));
  EXPECT_EQ(surface.signed_distance({-1, -1, -1}).distance(), std::sqrt(3));
  EXPECT_EQ(surface.signed_distance({0.5, 0.5, 0.5}).distance(), -0.5);
  // Two cubes as one surface, so that rays go on, and points between the cubes lie in the planes of faces.
  std::vector<Vec3> positions = cube.mesh().positions();
  std::vector<Corners> triangles = cube.mesh().triangles();
  for (std::size_t v = 0; v < 8; ++v) positions.push_back(positions[v] + Vec3{2, 2, 2});
  for (std::size_t t = 0; t < 12; ++t) {
    triangles.push_back({triangles[t][0] + 8, triangles[t][1] + 8, triangles[t][2] + 8});
  }
  const Model two(Mesh::create(positions, triangles).value());
  const ClosedSurface both = ClosedSurface::create(two).value();
  const auto is_between = [](int low, int high, int x, int y, int z) {
    return std::min({x, y, z}) >= low && std::max({x, y, z}) <= high;
  };
  for (int x = -2; x <= 14; ++x) {
    for (int y = -2; y <= 14; ++y) {
      for (int z = -2; z <= 14; ++z) {
        const Vec3 p = 0.25 * Vec3{1.0 * x, 1.0 * y, 1.0 * z};
        const bool in_first = is_between(0, 4, x, y, z), in_second = is_between(8, 12, x, y, z);
        ASSERT_EQ(surface.contains(p), in_first) << x << ' ' << y << ' ' << z;
        ASSERT_EQ(both.contains(p), in_first || in_second) << x << ' ' << y << ' ' << z;
      }
    }
  }
}

// axom #703, PR #706, CGAL #1288: wrong signs of points that are closest to an edge or a corner.
TEST(Inside, IsRightWhereAnEdgeOrACornerIsClosest) {
  scenes::Rng rng(703);
  const Model tetrahedron(hull({{0, 0, 0}, {1, 0, 0.1}, {0.2, 1, 0}, {0.1, 0.3, 1}}));
  const ClosedSurface surface = ClosedSurface::create(tetrahedron).value();
  for (int i = 0; i < 1500; ++i) {
    const Triangle t = tetrahedron.mesh().triangle(static_cast<TriangleId>(rng.below(4)));
    const double u = rng.below(3) == 0 ? 0 : rng.uniform();
    const Vec3 on_edge = t.v0 + u * (t.v1 - t.v0);
    expect_signed_distance(surface, on_edge + std::pow(10.0, rng.uniform(-16, -0.5)) * random_point(rng, 1));
  }
}

// axom #783, PR #784: wrong signs next to an edge with an acute angle between triangles of very different areas.
// libigl #906: bumps where triangles are slivers.
TEST(Inside, IsRightNextToSharpEdgesOfUnequalTriangles) {
  scenes::Rng rng(783);
  for (const double angle : {0.3, 1e-2, 1e-5, 1e-9}) {
    for (const double small : {0.1, 1e-4, 1e-8}) {
      // A blade along the y axis with its edge at the origin: two long sides that include the angle, a thin back.
      const double h = 0.5 * angle;
      const Model blade(
          Mesh::create({{0, 0, 0}, {0, small, 0}, {10, 0, -h}, {10, 0, h}, {10, small, -h}, {10, small, h}},
                       {{0, 1, 2}, {1, 4, 2}, {0, 3, 1}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}, {0, 2, 3}, {1, 5, 4}})
              .value());
      const ClosedSurface surface = ClosedSurface::create(blade).value();
      for (int i = 0; i < 60; ++i) {
        const double size = std::pow(10.0, rng.uniform(-12, 0));
        const Vec3 along{i % 2 == 0 ? 0 : rng.uniform(0, 10), rng.uniform(0, small), 0};
        expect_signed_distance(surface, along + size * random_point(rng, 1));
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing
