// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The exact intersection test against CGAL's kernel with exact predicates, on millions of pairs. CGAL asks for
// non-degenerate triangles, so a degenerate one is handed to it as the segment or point that it is.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <iostream>
#include <string>
#include <utility>
#include <variant>

#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Shape = std::variant<Point, Kernel::Segment_3, Kernel::Triangle_3>;

Point cgal_point(const Vec3& v) { return {v.x, v.y, v.z}; }

Shape shape_of(const Triangle& t) {
  const Point a = cgal_point(t.v0), b = cgal_point(t.v1), c = cgal_point(t.v2);
  if (!CGAL::collinear(a, b, c)) return Kernel::Triangle_3(a, b, c);
  const Point low = std::min({a, b, c}), high = std::max({a, b, c});
  if (low == high) return low;
  return Kernel::Segment_3(low, high);
}

struct Meet {
  bool operator()(const Point& p, const Point& q) const { return p == q; }
  bool operator()(const Point& p, const Kernel::Segment_3& s) const { return s.has_on(p); }
  bool operator()(const Kernel::Segment_3& s, const Point& p) const { return s.has_on(p); }
  bool operator()(const Point& p, const Kernel::Triangle_3& t) const { return t.has_on(p); }
  bool operator()(const Kernel::Triangle_3& t, const Point& p) const { return t.has_on(p); }
  template <typename A, typename B>
  bool operator()(const A& a, const B& b) const {
    return CGAL::do_intersect(a, b);
  }
};

bool cgal_intersects(const Triangle& a, const Triangle& b) { return std::visit(Meet{}, shape_of(a), shape_of(b)); }

class CgalIntersection : public ::testing::TestWithParam<PairKind> {};

TEST_P(CgalIntersection, NeverDisagrees) {
  constexpr auto kinds = static_cast<std::uint64_t>(PairKind::count);
  const std::uint64_t pairs = count_from("LIMBER_ORACLE_PAIRS", 2'000'000) / kinds + 1;
  Rng rng(1000 + static_cast<std::uint64_t>(GetParam()));
  std::uint64_t meeting = 0;
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const auto [a, b] = random_pair(rng, GetParam());
    const bool truth = cgal_intersects(a, b);
    meeting += truth ? 1 : 0;
    ASSERT_EQ(intersects(a, b), truth) << "pair " << i;
  }
  std::cout << pairs << " pairs, " << meeting << " meeting, 0 disagreements\n";
  EXPECT_GT(meeting, pairs / 1000);
  EXPECT_LT(meeting, pairs - pairs / 1000);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CgalIntersection, ::testing::ValuesIn(every_kind<PairKind>()));

}  // namespace
}  // namespace limber::testing
