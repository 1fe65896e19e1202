// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The sides of contact normals: of two triangles that have an outside, and of closed meshes, where the normals together
// must part the bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "limber/contacts.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "support/random_solids.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

constexpr OrientedFaces all_oriented[] = {OrientedFaces::none, OrientedFaces::of_a, OrientedFaces::of_b,
                                          OrientedFaces::both};

OrientedFaces swapped_faces(OrientedFaces faces) {
  if (faces == OrientedFaces::of_a) return OrientedFaces::of_b;
  return faces == OrientedFaces::of_b ? OrientedFaces::of_a : faces;
}

Vec3 scaled_to_one(const Vec3& v) { return length_sq(v) == 0 ? v : v * (1 / length(v)); }
Vec3 face_normal(const Triangle& t) { return scaled_to_one(cross(t.v1 - t.v0, t.v2 - t.v0)); }

// --- two triangles ---

const Triangle floor_face{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};  // its outside is up

TEST(ContactSides, OfFacesThatLookTheSameWayAreUnknown) {
  const auto through_the_floor = [](double angle) {  // its outside is up, turned by the angle
    const double c = std::cos(angle), s = std::sin(angle);
    return Triangle{{1 - c, 1, -s}, {1 + c, 1, s}, {1, 2, 0}};
  };
  for (const double degrees : {0.0, 1.0, 29.0}) {
    const Triangle t = through_the_floor(degrees * std::numbers::pi / 180);
    const TriangleContact c = contact(floor_face, t, OrientedFaces::both), plain = contact(floor_face, t);
    EXPECT_EQ(c.normal_side, NormalSide::unknown) << degrees;
    EXPECT_EQ(c.normal, plain.normal);
    EXPECT_EQ(c.depth, plain.depth);
    EXPECT_EQ(contact(floor_face, t, OrientedFaces::of_a).normal_side, NormalSide::outward) << degrees;
  }
  const Triangle t = through_the_floor(31 * std::numbers::pi / 180);
  EXPECT_EQ(contact(floor_face, t, OrientedFaces::both).normal_side, NormalSide::outward);
  // A face that looks down and a little sideways, and reaches through the floor.
  const Triangle lid{{1, 1, -0.25}, {1, 2, 1}, {2.5, 1, 1}};
  const TriangleContact c = contact(floor_face, lid, OrientedFaces::both);
  EXPECT_LE(max_abs(c.normal - scaled_to_one(Vec3{0, 0, 1} - face_normal(lid))), 1e-15);
}

TEST(ContactSides, OfTrianglesThatAreApartTellTheBackFromTheFront) {
  const Triangle above{{1, 1, 2}, {1, 2, 5}, {2, 1, 5}};  // looks down
  const Triangle back{above.v0, above.v2, above.v1}, below{{1, 1, -2}, {1, 2, -5}, {2, 1, -5}};
  const Triangle wall{{1, 1, 0.1}, {2, 1, 0.1}, {1, 1, 5}};  // the normal lies in its face
  const struct {
    const Triangle& other;
    OrientedFaces oriented;
    NormalSide side;
  } cases[] = {
      {above, OrientedFaces::none, NormalSide::unknown}, {above, OrientedFaces::both, NormalSide::outward},
      {back, OrientedFaces::both, NormalSide::inward},   {back, OrientedFaces::of_a, NormalSide::outward},
      {below, OrientedFaces::of_a, NormalSide::inward},  {below, OrientedFaces::none, NormalSide::unknown},
      {wall, OrientedFaces::both, NormalSide::outward},
  };
  for (const auto& [other, oriented, side] : cases) {
    EXPECT_EQ(contact(floor_face, other, oriented).normal_side, side);
  }
}

TEST(ContactSides, OfDegenerateTrianglesAreThoseOfTheOther) {
  const Triangle needle{{1, 1, -1}, {1, 1, 1}, {1, 1, 1}};
  const TriangleContact c = contact(floor_face, needle, OrientedFaces::both);
  EXPECT_EQ(c.normal_side, NormalSide::outward);
  EXPECT_EQ(c.normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(c.depth, contact(floor_face, needle).depth);
  EXPECT_EQ(contact(needle, needle, OrientedFaces::both).normal_side, NormalSide::unknown);
  EXPECT_EQ(contact(floor_face, needle, OrientedFaces::of_b).normal_side, NormalSide::unknown);
}

TEST(ContactSides, OfTrianglesThatMeetAreTheirNormalsCombined) {
  Rng rng(435);
  const double cosine_of_20_degrees = std::cos(std::numbers::pi / 9);
  constexpr double scales[] = {1, 0x1p-500, 0x1p-200, 0x1p60, 0x1p190};
  int meeting = 0, looking_alike = 0;
  for (int i = 0; i < 20'000; ++i) {
    Triangle a = uniform_triangle(rng), b = uniform_triangle(rng);
    if (i % 2 == 0) b = {a.v0 + 0.2 * b.v0, a.v1 + 0.2 * b.v1, a.v2 + 0.2 * b.v2};  // nearly parallel
    const Vec3 n_a = face_normal(a), n_b = face_normal(b);
    const double scale = scales[i % 5];
    a = {scale * a.v0, scale * a.v1, scale * a.v2}, b = {scale * b.v0, scale * b.v1, scale * b.v2};
    const TriangleContact of_a = contact(a, b, OrientedFaces::of_a), of_b = contact(a, b, OrientedFaces::of_b);
    if (of_a.distance > 0) continue;
    ++meeting;
    const double along = dot(n_a, n_b);
    looking_alike += along > 0.9 ? 1 : 0;
    ASSERT_EQ(of_a.normal_side, NormalSide::outward) << "case " << i;
    ASSERT_EQ(of_b.normal_side, NormalSide::outward) << "case " << i;
    ASSERT_GT(dot(of_a.normal, n_a), cosine_of_20_degrees) << "case " << i;
    ASSERT_LT(dot(of_b.normal, n_b), -cosine_of_20_degrees) << "case " << i;
    ASSERT_LE(max_abs(of_a.normal - scaled_to_one(n_a + along * n_b)), 1e-9) << "case " << i;
    ASSERT_LE(max_abs(of_b.normal + scaled_to_one(n_b + along * n_a)), 1e-9) << "case " << i;
    if (along > 0.86) continue;  // faces that look the same way
    const TriangleContact both = contact(a, b, OrientedFaces::both);
    ASSERT_EQ(both.normal_side, NormalSide::outward) << "case " << i;
  }
  EXPECT_GT(meeting, 2000);
  EXPECT_GT(looking_alike, 500);
}

/// Checks what contact() promises of triangles with outsides.
void expect_sided(const Triangle& a, const Triangle& b, OrientedFaces oriented) {
  const TriangleContact c = contact(a, b, oriented), plain = contact(a, b);
  const TriangleContact swapped = contact(b, a, swapped_faces(oriented));
  EXPECT_EQ(c.distance, plain.distance);
  EXPECT_EQ(c.point_a, plain.point_a);
  EXPECT_EQ(c.feature_b, plain.feature_b);
  EXPECT_NEAR(length(c.normal), 1, 0x1p-50);
  EXPECT_TRUE(c.distance > 0 || swapped.normal_side == c.normal_side);
  EXPECT_TRUE(oriented != OrientedFaces::none || c.normal_side == NormalSide::unknown);
  EXPECT_EQ(c.depth, plain.depth);
  if (c.distance > 0 || c.normal_side == NormalSide::unknown) {
    EXPECT_EQ(c.normal, plain.normal);
    return;
  }
  EXPECT_EQ(c.normal_side, NormalSide::outward);
  EXPECT_EQ(swapped.normal, -c.normal);
  EXPECT_EQ(swapped.depth, c.depth);
}

TEST(ContactSides, OfAnyTrianglesAreSound) {
  Rng rng(431);
  int outward = 0, at_the_limit = 0;
  for (int i = 0; i < 46'000 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    // Small whole numbers put the angle between two faces at exactly 30 degrees now and then, where rounding decides
    // whether the faces look the same way.
    const bool is_on_lattice = i >= 6000;
    const auto [a, b] = is_on_lattice
                            ? std::pair<Triangle, Triangle>{lattice_triangle(rng, 8), lattice_triangle(rng, 8)}
                            : random_pair(rng, static_cast<PairKind>(i % static_cast<int>(PairKind::count)));
    const Vec3 n_a = cross(a.v1 - a.v0, a.v2 - a.v0), n_b = cross(b.v1 - b.v0, b.v2 - b.v0);
    const double along = dot(n_a, n_b);
    at_the_limit += is_on_lattice && along > 0 && 4 * along * along == 3 * length_sq(n_a) * length_sq(n_b);
    for (const OrientedFaces oriented : all_oriented) {
      expect_sided(a, b, oriented);
      const TriangleContact c = contact(a, b, oriented);
      if (c.distance > 0 || c.normal_side != NormalSide::outward) continue;
      ++outward;
      // Neither into a nor out of b, where their faces are known well.
      const auto is_clear = [](const Triangle& t, const Vec3& n) {
        return length_sq(n) > 1e-12 * length_sq(t.v1 - t.v0) * length_sq(t.v2 - t.v0);
      };
      EXPECT_TRUE(oriented == OrientedFaces::of_b || !is_clear(a, n_a) || dot(c.normal, scaled_to_one(n_a)) >= -1e-9);
      EXPECT_TRUE(oriented == OrientedFaces::of_a || !is_clear(b, n_b) || dot(c.normal, scaled_to_one(n_b)) <= 1e-9);
    }
  }
  EXPECT_GT(outward, 1000);
  EXPECT_GT(at_the_limit, 10);
}

// --- bodies ---

/// What a solver makes of a list of contacts.
struct Resultant {
  std::size_t intersecting = 0, unknown = 0, inward = 0;
  std::size_t backwards = 0;  // of those that intersect
  Vec3 sum, weighted;         // normals of those that intersect; the same by their depths
  Vec3 sum_of_outward;        // of all that are outward
};

Resultant resultant_of(const Placed& a, const Placed& b, double margin, const Vec3& out_of_a,
                       const PairOptions& options = {}) {
  Resultant result;
  const PairCount count = visit_contacts(
      a, b, margin,
      [&](const Contact& c) {
        result.unknown += c.normal_side == NormalSide::unknown;
        result.inward += c.normal_side == NormalSide::inward;
        if (c.normal_side == NormalSide::outward) result.sum_of_outward += c.normal;
        if (c.distance > 0) return true;
        ++result.intersecting;
        result.backwards += dot(c.normal, out_of_a) < 0;
        result.sum += c.normal, result.weighted += c.depth * c.normal;
        return true;
      },
      options);
  EXPECT_TRUE(count.is_complete);
  return result;
}

double cosine_between(const Vec3& v, const Vec3& w) { return dot(scaled_to_one(v), scaled_to_one(w)); }

/// Expects that the contacts of what meets lead b out of a. Returns their sum.
Vec3 expect_parted(const Placed& a, const Placed& b, const Vec3& out, double least_cosine = 0.99,
                   double least_of_outward = 0) {
  const Resultant r = resultant_of(a, b, 0.002, out);
  EXPECT_EQ(r.unknown + r.backwards, 0U);
  if (r.intersecting == 0) return {};
  for (const Vec3& sum : {r.sum, r.weighted}) EXPECT_GE(cosine_between(sum, out), least_cosine);
  EXPECT_GE(cosine_between(r.sum_of_outward, out), least_of_outward);
  return r.sum;
}

TEST(ContactSides, OfTwoBallsPartThem) {
  Rng rng(433);
  std::size_t scenes_that_meet = 0;
  for (const auto& [slices, stacks] : {std::pair{12U, 9U}, {33U, 20U}, {100U, 60U}, {300U, 180U}}) {
    const Model a(scenes::ball(slices, stacks)), b(scenes::ball(slices + 3, stacks - 1));
    for (const double depth : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 0.5}) {
      for (int turn = 0; turn < 4; ++turn) {
        SCOPED_TRACE(std::to_string(slices) + " slices, depth " + std::to_string(depth));
        const Vec3 out = scaled_to_one(uniform_point(rng));
        const Transform pose_a{scenes::random_rotation(rng), {}};
        const Transform pose_b{scenes::random_rotation(rng), out * (2 - depth)};
        // Flat faces do not reach as far as balls.
        scenes_that_meet += expect_parted({a, pose_a}, {b, pose_b}, out, 0.99, 0.99) == Vec3{} ? 0 : 1;
      }
    }
  }
  EXPECT_GT(scenes_that_meet, 60U);
}

TEST(ContactSides, OfBallsWithAWideMarginPartThemWithoutThoseInward) {
  const Model ball(scenes::ball(60, 40));
  for (const double depth : {0.01, 0.05, 0.2}) {
    for (const double margin : {0.02, 0.05, 0.1}) {
      const Resultant r = resultant_of({ball}, {ball, {{}, {2 - depth, 0.01, 0.02}}}, margin, {1, 0, 0});
      EXPECT_GT(r.inward, 0U);
      EXPECT_GE(cosine_between(r.sum_of_outward, {1, 0, 0}), 0.95) << depth << ", margin " << margin;
    }
  }
  std::vector<Contact> closest(9);
  ASSERT_EQ(closest_pairs({ball}, {ball, {{}, {2.5, 0, 0}}}, closest).count, closest.size());
  for (const Contact& c : closest) EXPECT_EQ(c.normal_side, NormalSide::outward);
}

TEST(ContactSides, OfACrateThatTouchesAFloorAreTheFloors) {
  const Model floor(box_mesh({-5, -5, -2}, {5, 5, 0})), crate(box_mesh({-0.5, -0.5, 0}, {0.5, 0.5, 1}));
  Rng rng(436);
  for (const double gap : {1e-3, 1e-6, 0.0, -1e-6, -1e-4, -1e-3}) {
    for (int turn = 0; turn < 20; ++turn) {
      SCOPED_TRACE("gap " + std::to_string(gap) + ", turn " + std::to_string(turn));
      const Transform room{turn % 2 == 0 ? Mat3{} : scenes::random_rotation(rng), {}};
      const double c = std::cos(0.3 * turn), s = std::sin(0.3 * turn);
      const Transform in_room{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, {0.1 + 0.013 * turn, 0.05, gap}};
      const Placed a{floor, room}, b{crate, room * in_room};
      std::size_t count = 0;
      double depth = 0;
      for (const bool swaps : {false, true}) {
        visit_contacts(swaps ? b : a, swaps ? a : b, std::max(gap, 0.0) + 1e-9, [&](const Contact& contact) {
          if (contact.normal_side == NormalSide::inward || (gap < 0 && contact.distance > 0)) return true;
          ++count, depth = std::max(depth, contact.depth);
          EXPECT_EQ(contact.normal_side, NormalSide::outward);
          EXPECT_GT((swaps ? -1 : 1) * dot(contact.normal, room.rotation * Vec3{0, 0, 1}), 0.99985);  // 1 degree
          return true;
        });
      }
      EXPECT_GE(count, 16U);
      EXPECT_NEAR(depth, std::max(-gap, 0.0), 1e-12);
    }
  }
}

TEST(ContactSides, OfOneClosedBodyOrTwoPartWhatMeets) {
  const Mesh mesh = scenes::ball(30, 20);
  const Model ring(scenes::ring(48, 24, 0.4)), cloth(scenes::grid(40, 40, -2, -2, 0.1, 0.1));
  const Model ball(mesh), hollow(turned_inside_out(mesh)), small(scaled(mesh, 0.4));
  EXPECT_FALSE(cloth.mesh().is_closed());
  for (const double depth : {0.01, 0.1, 0.3}) {
    SCOPED_TRACE(depth);
    EXPECT_GT(expect_parted({ring}, {ring, {{}, {0.0123, 0.02, 0.8 - depth}}}, {0, 0, 1}).z, 0);
    EXPECT_GT(expect_parted({ring}, {ring, {{}, {2.8 - depth, 0.01, 0.02}}}, {1, 0, 0}).x, 0);
  }
  Rng rng(434);
  for (const double through : {0.01, 0.05, 0.2, 0.5}) {
    SCOPED_TRACE(through);
    const Transform above{scenes::random_rotation(rng), {0.01, 0.02, 1 - through}};
    const Vec3 over = expect_parted({cloth}, {ball, above}, {0, 0, 1});
    const Vec3 under = expect_parted({ball, above}, {cloth}, {0, 0, -1});
    EXPECT_GT(over.z, 0);
    EXPECT_LE(max_abs(under + over), 1e-12);
  }
  // A cave pushes the cloth, and a ball that is stuck in its wall, inward.
  EXPECT_LT(expect_parted({cloth}, {hollow, {{}, {0.013, 0.021, 0.8}}}, {0, 0, -1}).z, 0);
  for (const double at : {0.65, 0.8}) {
    EXPECT_LT(expect_parted({hollow}, {small, {{}, {at, 0.01, 0.02}}}, {-1, 0, 0}, 0.98).x, 0);
  }
}

TEST(ContactSides, OfOpenMeshesAreUnknownUnlessAskedFor) {
  const Model soup_a(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}}));
  const Model soup_b(soup({{{0.2, 0.2, -0.1}, {0.2, 0.3, 1}, {0.3, 0.2, 1}}}));
  std::vector<Contact> found(4);
  ASSERT_EQ(contacts({soup_a}, {soup_b}, 0, found).count, 1U);
  EXPECT_EQ(found[0].normal_side, NormalSide::unknown);
  for (const OrientedFaces faces : all_oriented) {
    const TriangleContact asked = contact(soup_a.mesh().triangle(0), soup_b.mesh().triangle(0), faces);
    ASSERT_EQ(contacts({soup_a}, {soup_b}, 0, found, {.oriented_faces = faces}).count, 1U);
    EXPECT_EQ(found[0].normal_side, asked.normal_side);
    EXPECT_EQ(found[0].normal, asked.normal);
  }
  const Model ball(scenes::ball(20, 12));
  const Resultant r =
      resultant_of({ball}, {ball, {{}, {1.8, 0.01, 0.02}}}, 0, {1, 0, 0}, {.oriented_faces = OrientedFaces::none});
  EXPECT_EQ(r.unknown, r.intersecting);
}

TEST(ContactSides, OfABodyInsideACopyOfItselfAreUnknown) {
  const Mesh mesh = scenes::ball(30, 20);
  const Model ball(mesh), inner(scaled(mesh, 0.9995));
  const Mat3 turned{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}};
  const Resultant r = resultant_of({ball}, {inner, {turned, {0.0005, 0, 0}}}, 0, {1, 0, 0});
  EXPECT_GT(r.intersecting, 500U);
  EXPECT_EQ(r.unknown, r.intersecting);
}

// --- one model with itself ---

TEST(ContactSides, OfOneModelAreThoseOfTwoBodies) {
  // Two balls as one mesh.
  const Mesh ball = scenes::ball(24, 16);
  const Model both(joined(ball, mapped(ball, [](const Vec3& p) { return p + Vec3{1.9, 0.01, 0.02}; })));
  Vec3 sum;
  visit_self_contacts(both, 0, [&](const Contact& c) {
    EXPECT_EQ(c.normal_side, NormalSide::outward);
    EXPECT_LT(c.triangle_a, ball.triangles().size());
    sum += c.normal;
    return true;
  });
  EXPECT_GE(cosine_between(sum, {1, 0, 0}), 0.99);
  std::size_t unknown = 0, count = 0;
  visit_self_contacts(both, 0,
                      [&](const Contact& c) { return ++count, unknown += c.normal_side == NormalSide::unknown, true; },
                      {.oriented_faces = OrientedFaces::none});
  EXPECT_EQ(unknown, count);
}

TEST(ContactSides, OfNeighborsAreUnknown) {
  // A double pyramid over a bent quadrilateral: two faces at the top cross beyond their common corner.
  const std::vector<Vec3> positions{{0, 0, 1},        {0, 0, -1},     {1, 0, 0},       {1, 1, 0},
                                    {-0.2, 0.5, 0.3}, {1, 0.2, -0.5}, {0.8, -0.4, 0.6}};
  std::vector<Corners> triangles;
  for (VertexId i = 0; i < 5; ++i) {
    const VertexId v = 2 + i, w = 2 + (i + 1) % 5;
    triangles.push_back({0, v, w}), triangles.push_back({1, w, v});
  }
  const Model folded(Mesh::create(positions, triangles).value());
  ASSERT_TRUE(folded.mesh().is_closed());
  std::size_t neighbors = 0;
  visit_self_contacts(folded, 0, [&](const Contact& c) {
    const Corners &v = folded.mesh().triangles()[c.triangle_a], &w = folded.mesh().triangles()[c.triangle_b];
    if (std::find_first_of(v.begin(), v.end(), w.begin(), w.end()) == v.end()) return true;
    ++neighbors;
    EXPECT_EQ(c.normal_side, NormalSide::unknown);
    return true;
  });
  EXPECT_GT(neighbors, 0U);
}

}  // namespace
}  // namespace limber::testing
