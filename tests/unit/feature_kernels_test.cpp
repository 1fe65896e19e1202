// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels that compare pairs of segments, and edges, corners and crossings of two triangles, next to one pair at a
// time; and that of elements: what it leaves out is apart, and all instruction sets leave out the same.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/features.h"
#include "geometry/primitives.h"
#include "geometry/triangle_contact.h"
#include "limber/contacts.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

class CompareFeatures : public ::testing::TestWithParam<PairKind> {};

// --- segments ---

constexpr std::uint32_t segment_room = simd::SegmentPairs::room;

/// Edges of random triangles, all lengths times a scale.
simd::SegmentPairs random_segments(Rng& rng, PairKind kind, double scale) {
  simd::SegmentPairs pairs;
  for (std::uint32_t i = 0; i < segment_room; ++i) {
    const auto [t, u] = random_pair(rng, kind);
    pairs.start_a[i] = scale * t[i % 3], pairs.end_a[i] = scale * t[(i + 1) % 3];
    pairs.start_b[i] = scale * u[i / 3 % 3], pairs.end_b[i] = scale * u[(i / 3 + 1) % 3];
  }
  return pairs;
}

/// Compares one set of pairs with every instruction set. Returns how many pairs were ordinary.
int compare_all(const simd::SegmentPairs& pairs) {
  int ordinary = 0;
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::ClosestOfSegments found;
    set.compare_segments(pairs, found);
    ordinary = 0;
    for (std::uint32_t i = 0; i < segment_room; ++i) {
      const Segment a{pairs.start_a[i], pairs.end_a[i]}, b{pairs.start_b[i], pairs.end_b[i]};
      const geometry::PointsOnSegments expected = geometry::closest_on(a, b);
      const bool is_ordinary = (found.are_ordinary >> i & 1) != 0;
      EXPECT_FALSE(is_ordinary && expected.distance == 0) << set.name << ", pair " << i;
      if (!is_ordinary) continue;
      ++ordinary;
      EXPECT_EQ(std::tuple(found.distance[i], found.s[i], found.t[i]),
                std::tuple(expected.distance, expected.s, expected.t))
          << set.name << ", pair " << i;
    }
  }
  return ordinary;
}

TEST_P(CompareFeatures, OfSegmentsGivesTheClosestPointsToTheBit) {
  Rng rng(1701);
  int ordinary = 0;
  for (int round = 0; round < 500; ++round) ordinary += compare_all(random_segments(rng, GetParam(), 1));
  EXPECT_GT(ordinary, 0);
}

TEST_P(CompareFeatures, OfSegmentsLeavesTheHugeTheTinyAndTheTouchingToOthers) {
  if (GetParam() == PairKind::far_away) return;  // larger than a part of the scales is for
  Rng rng(1702);
  for (const double scale : {0x1p-1000, 0x1p-500, 0x1p-110, 0x1p110, 0x1p500, 0x1p900}) {
    EXPECT_EQ(compare_all(random_segments(rng, GetParam(), scale)), 0) << scale;
  }
  simd::SegmentPairs touching;  // points, at the origin
  EXPECT_EQ(compare_all(touching), 0);
}

// --- triangles ---

simd::FaceVectors face_of(const Triangle& t) {
  simd::FaceVectors face{t, {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2}, {}};
  const Vec3 normal = cross(face.edge[0], face.edge[1]);
  for (std::size_t i = 0; i < 3; ++i) face.inward[i] = cross(normal, face.edge[i]);
  return face;
}

/// One pair of edges after the other.
simd::TriangleFeatures compare_edges(const simd::FaceVectors& a, const simd::FaceVectors& b) {
  simd::TriangleFeatures best{std::numeric_limits<double>::infinity(), 0, 0, 0, 0, 0, 0};
  for (std::uint32_t i = 0; i < 3; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      const Segment of_a{a.corner[i], a.corner[geometry::next_corner[i]]},
          of_b{b.corner[j], b.corner[geometry::next_corner[j]]};
      const auto [s, t] = geometry::closest_parameters(of_a, of_b);
      const double distance_sq = length_sq((of_b.p0 - of_a.p0) + (t * b.edge[j] - s * a.edge[i]));
      if (distance_sq < best.distance_sq) best = {distance_sq, s, t, i, j, 0, 0};
    }
  }
  return best;
}

/// Corners whose foot is in a face.
unsigned feet_in(const simd::FaceVectors& face, const Triangle& corners) {
  unsigned feet = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double w2 = dot(face.inward[0], corners[k] - face.corner.v0);
    const double w0 = dot(face.inward[1], corners[k] - face.corner.v1);
    const double w1 = dot(face.inward[2], corners[k] - face.corner.v2);
    feet |= w0 >= 0 && w1 >= 0 && w2 >= 0 && w0 + w1 + w2 > 0 ? 1U << k : 0;
  }
  return feet;
}

auto values_of(const simd::TriangleFeatures& f) {
  return std::tuple(f.distance_sq, f.at_a, f.at_b, f.edge_a, f.edge_b, f.feet_of_a, f.feet_of_b);
}

TEST_P(CompareFeatures, OfTrianglesFindsTheFirstOfTheClosestEdgesAndAllFeet) {
  Rng rng(1501);
  int feet = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto [t, u] = random_pair(rng, GetParam());
    const simd::FaceVectors a = face_of(t), b = face_of(u);
    simd::TriangleFeatures expected = compare_edges(a, b);
    expected.feet_of_a = feet_in(b, t), expected.feet_of_b = feet_in(a, u);
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::TriangleFeatures found;
      set.compare_triangles(a, b, found);
      ASSERT_EQ(values_of(found), values_of(expected)) << set.name << ", pair " << i;
    }
    feet += expected.distance_sq > 0 && expected.feet_of_b != 0 ? 1 : 0;
  }
  EXPECT_GT(feet, 0);
}

// --- contacts of triangles ---

auto values_of(const TriangleContact& c) {
  return std::tuple(c.distance, c.depth, c.point_a, c.point_b, c.normal, c.weights_a, c.weights_b, c.feature_a,
                    c.feature_b, c.normal_side);
}

TEST_P(CompareFeatures, ContactsFoundTogetherAreThoseOfEachPairOnEveryInstructionSet) {
  Rng rng(1503);
  constexpr OrientedFaces ways[] = {OrientedFaces::none, OrientedFaces::of_a, OrientedFaces::of_b, OrientedFaces::both};
  int found = 0;
  for (int round = 0; round < 150; ++round) {
    std::vector<Triangle> of_a, of_b;
    for (std::uint64_t i = 0, count = 1 + rng.below(8); i < count; ++i) {
      const auto [t, u] = random_pair(rng, GetParam());
      of_a.push_back(t), of_b.push_back(u);
    }
    const Model a(soup(of_a)), b(soup(of_b));
    const OrientedFaces oriented = ways[rng.below(4)];
    for (const simd::Kernels& set : simd::all_kernels()) {
      visit_contacts({a}, {b}, round % 2,
                     [&](const Contact& c) {
                       simd::use_kernels(&simd::scalar_kernels);
                       const TriangleContact alone = contact(of_a[c.triangle_a], of_b[c.triangle_b], oriented);
                       simd::use_kernels(&set);
                       EXPECT_EQ(values_of(c), values_of(alone)) << set.name << ", round " << round;
                       return ++found, !HasFailure();
                     },
                     {.oriented_faces = oriented});
    }
    simd::use_kernels(nullptr);
  }
  EXPECT_GT(found, 1000);
}

/// Pairs that the kernel calls certain intersect, and most pairs that intersect are certain.
TEST_P(CompareFeatures, CrossingsAreThoseOfTrianglesThatIntersect) {
  Rng rng(1504);
  int answered = 0, intersecting = 0;
  for (int round = 0; round < 1000; ++round) {
    simd::TrianglePairs pairs;
    bool intersect[simd::TrianglePairs::room];
    for (std::uint32_t i = 0; i < simd::TrianglePairs::room; ++i) {
      const auto [t, u] = random_pair(rng, GetParam());
      for (std::size_t k = 0; k < 3; ++k) pairs.a[k][i] = t[k], pairs.b[k][i] = u[k];
      intersect[i] = geometry::intersects(t, u);
      intersecting += intersect[i] ? 1 : 0;
    }
    simd::Crossings found;
    simd::kernels().find_crossings(pairs, found);
    for (std::uint32_t i = 0; i < simd::TrianglePairs::room; ++i) {
      if ((found.are_certain >> i & 1) == 0) continue;
      ++answered;
      ASSERT_TRUE(intersect[i]) << round;
    }
  }
  if (GetParam() == PairKind::uniform) {
    EXPECT_GT(answered, intersecting * 9 / 10);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompareFeatures,
                         ::testing::Values(PairKind::uniform, PairKind::lattice, PairKind::near_lattice,
                                           PairKind::touching, PairKind::sliver, PairKind::coplanar,
                                           PairKind::shared_edge, PairKind::mixed_scale, PairKind::far_away,
                                           PairKind::one_line, PairKind::needle),
                         ::testing::PrintToStringParamName());

// --- elements of leaves ---

using pair::Side;
using ElementIds = std::pair<int, int>;

template <typename List>
std::set<ElementIds> ids_in(const List& list) {
  std::set<ElementIds> ids;
  for (std::uint32_t i = 0; i < list.count; ++i) ids.insert({list.pairs[i].a, list.pairs[i].b});
  EXPECT_EQ(ids.size(), list.count) << "a pair came twice";
  return ids;
}

template <typename List>
void expect_same_pairs(const List& list, const List& other, const char* set) {
  ASSERT_EQ(list.count, other.count) << set;
  for (std::uint32_t i = 0; i < list.count; ++i) {
    ASSERT_EQ(list.pairs[i].a, other.pairs[i].a) << set;
    ASSERT_EQ(list.pairs[i].b, other.pairs[i].b) << set;
  }
}

/// Calls `visit` with the distance and the ids of each pair of elements of two leaves that are owned, of each kind.
template <typename Visit>
void for_all_elements(const std::array<Triangle, 8>& a, const std::array<Triangle, 8>& b, std::uint64_t owned_a,
                      std::uint64_t owned_b, const Visit& visit) {
  const auto has = [](std::uint64_t owned, int slot, int bit) { return (owned >> (8 * slot + bit) & 1) != 0; };
  const auto edge = [](const Triangle& t, int k) {
    const auto from = static_cast<std::size_t>(k);
    return Segment{t[from], t[geometry::next_corner[from]]};
  };
  for (int s = 0; s < 8; ++s) {
    for (int t = 0; t < 8; ++t) {
      if (!has(owned_a, s, 6) || !has(owned_b, t, 6)) continue;
      const Triangle &p = a[static_cast<std::size_t>(s)], &q = b[static_cast<std::size_t>(t)];
      for (int k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(k);
        if (has(owned_a, s, k)) visit(0, closest_points(p[corner], q).distance, k * 8 + s, t);
        if (has(owned_b, t, k)) visit(1, closest_points(q[corner], p).distance, s, k * 8 + t);
        for (int l = 0; has(owned_a, s, 3 + k) && l < 3; ++l) {
          if (has(owned_b, t, 3 + l)) visit(2, closest_points(edge(p, k), edge(q, l)).distance, k * 8 + s, l * 8 + t);
        }
      }
    }
  }
}

/// Some elements of a leaf, and all or some of its slots. Those that are not in use own nothing.
std::uint64_t some_owned(Rng& rng) {
  constexpr std::uint64_t is_in_use = 0x40;
  std::uint64_t owned = 0;
  for (int slot = 0; slot < 8; ++slot) {
    const std::uint64_t of_slot = rng.below(128);
    owned |= ((of_slot & is_in_use) != 0 ? of_slot : 0) << (8 * slot);
  }
  return rng.below(3) == 0 ? ~std::uint64_t{0} : owned;
}

TEST(CloseElements, ContainEveryPairThatMatters) {
  Rng rng(205);
  const auto sets = simd::all_kernels();
  int left_out = 0, kept = 0, close = 0;
  for (int i = 0; i < 1500; ++i) {
    KernelCase c(rng);
    const auto ka = static_cast<std::uint32_t>(rng.below(tree_of(c.a).nodes[1].child_count));
    const auto kb = static_cast<std::uint32_t>(rng.below(tree_of(c.b).nodes[1].child_count));
    const bvh::Leaf &la = tree_of(c.a).leaves[ka], &lb = tree_of(c.b).leaves[kb];
    std::array<Triangle, 8> a, b;
    for (std::size_t slot = 0; slot < 8; ++slot) {
      a[slot] = c.world_a[la.triangle[slot]], b[slot] = c.world_b[lb.triangle[slot]];
    }
    const std::uint64_t owned_a = some_owned(rng), owned_b = some_owned(rng);
    // The distance of some pair, and hardly more: quantization of corners decides.
    double cutoff = 0;
    std::uint64_t which = rng.below(400);
    for_all_elements(a, b, owned_a, owned_b, [&](int, double distance, int, int) {
      if (which-- == 0) cutoff = distance * (1 + 1e-9) + 1e-12;
    });
    if (cutoff == 0) cutoff = rng.uniform(0, 2) + 1e-12;
    const pair::Pruning pruning(c.placed, cutoff);
    simd::ElementCandidates found, again;
    const auto find = [&](const simd::Kernels& set, simd::ElementCandidates& candidates) {
      set.find_close_elements(at_slot(c.a, ka, true), at_slot(c.b, kb, true), c.frames.of(Side::a), pruning.of(Side::a),
                              {owned_a}, {owned_b}, nullptr, candidates);
    };
    find(simd::scalar_kernels, found);
    for (const simd::Kernels& set : sets) {
      find(set, again);
      expect_same_pairs(found.vertex_face, again.vertex_face, set.name);
      expect_same_pairs(found.face_vertex, again.face_vertex, set.name);
      expect_same_pairs(found.edge_edge, again.edge_edge, set.name);
    }
    const std::array<std::set<ElementIds>, 3> ids{ids_in(found.vertex_face), ids_in(found.face_vertex),
                                                  ids_in(found.edge_edge)};
    std::size_t count = 0;
    for_all_elements(a, b, owned_a, owned_b, [&](int kind, double distance, int of_a, int of_b) {
      if (ids[static_cast<std::size_t>(kind)].count({of_a, of_b}) == 0) {
        ASSERT_GE(distance, cutoff * (1 - 1e-15)) << "case " << i << ", kind " << kind;
        ++left_out;
      } else {
        ++count, ++kept;
        close += distance < cutoff * 1.01 + 1e-3 ? 1 : 0;
      }
    });
    ASSERT_EQ(count, ids[0].size() + ids[1].size() + ids[2].size()) << "case " << i;
  }
  EXPECT_GT(left_out, 50000);
  EXPECT_GT(kept, 20000);
  EXPECT_GT(close, kept * 9 / 10);  // little is kept in vain
}

}  // namespace
}  // namespace limber::testing
