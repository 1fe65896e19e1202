// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Which meshes are convex, and queries of two convex bodies next to those of their triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "limber/convex.h"
#include "limber/points.h"
#include "limber/shapes.h"
#include "scenes/scenes.h"
#include "support/random_bodies.h"

namespace limber::testing {
namespace {

Mesh mesh_of(std::vector<Vec3> positions, std::vector<Corners> triangles) {
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

const Mesh& box_mesh() {
  static const Shape box = Shape::box({1, 1, 1});
  return box.model().mesh();
}

void expect_convex(const Mesh& mesh) {
  const Model model(mesh);
  const Result<ConvexSurface> surface = ConvexSurface::create(model);
  EXPECT_TRUE(static_cast<bool>(surface)) << surface.error().text;
}

void expect_refused(const Mesh& mesh, const std::string& part, ErrorCode code = ErrorCode::not_convex) {
  const Model model(mesh);
  const Result<ConvexSurface> surface = ConvexSurface::create(model);
  ASSERT_FALSE(static_cast<bool>(surface));
  EXPECT_EQ(surface.error().code, code);
  EXPECT_NE(surface.error().text.find(part), std::string::npos) << surface.error().text;
}

TEST(ConvexSurface, ConvexMeshesAreAccepted) {
  expect_convex(box_mesh());
  expect_convex(mapped(box_mesh(), [](const Vec3& p) { return Vec3{-p.x, p.y, p.z}; }));
  expect_convex(scenes::ball(20, 12));
  expect_convex(mapped(box_mesh(), [](const Vec3& p) { return 0x1p-100 * p; }));
  expect_convex(mapped(box_mesh(), [](const Vec3& p) { return 0x1p190 * p; }));
  expect_convex(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  expect_convex(mesh_of({{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {1, 0, 1}}, {{0, 4, 3}, {4, 1, 2}, {4, 2, 3}}));
  expect_convex(mesh_of({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, {{0, 1, 1}, {1, 2, 1}}));
  expect_convex(mesh_of({{5, 5, 5}}, {{0, 0, 0}}));
}

TEST(ConvexSurface, OthersAreRefusedNamingWhatAndWhere) {
  std::vector<Vec3> dented = scenes::ball(8, 5).positions();
  dented[5] *= 0.5;
  expect_refused(mesh_of(dented, scenes::ball(8, 5).triangles()), ") is concave: vertex ");
  expect_refused(joined(box_mesh(), mapped(box_mesh(),
                                           [](const Vec3& p) {
                                             return p + Vec3{3, 0, 0};
                                           })),
                 "in front of triangle");
  std::vector<Corners> open = box_mesh().triangles();
  open.pop_back();
  expect_refused(mesh_of(box_mesh().positions(), open), "", ErrorCode::not_closed);
  const std::vector<Vec3> corner{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  expect_refused(mesh_of(corner, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}), "outline is concave at vertex 3");
  expect_refused(mesh_of(corner, {{0, 1, 2}, {3, 4, 5}}), "more than one outline");
  expect_refused(mesh_of(corner, {{0, 1, 2}, {0, 2, 1}}), "lies on others");
  std::vector<Vec3> star{{0, 0, 0}};
  for (int i = 0; i < 5; ++i)
    star.push_back({std::cos(0.8 * i * std::numbers::pi), std::sin(0.8 * i * std::numbers::pi), 0});
  expect_refused(mesh_of(star, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1}}), "crosses itself");
  expect_refused(mesh_of({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {{0, 1, 1}, {2, 3, 3}}), "a gap of 1.73");
}

TEST(ConvexSurface, AModelThatHasMovedIsRefusedUntilItIsCheckedAgain) {
  Model model(box_mesh());
  const ConvexSurface surface = ConvexSurface::create(model).value();
  const Placed placed = surface.solid(), other = surface.solid({{}, {5, 0, 0}});
  EXPECT_EQ(distance(placed, other).upper, 3);
  ASSERT_TRUE(model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{0, 0, 0}}));
  model.commit();
  EXPECT_THROW((void)distance(placed, other), std::invalid_argument);
  EXPECT_THROW((void)convex_depth(placed, other), std::invalid_argument);
  EXPECT_THROW((void)surface.solid(), std::invalid_argument);
  EXPECT_FALSE(static_cast<bool>(ConvexSurface::create(model)));
  ASSERT_TRUE(model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{-1, -1, -1}}));
  model.commit();
  const ConvexSurface again = ConvexSurface::create(model).value();
  EXPECT_EQ(distance(again.solid(), again.solid({{}, {5, 0, 0}})).upper, 3);
  model.reset(box_mesh());
  EXPECT_THROW((void)again.solid(), std::invalid_argument);
}

/// A body twice: known as convex, and as triangles or a solid.
struct BothWays {
  explicit BothWays(Mesh mesh, double wanted = 0)
      : model(std::make_unique<Model>(std::move(mesh))), convex(ConvexSurface::create(*model).value()), radius(wanted) {
    if (convex.is_solid()) closed = ClosedSurface::create(*model).value();
  }
  Placed known(const Transform& pose) const { return {Body(convex, radius), pose}; }
  Placed plain(const Transform& pose) const {
    return closed && radius == 0 ? Placed(Body(*closed), pose) : Placed(Body(*model, radius), pose);
  }

  std::unique_ptr<Model> model;
  ConvexSurface convex;
  std::optional<ClosedSurface> closed;
  double radius;
};

std::vector<BothWays> some_bodies(double scale) {
  std::vector<BothWays> bodies;
  const auto add = [&](const Mesh& mesh, double radius = 0) {
    bodies.emplace_back(mapped(mesh, [&](const Vec3& p) { return scale * p; }), scale * radius);
  };
  add(box_mesh());
  add(mapped(box_mesh(), [](const Vec3& p) { return 0.25 * p; }));
  add(scenes::ball(12, 8));
  add(mapped(scenes::ball(8, 5), [](const Vec3& p) { return Vec3{-p.x, 0.5 * p.y, 0.125 * p.z}; }));
  add(Shape::cylinder({0, 0, -1}, {0, 0, 1}, 0.5, 0.01).model().mesh());
  add(mesh_of({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
  add(mesh_of({{-1, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}));
  add(mesh_of({{0, 0, 0}}, {{0, 0, 0}}));
  add(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), 0.25);
  return bodies;
}

double size_of(const Placed& a, const Placed& b) {
  double size = 0;
  for (const Placed* p : {&a, &b}) {
    const Sphere sphere = p->model().bounding_sphere();
    size += max_abs(p->pose.translation) + max_abs(sphere.center) + sphere.radius + p->body().radius();
  }
  return size;
}

/// Yes and no are the same; distances but for rounding.
void expect_same(const BothWays& a, const Transform& pose_a, const BothWays& b, const Transform& pose_b,
                 QueryCache& cache) {
  const Placed known_a = a.known(pose_a), known_b = b.known(pose_b), plain_a = a.plain(pose_a),
               plain_b = b.plain(pose_b);
  const DistanceResult truth = distance(plain_a, plain_b);
  const double tolerance = 0x1p-44 * size_of(plain_a, plain_b), limits[] = {truth.upper, 0.5 * truth.upper};
  for (QueryCache* with : {static_cast<QueryCache*>(nullptr), &cache, &cache}) {
    const DistanceResult found = distance(known_a, known_b, {.cache = with});
    EXPECT_NEAR(found.upper, truth.upper, tolerance);
    EXPECT_EQ(found.lower, found.upper);
    EXPECT_EQ(found.status, truth.status);
    EXPECT_EQ(collide(known_a, known_b, {.cache = with}).answer, truth.upper == 0 ? Answer::yes : Answer::no);
    EXPECT_TRUE(within(known_a, known_b, found.upper, {.cache = with}).is_yes());
    for (const double limit : limits) {
      EXPECT_EQ(within(known_a, known_b, limit, {.cache = with}).answer, within(plain_a, plain_b, limit).answer);
    }
    if (truth.upper == 0) continue;
    EXPECT_NEAR(length(found.witness->point_a - found.witness->point_b), found.upper, tolerance);
    for (const auto& [body, id, point] : {std::tuple{plain_a, found.witness->triangle_a, found.witness->point_a},
                                          std::tuple{plain_b, found.witness->triangle_b, found.witness->point_b}}) {
      const Triangle triangle = mapped(body.model().mesh().triangle(id), body.pose);
      EXPECT_NEAR(closest_points(point, triangle).distance, body.body().radius(), tolerance);
    }
    const DistanceResult limited = distance(known_a, known_b, {.max_distance = 0.5 * truth.upper, .cache = with});
    EXPECT_EQ(limited.status, DistanceStatus::beyond_limit);
  }
  const ConvexDepth depth = convex_depth(known_a, known_b);
  EXPECT_LE(depth.lower, depth.upper);
  if (truth.upper > tolerance) {
    EXPECT_EQ(depth.upper, 0);
    EXPECT_FALSE(depth.witness);
  } else if (truth.upper == 0) {
    EXPECT_LE(depth.upper - depth.lower, 0x1p-42 * size_of(plain_a, plain_b));
    Transform moved = pose_b;
    moved.translation += (depth.upper + tolerance) * depth.direction;
    EXPECT_EQ(collide(plain_a, b.plain(moved)).answer, Answer::no);
    moved.translation = pose_b.translation + 0.5 * depth.lower * depth.direction;
    EXPECT_EQ(collide(known_a, b.known(moved)).answer, Answer::yes);
  }
}

const Vec3 places[] = {{0, 0, 0},     {2, 0, 0},   {2, 2, 0},       {2, 2, 2},        {0.25, 0.5, 0}, {1.25, 0.5, 0.75},
                       {2.5, 2.5, 0}, {0, 0, 1.5}, {0.75, 0, 0.25}, {3, 0.5, -0.125}, {1, 0, 0},      {2.0625, 1.5, 1}};

TEST(ConvexQueries, AnswersAreThoseOfTheTriangles) {
  for (const double scale : {1.0, 0x1p-100, 0x1p100}) {
    const std::vector<BothWays> bodies = some_bodies(scale);
    QueryCache cache;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        SCOPED_TRACE(::testing::Message() << "bodies " << i << " and " << j << ", scale " << scale);
        for (const Vec3& place : places) expect_same(bodies[i], {}, bodies[j], {Mat3{}, scale * place}, cache);
      }
    }
  }
}

TEST(ConvexQueries, AnswersAreThoseOfTheTrianglesInAnyPose) {
  const std::vector<BothWays> bodies = some_bodies(1);
  QueryCache cache;
  Rng rng(5);
  for (int round = 0; round < 800; ++round) {
    const std::size_t i = rng.below(bodies.size()), j = rng.below(bodies.size());
    SCOPED_TRACE(::testing::Message() << "round " << round << ", bodies " << i << " and " << j);
    Transform pose_a = random_pose(rng, 1), pose_b = random_pose(rng, 2);
    if (rng.below(3) == 0) pose_a.rotation = pose_b.rotation = Mat3{};
    if (rng.below(4) == 0) pose_a.translation += Vec3{1e6, -1e6, 1e6}, pose_b.translation += Vec3{1e6, -1e6, 1e6};
    expect_same(bodies[i], pose_a, bodies[j], pose_b, cache);
  }
}

// Otherwise all of the above would be about triangles alone.
TEST(ConvexQueries, AreAnsweredBySupports) {
  const Shape ball = Shape::convex_hull(scenes::ball(40, 20).positions()), box = Shape::box({1, 1, 1});
  const Placed a(ball), b(box, {{}, {3, 0.3, 0.2}});
  EXPECT_EQ(distance(a, b).stats.primitive_tests, 1U);
  EXPECT_LT(distance(a, b).stats.node_tests, 20U);
  EXPECT_EQ(collide(a, b).stats.primitive_tests, 0U);
  EXPECT_EQ(within(a, b, 2).stats.primitive_tests, 1U);
  Rng rng(6);
  int others = 0;
  for (int round = 0; round < 300; ++round) {
    const DistanceResult near = distance({ball, random_pose(rng, 1)}, {box, random_pose(rng, 3)});
    others += near.upper > 0 && near.stats.primitive_tests != 1 ? 1 : 0;
  }
  EXPECT_LE(others, 3);
  QueryCache cache;
  const std::uint64_t cold = distance(a, b, {.cache = &cache}).stats.node_tests;
  EXPECT_LT(distance(a, b, {.cache = &cache}).stats.node_tests, cold);
}

TEST(ConvexDepth, KnownDepths) {
  const Shape box = Shape::box({1, 1, 1}), small = Shape::box({0.25, 0.25, 0.25}), ball = Shape::sphere(0.5);
  const auto expect = [](const Placed& a, const Placed& b, double depth) {
    const ConvexDepth found = convex_depth(a, b), swapped = convex_depth(b, a);
    EXPECT_NEAR(found.lower, depth, 1e-12);
    EXPECT_NEAR(found.upper, depth, 1e-12);
    EXPECT_LE(found.lower, depth);
    EXPECT_GE(found.upper, depth);
    EXPECT_NEAR(swapped.upper, depth, 1e-12);
    EXPECT_NEAR(length(found.direction), 1, 1e-12);
    const Vec3 moved = found.witness->point_b + found.upper * found.direction;
    EXPECT_NEAR(length(moved - found.witness->point_a), 0, 1e-11);
  };
  expect(box, {box, {{}, {1.75, 0.5, 0}}}, 0.25);
  expect(box, box, 2);
  expect(box, small, 1.25);
  expect(box, {small, {{}, {0.5, 0, 0}}}, 0.75);
  expect(box, {ball, {{}, {1.25, 0, 0}}}, 0.25);
  expect(box, ball, 1.5);
  expect(ball, {ball, {{}, {0.75, 0, 0}}}, 0.25);
  expect(ball, ball, 1);
  expect(box, {box, {{}, {2, 0.5, 0}}}, 0);
  const Shape beam = Shape::capsule({-1, 0, 0}, {1, 0, 0}, 0.5);
  expect(beam, {beam, {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {}}}, 1);
}

TEST(ConvexDepth, RefusesWhatIsNotKnownToBeConvex) {
  const Shape box = Shape::box({1, 1, 1}), cloud = Shape::point_cloud(std::vector<Vec3>{{0, 0, 0}}, 1);
  EXPECT_THROW((void)convex_depth(box, cloud), std::invalid_argument);
  EXPECT_THROW((void)convex_depth(Placed(box.model()), box), std::invalid_argument);
  EXPECT_THROW((void)convex_depth(box, box, {.relative_error = std::nan("")}), std::invalid_argument);
  EXPECT_THROW((void)convex_depth(box, box, {.relative_error = -1}), std::invalid_argument);
  const ConvexDepth rough = convex_depth(box, {box, {{}, {1.5, 0, 0}}}, {.relative_error = 0.5});
  EXPECT_LE(rough.upper, 1.5 * rough.lower + 1e-12);
}

}  // namespace
}  // namespace limber::testing
