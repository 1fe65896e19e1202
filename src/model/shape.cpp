// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The factories of Shape: each checks its arguments, and makes the mesh of the core, around which the radius is swept.
// Those that compute nothing but negations do without the default floating-point environment. u is 2^-53.
#include "limber/shapes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/local_frame.h"
#include "model/convex_hull.h"
#include "model/convex_parts.h"

namespace limber {
namespace {

[[noreturn]] void refuse(const char* function, const std::string& text) {
  base::throw_invalid_argument((std::string("limber::Shape::") + function + ": " + text).c_str());
}

void check(bool holds, const char* function, const char* text) {
  if (!holds) refuse(function, text);
}

void check_size(double size, const char* function, const std::string& name) {
  if (!(size >= 0 && size <= max_coordinate)) refuse(function, name + " must be at least 0 and at most 2^200");
}

bool is_in_range(const Vec3& point) { return is_finite(point) && max_abs(point) <= max_coordinate; }

void check_point(const Vec3& point, const char* function, const std::string& name) {
  if (!is_in_range(point)) refuse(function, name + " has a coordinate that is not finite, or above 2^200");
}

void check_points(std::span<const Vec3> points, const char* function) {
  check(!points.empty(), function, "there must be a point");
  check(points.size() < no_id, function, "there are more points than ids can count");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_in_range(points[i])) check_point(points[i], function, "point " + std::to_string(i));
  }
}

/// The mesh of a core, whose arrays come from the factories.
Mesh core_mesh(std::vector<Vec3> positions, std::vector<Corners> triangles, const char* function) {
  Result<Mesh> mesh = Mesh::create(std::move(positions), std::move(triangles));
  if (!mesh) refuse(function, mesh.error().text);
  return std::move(mesh).value();
}

/// The corners of a box. Corner i has the high x if bit 0 of i is set, and so on.
std::vector<Vec3> box_corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (unsigned i = 0; i < 8; ++i) {
    corners.push_back({((i & 1) != 0 ? high : low).x, ((i & 2) != 0 ? high : low).y, ((i & 4) != 0 ? high : low).z});
  }
  return corners;
}

/// The triangles between these corners; normals point outward.
std::vector<Corners> box_triangles() {
  return {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
}

/// The direction of a vector that is not 0, and two directions across it, which make a right-handed frame.
std::array<Vec3, 3> frame_of(const Vec3& v) {
  const Vec3 along = geometry::unit(v), first = geometry::perpendicular_to(along);
  return {along, first, cross(along, first)};
}

// Most sides of the prism around a cylinder: 262 144 triangles. A guess: more are refused.
constexpr std::uint32_t most_sides = 65'536;
// Room for rounding, as a part of a corner's distance from the axis. It leaves 32 u, of which are needed
//   8 u  for that distance: a sum, a cosine, the division by it, a product;
//   5 u  for the way out to a corner: a cosine and a sine, products and a sum;
//   8 u  for angles. One is off by up to 10 u, so one between two corners by 21 u. A side moves inward by half of that
//        times tan(pi / sides), 0.73 from five sides on; three or four have angles that are off by less.
constexpr double prism_room = 1 + 0x1p-48;
// Room for rounding, as a part of coordinates and the radius, sideways and along. It leaves 16 u, of which are needed
//   5 u sideways, for the length of the axes of the frame; 8 u along, for the direction of both that are across;
//   4 u either way, for the coordinates of a corner, which are rounded twice.
constexpr double prism_rounding = 0x1p-49;

/// By how much a regular polygon's corners are farther from its center than its sides, as a part of the latter.
double excess(std::uint32_t sides) {
  const double half = std::sin(std::numbers::pi / (2.0 * sides));
  return 2 * half * half / std::cos(std::numbers::pi / sides);
}

/// The fewest sides of a polygon around a circle whose corners are at most `error` away from it.
std::uint32_t sides_within(double error, double radius) {
  std::uint32_t low = 3, high = most_sides;
  check(excess(high) * radius <= error, "cylinder", "max_error is so small that more than 65 536 sides are needed");
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (excess(middle) * radius <= error)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace

Shape::Shape(Mesh core, double radius, bool is_solid, bool is_convex, double deviation)
    : model_(std::make_unique<const Model>(std::move(core))),
      parts_(is_convex ? std::make_shared<const model::ConvexParts>(*model_) : nullptr),
      radius_(radius),
      deviation_(deviation),
      is_solid_(is_solid) {
  LIMBER_ASSERT(radius >= 0 && radius <= max_coordinate && deviation >= 0);
  LIMBER_ASSERT(!is_solid || model_->mesh().is_closed());
}

Shape Shape::sphere(double radius) {
  check_size(radius, "sphere", "radius");
  return {core_mesh({Vec3{}}, {{0, 0, 0}}, "sphere"), radius, false, true};
}

Shape Shape::capsule(const Vec3& start, const Vec3& end, double radius) {
  check_point(start, "capsule", "start");
  check_point(end, "capsule", "end");
  check_size(radius, "capsule", "radius");
  return {core_mesh({start, end}, {{0, 1, 1}}, "capsule"), radius, false, true};
}

Shape Shape::box(const Vec3& half_extents, double radius) {
  for (std::size_t k = 0; k < 3; ++k) check_size(half_extents[k], "box", "each of the half extents");
  check_size(radius, "box", "radius");
  return {core_mesh(box_corners(-half_extents, half_extents), box_triangles(), "box"), radius, true, true};
}

Shape Shape::cylinder(const Vec3& start, const Vec3& end, double radius, double max_error) {
  const base::DefaultFloatEnvironment environment;
  check_point(start, "cylinder", "start");
  check_point(end, "cylinder", "end");
  check_size(radius, "cylinder", "radius");
  check(start != end && radius > 0, "cylinder", "start and end must differ, and the radius must be above 0");
  check_size(max_error, "cylinder", "max_error");
  check(max_error > 0, "cylinder", "max_error must be above 0");
  const std::uint32_t sides = sides_within(max_error, radius);
  const auto [along, across, up] = frame_of(end - start);
  // The prism is larger by what rounding may move a corner by.
  const double rounding = prism_rounding * (max_abs(start) + max_abs(end) + radius);
  const double to_corner = (radius + rounding) / std::cos(std::numbers::pi / sides) * prism_room;
  const Vec3 bottom = start - rounding * along, top = end + rounding * along;
  std::vector<Vec3> positions{bottom, top};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vec3 out = to_corner * (std::cos(angle) * across + std::sin(angle) * up);
    positions.insert(positions.end(), {bottom + out, top + out});
    const std::uint32_t here = 2 + 2 * i, next = 2 + 2 * ((i + 1) % sides);
    triangles.insert(triangles.end(), {{0, next, here}, {1, here + 1, next + 1}});
    triangles.insert(triangles.end(), {{here, next, next + 1}, {here, next + 1, here + 1}});
  }
  // A corner is off by the rounding, sideways and along, and its end was moved out by as much: three times at most.
  return {core_mesh(std::move(positions), std::move(triangles), "cylinder"), 0, true, true,
          (to_corner - radius + 3 * rounding) * prism_room};
}

Shape Shape::half_space(const Vec3& normal, double offset, double half_extent) {
  const base::DefaultFloatEnvironment environment;
  check_point(normal, "half_space", "normal");
  check(normal != Vec3{}, "half_space", "the normal must not be 0");
  check_size(std::abs(offset), "half_space", "the size of the offset");
  check_size(half_extent, "half_space", "half_extent");
  check(half_extent > 0, "half_space", "half_extent must be above 0");
  const auto [along, across, up] = frame_of(normal);
  std::vector<Vec3> corners =
      box_corners({-half_extent, -half_extent, offset - 2 * half_extent}, {half_extent, half_extent, offset});
  for (Vec3& corner : corners) corner = corner.x * across + corner.y * up + corner.z * along;
  return {core_mesh(std::move(corners), box_triangles(), "half_space"), 0, true, true};
}

Shape Shape::convex_hull(std::span<const Vec3> points, double radius) {
  const base::DefaultFloatEnvironment environment;
  check_points(points, "convex_hull");
  check_size(radius, "convex_hull", "radius");
  model::Hull hull = model::convex_hull(points);
  return {core_mesh(std::move(hull.positions), std::move(hull.triangles), "convex_hull"), radius, hull.is_solid, true};
}

Shape Shape::height_field(std::span<const double> heights, std::size_t columns, std::size_t rows, double step_x,
                          double step_y, double radius) {
  const base::DefaultFloatEnvironment environment;
  check_size(step_x, "height_field", "step_x");
  check_size(step_y, "height_field", "step_y");
  check(step_x > 0 && step_y > 0, "height_field", "step_x and step_y must be above 0");
  check_size(radius, "height_field", "radius");
  // By a division: a product might wrap around.
  check(columns >= 2 && rows >= 2 && heights.size() % columns == 0 && heights.size() / columns == rows, "height_field",
        "there must be two columns and rows or more, and columns * rows heights");
  check(heights.size() < no_id, "height_field", "there are more heights than ids can count");
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!is_in_range({0, 0, heights[i]}))
      refuse("height_field", "height " + std::to_string(i) + " is not finite, or above 2^200 in size");
    const std::size_t column = i % columns, row = i / columns;
    positions.push_back({static_cast<double>(column) * step_x, static_cast<double>(row) * step_y, heights[i]});
    if (column + 1 == columns || row + 1 == rows) continue;
    const auto here = static_cast<VertexId>(i), above = static_cast<VertexId>(i + columns);
    triangles.insert(triangles.end(), {{here, here + 1, above + 1}, {here, above + 1, above}});
  }
  return {core_mesh(std::move(positions), std::move(triangles), "height_field"), radius, false, false};
}

Shape Shape::point_cloud(std::span<const Vec3> points, double radius) {
  check_points(points, "point_cloud");
  check_size(radius, "point_cloud", "radius");
  std::vector<Corners> triangles;
  for (VertexId i = 0; i < points.size(); ++i) triangles.push_back({i, i, i});
  return {core_mesh({points.begin(), points.end()}, std::move(triangles), "point_cloud"), radius, false, false};
}

}  // namespace limber
