// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shared_corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "geometry/primitives.h"
#include "support/exact_intersection.h"
#include "support/neighbors.h"

namespace limber::testing {
namespace {

using geometry::meets_elsewhere;

bool meet(const Neighbors& n) { return meets_elsewhere(n.a(), n.ids_a, n.b(), n.ids_b); }

/// The answer by the exact intersection.
bool truly_meet(const Neighbors& n) {
  const std::vector<VertexId> shared = n.shared();
  if (shared.size() == 3) return false;
  return exact::intersect_off_segment(n.a(), n.b(), n.positions[shared.front()], n.positions[shared.back()]);
}

/// The answer for every order of triangles and corners, which has to be one.
void expect_meeting(const Neighbors& n, bool truth, const std::string& what) {
  Neighbors m = n;
  for (int swaps = 0; swaps < 2; ++swaps, std::swap(m.ids_a, m.ids_b)) {
    std::sort(m.ids_a.begin(), m.ids_a.end());
    do {
      std::sort(m.ids_b.begin(), m.ids_b.end());
      do {
        EXPECT_EQ(meet(m), truth) << what;
      } while (std::next_permutation(m.ids_b.begin(), m.ids_b.end()));
    } while (std::next_permutation(m.ids_a.begin(), m.ids_a.end()));
  }
}

struct KnownNeighbors {
  const char* what;
  std::vector<Vec3> positions;
  bool meets;
};

TEST(MeetsElsewhere, KnownCasesOfSharedEdges) {
  const Vec3 v{0, 0, 0}, w{4, 0, 0}, up{1, 3, 0};
  const KnownNeighbors cases[] = {
      {"flat neighbours", {v, w, up, {2, -3, 0}}, false},
      {"at a right angle", {v, w, up, {2, 0, 3}}, false},
      {"folded to a sharp angle", {v, w, up, {2, 3, 1e-300}}, false},
      {"folded flat", {v, w, up, {2, 3, 0}}, true},
      {"folded onto each other", {v, w, up, up}, true},
      {"folded, a sliver inside", {v, w, up, {1, 1e-300, 0}}, true},
      {"one degenerate, on the edge", {v, w, up, {1, 0, 0}}, false},
      {"one degenerate, beyond the edge", {v, w, up, {9, 0, 0}}, false},
      {"one degenerate, beyond the edge, as is the other in x", {v, w, {5, 3, 0}, {9, 0, 0}}, false},
      {"one degenerate, at an end", {v, w, up, v}, false},
      {"both degenerate, beyond the same end", {v, w, {6, 0, 0}, {5, 0, 0}}, true},
      {"both degenerate, beyond different ends", {v, w, {6, 0, 0}, {-5, 0, 0}}, false},
      {"both degenerate, one within the edge", {v, w, {6, 0, 0}, {3, 0, 0}}, false},
      {"the edge is a point, sides along each other", {v, v, up, {2, 6, 0}}, true},
      {"the edge is a point, sides apart", {v, v, up, {-2, 6, 0}}, false},
      {"the edge is a point, and so is one triangle", {v, v, v, {-2, 6, 0}}, false},
      {"all is one point", {v, v, v, v}, false},
  };
  for (const KnownNeighbors& c : cases) expect_meeting({c.positions, {0, 1, 2}, {0, 1, 3}}, c.meets, c.what);
}

TEST(MeetsElsewhere, KnownCasesOfSharedCorners) {
  const Vec3 v{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0};
  const KnownNeighbors cases[] = {
      {"flat, opposite", {v, x, y, {-4, 0, 0}, {0, -4, 0}}, false},
      {"flat, beside each other with a gap", {v, x, y, {-1, 4, 0}, {-4, 0, 0}}, false},
      {"flat, sides along each other", {v, x, y, {0, 3, 0}, {-4, 0, 0}}, true},
      {"flat, overlapping", {v, x, y, {1, 2, 0}, {-4, 1, 0}}, true},
      {"flat, one inside the other", {v, x, y, {1, 0.5, 0}, {0.5, 1, 0}}, true},
      {"standing on the other", {v, x, y, {1, 1, 3}, {2, 1, 3}}, false},
      {"standing on the other with a side", {v, x, y, {1, 1, 0}, {1, 1, 3}}, true},
      {"passing through the other", {v, x, y, {1, 1, -1}, {1, 1, 1}}, true},
      {"passing beside the other", {v, x, y, {-1, 1, -1}, {-1, 1, 1}}, false},
      {"passing through the other beyond its far side", {v, x, y, {9, 9, -1}, {9, 9, 1}}, true},
      {"a corner on the far side", {v, x, y, {2, 2, 0}, {9, 9, 9}}, true},
      {"a corner at a corner", {v, x, y, x, {4, 0, 3}}, true},
      {"a segment inside the face", {v, x, y, {1, 1, 0}, {1, 1, 0}}, true},
      {"a segment away from the face", {v, x, y, {-1, 1, 0}, {-1, 1, 0}}, false},
      {"a segment with its end in the common corner", {v, x, y, v, {1, 2, 0}}, true},
      {"a segment around the common corner, into the face", {v, x, y, {-1, -1, 0}, {1, 1, 0}}, true},
      {"a segment around the common corner, across the face", {v, x, y, {-1, 1, 0}, {1, -1, 0}}, false},
      {"a segment around the common corner, through the face", {v, x, y, {1, 1, -1}, {-1, -1, 1}}, false},
      {"a point", {v, x, y, v, v}, false},
      {"segments along each other", {v, x, x, {1, 0, 0}, {2, 0, 0}}, true},
      {"segments away from each other", {v, x, x, {-1, 0, 0}, {-2, 0, 0}}, false},
      {"segments around the common corner, crossing", {v, x, {-1, 0, 0}, y, {0, -1, 0}}, false},
      {"segments around the common corner, along each other", {v, x, {-1, 0, 0}, {2, 0, 0}, {-3, 0, 0}}, true},
  };
  for (const KnownNeighbors& c : cases) expect_meeting({c.positions, {0, 1, 2}, {0, 3, 4}}, c.meets, c.what);
}

TEST(MeetsElsewhere, WithoutSharedIdsIsIntersecting) {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0};
  EXPECT_TRUE(meets_elsewhere({o, x, y}, {0, 1, 2}, {o, x, y}, {3, 4, 5}));
  EXPECT_FALSE(meets_elsewhere({o, x, y}, {0, 1, 2}, {{0, 0, 1}, x + Vec3{0, 0, 1}, y + Vec3{0, 0, 1}}, {3, 4, 5}));
}

TEST(MeetsElsewhere, NothingIsElsewhereWhereAllIsShared) {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0};
  expect_meeting({{o, x, y}, {0, 1, 2}, {0, 1, 2}}, false, "the same");
  expect_meeting({{o, x, y}, {0, 1, 1}, {0, 0, 1}}, false, "one segment");
  expect_meeting({{o, x, y}, {0, 0, 0}, {0, 1, 2}}, false, "a point of a triangle");
  expect_meeting({{o, x, y}, {0, 1, 1}, {0, 1, 2}}, false, "an edge of a triangle");
}

/// Compares some neighbors that a function draws with the exact intersection. So many of them meet.
template <typename Draw>
void expect_exact(std::uint64_t seed, int count, int least, int most, const Draw& draw) {
  Rng rng(seed);
  int meeting = 0;
  for (int i = 0; i < count; ++i) {
    const Neighbors n = draw(rng, i);
    const bool truth = truly_meet(n);
    meeting += truth ? 1 : 0;
    ASSERT_EQ(meet(n), truth) << "case " << i;
  }
  EXPECT_GT(meeting, least);
  EXPECT_LT(meeting, most);
}

TEST(MeetsElsewhere, IsDecidedByTheLastBit) {
  // Third corners within units in the last place of the line of a common edge, or of a side: on one side of it or not.
  expect_exact(302, 900, 100, 800, [](Rng& rng, int i) {
    const Vec3 v{rng.uniform(), rng.uniform(), 0}, w{rng.uniform(2, 3), rng.uniform(), 0};
    const auto on_line = [&] {
      const Vec3 p = nudged(rng, v + rng.uniform(0.1, 1) * (w - v), 1);
      return Vec3{p.x, p.y, 0};
    };
    const Vec3 p = on_line(), q = on_line(), r = on_line(), s{rng.uniform(), rng.uniform(2, 3), 0};
    return i % 3 == 0   ? Neighbors{{v, w, p, q}, {0, 1, 2}, {0, 1, 3}}
           : i % 3 == 1 ? Neighbors{{v, w, s, p, Vec3{s.x, -s.y, 0}}, {0, 1, 2}, {0, 3, 4}}
                        : Neighbors{{v, w, p, q, r}, {0, 1, 2}, {0, 3, 4}};
  });
}

TEST(MeetsElsewhere, IsDecidedWhereSidesLieAlongEachOther) {
  // Triangles on both sides of a line, with a side of each along it up to rounding, so that the plane across the
  // difference of both sums of sides is perpendicular to that line up to rounding.
  expect_exact(303, 1500, 250, 1250, [](Rng& rng, int i) {
    const double scale = i % 2 == 0 ? 1 : std::ldexp(1.0, -500 - static_cast<int>(rng.below(38)));
    const Vec3 p1{rng.uniform(1, 2), rng.uniform(-1, 1), 0}, across{-p1.y, p1.x, 0};
    const Vec3 p2 = rng.uniform(-1, 1) * p1 + rng.uniform(0.1, 1) * across;
    const Vec3 q1 = rng.uniform(0.2, 2) * p1;
    const Vec3 q2 = p1 + p2 - q1 - rng.uniform(1, 2) * across;
    return Neighbors{{{}, scale * p1, scale * p2, scale * q1, scale * q2}, {0, 1, 2}, {0, 3, 4}};
  });
}

TEST(MeetsElsewhere, IsDecidedWhereProductsUnderflow) {
  // An edge so short that its square is subnormal, and triangles that point nearly along it.
  expect_exact(304, 1000, 200, 980, [](Rng& rng, int i) {
    const double angle = rng.uniform(0, 7), width = std::ldexp(1.0, -static_cast<int>(rng.below(14)));
    const Vec3 along{std::cos(angle), std::sin(angle), 0}, across{-along.y, along.x, 0};
    const auto nearly_along = [&] { return rng.uniform(0.5, 1) * along + width * rng.uniform(-0.2, 1) * across; };
    const Vec3 e = std::ldexp(rng.uniform(1, 2), -525 - static_cast<int>(rng.below(12))) * along;
    const Vec3 p = nearly_along(), q = nearly_along();
    return i % 2 == 0 ? Neighbors{{{}, e, p, q}, {0, 1, 2}, {0, 1, 3}}
                      : Neighbors{{{}, e, p, q, nearly_along()}, {0, 1, 2}, {0, 3, 4}};
  });
}

}  // namespace
}  // namespace limber::testing
