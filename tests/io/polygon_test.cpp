// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>

#include "files.h"
#include "limber/geometry.h"

namespace limber {
namespace {

using Polygon = std::vector<std::array<int, 2>>;

/// Corners above each other at growing x: combs and steps, with straight runs.
Polygon between_two_chains(std::mt19937& random) {
  Polygon polygon;
  const int count = 2 + static_cast<int>(random() % 7), height = 1 + static_cast<int>(random() % 9);
  for (int x = 0; x < count; ++x) polygon.push_back({x, static_cast<int>(random() % height)});
  for (int x = count; x-- > 0;) polygon.push_back({x, height + static_cast<int>(random() % height)});
  return polygon;
}

/// Seen as a whole from the origin; corners in 16 directions, counter-clockwise.
Polygon around_a_point(std::mt19937& random) {
  constexpr std::array<std::array<int, 2>, 4> first_quarter = {{{1, 0}, {2, 1}, {1, 1}, {1, 2}}};
  Polygon polygon;
  for (std::size_t i = 0; i < 16; ++i) {
    std::array<int, 2> corner = first_quarter[i % 4];
    for (std::size_t quarter = 0; quarter < i / 4; ++quarter) corner = {-corner[1], corner[0]};
    const int reach = 1 + static_cast<int>(random() % 6);
    polygon.push_back({corner[0] * reach, corner[1] * reach});
  }
  return polygon;
}

Polygon spiral(int arm_count) {
  Polygon polygon = {{0, 0}}, inner = {{1, 1}};
  constexpr std::array<std::array<int, 2>, 4> step = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  constexpr std::array<std::array<int, 2>, 4> inward = {{{-1, 1}, {-1, -1}, {1, -1}, {1, 1}}};
  for (int arm = 0; arm < arm_count; ++arm) {
    const auto side = static_cast<std::size_t>(arm % 4);
    const int length = 4 * (arm / 2 + 1);
    polygon.push_back({polygon.back()[0] + step[side][0] * length, polygon.back()[1] + step[side][1] * length});
    inner.push_back({polygon.back()[0] + inward[side][0], polygon.back()[1] + inward[side][1]});
  }
  polygon.insert(polygon.end(), inner.rbegin(), inner.rend());
  return polygon;
}

class Polygons : public FilesTest {
 protected:
  /// Reads the polygon from every starting corner, in both directions and in several planes. Directed edges of the
  /// triangles are the polygon's and pairs of opposite ones, and no triangle is turned over where `is_simple`: so
  /// triangles cover each point as often as the polygon winds around it, which needs no other triangulation.
  static void check(const Polygon& polygon, bool is_simple) {
    constexpr std::array<std::array<Vec3, 2>, 4> planes = {
        {{{{1, 0, 0}, {0, 1, 0}}}, {{{0, 0, 3}, {1, 0, 1}}}, {{{0, 1, -7}, {0, 2, 1}}}, {{{1, 2, 3}, {-3, 1, 4}}}}};
    const std::size_t count = polygon.size();
    for (std::size_t round = 0; round < 2 * count; ++round) {
      Polygon turned = polygon;
      if (round % 2 != 0) std::reverse(turned.begin(), turned.end());
      std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(round / 2), turned.end());
      const auto& [along, across] = planes[round % 4];
      std::string obj, face = "f";
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 p = turned[i][0] * along + turned[i][1] * across + Vec3{5, 6, 7};
        obj += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
        face += " " + std::to_string(i + 1);
      }
      const std::string bytes = obj + face + "\n";
      const auto file = read_mesh_bytes(std::as_bytes(std::span(bytes)), "a.obj", {.weld = false});
      ASSERT_TRUE(file) << file.error().text;
      ASSERT_EQ(file->mesh.triangles().size(), count - 2) << bytes;
      std::map<std::pair<VertexId, VertexId>, int> edges;
      for (const Corners& corners : file->mesh.triangles()) {
        for (std::size_t i = 0; i < 3; ++i) ++edges[{corners[i], corners[(i + 1) % 3]}];
        const auto flat = [&](std::size_t i) {
          return Vec3{static_cast<double>(turned[corners[i]][0]), static_cast<double>(turned[corners[i]][1]), 0};
        };
        const int turn = orient2d(flat(0), flat(1), flat(2), 2);
        if (is_simple) {
          EXPECT_GE(round % 2 == 0 ? turn : -turn, 0) << bytes;
        }
      }
      for (const auto& [edge, times] : edges) {
        const auto& [from, to] = edge;
        EXPECT_EQ(times, 1) << bytes;
        EXPECT_NE(edges.contains({to, from}), to == (from + 1) % count) << from << " " << to << "\n" << bytes;
      }
    }
  }
};

TEST_F(Polygons, become_triangles_that_stay_inside_wherever_they_start) {
  std::mt19937 random(11);
  check({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, true);
  check({{0, 0}, {2, 1}, {4, 0}, {2, 4}}, true);
  for (int arms = 2; arms < 13; ++arms) check(spiral(arms), true);
  for (int round = 0; round < 60; ++round) {
    check(between_two_chains(random), true);
    check(around_a_point(random), true);
  }
}

TEST_F(Polygons, with_a_cut_to_a_hole_keep_the_hole) {
  check({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}}, true);
}

TEST_F(Polygons, whose_corners_repeat_stay_inside) {
  std::mt19937 random(13);
  check({{0, 0}, {6, 0}, {6, 6}, {6, 6}, {3, 1}, {0, 6}, {0, 6}}, true);
  for (int round = 0; round < 60; ++round) {
    Polygon repeated;
    for (const auto& corner : round % 2 == 0 ? between_two_chains(random) : around_a_point(random)) {
      repeated.insert(repeated.end(), 1 + random() % 3, corner);
    }
    check(repeated, true);
  }
}

TEST_F(Polygons, that_are_degenerate_or_cross_themselves_are_as_closed_as_others) {
  std::mt19937 random(12);
  check({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, false);
  check({{1, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 1}}, false);
  check({{0, 0}, {3, 0}, {1, 0}, {2, 0}, {5, 0}}, false);
  check({{0, 0}, {0, 0}, {4, 0}, {4, 0}, {4, 4}, {1, 1}, {1, 1}, {0, 4}}, true);
  for (int round = 0; round < 100; ++round) {
    Polygon polygon(4 + random() % 9);
    for (auto& corner : polygon) corner = {static_cast<int>(random() % 4), static_cast<int>(random() % 4)};
    check(polygon, false);
  }
}

TEST_F(Polygons, that_take_too_long_are_refused) {
  std::string obj, face = "f";  // a comb
  for (int i = 0; i < 100'000; ++i) {
    obj += "v " + std::to_string(i) + (i % 2 == 0 ? " 0 0\n" : " 9 0\n");
    face += " " + std::to_string(i + 1);
  }
  EXPECT_TRUE(read("comb.obj", obj + "v 0 -5 0\nf 1 2 3 4 5 6 100001\n"));
  const Error error = refused("comb.obj", obj + "v 50000 9000000 0\n" + face + " 100001\n");
  EXPECT_EQ(error.code, ErrorCode::too_large);
  EXPECT_EQ(error.where, 0U);
}

}  // namespace
}  // namespace limber
