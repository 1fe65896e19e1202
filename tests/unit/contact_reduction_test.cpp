// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts reduced to manifolds: known answers, the promise by brute force, the twin, any order of the input, and
// mistakes of callers.
#include "limber/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_scene.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

Contact contact_at(const Vec3& position, double depth, const Vec3& normal = {0, 0, 1}) {
  Contact contact;
  contact.point_a = contact.point_b = position;
  contact.normal = normal;
  contact.depth = depth;
  return contact;
}

/// A square of k x k contacts with sides of length 1, the deepest at a corner.
std::vector<Contact> patch(int k) {
  std::vector<Contact> contacts;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) {
      const double x = j / (k - 1.0), y = i / (k - 1.0);
      contacts.push_back(contact_at({x, y, 0}, 0.01 - 0.001 * (x + 2 * y)));
    }
  }
  return contacts;
}

auto fields_of(const Contact& c) {
  return std::tie(c.triangle_a, c.triangle_b, c.point_a, c.point_b, c.normal, c.distance, c.depth, c.weights_a,
                  c.weights_b, c.feature_a, c.feature_b, c.normal_side);
}
bool same_contact(const Contact& c, const Contact& d) { return fields_of(c) == fields_of(d); }

/// Reduces contacts, and compares them with those of the twin.
std::size_t expect_twin(std::vector<Contact>& contacts, double radius, const ReductionOptions& options) {
  const std::vector<Contact> twin = reference::reduced_contacts(contacts, radius, options);
  const std::size_t kept = reduce_contacts(contacts, radius, options);
  EXPECT_EQ(kept, twin.size()) << radius;
  for (std::size_t k = 0; k < std::min(kept, twin.size()); ++k) {
    EXPECT_TRUE(same_contact(contacts[k], twin[k])) << radius << ", " << k;
  }
  return kept;
}

void shuffle(Rng& rng, std::vector<Contact>& contacts) {
  for (std::size_t k = contacts.size(); k > 1; --k) std::swap(contacts[k - 1], contacts[rng.below(k)]);
}

TEST(ContactReduction, OfASquareKeepsItsCorners) {
  std::vector<Contact> contacts = patch(9);
  ASSERT_EQ(reduce_contacts(contacts, 1.5), 4U);
  EXPECT_EQ(contacts[0].point_a, (Vec3{0, 0, 0}));
  EXPECT_EQ(contacts[1].point_a, (Vec3{1, 1, 0}));
  EXPECT_EQ(contacts[2].point_a, (Vec3{1, 0, 0}));
  EXPECT_EQ(contacts[3].point_a, (Vec3{0, 1, 0}));
  // The removed ones are behind, the deepest first.
  EXPECT_EQ(contacts[4].point_a, (Vec3{0.125, 0, 0}));
  for (const std::size_t most : {1U, 2U, 3U, 4U, 7U}) {
    EXPECT_EQ(reduce_contacts(contacts, 1.5, {.max_points = most}), most);
    EXPECT_EQ(contacts[0].depth, 0.01);
  }
}

TEST(ContactReduction, PutsTheDeepestRegionFirstAndNumbersThem) {
  std::vector<Contact> contacts = patch(5);
  for (Contact c : patch(5)) {
    c.point_a.x += 10, c.point_b.x += 10, c.depth += 1;
    contacts.push_back(c);
  }
  std::vector<std::uint32_t> patches(10, 9);
  ASSERT_EQ(reduce_contacts(contacts, 1.5, {.patch_ids = patches}), 8U);
  EXPECT_EQ(contacts[0].point_a, (Vec3{10, 0, 0}));
  EXPECT_EQ(contacts[4].point_a, (Vec3{0, 0, 0}));
  EXPECT_EQ(patches, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1, 9, 9}));
  std::array<std::uint32_t, 2> two{9, 9};  // as far as there is room
  EXPECT_EQ(reduce_contacts(contacts, 1.5, {.patch_ids = two}), 8U);
}

TEST(ContactReduction, CountsTheRadiusFromTheDeepestToTheBit) {
  for (const double scale : {1.0, 0x1p-600, 0x1p150}) {
    std::vector<Contact> contacts = {contact_at({}, 2), contact_at({scale, 0, 0}, 1),
                                     contact_at({0, scale * (1 + 0x1p-50), 0}, 0.5)};
    std::array<std::uint32_t, 3> patches{};
    ASSERT_EQ(reduce_contacts(contacts, scale, {.patch_ids = patches}), 3U) << scale;
    EXPECT_EQ(patches, (std::array<std::uint32_t, 3>{0, 0, 1})) << scale;
  }
}

TEST(ContactReduction, TakesAnyFiniteNumbers) {
  constexpr double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  for (const double radius : {huge, tiny, 1.0}) {
    std::vector<Contact> contacts = {contact_at({huge, huge, huge}, huge), contact_at({-huge, 0, 0}, 0),
                                     contact_at({tiny, 0, 0}, 0), contact_at({}, 0)};
    expect_twin(contacts, radius, {});
  }
  std::vector<Contact> contacts = {contact_at({}, 1), contact_at({}, 0)};
  EXPECT_EQ(reduce_contacts(contacts, tiny), 1U);
  EXPECT_EQ(reduce_contacts({}, 1), 0U);
}

TEST(ContactReduction, TakesTimeInProportionWhereverContactsAre) {
  // Each is a patch of its own. If all were compared with all, a case would take minutes.
  Rng rng(1402);
  struct Place {
    Vec3 at;
    double spread, radius, max_angle, turn = 1;
  };
  const Place places[] = {
      {{}, 1e-6, 1e-10, 0.5},    {{1e6, 1e6, 1e6}, 1e-5, 1e-10, 0.5}, {{1e6, -1e6, 0}, 1e-5, 1e-14, 0.5},
      {{}, 1e-300, 1e-305, 0.5}, {{}, 1e-310, 1e-320, 0.5},           {{1, 2, 3}, 0, 1, 0},
      {{1, 2, 3}, 0, 1, 1e-4},   {{1, 2, 3}, 0, 1, 0, 1e-152}};
  for (const Place& place : places) {
    std::vector<Contact> contacts(200'000);
    for (Contact& c : contacts) {
      const Vec3 normal = place.turn * uniform_point(rng) + Vec3{0, 0, 2};
      const Vec3 up = place.spread == 0 ? normal * (1 / length(normal)) : Vec3{0, 0, 1};
      c = contact_at(place.at + place.spread * uniform_point(rng), rng.uniform(), up);
    }
    contacts.back().point_a = contacts.back().point_b = {1e300, -1e300, 0};
    EXPECT_GT(reduce_contacts(contacts, place.radius, {.max_angle = place.max_angle}), 150'000U);
  }
}

TEST(ContactReduction, OfManyNormalsInOnePlaceIsThatOfTheTwin) {
  Rng rng(1404);
  for (const double max_angle : {0.0, 1e-160, 1e-9, 0.01, 0.0626, 0.1, 0.3, 0.5, 1.5, 3.0}) {
    for (const double turn : {1e-161, 1e-160, 1e-8, 0.01, 1.0, 100.0}) {
      std::vector<Contact> contacts(300);
      for (Contact& c : contacts) {
        const Vec3 normal = turn * uniform_point(rng) + (turn < 1 ? Vec3{1, 0, 0} : 1e-3 * Vec3{1, 1, 1});
        const double size = rng.below(8) == 0 ? 1e-155 : 1 / length(normal);  // shorter ones are taken too
        c = contact_at({1, 2, 3}, 0.01 * static_cast<double>(rng.below(9)), normal * size);
      }
      expect_twin(contacts, 1, {.max_angle = max_angle});
    }
  }
}

TEST(ContactReduction, InMemoryOfOtherContactsIsTheSame) {
  Rng rng(1405);
  ReductionMemory memory;
  for (const int n : {9, 3, 30, 2, 5}) {
    std::vector<Contact> contacts = patch(n), alone = contacts;
    shuffle(rng, contacts);
    const double radius = rng.uniform(0.1, 2);
    ASSERT_EQ(reduce_contacts(contacts, radius, {.memory = &memory}), reduce_contacts(alone, radius));
    EXPECT_TRUE(std::equal(contacts.begin(), contacts.end(), alone.begin(), alone.end(), same_contact));
  }
}

// --- random contacts ---

double gap_of(const Contact& c) { return c.distance - c.depth; }
Vec3 middle_of(const Contact& c) { return 0.5 * c.point_a + 0.5 * c.point_b; }

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
    const RandomScene s = arbitrary_scene(rng);
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
                    double radius, const ReductionOptions& options, double rounding) {
  std::vector<Contact> first;  // of each patch
  std::size_t points = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    if (patches[i] == first.size()) first.push_back(all[i]), points = 0;
    ASSERT_EQ(patches[i] + 1, first.size());
    ASSERT_LE(++points, options.max_points);
  }
  const double far = radius + rounding, wide = 2 * std::sin(options.max_angle / 2) + 1e-14;
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
      ASSERT_TRUE(length(middle_of(first[i]) - middle_of(first[j])) > radius - rounding ||
                  length(first[i].normal - first[j].normal) > wide - 2e-14);
    }
  }
}

TEST(ContactReduction, KeepsWhatItPromisesInAnyOrder) {
  Rng rng(1401);
  std::size_t removed = 0, several = 0, patches_seen = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    double size = 1;
    std::vector<Contact> contacts = some_contacts(rng, size);
    const double radius = rng.below(3) == 0 ? size : size * std::pow(10.0, rng.uniform(-3, 0.5));
    std::vector<std::uint32_t> patches(contacts.size(), 0);
    const ReductionOptions options{.max_angle = rng.below(3) == 0 ? 0 : rng.uniform(0, std::numbers::pi),
                                   .max_points = 1 + rng.below(6),
                                   .patch_ids = patches};
    const std::vector<Contact> input = contacts;
    const std::size_t kept = expect_twin(contacts, radius, options);
    expect_promise(contacts, kept, patches, radius, options, 1e-9 * size + 1e-15 * farthest_of(contacts));
    // No contact is lost.
    ASSERT_EQ(contacts.size(), input.size());
    ASSERT_TRUE(std::is_permutation(contacts.begin(), contacts.end(), input.begin(), same_contact));
    std::vector<Contact> shuffled = contacts;
    shuffle(rng, shuffled);
    expect_twin(shuffled, radius, options);
    if (HasFailure()) return;
    const std::size_t patch_count = kept == 0 ? 0 : patches[kept - 1] + std::size_t{1};
    removed += contacts.size() - kept, several += kept - patch_count, patches_seen += patch_count;
  }
  EXPECT_GT(removed, 10'000U);
  EXPECT_GT(several, 1'000U);
  EXPECT_GT(patches_seen, 10'000U);
}

TEST(ContactReduction, OfContactsThatDifferInTheirWeightsDoesNotDependOnTheirOrder) {
  Contact first = contact_at({0, 0, 0}, 0.01), second = first;
  first.weights_b = {0.25, 0.5, 0.25};
  second.weights_b = {0.5, 0.25, 0.25};
  for (const bool is_swapped : {false, true}) {
    std::array<Contact, 2> contacts{first, second};
    if (is_swapped) std::swap(contacts[0], contacts[1]);
    EXPECT_EQ(reduce_contacts(contacts, 1), 1U);
    EXPECT_EQ(contacts[0].weights_b, first.weights_b);
  }
}

TEST(ContactReduction, RefusesBadOptionsAndContacts) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Contact> good = patch(3);
  const auto expect_refused = [&](const auto& damage, const std::string& what) {
    std::vector<Contact> contacts = good;
    damage(contacts[7]);
    EXPECT_TRUE(is_refused([&] { static_cast<void>(reduce_contacts(contacts, 1)); },
                           {"limber::reduce_contacts: contact 7 has a " + what}));
    EXPECT_EQ(contacts[0].point_a, good[0].point_a);
  };
  expect_refused([](Contact& c) { c.normal.z = 1.01; }, "normal longer than 1");
  expect_refused([](Contact& c) { c.normal.z = -0.0; }, "normal of length 0");
  for (const double bad : {infinity, -infinity, nan}) {
    for (int k = 0; k < 7; ++k) {
      const auto damage = [&](Contact& c) {
        double* const numbers[] = {&c.point_a.x, &c.point_b.y,   &c.normal.z,   &c.depth,
                                   &c.distance,  &c.weights_a.x, &c.weights_b.z};
        *numbers[k] = bad;
      };
      expect_refused(damage, "number that is not finite");
    }
  }
  std::vector<Contact> contacts = good;
  contacts[4].normal.z = 1 + 0x1p-24;
  EXPECT_GT(reduce_contacts(contacts, 1), 0U);
  const auto reduce = [&](double radius, const ReductionOptions& options) {
    static_cast<void>(reduce_contacts(contacts, radius, options));
  };
  for (const double bad : {0.0, -1.0, infinity, nan}) EXPECT_THROW(reduce(bad, {}), std::invalid_argument);
  for (const double bad : {-0.1, 3.2, infinity, nan}) {
    EXPECT_THROW(reduce(1, {.max_angle = bad}), std::invalid_argument);
  }
  EXPECT_THROW(reduce(1, {.max_points = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace limber::testing
