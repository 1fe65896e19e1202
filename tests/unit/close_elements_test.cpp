// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernel of elements: what it leaves out is apart, and all instruction sets leave out the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/primitives.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

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
    const KernelCase c(rng);
    const pair::PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    pair::Frames frames(placed);
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
    const pair::Pruning pruning(placed, cutoff);
    simd::ElementCandidates found, again;
    const auto find = [&](const simd::Kernels& set, simd::ElementCandidates& candidates) {
      set.find_close_elements(at_slot(c.a, ka, true), at_slot(c.b, kb, true), frames.of(Side::a), pruning.of(Side::a),
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
