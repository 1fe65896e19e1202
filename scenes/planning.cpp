// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "scenes/surfaces.h"

namespace limber::scenes {
namespace {

using std::numbers::pi;
constexpr std::uint64_t house_seed = 0x5EED0020, flat_seed = 0x5EED0021;

/// A number of segments. A surface has segments in two directions: both numbers grow by the root of the detail, so the
/// triangles by the detail.
std::uint32_t scaled(double count, double detail) {
  return static_cast<std::uint32_t>(std::lround(count * std::sqrt(detail)));
}

/// The points of a circle around the z axis, pushed out onto a rectangle of these half sides, which turns by `angle`.
Ring rectangle(const Ring& points, double x, double y, double angle = 0) {
  Ring ring;
  for (const Vec3& p : points) {
    const double size = std::max(std::abs(p.x), std::abs(p.y)), u = x * p.x / size, v = y * p.y / size;
    ring.push_back({cosine(angle) * u - sine(angle) * v, sine(angle) * u + cosine(angle) * v, p.z});
  }
  return ring;
}

Transform at(double x, double y, double z, double turn_about_z = 0) {
  const double c = cosine(turn_about_z), s = sine(turn_about_z);
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, {x, y, z}};
}

/// A box that stands on the middle of its lower side.
Box standing(double x, double y, double z, double size_x, double size_y, double size_z) {
  return {{x - size_x / 2, y - size_y / 2, z}, {x + size_x / 2, y + size_y / 2, z + size_z}};
}

/// A table of these sizes, or a chair without its back.
std::vector<Box> table(double size_x, double size_y, double height) {
  const double x = size_x / 2 - 0.05, y = size_y / 2 - 0.05;
  std::vector<Box> parts = {standing(0, 0, height - 0.04, size_x, size_y, 0.04)};
  for (const Vec3& leg : {Vec3{-x, -y, 0}, Vec3{x, -y, 0}, Vec3{x, y, 0}, Vec3{-x, y, 0}}) {
    parts.push_back(standing(leg.x, leg.y, 0, 0.06, 0.06, height - 0.04));
  }
  return parts;
}

constexpr double room_side = 4, room_height = 2.5;

/// Grid of nx by ny rooms from the origin on, with floor and ceiling. Walls between rooms have doors, some of those
/// outside have windows, and one leads in.
std::vector<Box> rooms(std::uint32_t nx, std::uint32_t ny) {
  constexpr double half = 0.1, door_width = 1, door_height = 2.1, sill = 0.9;
  Rng rng(house_seed);
  std::vector<Box> walls;
  // A part of the wall from (x, y) on, along the x or the y axis, between two distances from there and two heights.
  const auto add = [&](double x, double y, bool along_x, double u0, double u1, double z0, double z1) {
    walls.push_back(along_x ? Box{{x + u0, y - half, z0}, {x + u1, y + half, z1}}
                            : Box{{x - half, y + u0, z0}, {x + half, y + u1, z1}});
  };
  const auto wall = [&](std::uint32_t i, std::uint32_t j, bool along_x) {
    const double x = i * room_side, y = j * room_side, u = rng.uniform(0.4, room_side - 0.4 - door_width);
    const bool outside = along_x ? j == 0 || j == ny : i == 0 || i == nx;
    const bool door = !outside || (along_x && i == 0 && j == 0), window = !door && (i + 2 * j) % 5 == 1;
    if (!door && !window) return add(x, y, along_x, 0, room_side, 0, room_height);
    add(x, y, along_x, 0, u, 0, room_height);
    add(x, y, along_x, u + door_width, room_side, 0, room_height);
    add(x, y, along_x, u, u + door_width, door_height, room_height);
    if (window) add(x, y, along_x, u, u + door_width, 0, sill);
  };
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) {
      if (i < nx) wall(i, j, true);
      if (j < ny) wall(i, j, false);
    }
  }
  const double x = nx * room_side, y = ny * room_side;
  walls.push_back({{-half, -half, -half}, {x + half, y + half, 0}});
  walls.push_back({{-half, -half, room_height}, {x + half, y + half, room_height + half}});
  return walls;
}

/// Numbers of rooms along x and y for about `count` rooms.
std::pair<std::uint32_t, std::uint32_t> grid_of(double count) {
  const auto nx = static_cast<std::uint32_t>(std::ceil(std::sqrt(count)));
  return {nx, static_cast<std::uint32_t>(std::lround(count / nx))};
}

/// What stands in a room of the flat, with its corner in the origin: a table with chairs, a shelf of books, a round
/// table, a lamp, and cushions.
Mesh furniture(Rng& rng, double detail) {
  const auto n = [&](double count) { return scaled(count, detail); };
  std::vector<Mesh> parts = {together({boxes(table(1.2, 0.8, 0.75))}, at(1.3, 1.2, 0, rng.uniform(-0.3, 0.3)))};
  for (int k = 0; k < 4; ++k) {
    std::vector<Box> chair = table(0.45, 0.45, 0.45);
    chair.push_back(standing(0, 0.2, 0.45, 0.45, 0.04, 0.5));
    const Mesh seat = together({boxes(chair)}, at(0, 0.7, 0, rng.uniform(-0.4, 0.4)));
    parts.push_back(together({seat}, at(1.3, 1.2, 0, pi / 2 * k)));
  }
  std::vector<Box> shelf = {standing(-1, 0, 0, 0.03, 0.3, 2), standing(1, 0, 0, 0.03, 0.3, 2),
                            standing(0, 0.15, 0, 2.03, 0.02, 2)};
  for (int board = 0; board < 5; ++board) {
    shelf.push_back(standing(0, 0, 0.45 * board, 2, 0.28, 0.03));
    for (int book = 0; board < 4 && book < 12; ++book) {
      const double thickness = rng.uniform(0.03, 0.12), height = rng.uniform(0.2, 0.35);
      shelf.push_back(standing(-0.9 + 0.16 * book, 0, 0.45 * board + 0.03, thickness, 0.2, height));
    }
  }
  parts.push_back(together({boxes(shelf)}, at(2.2, 3.6, 0)));
  const std::vector<ProfilePoint> foot = {{0.3, 0}, {0.3, 0.03}, {0.05, 0.1}, {0.05, 0.65}, {0.5, 0.7}, {0.5, 0.73}};
  parts.push_back(together({lathe(foot, n(48), n(2))}, at(3, 1.1, 0)));
  const std::vector<ProfilePoint> lamp = {{0.15, 0},    {0.15, 0.03}, {0.015, 0.04},
                                          {0.015, 1.4}, {0.25, 1.4},  {0.12, 1.8}};
  parts.push_back(together({lathe(lamp, n(30), n(4))}, at(0.5, 3.5, 0)));
  for (int k = 0; k < 3; ++k) {
    const double size = rng.uniform(0.25, 0.4);
    const Transform flattened = {{{size, 0, 0}, {0, size, 0}, {0, 0, 0.5 * size}}, {1.2 + 0.9 * k, 2.7, 0.2}};
    parts.push_back(together({ball(n(24), n(20))}, flattened));
  }
  return together(parts);
}

/// A grand piano on three turned legs, 1.5 wide and 1.7 long, around the origin.
Mesh piano(double detail) {
  Ring bottom = {{-0.75, 0, 0.65}};
  constexpr int curve = 36;
  for (int k = 0; k <= curve; ++k) {
    const double s = static_cast<double>(k) / curve;
    bottom.push_back({0.75 - 0.9 * s * s * (3 - 2 * s), 1.7 * s, 0.65});
  }
  bottom.push_back({-0.75, 1.7, 0.65});
  const auto raised = [&](double height) {
    Ring ring = bottom;
    for (Vec3& p : ring) p.z += height;
    return ring;
  };
  std::vector<Box> keys = {standing(0, -0.09, 0.6, 1.5, 0.18, 0.05), standing(0, 0.3, 0.1, 0.3, 0.1, 0.55)};
  for (int k = 0; k < 52; ++k) {
    const double x = -0.61 + 0.0235 * k;
    keys.push_back(standing(x, -0.08, 0.66, 0.022, 0.15, 0.02));
    if (k % 7 != 1 && k % 7 != 4 && k != 51) keys.push_back(standing(x + 0.0118, -0.05, 0.68, 0.01, 0.1, 0.012));
  }
  for (int k = -1; k <= 1; ++k) keys.push_back(standing(0.08 * k, 0.2, 0.1, 0.03, 0.15, 0.02));
  std::vector<Mesh> parts = {loft({bottom, raised(0.3)}, Ends::capped),
                             loft({raised(0.33), raised(0.35)}, Ends::capped), boxes(keys)};
  const std::vector<ProfilePoint> leg = {{0.03, 0}, {0.05, 0.05}, {0.03, 0.1}, {0.05, 0.4}, {0.08, 0.65}};
  const Mesh turned = lathe(leg, scaled(25, detail), scaled(3, detail));
  for (const Transform& foot : {at(-0.6, 0.15, 0), at(0.6, 0.15, 0), at(-0.45, 1.5, 0)}) {
    parts.push_back(together({turned}, foot));
  }
  return together(parts, at(0, -0.8, -0.6));
}

/// A plate of square tiles of side 1 from the origin on, each with a round hole, laid face to face.
std::vector<Mesh> plate(std::uint32_t nx, std::uint32_t ny, double z0, double z1, std::uint32_t sides) {
  const Ring low = circle(sides, 0.3, z0), high = circle(sides, 0.3, z1);
  const Mesh tile = loft({rectangle(low, 0.5, 0.5), rectangle(high, 0.5, 0.5), high, low}, Ends::joined);
  std::vector<Mesh> tiles;
  for (std::uint32_t i = 0; i < nx; ++i) {
    for (std::uint32_t j = 0; j < ny; ++j) tiles.push_back(together({tile}, at(i + 0.5, j + 0.5, 0)));
  }
  return tiles;
}

/// A hexagonal head on a shank that begins at the origin.
Mesh bolt(double shank) {
  return together({loft({circle(6, 0.42, shank), circle(6, 0.42, shank + 0.25)}, Ends::capped),
                   lathe({{0.25, 0}, {0.25, shank}}, 24)});
}

}  // namespace

PlanningScene sculptures(double detail) {
  const auto n = [&](double count) { return scaled(count, detail); };
  const auto knot = [](double t) {
    const double a = 2 * pi * t, r = 0.16 * (2 + cosine(3 * a));
    return Vec3{r * cosine(2 * a), r * sine(2 * a), 0.16 * sine(3 * a)};
  };
  const Mesh trefoil = loft(circles_along(knot, n(60), n(5), 0.06, Ends::joined), Ends::joined);
  std::vector<Ring> column;
  for (std::uint32_t k = 0; k <= n(20); ++k) {
    const double t = static_cast<double>(k) / n(20);
    column.push_back(rectangle(circle(n(4), 1, 1.5 * t, pi / 4), 0.2, 0.12, 3 * t));
  }
  const std::vector<ProfilePoint> vase = {{0.15, 0}, {0.3, 0.3}, {0.1, 0.6}, {0.2, 0.8}, {0.17, 0.8}, {0, 0.5}};
  const Mesh cube = boxes({{{-1.1, -1.1, -1.1}, {1.1, 1.1, -1}},
                           {{-1.1, -1.1, 1}, {1.1, 1.1, 1.1}},
                           {{-1.1, -1.1, -1}, {-1, 1.1, 1}},
                           {{1, -1.1, -1}, {1.1, 1.1, 1}},
                           {{-1, -1.1, -1}, {1, -1, 1}},
                           {{-1, 1, -1}, {1, 1.1, 1}}});
  const Mesh steps = boxes({standing(0.5, -0.5, -1, 0.6, 0.6, 0.2), standing(0.5, -0.5, -0.8, 0.4, 0.4, 0.2),
                            standing(0.5, -0.5, -0.6, 0.2, 0.2, 0.6)});
  const Transform upright = {{{0.4, 0, 0}, {0, 0, -0.4}, {0, 0.4, 0}}, {0.5, 0.5, -0.4}};
  return {together({cube, steps, together({trefoil}, at(-0.4, 0.4, 0.4)), together({ring(n(20), n(8), 0.25)}, upright),
                    together({loft(column, Ends::capped)}, at(-0.5, -0.5, -1)),
                    together({lathe(vase, n(10), n(2))}, at(0.4, -0.1, -0.2))}),
          boxes({standing(0, 0, -0.3, 0.08, 0.08, 0.6),
                 {{0.04, -0.04, 0.22}, {0.3, 0.04, 0.3}},
                 {{0.04, -0.04, -0.04}, {0.2, 0.04, 0.04}},
                 {{-0.3, -0.04, -0.3}, {-0.04, 0.04, -0.22}}})};
}

PlanningScene house(double detail) {
  const auto [nx, ny] = grid_of(9 * detail);
  std::vector<Box> parts;
  constexpr double legs[][2] = {{-0.6, -0.6}, {0.6, -0.6}, {0.6, -0.1}, {-0.1, -0.1}, {-0.1, 0.6}, {-0.6, 0.6}};
  for (const auto& [x, y] : legs) parts.push_back(standing(x, y, -0.4, 0.08, 0.08, 0.7));
  parts.push_back({{-0.7, -0.7, 0.3}, {0.7, 0, 0.36}});
  parts.push_back({{-0.7, 0, 0.3}, {0, 0.7, 0.36}});
  parts.push_back({{-0.56, -0.62, -0.2}, {0.56, -0.58, -0.15}});
  parts.push_back({{-0.62, -0.56, -0.2}, {-0.58, 0.56, -0.15}});
  return {boxes(rooms(nx, ny)), boxes(parts)};
}

PlanningScene twisty_wall(double detail) {
  const std::uint32_t sides = 4 * scaled(1, detail), layers = scaled(19, detail);
  const auto at_height = [&](double z) { return circle(sides, 1, z, pi / 4); };
  std::vector<Ring> rings = {rectangle(at_height(-0.25), 2, 2), rectangle(at_height(0.25), 2, 2)};
  for (std::uint32_t k = 0; k <= layers; ++k) {
    const double t = static_cast<double>(k) / layers - 0.5;
    rings.push_back(rectangle(at_height(-0.5 * t), 0.5, 0.2, -pi / 3 * t));
  }
  const auto bent = [](double t) { return Vec3{1.2 * t - 0.6, 0.5 * t * (1 - t) - 0.08, 0.1 * t}; };
  return {loft(rings, Ends::joined),
          loft(circles_along(bent, scaled(4, detail), scaled(6, detail), 0.1), Ends::capped)};
}

PlanningScene cubicles(double detail) {
  const std::uint32_t nx = scaled(5, detail), ny = scaled(2, detail);
  std::vector<Box> parts = {{{-1, -1, -0.1}, {2.0 * nx + 1, 3.0 * ny, 0}},
                            {{2.0 * nx - 0.03, 0, 0}, {2.0 * nx + 0.03, 3.0 * ny - 1.2, 1.5}}};
  for (std::uint32_t i = 0; i < nx; ++i) {
    for (std::uint32_t j = 0; j < ny; ++j) {
      const double x = 2.0 * i, y = 3.0 * j;
      parts.push_back({{x - 0.03, y, 0}, {x + 0.03, y + 1.8, 1.5}});
      parts.push_back({{x, y - 0.03, 0}, {x + 2, y + 0.03, 1.5}});
      parts.push_back({{x + 0.1, y + 0.05, 0.7}, {x + 1.9, y + 0.7, 0.74}});
      parts.push_back({{x + 1.4, y + 0.1, 0}, {x + 1.85, y + 0.65, 0.6}});
      parts.push_back(standing(x + 0.9, y + 0.3, 0.8, 0.6, 0.03, 0.4));
    }
  }
  const Ring low = {{0.08, 0.08, 0}, {0.08, 0.5, 0}, {0, 0.5, 0}, {0, 0, 0}, {0.5, 0, 0}, {0.5, 0.08, 0}};
  Ring high = low;
  for (Vec3& p : high) p.z = 0.1;
  const Mesh prism = loft({low, high}, Ends::capped);
  return {boxes(parts),
          together({together({prism}, at(-0.2, -0.2, -0.15)), together({prism}, at(0.2, 0.2, 0.05, pi))})};
}

PlanningScene alpha_puzzle(double detail) {
  // A cubic curve crosses itself as the letter does. It runs fast in the middle of its loop, so segments are alike.
  const auto alpha = [](double t) {
    const double v = 2 * t - 1, u = v * (2 - 0.5 * v * v);
    return Vec3{2 * u * u - 2, 1.5 * (u * u * u - u), 0.25 * u};
  };
  const Mesh tube = loft(circles_along(alpha, scaled(23, detail), scaled(42, detail), 0.07), Ends::capped);
  return {tube, tube};
}

PlanningScene bug_trap(double detail) {
  constexpr double wall = 0.05, mouth = pi - 0.6, neck = 0.2;
  const auto on_ball = [](double radius, double angle) {
    return ProfilePoint{angle > 0 ? radius * sine(angle) : 0, -radius * cosine(angle)};
  };
  // From a place of the mouth down to the neck.
  const auto in_funnel = [](const ProfilePoint& from, double radius, double t) {
    return ProfilePoint{radius + (from.radius - radius) * (1 - t) * (1 - t), from.z * (1 - t)};
  };
  const std::uint32_t shell = scaled(24, detail), funnel = scaled(12, detail);
  std::vector<ProfilePoint> outside, inside;
  for (std::uint32_t k = 0; k < shell; ++k) {
    outside.push_back(on_ball(1, mouth * k / shell));
    inside.push_back(on_ball(1 - wall, (mouth - 2 * wall) * k / shell));
  }
  for (std::uint32_t k = 0; k <= funnel; ++k) {
    const double t = static_cast<double>(k) / funnel;
    outside.push_back(in_funnel(on_ball(1, mouth), neck, t));
    inside.push_back(in_funnel(on_ball(1 - wall, mouth - 2 * wall), neck + wall, t));
  }
  outside.insert(outside.end(), inside.rbegin(), inside.rend());
  std::vector<ProfilePoint> peanut;
  const std::uint32_t rings = scaled(12, detail);
  for (std::uint32_t k = 0; k <= rings; ++k) {
    const double angle = pi * k / rings, s = sine(angle);
    peanut.push_back({k % rings == 0 ? 0 : 0.2 * s * (1.5 - 0.8 * s * s), -0.25 * cosine(angle)});
  }
  return {lathe(outside, scaled(36, detail)), lathe(peanut, scaled(12, detail))};
}

PlanningScene spiral_tunnel(double detail) {
  const auto spiral = [](double t) {
    const double angle = 7 * pi * t, radius = 2.2 - t;
    return Vec3{radius * cosine(angle), radius * sine(angle), 2.8 * t - 1.4};
  };
  const auto corkscrew = [](double t) {
    return Vec3{0.12 * cosine(6 * pi * t), 0.12 * sine(6 * pi * t), 0.6 * t - 0.3};
  };
  const std::uint32_t segments = scaled(333, detail), sides = scaled(32, detail);
  std::vector<Ring> rings = circles_along(spiral, segments, sides, 0.3);
  const std::vector<Ring> inside = circles_along(spiral, segments, sides, 0.25);
  rings.insert(rings.end(), inside.rbegin(), inside.rend());
  return {loft(rings, Ends::joined),
          loft(circles_along(corkscrew, scaled(287, detail), scaled(10, detail), 0.035), Ends::capped)};
}

PlanningScene furnished_flat(double detail) {
  // Half of the detail goes into rooms, half into furniture.
  const double part = std::sqrt(detail);
  const auto [nx, ny] = grid_of(6 * part);
  Rng rng(flat_seed);
  std::vector<Mesh> parts = {boxes(rooms(nx, ny))};
  for (std::uint32_t i = 0; i < nx; ++i) {
    for (std::uint32_t j = 0; j < ny; ++j) {
      const Mesh around_middle = together({furniture(rng, part)}, at(-room_side / 2, -room_side / 2, 0));
      const double turn = pi / 2 * static_cast<double>(rng.below(4));
      parts.push_back(together({around_middle}, at((i + 0.5) * room_side, (j + 0.5) * room_side, 0, turn)));
    }
  }
  return {together(parts), piano(part)};
}

PlanningScene assembly(double detail) {
  const std::uint32_t n = scaled(3, detail);
  std::vector<Mesh> parts = plate(n, n, 0, 0.2, 32);
  for (Mesh& tile : plate(n, n, 1, 1.2, 32)) parts.push_back(std::move(tile));
  const Mesh through = bolt(1.5);
  const Mesh washer =
      loft({circle(24, 0.4, 1.3), circle(24, 0.4, 1.4), circle(24, 0.26, 1.4), circle(24, 0.26, 1.3)}, Ends::joined);
  const Mesh shaft = lathe({{0.2, -1}, {0.2, 0.4}, {0.4, 0.4}, {0.4, 0.8}, {0.2, 0.8}, {0.2, 2}}, 40);
  const Transform lying = {{{0, 0, 1}, {0.55, 0, 0}, {0, 0.55, 0}}, {}};
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const bool is_shaft = i % 3 == 1 && j % 3 == 1;
      parts.push_back(
          together(is_shaft ? std::vector{shaft} : std::vector{through, washer}, at(i + 0.5, j + 0.5, -0.1)));
      if (is_shaft) parts.push_back(together({together({shaft}, lying)}, at(i, j, 0.6)));
    }
  }
  std::vector<Mesh> link = plate(2, 1, 0, 0.2, 24);
  link.push_back(together({bolt(0.4)}, at(0.5, 0.5, -0.1)));
  const Transform smaller = {{{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.4}}, {-0.4, -0.2, -0.04}};
  return {together(parts), together(link, smaller)};
}

}  // namespace limber::scenes
