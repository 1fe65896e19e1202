// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Penetration of random solids on a small lattice and off it: deepest vertices as by a loop, separating translations as
// in rational arithmetic, and signed distances whose translations are proven by other queries.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "limber/io.h"
#include "limber/penetration.h"
#include "reference/place.h"
#include "simd/kernels.h"
#include "support/random_solids.h"
#include "support/rational_geometry.h"
#include "support/real_meshes.h"

namespace limber::testing {
namespace {

/// Two solids and their poses.
struct SolidPair {
  Mesh a, b;
  Transform pose_a, pose_b;
  double size = 1;  // what coordinates are at most about

  explicit SolidPair(Rng& rng) : a(random_solid(rng)), b(rng.below(8) == 0 ? a : random_solid(rng)) {
    const std::uint64_t kind = rng.below(8);
    double scale = 1;
    if (kind == 0) scale = std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150);
    if (kind == 1) scale = 0.1;  // nothing is a whole number
    const double scale_of_b = rng.below(4) == 0 ? scale * std::pow(10.0, -rng.uniform(0, 4)) : scale;
    a = mapped(a, [&](const Vec3& p) { return scale * p; });
    b = mapped(b, [&](const Vec3& p) { return scale_of_b * p; });
    if (rng.below(2) == 0) pose_b.translation = scale * (lattice_point(rng, 7) - Vec3{3, 3, 3});
    if (rng.below(3) == 0) {
      pose_a = random_pose(rng, 2), pose_b = random_pose(rng, 2);
      pose_a.translation *= scale, pose_b.translation *= scale;
    }
    if (kind == 2) {
      const Vec3 offset = std::ldexp(scale, static_cast<int>(rng.below(30))) * lattice_point(rng);
      pose_a.translation += offset, pose_b.translation += offset;
    }
    size = 8 * scale + max_abs(pose_a.translation) + max_abs(pose_b.translation);
  }
};

Vec3 random_direction(Rng& rng) {
  const Vec3 d = rng.below(3) == 0   ? Vec3{0, 0, rng.below(2) == 0 ? 1.0 : -1.0}
                 : rng.below(2) == 0 ? lattice_point(rng, 3) - Vec3{1, 1, 1}
                                     : uniform_point(rng);
  return max_abs(d) == 0 ? Vec3{1, 0, 0} : d;
}

Transform pose_moved_by(const Transform& pose, const Vec3& by) { return {pose.rotation, pose.translation + by}; }

void expect_same_vertex(const std::optional<DeepestVertex>& found, const std::optional<DeepestVertex>& truth) {
  ASSERT_EQ(found.has_value(), truth.has_value());
  if (!truth) return;
  EXPECT_EQ(found->vertex, truth->vertex);
  EXPECT_EQ(found->depth, truth->depth);
  EXPECT_EQ(found->position, truth->position);
  EXPECT_EQ(found->closest.position, truth->closest.position);
  EXPECT_EQ(found->closest.distance, truth->depth);
  EXPECT_NEAR(length(found->direction), 1, 1e-12);
}

class PenetrationProperty : public ::testing::Test {
 protected:
  ~PenetrationProperty() override { simd::use_kernels(nullptr); }
};

TEST_F(PenetrationProperty, DeepestVerticesAreThoseOfALoop) {
  const std::uint64_t pairs = count_from("LIMBER_PENETRATION_PAIRS", 10'000);
  Rng rng(4001);
  int of_a = 0, of_both = 0;
  for (std::uint64_t i = 0; i < pairs && !HasFailure(); ++i) {
    SCOPED_TRACE("pair " + std::to_string(i));
    const SolidPair pair(rng);
    const SolidModel model_a(pair.a), model_b(pair.b);
    const ClosedSurface &a = model_a.surface, &b = model_b.surface;
    const std::optional<DeepestVertex> truth_a = deepest_by_loop(pair.a, pair.pose_a, b, pair.pose_b);
    const std::optional<DeepestVertex> truth_b = deepest_by_loop(pair.b, pair.pose_b, a, pair.pose_a);
    const std::span<const simd::Kernels> sets = simd::all_kernels();
    simd::use_kernels(&sets[i % sets.size()]);
    const DeepestVertices found = deepest_vertices({a, pair.pose_a}, {b, pair.pose_b});
    simd::use_kernels(nullptr);
    expect_same_vertex(found.of_a, truth_a), expect_same_vertex(found.of_b, truth_b);
    EXPECT_EQ(found.max_depth, std::max(truth_a ? truth_a->depth : 0, truth_b ? truth_b->depth : 0));
    of_a += truth_a ? 1 : 0, of_both += truth_a && truth_b ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(of_a), 0.1 * static_cast<double>(pairs));
  EXPECT_GT(static_cast<double>(of_both), 0.05 * static_cast<double>(pairs));
}

TEST_F(PenetrationProperty, SeparatingTranslationsAreThoseOfRationalArithmetic) {
  const std::uint64_t pairs = count_from("LIMBER_PENETRATION_PAIRS", 10'000) / 20;
  Rng rng(4002);
  int moving = 0, wide = 0;
  for (std::uint64_t i = 0; i < pairs && !HasFailure(); ++i) {
    SCOPED_TRACE("pair " + std::to_string(i));
    const SolidPair pair(rng);
    const SolidModel model_a(pair.a), model_b(pair.b);
    const ClosedSurface &a = model_a.surface, &b = model_b.surface;
    const SeparatingTranslation found =
        separating_translation({a, pair.pose_a}, {b, pair.pose_b}, random_direction(rng));
    const Rational truth = rational_separation(reference::place({pair.a, pair.pose_a}),
                                               reference::place({pair.b, pair.pose_b}), found.direction);
    EXPECT_GE(Rational(found.upper), truth) << found.upper << " is below " << truth.get_d();
    EXPECT_LE(found.lower, found.upper);
    const double tolerance = 0x1p-38 * pair.size;
    ++moving;
    if (found.upper > truth.get_d() + tolerance) {  // what only just passes may count as a contact
      ++wide;
      const Transform passing = pose_moved_by(pair.pose_b, found.upper * found.direction);
      EXPECT_LE(distance({model_a.model, pair.pose_a}, {model_b.model, passing}).upper, tolerance);
    }
    const Transform pose = pose_moved_by(pair.pose_b, found.upper * found.direction);
    EXPECT_TRUE(collide({model_a.model, pair.pose_a}, {model_b.model, pose}).is_no());
    if (!found.witness) continue;
    const Vec3 apart = found.witness->point_a - found.witness->point_b - found.lower * found.direction;
    EXPECT_LE(max_abs(apart), tolerance);
    const Transform last = pose_moved_by(pair.pose_b, found.lower * found.direction);
    EXPECT_LE(distance({model_a.model, pair.pose_a}, {model_b.model, last}).upper, tolerance);
  }
  EXPECT_LE(wide, 0.05 * moving);
}

TEST_F(PenetrationProperty, SignedDistancesAreProvenByOtherQueries) {
  const std::uint64_t pairs = count_from("LIMBER_PENETRATION_PAIRS", 10'000) / 5;
  Rng rng(4003);
  int apart = 0;
  for (std::uint64_t i = 0; i < pairs && !HasFailure(); ++i) {
    SCOPED_TRACE("pair " + std::to_string(i));
    const SolidPair pair(rng);
    const SolidModel model_a(pair.a), model_b(pair.b);
    const ClosedSurface &a = model_a.surface, &b = model_b.surface;
    const SolidDistance found = signed_distance({a, pair.pose_a}, {b, pair.pose_b});
    const auto is_apart = [&](const Transform& pose) {
      return collide({model_a.model, pair.pose_a}, {model_b.model, pose}).is_no() &&
             !deepest_by_loop(pair.a, pair.pose_a, b, pose) && !deepest_by_loop(pair.b, pose, a, pair.pose_a);
    };
    EXPECT_LE(found.lower, found.upper);
    ASSERT_EQ(found.are_apart(), is_apart(pair.pose_b));
    if (found.are_apart()) {
      ++apart;
      EXPECT_EQ(found.translation, Vec3{});
      EXPECT_EQ(found.upper, distance({model_a.model, pair.pose_a}, {model_b.model, pair.pose_b}).upper);
      EXPECT_TRUE(found.witness);
      continue;
    }
    EXPECT_LE(found.upper, 0);
    EXPECT_GE(-found.lower, length(found.translation));
    EXPECT_LE(-found.lower, length(found.translation) * (1 + 0x1p-30));
    EXPECT_LE(found.deepest.max_depth, -found.lower);
    EXPECT_TRUE(is_apart(pose_moved_by(pair.pose_b, found.translation)));
    const SolidDistance swapped = signed_distance({b, pair.pose_b}, {a, pair.pose_a});
    EXPECT_LE(swapped.lower, found.upper);
    EXPECT_LE(found.lower, swapped.upper);
  }
  EXPECT_GT(apart, 0);
}

/// A real mesh, scaled to a size of 1, with its holes filled by fans; nothing if it is not there.
std::optional<Mesh> closed_real_mesh(const char* name) {
  const Result<Mesh> loaded = load_mesh(real_mesh(name));
  if (!loaded) return std::nullopt;
  std::map<std::pair<VertexId, VertexId>, int> sides;
  for (const Corners& c : loaded->triangles()) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{c[k], c[(k + 1) % 3]}];
  }
  std::map<VertexId, VertexId> next;  // along the holes
  for (const auto& [side, count] : sides) {
    if (!sides.contains({side.second, side.first})) next[side.second] = side.first;
  }
  std::vector<Vec3> positions = loaded->positions();
  std::vector<Corners> triangles = loaded->triangles();
  while (!next.empty()) {
    const auto middle = static_cast<VertexId>(positions.size());
    Vec3 sum;
    double count = 0;
    for (auto at = next.begin(); at != next.end(); at = next.find(triangles.back()[1])) {
      triangles.push_back({at->first, at->second, middle});
      sum += positions[at->first], ++count;
      next.erase(at);
    }
    positions.push_back(sum * (1 / count));
  }
  Vec3 low = positions[0], high = low;
  for (const Vec3& p : positions) low = min(low, p), high = max(high, p);
  for (Vec3& p : positions) p = (p - 0.5 * (low + high)) * (1 / max_abs(high - low));
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

class RealPenetration : public ::testing::TestWithParam<const char*> {};

TEST_P(RealPenetration, IsKnownWhereAPlateIsPushedIn) {
  const std::optional<Mesh> mesh = closed_real_mesh(GetParam());
  if (!mesh) GTEST_SKIP() << "no such mesh";
  const SolidModel model(*mesh), plate(scenes::boxes({{{-2, -2, 0}, {2, 2, 2}}}));
  const ClosedSurface &body = model.surface, &above = plate.surface;
  Rng rng(4005);
  for (const double depth : {1e-6, 0.001, 0.05, 0.4}) {
    const Transform pose{scenes::random_rotation(rng), uniform_point(rng)};
    double top = -HUGE_VAL;
    for (const Corners& c : mesh->triangles()) {  // the bunny has vertices that no triangle uses
      for (const VertexId v : c) top = std::max(top, pose(mesh->positions()[v]).z);
    }
    const Transform at{{}, {0, 0, top - depth}};
    EXPECT_NEAR(deepest_vertices({body, pose}, {above, at}).of_a->depth, depth, 1e-12);
    const SeparatingTranslation up = separating_translation({body, pose}, {above, at}, {0, 0, 1});
    EXPECT_NEAR(up.lower, depth, 1e-11);
    EXPECT_NEAR(up.upper, depth, 1e-11);
    const SolidDistance found = signed_distance({body, pose}, {above, at});
    EXPECT_NEAR(found.upper, -depth, 1e-11);
    EXPECT_LE(-found.lower, 1.01 * depth + 1e-11);
  }
}

TEST_P(RealPenetration, OfABodyInItselfIsProvenByOtherQueries) {
  const std::optional<Mesh> mesh = closed_real_mesh(GetParam());
  if (!mesh) GTEST_SKIP() << "no such mesh";
  const SolidModel model(*mesh), small(mapped(*mesh, [](const Vec3&p) { return 0.5 * p; }));
  const ClosedSurface &body = model.surface, &other = small.surface;
  Rng rng(4006);
  for (int i = 0; i < 3; ++i) {
    const Transform pose{scenes::random_rotation(rng), 0.3 * uniform_point(rng)};
    const DeepestVertices deepest = deepest_vertices({body}, {other, pose});
    expect_same_vertex(deepest.of_a, deepest_by_loop(*mesh, {}, other, pose));
    expect_same_vertex(deepest.of_b, deepest_by_loop(small.model.mesh(), pose, body, {}));
    const SolidDistance found = signed_distance({body}, {other, pose});
    EXPECT_LE(deepest.max_depth, -found.upper + 1e-12);
    EXPECT_LE(found.lower, found.upper);
    const Transform away = pose_moved_by(pose, found.translation);
    EXPECT_TRUE(collide({model.model}, {small.model, away}).is_no());
    EXPECT_FALSE(deepest_by_loop(small.model.mesh(), away, body, {}));
    const SeparatingTranslation along = separating_translation({body}, {other, pose}, found.translation);
    EXPECT_LE(distance({model.model}, {small.model, pose_moved_by(pose, along.lower * along.direction)}).upper, 1e-11);
    for (double more = 1e-11; more < 2; more *= 1.5) {
      const Transform farther = pose_moved_by(pose, (along.upper + more) * along.direction);
      ASSERT_TRUE(collide({model.model}, {small.model, farther}).is_no());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, RealPenetration, ::testing::Values("spot.ply", "stanford-bunny.obj"),
                         [](const auto& test) { return std::string(test.param).substr(0, 4); });

/// The least translation of two convex solids that makes them apart: over the normals of all faces of their Minkowski
/// difference.
long double least_of_convex(const Mesh& a, const Mesh& b) {
  const auto edges_of = [](const Mesh& mesh) {
    std::vector<Vec3> edges;
    for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
      const Triangle s = mesh.triangle(t);
      edges.insert(edges.end(), {s.v1 - s.v0, s.v2 - s.v1, s.v0 - s.v2});
    }
    return edges;
  };
  const std::vector<Vec3> edges_a = edges_of(a), edges_b = edges_of(b);
  std::vector<Vec3> normals;
  for (const auto* edges : {&edges_a, &edges_b}) {
    for (std::size_t k = 0; k < edges->size(); k += 3) normals.push_back(cross((*edges)[k], (*edges)[k + 1]));
  }
  for (const Vec3& e : edges_a) {
    for (const Vec3& f : edges_b) normals.push_back(cross(e, f));
  }
  long double least = HUGE_VALL;
  for (const Vec3& n : normals) {
    if (length(n) < 1e-12) continue;
    const auto along = [&](const Vec3& p) {
      return static_cast<long double>(n.x) * p.x + static_cast<long double>(n.y) * p.y +
             static_cast<long double>(n.z) * p.z;
    };
    const auto range_of = [&](const Mesh& mesh) {
      long double low = HUGE_VALL, high = -HUGE_VALL;
      for (const Vec3& p : mesh.positions()) low = std::min(low, along(p)), high = std::max(high, along(p));
      return std::pair(low, high);
    };
    const auto [low_a, high_a] = range_of(a);
    const auto [low_b, high_b] = range_of(b);
    least = std::min(least, std::min(high_a - low_b, high_b - low_a) / std::sqrt(along(n)));
  }
  return least;
}

TEST_F(PenetrationProperty, TheLeastTranslationOfConvexSolidsIsInTheInterval) {
  const std::uint64_t pairs = count_from("LIMBER_PENETRATION_PAIRS", 10'000) / 10;
  Rng rng(4004);
  int meeting = 0, good = 0;
  for (std::uint64_t i = 0; i < pairs && !HasFailure(); ++i) {
    SCOPED_TRACE("pair " + std::to_string(i));
    const auto convex = [&] {
      const Vec3 p = uniform_point(rng, 0, 4), q = uniform_point(rng, 0, 4), r = uniform_point(rng, 0, 4);
      if (rng.below(2) == 0) return scenes::boxes({lattice_box(rng)});
      return tetrahedron(p, q, r, (p + q + r) * (1.0 / 3) + (0.1 + rng.uniform()) * uniform_point(rng));
    };
    const Mesh mesh_a = convex(), mesh_b = convex();
    Transform pose;
    if (rng.below(2) == 0) pose = random_pose(rng, 2);
    const SolidModel model_a(mesh_a), model_b(mesh_b);
    const ClosedSurface &a = model_a.surface, &b = model_b.surface;
    const SolidDistance found = signed_distance({a}, {b, pose}, {.relative_error = 0});
    if (found.are_apart()) continue;
    const auto truth = static_cast<double>(least_of_convex(mesh_a, mapped(mesh_b, pose)));
    EXPECT_GE(-found.lower, truth - 1e-11);
    EXPECT_LE(-found.upper, truth + 1e-11);
    ++meeting, good += -found.lower <= (1 + 1e-9) * truth + 1e-10 ? 1 : 0;
  }
  EXPECT_GT(good, 0.95 * meeting);
}

}  // namespace
}  // namespace limber::testing
