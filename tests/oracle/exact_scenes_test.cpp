// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Distances and decisions compared with exact arithmetic, within the tolerance that docs/algorithms/numerics.md
// states. The numbers of pairs, scenes and sequences come from LIMBER_EXACT_PAIRS, _SCENES and _SEQUENCES.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/classic/classic.h"
#include "support/exact_distance.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Largest coordinate of a corner, relative to the first.
double extent_of(const Triangle& a, const Triangle& b) {
  double extent = 0;
  for (std::size_t i = 0; i < 3; ++i) extent = std::max({extent, max_abs(a[i] - a.v0), max_abs(b[i] - a.v0)});
  return extent;
}

class ExactPairs : public ::testing::TestWithParam<PairKind> {};

TEST_P(ExactPairs, AreAsFarApartAsSaidAndMeetExactlyWhenSaid) {
  Rng rng(3000 + static_cast<std::uint64_t>(GetParam()));
  const std::uint64_t pairs = count_from("LIMBER_EXACT_PAIRS", 10'000) / static_cast<std::uint64_t>(PairKind::count);
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const auto [a, b] = random_pair(rng, GetParam());
    const exact::Fraction truth = exact::squared_distance(a, b);
    const ClosestPoints found = closest_points(a, b);
    const double tolerance = 0x1p-50 * extent_of(a, b) + 0x1p-1022;
    ASSERT_EQ(intersects(a, b), truth == 0) << "pair " << i;
    ASSERT_EQ(found.distance == 0, truth == 0) << "pair " << i;
    ASSERT_TRUE(exact::is_at_most(found.distance, truth, tolerance)) << "pair " << i;
    ASSERT_TRUE(exact::is_at_least(found.distance, truth, tolerance)) << "pair " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, ExactPairs, ::testing::ValuesIn(every_kind<PairKind>()));

std::vector<Triangle> placed(const Mesh& mesh, const Transform& pose) {
  std::vector<Triangle> triangles;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle m = mesh.triangle(t);
    triangles.push_back({pose(m.v0), pose(m.v1), pose(m.v2)});
  }
  return triangles;
}

/// The exact squared distance of placed meshes, and the error that an answer may have.
struct Truth {
  exact::Fraction squared;
  double tolerance;  // of a distance of `distance`
};

/// Compares all pairs in float64, whose error ExactPairs bounds, and those that may be closest in exact arithmetic too.
Truth truth_of(const Mesh& mesh_a, const Transform& pose_a, const Mesh& mesh_b, const Transform& pose_b,
               const Witness* witness) {
  struct Pair {
    double lower, upper, extent;
    std::size_t a, b;
  };
  const std::vector<Triangle> a = placed(mesh_a, pose_a), b = placed(mesh_b, pose_b);
  std::vector<Pair> pairs;
  double nearest = std::numeric_limits<double>::infinity(), largest_coordinate = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double distance = closest_points(a[i], b[j]).distance, extent = extent_of(a[i], b[j]);
      const double error = distance == 0 ? 0 : 0x1p-50 * extent + 0x1p-1022;
      pairs.push_back({distance - error, distance + error, extent, i, j});
      nearest = std::min(nearest, distance + error);
    }
  }
  std::erase_if(pairs, [&](const Pair& p) { return p.lower > nearest; });
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.upper < q.upper; });
  // Where many pairs are equally near, they are so by construction, and a few of them are enough.
  if (pairs.size() > 12) pairs.resize(12);
  Truth truth{exact::squared_distance(a[pairs[0].a], b[pairs[0].b]), 0};
  double extent = 0;
  for (const Pair& p : pairs) {
    truth.squared = std::min(truth.squared, exact::squared_distance(a[p.a], b[p.b]));
    extent = std::max(extent, p.extent);
  }
  if (witness != nullptr) extent = std::max(extent, extent_of(a[witness->triangle_a], b[witness->triangle_b]));
  const bool is_still = pose_a == Transform{} && pose_b == Transform{};
  for (const auto& [mesh, pose] : {std::pair(&mesh_a, &pose_a), std::pair(&mesh_b, &pose_b)}) {
    for (const Vec3& p : mesh->positions())
      largest_coordinate = std::max(largest_coordinate, max_abs(p) + max_abs(pose->translation));
  }
  truth.tolerance = 0x1p-46 * extent + 0x1p-44 * nearest + (is_still ? 0 : 0x1p-45 * largest_coordinate) + 0x1p-1021;
  return truth;
}

/// Meshes of one scale, or of two scales up to 2^400 apart with the smaller mesh at a vertex of the larger one; meshes
/// that are points, some far from their origin; with poses and without.
RandomScene scene_of_any_scales(Rng& rng) {
  if (rng.below(2) == 0) return arbitrary_scene(rng);
  const double large = std::ldexp(1.0, static_cast<int>(rng.below(300)) - 160);
  const double small = std::ldexp(large, -static_cast<int>(rng.below(400)));
  const Vec3 offset = rng.below(3) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
  // Enough triangles for trees of two levels and more: only they have nodes that are projected in the other's frame.
  Mesh a = arbitrary_mesh(rng, rng.below(2) == 0 ? 300 : 12, offset, large), b = arbitrary_mesh(rng, 100, {}, small);
  const Vec3 vertex = a.positions()[rng.below(a.positions().size())];
  // At the vertex, near it, or so far from it that float64 hardly resolves the small mesh.
  const double separation = rng.below(3) == 0   ? 0
                            : rng.below(2) == 0 ? 4
                                                : std::ldexp(1, static_cast<int>(rng.below(55)));
  const Vec3 at = vertex + small * separation * uniform_point(rng);
  Transform pose_b;
  if (rng.below(4) == 0) {  // a mesh that is a point
    b = Mesh::create(std::vector<Vec3>(b.positions().size(), at), b.triangles()).value();
  } else if (rng.below(2) == 0) {
    pose_b.translation = at;
    if (rng.below(2) == 0) pose_b.rotation = scenes::random_rotation(rng);
  } else {
    b = moved(b, at, 1);
  }
  return {std::move(a), std::move(b), {}, pose_b, 0, 0};
}

/// Compares all answers about two models with the exact distance.
void check(const Model& model_a, const Transform& pose_a, const Model& model_b, const Transform& pose_b, Rng& rng,
           QueryCache* cache) {
  const Placed a{model_a, pose_a}, b{model_b, pose_b};
  const DistanceResult found = distance(a, b, {.cache = cache});
  const Truth truth = truth_of(model_a.mesh(), pose_a, model_b.mesh(), pose_b, &found.witness.value());
  const bool meets = truth.squared == 0;
  ASSERT_EQ(found.status, meets ? DistanceStatus::collision : DistanceStatus::exact);
  ASSERT_EQ(found.upper == 0, meets);
  ASSERT_EQ(found.lower, found.upper);
  ASSERT_TRUE(exact::is_at_most(found.upper, truth.squared, truth.tolerance)) << found.upper;
  ASSERT_TRUE(exact::is_at_least(found.upper, truth.squared, truth.tolerance)) << found.upper;
  ASSERT_EQ(collide(a, b).is_yes(), meets);
  ASSERT_EQ(within(a, b, 0).is_yes(), meets);
  // The models are within the distance that the query has returned.
  ASSERT_TRUE(within(a, b, found.upper).is_yes());
  ASSERT_NE(distance(a, b, {.max_distance = found.upper}).status, DistanceStatus::beyond_limit);
  ASSERT_NE(distance(b, a, {.max_distance = found.upper + truth.tolerance}).status, DistanceStatus::beyond_limit);

  const double error = rng.uniform(0, 1);
  const DistanceResult rough = distance(a, b, {.relative_error = error});
  ASSERT_EQ(rough.upper == 0, meets);
  ASSERT_TRUE(exact::is_at_most(rough.lower, truth.squared, truth.tolerance)) << rough.lower;
  ASSERT_TRUE(exact::is_at_least(rough.upper, truth.squared, truth.tolerance)) << rough.upper;
  ASSERT_LE(rough.upper, (found.upper + truth.tolerance) * (1 + error) + truth.tolerance);
  const double limit = found.upper * rng.uniform(0.1, 0.9);
  const DistanceResult limited = distance(a, b, {.max_distance = limit});
  ASSERT_TRUE(exact::is_at_most(limited.lower, truth.squared, truth.tolerance)) << limited.lower;

  const classic::Model classic_a(model_a.mesh()), classic_b(model_b.mesh());
  const DistanceResult classic_found = classic::distance({classic_a, pose_a}, {classic_b, pose_b});
  ASSERT_EQ(classic_found.upper == 0, meets);
  ASSERT_TRUE(exact::is_at_most(classic_found.lower, truth.squared, truth.tolerance)) << classic_found.lower;
}

TEST(ExactScenes, OfAnyScalesAreAnsweredWithinTheStatedError) {
  Rng rng(3100);
  const std::uint64_t scenes = count_from("LIMBER_EXACT_SCENES", 500);
  std::uint64_t i = 0, meeting = 0;
  for (; i < scenes && !HasFatalFailure(); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    const RandomScene s = scene_of_any_scales(rng);
    const Model a(s.mesh_a), b(s.mesh_b);
    check(a, s.pose_a, b, s.pose_b, rng, nullptr);
    meeting += collide({a, s.pose_a}, {b, s.pose_b}).is_yes() ? 1 : 0;
  }
  std::cout << i << " scenes, " << meeting << " in contact\n";
  EXPECT_GT(meeting, scenes / 50);
}

/// Positions that collapse to a point, a line or a plane, shrink or grow by powers of two, or are those of `home`.
std::vector<Vec3> deformed(Rng& rng, const std::vector<Vec3>& home) {
  std::vector<Vec3> positions = home;
  const Vec3 at = rng.below(2) == 0 ? home[rng.below(home.size())] : uniform_point(rng, -2, 2);
  const double scale = std::ldexp(1.0, static_cast<int>(rng.below(370)) - 190);
  const std::uint64_t kind = rng.below(6);
  for (Vec3& p : positions) {
    if (kind == 0) p = at;
    if (kind == 1) p.z = at.z;
    if (kind == 2) p.y = at.y, p.z = at.z;
    if (kind == 3) p = at + scale * (p - at);
    if (kind == 4) p += 0.1 * uniform_point(rng);
  }
  if (kind == 5) positions[rng.below(positions.size())] *= std::max(scale, 1.0);
  return positions;
}

TEST(ExactScenes, OfDeformingModelsAreAnsweredWithinTheStatedError) {
  Rng rng(3200);
  const std::uint64_t sequences = count_from("LIMBER_EXACT_SEQUENCES", 60);
  std::uint64_t i = 0;
  for (; i < sequences && !HasFatalFailure(); ++i) {
    SCOPED_TRACE("sequence " + std::to_string(i));
    constexpr double margins[] = {0, 0, 0.005, 0.05};
    const double motion_margin = margins[rng.below(4)];
    Model deforming(arbitrary_mesh(rng, rng.below(2) == 0 ? 100 : 12, {}, 1), {.motion_margin = motion_margin});
    const Model still(arbitrary_mesh(rng, rng.below(2) == 0 ? 100 : 8, {}, 1));
    const std::vector<Vec3> home = deforming.mesh().positions();
    QueryCache cache;
    for (int frame = 0; frame < 8 && !HasFatalFailure(); ++frame) {
      const std::vector<Vec3> positions = deformed(rng, home);
      if (rng.below(2) == 0) {
        ASSERT_TRUE(static_cast<bool>(deforming.move_all(positions)));
      } else {
        std::vector<VertexId> ids;
        std::vector<Vec3> some_positions;
        for (VertexId v = 0; v < positions.size(); v += 1 + static_cast<VertexId>(rng.below(3))) {
          ids.push_back(v), some_positions.push_back(positions[v]);
        }
        ASSERT_TRUE(static_cast<bool>(deforming.move_vertices(ids, some_positions)));
      }
      deforming.commit();
      const Result<void> valid = deforming.validate();
      ASSERT_TRUE(static_cast<bool>(valid)) << valid.error().text;
      const double range = rng.below(2) == 0 ? 2 : std::ldexp(1, static_cast<int>(rng.below(50)));
      check(deforming, {}, still, rng.below(2) == 0 ? Transform{} : random_pose(rng, range), rng, &cache);
    }
  }
  std::cout << i << " sequences\n";
}

}  // namespace
}  // namespace limber::testing
