// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles of one mesh that share vertices: known ones, and all that degenerates next to exact arithmetic.
// LIMBER_NEIGHBOR_PAIRS says how many pairs.
#include "geometry/shared_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "geometry/primitives.h"
#include "support/exact_intersection.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using geometry::meets_elsewhere;

/// Two triangles by ids of common positions.
struct Neighbors {
  std::vector<Vec3> positions;
  Corners ids_a, ids_b;

  Triangle triangle(const Corners& ids) const { return {positions[ids[0]], positions[ids[1]], positions[ids[2]]}; }
  Triangle a() const { return triangle(ids_a); }
  Triangle b() const { return triangle(ids_b); }

  /// The ids that both name, each once.
  std::vector<VertexId> shared() const {
    std::vector<VertexId> ids;
    for (VertexId id = 0; id < positions.size(); ++id) {
      if (std::count(ids_a.begin(), ids_a.end(), id) > 0 && std::count(ids_b.begin(), ids_b.end(), id) > 0) {
        ids.push_back(id);
      }
    }
    return ids;
  }
};

constexpr int neighbor_kinds = 12;

/// Five positions of a kind.
std::vector<Vec3> positions_of_kind(Rng& rng, int kind) {
  const Triangle plane = uniform_triangle(rng);
  const Vec3 step = lattice_point(rng) - Vec3{1, 1, 1};
  const auto flat = [](Vec3 q) { return Vec3{q.x, q.y, 0}; };
  const auto position = [&](std::size_t i) -> Vec3 {
    const double s = rng.uniform(-1, 2), t = rng.uniform(-1, 2);
    if (kind == 0) return uniform_point(rng);
    if (kind == 1) return lattice_point(rng);
    if (kind == 2) return nudged(rng, lattice_point(rng));
    if (kind == 3) return flat(lattice_point(rng));
    if (kind == 4) return nudged(rng, flat(lattice_point(rng)));
    if (kind == 5) return flat(uniform_point(rng));
    if (kind == 6) return point_on(plane, s, t);                       // coplanar up to rounding
    if (kind == 7) return flat(plane.v0 + s * (plane.v1 - plane.v0));  // collinear up to rounding, but coplanar
    if (kind == 8) return static_cast<double>(rng.below(5)) * step;    // collinear
    if (kind == 9) return std::ldexp(1.0, -static_cast<int>(rng.below(400))) * lattice_point(rng);
    if (kind == 10) return nudged(rng, plane.v0 + s * (plane.v1 - plane.v0));  // slivers
    const double angle = static_cast<double>(i) * 1.05 + 0.3 * rng.uniform();  // a fan, flat or nearly so
    return i == 0 ? Vec3{} : Vec3{std::cos(angle), std::sin(angle), rng.below(2) == 0 ? 0 : 0.1 * rng.uniform()};
  };
  std::vector<Vec3> p(5);
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = position(i);
  if (rng.below(6) == 0) p[4] = nudged(rng, point_on({p[0], p[1], p[2]}, rng.uniform(), rng.uniform()), 1);
  return p;
}

/// Two triangles that share one or two vertices, now and then three.
Neighbors random_neighbors(Rng& rng, int kind) {
  Neighbors n{positions_of_kind(rng, kind), {0, 1, 2}, {0, 3, 4}};
  if (rng.below(2) == 0) n.ids_b[1] = 1;
  if (rng.below(16) == 0) n.ids_b = {0, 1, 2};
  if (rng.below(16) == 0) n.ids_a[rng.below(3)] = static_cast<VertexId>(rng.below(5));
  if (rng.below(16) == 0) n.ids_b[rng.below(3)] = static_cast<VertexId>(rng.below(5));
  if (n.shared().empty()) n.ids_b[0] = n.ids_a[0];
  // Some at scales where products of four lengths underflow, some far from the origin.
  const double scale = rng.below(4) != 0 ? 1 : std::ldexp(1.0, static_cast<int>(rng.below(438)) - 250);
  const Vec3 offset = rng.below(8) == 0 ? uniform_point(rng, -1e3, 1e3) : Vec3{};
  for (Vec3& p : n.positions) p = scale * (p + offset);
  for (Corners* ids : {&n.ids_a, &n.ids_b}) {
    std::rotate(ids->begin(), ids->begin() + static_cast<std::ptrdiff_t>(rng.below(3)), ids->end());
    if (rng.below(2) == 0) std::swap((*ids)[0], (*ids)[1]);
  }
  return n;
}

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

class NeighborsOfKind : public ::testing::TestWithParam<int> {};

TEST_P(NeighborsOfKind, MeetElsewhereExactlyWhenTheirIntersectionIsNotAllShared) {
  const std::uint64_t pairs = count_from("LIMBER_NEIGHBOR_PAIRS", 12'000) / neighbor_kinds;
  Rng rng(3200 + static_cast<std::uint64_t>(GetParam()));
  std::uint64_t meeting = 0;
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const Neighbors n = random_neighbors(rng, GetParam());
    const bool truth = truly_meet(n);
    meeting += truth ? 1 : 0;
    ASSERT_EQ(meet(n), truth) << "pair " << i;
    ASSERT_EQ(meets_elsewhere(n.b(), n.ids_b, n.a(), n.ids_a), truth) << "pair " << i << ", swapped";
  }
  std::cout << pairs << " pairs, " << meeting << " meeting elsewhere, 0 disagreements\n";
  EXPECT_GT(meeting, pairs / 100);
  EXPECT_LT(meeting, pairs - pairs / 100);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, NeighborsOfKind, ::testing::Range(0, neighbor_kinds));

}  // namespace
}  // namespace limber::testing
