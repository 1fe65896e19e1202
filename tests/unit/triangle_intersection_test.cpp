// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "support/random_geometry.h"
#include "support/rational_distance.h"

namespace limber::testing {
namespace {

const Triangle flat_triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

struct KnownCase {
  const char* what;
  Triangle other;
  bool meets;
};

TEST(TriangleIntersection, KnownCases) {
  const KnownCase cases[] = {
      {"pierced by an edge", {{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}, true},
      {"pierces with a corner", {{1, 1, -1}, {1, 0.5, 1}, {0.5, 1, 1}}, true},
      {"above", {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, false},
      {"plane crossed beside the triangle", {{5, 5, -1}, {5, 5, 1}, {9, 9, 1}}, false},
      {"corner touches the face", {{1, 1, 0}, {1, 1, 5}, {2, 1, 5}}, true},
      {"corner touches a corner", {{4, 0, 0}, {6, 0, 1}, {6, 1, 1}}, true},
      {"corner touches an edge", {{2, 0, 0}, {2, -3, 1}, {3, -3, 1}}, true},
      {"edge touches an edge", {{2, -1, -1}, {2, 1, 1}, {2, -5, 0}}, true},
      {"shares an edge", {{0, 0, 0}, {4, 0, 0}, {0, -4, 3}}, true},
      {"the same", flat_triangle, true},
      {"the same reversed", {{0, 4, 0}, {4, 0, 0}, {0, 0, 0}}, true},
      {"coplanar, inside", {{0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}}, true},
      {"coplanar, around", {{-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}}, true},
      {"coplanar, crossing", {{1, -1, 0}, {2, -1, 0}, {1, 9, 0}}, true},
      {"coplanar, touching at a corner", {{4, 0, 0}, {8, 0, 0}, {8, 4, 0}}, true},
      {"coplanar, touching along an edge", {{1, 0, 0}, {3, 0, 0}, {2, -4, 0}}, true},
      {"coplanar, beside", {{3, 3, 0}, {5, 3, 0}, {3, 5, 0}}, false},
      {"segment through the face", {{1, 1, -1}, {1, 1, 1}, {1, 1, 1}}, true},
      {"segment with its middle corner between", {{1, 1, 1}, {1, 1, 0.5}, {1, 1, -1}}, true},
      {"segment ending on the face", {{1, 1, 0}, {1, 1, 1}, {1, 1, 2}}, true},
      {"segment short of the face", {{1, 1, 0.5}, {1, 1, 1}, {1, 1, 2}}, false},
      {"segment in the plane, crossing", {{-1, 1, 0}, {9, 1, 0}, {2, 1, 0}}, true},
      {"segment in the plane, inside", {{0.5, 0.5, 0}, {1, 1, 0}, {1, 1, 0}}, true},
      {"segment in the plane, beside", {{4, 4, 0}, {5, 5, 0}, {5, 5, 0}}, false},
      {"segment along an edge, beyond it", {{5, 0, 0}, {6, 0, 0}, {7, 0, 0}}, false},
      {"segment along an edge, reaching it", {{4, 0, 0}, {6, 0, 0}, {7, 0, 0}}, true},
      {"point in the face", {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, true},
      {"point on the slanted edge", {{2, 2, 0}, {2, 2, 0}, {2, 2, 0}}, true},
      {"point at a corner", {{0, 4, 0}, {0, 4, 0}, {0, 4, 0}}, true},
      {"point beside", {{3, 3, 0}, {3, 3, 0}, {3, 3, 0}}, false},
      {"point above", {{1, 1, 1e-300}, {1, 1, 1e-300}, {1, 1, 1e-300}}, false},
  };
  for (const KnownCase& c : cases) {
    EXPECT_EQ(intersects(flat_triangle, c.other), c.meets) << c.what;
    EXPECT_EQ(intersects(c.other, flat_triangle), c.meets) << c.what;
  }
}

TEST(TriangleIntersection, DegenerateAgainstDegenerate) {
  const auto segment = [](const Vec3& a, const Vec3& b) { return Triangle{a, b, 0.5 * (a + b)}; };
  const auto point = [](const Vec3& a) { return Triangle{a, a, a}; };
  EXPECT_TRUE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({0, -1, 0}, {0, 1, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({0, -1, 1}, {0, 1, 1})));
  EXPECT_TRUE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({1, 0, 0}, {2, 0, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({2, 0, 0}, {3, 0, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({-1, 1, 0}, {1, 1, 0})));
  EXPECT_TRUE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({2, 2, 2})));
  EXPECT_FALSE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({6, 6, 6})));
  EXPECT_FALSE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({2, 2, 3})));
  EXPECT_TRUE(intersects(point({1, 2, 3}), point({1, 2, 3})));
  EXPECT_FALSE(intersects(point({1, 2, 3}), point({1, 2, std::nextafter(3.0, 4.0)})));
}

TEST(TriangleIntersection, EqualsRationalDistanceZeroOnLattices) {
  Rng rng(11);
  int meeting = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto [a, b] = random_pair(rng, PairKind::lattice);
    const bool truth = squared_distance(a, b) == 0;
    meeting += truth ? 1 : 0;
    ASSERT_EQ(intersects(a, b), truth) << "case " << i;
  }
  EXPECT_GT(meeting, 100);
  EXPECT_LT(meeting, 900);
}

TEST(TriangleIntersection, DoesNotDependOnOrderOrScale) {
  Rng rng(13);
  for (int i = 0; i < 2000; ++i) {
    const auto kind = static_cast<PairKind>(i % static_cast<int>(PairKind::count));
    const auto [a, b] = random_pair(rng, kind);
    const bool answer = intersects(a, b);
    ASSERT_EQ(intersects(b, a), answer) << "case " << i;
    ASSERT_EQ(intersects({a.v1, a.v2, a.v0}, {b.v2, b.v1, b.v0}), answer) << "case " << i;
    for (const double scale : {0x1p-150, 0x1p-40, 0x1p190}) {
      const bool has_subnormals =
          kind == PairKind::near_lattice || kind == PairKind::segment_like || kind == PairKind::needle;
      if (has_subnormals && scale < 1) continue;  // zeros that were nudged would vanish
      const auto scaled = [&](const Triangle& t) { return Triangle{t.v0 * scale, t.v1 * scale, t.v2 * scale}; };
      ASSERT_EQ(intersects(scaled(a), scaled(b)), answer) << "case " << i << ", scale " << scale;
    }
  }
}

TEST(TriangleIntersection, SegmentOverloadAgreesWithSegmentLikeTriangle) {
  EXPECT_TRUE(intersects(Segment{{1, 1, -1}, {1, 1, 1}}, flat_triangle));
  EXPECT_FALSE(intersects(Segment{{5, 5, -1}, {5, 5, 1}}, flat_triangle));
  EXPECT_TRUE(intersects(Segment{{4, 0, 0}, {9, 0, 0}}, flat_triangle));
}

}  // namespace
}  // namespace limber::testing
