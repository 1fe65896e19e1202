// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "files.h"
#include "limber/geometry.h"

namespace limber {
namespace {

using Polygon = std::vector<std::array<int, 2>>;

/// Triangles of a grid glued together at corners, one after another: the outline comes back to corners, around holes
/// too, and along edges where that is not taken out.
Polygon glued_triangles(std::mt19937& random) {
  const int bend = static_cast<int>(random() % 2);
  std::vector<Polygon> triangles;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      const auto corner = [bend](int i, int j) {
        return std::array{8 * i + (i * j + j) % 4 * bend, 8 * j + (i * j + i) % 4 * bend};
      };
      triangles.push_back({corner(x, y), corner(x + 1, y), corner(x, y + 1)});
      triangles.push_back({corner(x, y + 1), corner(x + 1, y), corner(x + 1, y + 1)});
    }
  }
  std::shuffle(triangles.begin(), triangles.end(), random);
  triangles.resize(2 + random() % 31);
  Polygon polygon = triangles.back();
  const std::size_t kept = random() % 4;
  for (triangles.pop_back(); !triangles.empty(); triangles.pop_back()) {
    Polygon& added = triangles.back();
    std::rotate(added.begin(), added.begin() + static_cast<std::ptrdiff_t>(random() % 3), added.end());
    const auto angle = [&](const auto& p) { return std::atan2(p[1] - added[0][1], p[0] - added[0][0]); };
    std::pair<double, std::size_t> nearest = {7, 0};  // a turn and the visit of the corner that comes from there
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const double turn = angle(added[1]) - angle(polygon[(i + polygon.size() - 1) % polygon.size()]);
      if (polygon[i] == added[0]) nearest = std::min(nearest, {turn < 0 ? turn + 2 * std::numbers::pi : turn, i + 1});
    }
    if (nearest.second == 0) continue;
    polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(nearest.second), {added[1], added[2], added[0]});
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      if (polygon[i - 1] != polygon[i + 1] || random() % 4 < kept) continue;
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i - 1),
                    polygon.begin() + static_cast<std::ptrdiff_t>(i + 1));
      i = 0;
    }
  }
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
  check({{2, 2}, {0, 2}, {0, 0}, {1, 0}, {0, 1}, {1, 2}, {2, 1}}, true);
  check({{1, 0}, {0, 2}, {1, 1}, {0, 3}, {2, 2}, {1, 3}, {3, 2}, {3, 3}, {0, 3}, {0, 0}}, true);
  for (std::size_t round = 0; round < 300; ++round) {
    Polygon polygon;
    for (const auto& corner : glued_triangles(random)) {
      polygon.insert(polygon.end(), 1 + random() % (1 + round % 3), corner);
    }
    for (std::size_t i = 1; round % 2 == 0 && i + 1 < polygon.size(); ++i) {  // corners where it goes straight on
      const auto &p = polygon[i - 1], &q = polygon[i], &r = polygon[i + 1];
      const int x0 = q[0] - p[0], y0 = q[1] - p[1], x1 = r[0] - q[0], y1 = r[1] - q[1];
      const bool is_straight = x0 * y1 == y0 * x1 && x0 * x1 + y0 * y1 > 0 && polygon.size() > 4;
      if (is_straight) polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i--));
    }
    check(polygon, true);
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
  EXPECT_EQ(refused("comb.obj", obj + "v 50000 9000000 0\n" + face + " 100001\n", ErrorCode::too_large).where, 0U);
}

}  // namespace
}  // namespace limber
