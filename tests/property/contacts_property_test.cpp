// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// All pairs of two models, and of one with itself, against brute force: in random scenes, on every instruction set, and
// while models deform.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <vector>

#include "limber/contacts.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/crumpled_mesh.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

bool is_before(const TrianglePair& p, const TrianglePair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); }

std::vector<TrianglePair> sorted(std::vector<TrianglePair> pairs) {
  std::sort(pairs.begin(), pairs.end(), is_before);
  return pairs;
}

template <typename Visit>
std::vector<TrianglePair> collected_pairs(const Visit& visit) {
  std::vector<TrianglePair> pairs;
  const PairCount result = visit([&](const TrianglePair& pair) {
    pairs.push_back(pair);
    return true;
  });
  EXPECT_EQ(result.count, pairs.size());
  EXPECT_TRUE(result.is_complete);
  return pairs;
}

template <typename Visit>
std::vector<Contact> collected_contacts(const Visit& visit) {
  std::vector<Contact> contacts;
  const PairCount result = visit([&](const Contact& contact) {
    contacts.push_back(contact);
    return true;
  });
  EXPECT_EQ(result.count, contacts.size());
  EXPECT_TRUE(result.is_complete);
  return contacts;
}

bool same(const TrianglePair& p, const TrianglePair& q) { return p == q; }
/// To the bit; padding does not count.
bool same(const Contact& c, const Contact& d) {
  const auto numbers_of = [](const Contact& x) {
    return std::array<double, 11>{x.distance,  x.depth,     x.point_a.x, x.point_a.y, x.point_a.z, x.point_b.x,
                                  x.point_b.y, x.point_b.z, x.normal.x,  x.normal.y,  x.normal.z};
  };
  const auto of_c = numbers_of(c), of_d = numbers_of(d);
  return std::memcmp(of_c.data(), of_d.data(), sizeof of_c) == 0 && c.triangle_a == d.triangle_a &&
         c.triangle_b == d.triangle_b && c.feature_a == d.feature_a && c.feature_b == d.feature_b &&
         c.normal_side == d.normal_side;
}

/// The same list on every instruction set, order included.
template <typename List>
auto on_all_sets(const List& list) {
  simd::use_kernels(&simd::scalar_kernels);
  const auto first = list();
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    const auto again = list();
    EXPECT_EQ(again.size(), first.size()) << set.name;
    const std::size_t count = std::min(again.size(), first.size());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(same(again[i], first[i])) << set.name << ", pair " << i;
    }
  }
  simd::use_kernels(nullptr);
  return first;
}

std::vector<TrianglePair> pairs_of(const std::vector<Contact>& contacts, double most) {
  std::vector<TrianglePair> pairs;
  for (const Contact& c : contacts) {
    if (c.distance <= most) pairs.push_back({c.triangle_a, c.triangle_b});
  }
  return sorted(pairs);
}

/// Whether what was found within a margin is what brute force finds; pairs whose distance equals the margin up to
/// rounding may be missing or not. `truth` has all pairs within margin + rounding.
void expect_same(const std::vector<Contact>& found, const std::vector<Contact>& truth, double margin, double rounding) {
  const std::vector<TrianglePair> all = pairs_of(found, std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end()) << "a pair came twice";
  const std::vector<TrianglePair> certain = pairs_of(truth, margin == 0 ? 0 : std::max(margin - rounding, 0.0));
  const std::vector<TrianglePair> possible = pairs_of(truth, margin == 0 ? 0 : margin + rounding);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), certain.begin(), certain.end(), is_before)) << "pairs are missing";
  EXPECT_TRUE(std::includes(possible.begin(), possible.end(), all.begin(), all.end(), is_before)) << "too many pairs";
  for (const Contact& c : found) {
    const auto same = std::find_if(truth.begin(), truth.end(), [&](const Contact& t) {
      return t.triangle_a == c.triangle_a && t.triangle_b == c.triangle_b;
    });
    if (same == truth.end()) continue;  // reported above
    EXPECT_EQ(c.distance == 0, same->distance == 0);
    EXPECT_NEAR(c.distance, same->distance, rounding);
    EXPECT_NEAR(length(c.normal), 1, 1e-14);
    EXPECT_TRUE(c.normal != same->normal || c.normal_side == same->normal_side);
  }
}

TEST(ContactsProperty, AreThoseOfBruteForceInRandomScenes) {
  Rng rng(1301);
  std::size_t intersecting = 0, close = 0;
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const reference::Placed twin_a{s.mesh_a, s.pose_a}, twin_b{s.mesh_b, s.pose_b};
    const std::vector<TrianglePair> meeting = on_all_sets(
        [&] { return collected_pairs([&](TrianglePairVisitor visit) { return visit_intersections(a, b, visit); }); });
    ASSERT_EQ(sorted(meeting), reference::intersections(twin_a, twin_b));
    const double margin = some_margin(rng, s.size);
    const std::vector<Contact> contacts = on_all_sets(
        [&] { return collected_contacts([&](ContactVisitor visit) { return visit_contacts(a, b, margin, visit); }); });
    expect_same(contacts, reference::contacts(twin_a, twin_b, margin + s.tolerance), margin, s.tolerance);
    if (::testing::Test::HasFailure()) return;
    intersecting += meeting.size(), close += contacts.size();
  }
  EXPECT_GT(intersecting, 200U);
  EXPECT_GT(close, 2000U);
}

/// Whether the closest pairs are those of the twin, but for pairs that are equally close.
void expect_closest(const std::vector<Contact>& found, const std::vector<Contact>& truth, double rounding) {
  ASSERT_EQ(found.size(), truth.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    ASSERT_EQ(found[k].distance == 0, truth[k].distance == 0) << k;
    ASSERT_NEAR(found[k].distance, truth[k].distance, rounding) << k;
    ASSERT_TRUE(k == 0 || found[k - 1].distance <= found[k].distance) << k;
    for (std::size_t j = 0; j < k; ++j) {
      ASSERT_FALSE(found[j].triangle_a == found[k].triangle_a && found[j].triangle_b == found[k].triangle_b);
    }
  }
}

TEST(ContactsProperty, ClosestPairsAreTheClosest) {
  Rng rng(1302);
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    std::vector<Contact> found(rng.below(40));
    const std::vector<Contact> truth =
        reference::closest_pairs({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, found.size());
    found.resize(closest_pairs({model_a, s.pose_a}, {model_b, s.pose_b}, found).count);
    expect_closest(found, truth, s.tolerance);
    if (::testing::Test::HasFailure()) return;
  }
}

/// What self_distance() looks for; infinite if there is no pair.
double brute_force_self_distance(MeshView mesh) {
  if (!reference::self_intersections(mesh).empty()) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (TriangleId i = 0; i < mesh.triangles.size(); ++i) {
    for (TriangleId j = i + 1; j < mesh.triangles.size(); ++j) {
      const Corners &a = mesh.triangles[i], &b = mesh.triangles[j];
      if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end()) continue;
      least = std::min(least, closest_points(mesh.triangle(i), mesh.triangle(j)).distance);
    }
  }
  return least;
}

/// All self-queries of a model against brute force.
void check_self(const Model& model, Rng& rng, std::size_t& intersecting) {
  const MeshView mesh = model.mesh();
  const double size = extent_of(model.mesh()), rounding = 1e-14 * size;
  const std::vector<TrianglePair> meeting = on_all_sets([&] {
    return collected_pairs([&](TrianglePairVisitor visit) { return visit_self_intersections(model, visit); });
  });
  const std::vector<TrianglePair> truth = reference::self_intersections(mesh);
  ASSERT_EQ(sorted(meeting), truth);
  intersecting += truth.size();
  const CollideResult collision = self_collide(model);
  ASSERT_EQ(collision.is_yes(), !truth.empty());
  ASSERT_EQ(collision.witness.has_value(), !truth.empty());
  if (collision.witness) {
    const TrianglePair pair{collision.witness->triangle_a, collision.witness->triangle_b};
    ASSERT_TRUE(std::binary_search(truth.begin(), truth.end(), pair, is_before));
  }
  const double margin = some_margin(rng, size);
  const std::vector<Contact> contacts = on_all_sets([&] {
    return collected_contacts([&](ContactVisitor visit) { return visit_self_contacts(model, margin, visit); });
  });
  expect_same(contacts, reference::self_contacts(mesh, margin + rounding), margin, rounding);
  std::vector<Contact> closest(rng.below(40));
  const std::vector<Contact> closest_truth = reference::self_closest_pairs(mesh, closest.size());
  closest.resize(self_closest_pairs(model, closest).count);
  expect_closest(closest, closest_truth, rounding);
  const double least = brute_force_self_distance(mesh);
  const double relative_error = rng.below(2) == 0 ? 0 : rng.uniform(0, 0.5);
  const DistanceResult distance = self_distance(model, {.relative_error = relative_error});
  ASSERT_EQ(distance.status == Status::beyond_limit, std::isinf(least));
  if (std::isinf(least)) return;
  ASSERT_EQ(distance.upper == 0, least == 0);
  ASSERT_LE(distance.lower, least + rounding);
  ASSERT_LE(distance.upper, least * (1 + relative_error) + rounding);
  ASSERT_GE(distance.upper, least - rounding);
}

TEST(SelfContactsProperty, AreThoseOfBruteForceInRandomMeshes) {
  Rng rng(1303);
  std::size_t intersecting = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    check_self(Model(crumpled(rng)), rng, intersecting);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(intersecting, 1000U);
}

TEST(SelfContactsProperty, AreThoseOfBruteForceWhileModelsDeform) {
  Rng rng(1304);
  std::size_t intersecting = 0;
  for (int i = 0; i < 16; ++i) {
    SCOPED_TRACE(i);
    const RebuildPolicy policy = rng.below(2) == 0 ? RebuildPolicy::off : RebuildPolicy::in_commit;
    const double margin = rng.below(2) == 0 ? 0.05 : 0.002;
    Model model(crumpled(rng), {.motion_margin = margin, .rebuild_policy = policy});
    const double size = extent_of(model.mesh());
    for (int step = 0; step < 6; ++step) {
      std::vector<Vec3> positions = model.mesh().positions();
      const double length = size * std::pow(10.0, rng.uniform(-4, -0.5));
      for (Vec3& p : positions) {
        if (rng.below(1 + step % 3) == 0) p += length * uniform_point(rng);
      }
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      if (step == 4) model.rebuild();
      check_self(model, rng, intersecting);
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(intersecting, 1000U);
}

}  // namespace
}  // namespace limber::testing
