// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Reduced contacts: the promise by brute force, the twin, and any order of the input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "limber/contacts.h"
#include "reference/reference.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

double gap_of(const Contact& c) { return c.distance - c.depth; }
Vec3 middle_of(const Contact& c) { return 0.5 * c.point_a + 0.5 * c.point_b; }

bool same_contact(const Contact& c, const Contact& d) {
  return c.triangle_a == d.triangle_a && c.triangle_b == d.triangle_b && c.point_a == d.point_a &&
         c.point_b == d.point_b && c.normal == d.normal && c.distance == d.distance && c.depth == d.depth &&
         c.feature_a == d.feature_a && c.feature_b == d.feature_b && c.normal_side == d.normal_side;
}

double farthest_of(const std::vector<Contact>& contacts) {
  double farthest = 0;
  for (const Contact& c : contacts) farthest = std::max({farthest, max_abs(c.point_a), max_abs(c.point_b)});
  return farthest;
}

/// Clusters of contacts whose normals point in a few directions, some on a lattice so that distances tie; or those of
/// two models.
std::vector<Contact> some_contacts(Rng& rng, double& size) {
  const std::uint64_t kind = rng.below(4);
  if (kind == 3) {
    const Scene s = arbitrary_scene(rng);
    size = s.size;
    std::vector<Contact> found = reference::contacts({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, 0.02 * s.size);
    found.resize(std::min<std::size_t>(found.size(), 1500));
    return found;
  }
  size = std::ldexp(1.0, rng.below(3) == 0 ? static_cast<int>(rng.below(300)) - 150 : 0);
  std::vector<Contact> contacts(rng.below(400));
  // Up to where a step from one coordinate to the next is larger than a radius.
  const Vec3 offset = rng.below(3) == 0 ? std::pow(10.0, rng.uniform(0, 17)) * uniform_point(rng) : Vec3{};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Contact& c = contacts[i];
    const Vec3 at = kind == 0   ? lattice_point(rng)
                    : kind == 1 ? uniform_point(rng)
                                : lattice_point(rng) + 0.1 * uniform_point(rng);
    c.point_a = size * (at + offset);
    c.normal = rng.below(2) == 0 ? Vec3{0, 0, 1} : uniform_point(rng) + Vec3{0, 0, 0.1};
    c.normal *= 1 / length(c.normal);
    c.distance = rng.below(2) == 0 ? 0 : size * 0.1 * rng.uniform();
    c.depth = c.distance > 0 ? 0 : size * 0.25 * static_cast<double>(rng.below(4));
    c.point_b = c.point_a + c.distance * c.normal;
    c.triangle_a = static_cast<TriangleId>(rng.below(50)), c.triangle_b = static_cast<TriangleId>(i);
  }
  return contacts;
}

void expect_promise(const std::vector<Contact>& all, std::size_t kept, const std::vector<std::uint32_t>& patches,
                    const ReductionOptions& options, double rounding) {
  std::vector<Contact> first;  // of each patch
  std::size_t points = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    if (patches[i] == first.size()) first.push_back(all[i]), points = 0;
    ASSERT_EQ(patches[i] + 1, first.size());
    ASSERT_LE(++points, options.max_points);
  }
  const double far = options.radius + rounding, wide = 2 * std::sin(options.max_angle / 2) + 1e-14;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_covered = std::any_of(first.begin(), first.end(), [&](const Contact& f) {
      return length(middle_of(f) - middle_of(all[i])) <= far && length(f.normal - all[i].normal) <= wide &&
             gap_of(f) <= gap_of(all[i]);
    });
    ASSERT_TRUE(is_covered) << i;
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_LE(gap_of(first[j]), gap_of(first[i]));
      ASSERT_TRUE(length(middle_of(first[i]) - middle_of(first[j])) > options.radius - rounding ||
                  length(first[i].normal - first[j].normal) > wide - 2e-14);
    }
  }
}

TEST(ContactReductionProperty, KeepsWhatItPromisesInAnyOrder) {
  Rng rng(1401);
  std::size_t removed = 0, several = 0, patches_seen = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    double size = 1;
    std::vector<Contact> contacts = some_contacts(rng, size);
    const ReductionOptions options{.radius = rng.below(3) == 0 ? size : size * std::pow(10.0, rng.uniform(-3, 0.5)),
                                   .max_angle = rng.below(3) == 0 ? 0 : rng.uniform(0, std::numbers::pi),
                                   .max_points = 1 + rng.below(6)};
    const std::vector<Contact> input = contacts, twin = reference::reduced_contacts(contacts, options);
    std::vector<std::uint32_t> patches(contacts.size(), 0);
    const std::size_t kept = reduce_contacts(contacts, options, patches);
    ASSERT_EQ(kept, twin.size());
    for (std::size_t k = 0; k < kept; ++k) ASSERT_TRUE(same_contact(contacts[k], twin[k])) << k;
    expect_promise(contacts, kept, patches, options, 1e-9 * size + 1e-15 * farthest_of(contacts));
    // No contact is lost.
    ASSERT_EQ(contacts.size(), input.size());
    ASSERT_TRUE(std::is_permutation(contacts.begin(), contacts.end(), input.begin(), same_contact));
    std::vector<Contact> shuffled = contacts;
    for (std::size_t k = shuffled.size(); k > 1; --k) std::swap(shuffled[k - 1], shuffled[rng.below(k)]);
    ASSERT_EQ(reduce_contacts(shuffled, options), kept);
    for (std::size_t k = 0; k < kept; ++k) ASSERT_TRUE(same_contact(shuffled[k], twin[k])) << k;
    if (::testing::Test::HasFailure()) return;
    const std::size_t patch_count = kept == 0 ? 0 : patches[kept - 1] + std::size_t{1};
    removed += contacts.size() - kept, several += kept - patch_count, patches_seen += patch_count;
  }
  EXPECT_GT(removed, 10'000U);
  EXPECT_GT(several, 1'000U);
  EXPECT_GT(patches_seen, 10'000U);
}

}  // namespace
}  // namespace limber::testing
