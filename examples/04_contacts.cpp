// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of triangles that are close: of two models, with a few contacts of them for a solver, and of a sheet with
// itself while it is rolled up.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

namespace {

constexpr std::uint32_t squares = 48;

/// The sheet after one and a half turns along x, with the layers `gap` apart.
std::vector<limber::Vec3> rolled(const limber::Mesh& flat, double gap) {
  std::vector<limber::Vec3> positions;
  for (const limber::Vec3& p : flat.positions()) {
    const double turns = 1.5 * (p.x / 4 + 0.5), angle = 2 * std::numbers::pi * turns, radius = 0.5 + gap * turns;
    positions.push_back({radius * std::cos(angle), p.y, radius * std::sin(angle)});
  }
  return positions;
}

/// Triangles of one layer are close to each other whatever the sheet does, so only those far apart in the sheet count.
bool may_touch(limber::TriangleId a, limber::TriangleId b) {
  const auto column = [](limber::TriangleId t) { return static_cast<int>(t / 2 % squares); };
  return std::abs(column(a) - column(b)) > 8;
}

}  // namespace

int main() {
  const limber::Model table(shapes::sheet(16, 4)), ball(shapes::ball(32));
  const limber::Placed a{table}, b{ball, {{}, {0.1, 0.2, 0.97}}};  // the ball is 0.03 too low

  // Into an array, as far as there is room. The count is that of all pairs.
  std::vector<limber::Contact> contacts(100);
  const limber::PairCount found = limber::contacts(a, b, 0.01, contacts);
  // Or one at a time, without an array. The visitor says whether to go on.
  limber::Contact deepest;
  const auto take_deepest = [&](const limber::Contact& contact) {
    if (contact.depth > deepest.depth) deepest = contact;
    return true;
  };
  const limber::PairCount visited = limber::visit_contacts(a, b, 0.01, take_deepest);
  std::printf("%zu pairs within 0.01; the deepest by %g, along (%g, %g, %g)\n", found.count, deepest.depth,
              deepest.normal.x, deepest.normal.y, deepest.normal.z);

  // A solver of rigid bodies wants a few points of each patch. All contacts are needed for that.
  contacts.resize(found.count);
  limber::contacts(a, b, 0.01, contacts);
  const std::size_t kept = limber::reduce_contacts(contacts, 0.6, {.max_angle = 1});
  for (std::size_t i = 0; i < kept; ++i) {
    const limber::Contact& c = contacts[i];
    std::printf("  at (%.3f, %.3f, %.3f), gap %.4f\n", c.point_a.x, c.point_a.y, c.point_a.z, c.distance - c.depth);
  }

  limber::Model sheet(shapes::sheet(squares, 4));
  const limber::Mesh flat = sheet.mesh();
  bool is_as_expected =
      found.count == visited.count && deepest.depth > 0 && kept > 0 && kept < 20 && contacts[0].depth == deepest.depth;
  for (const double gap : {0.2, 0.05, 0.0}) {
    sheet.move_all(rolled(flat, gap)).value();
    sheet.commit();
    const std::size_t close = limber::self_contacts(sheet, 0.1, {}, {.filter = may_touch}).count;
    const std::size_t meeting = limber::self_intersections(sheet, {}).count;
    std::printf("layers %g apart: %zu pairs within 0.1, %zu meet\n", gap, close, meeting);
    is_as_expected = is_as_expected && (close > 0) == (gap < 0.1) && (meeting > 0) == (gap == 0);
  }
  return is_as_expected ? 0 : 1;
}
