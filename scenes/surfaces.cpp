// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/surfaces.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "scenes/scenes.h"

namespace limber::scenes {

Mesh boxes(const std::vector<Box>& all) {
  constexpr Corners faces[] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                               {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (const auto& [low, high] : all) {
    const auto first = static_cast<VertexId>(positions.size());
    for (const Corners& c : faces) triangles.push_back({first + c[0], first + c[1], first + c[2]});
    for (unsigned corner = 0; corner < 8; ++corner) {
      positions.push_back(
          {(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y, (corner & 4) != 0 ? high.z : low.z});
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Mesh together(const std::vector<Mesh>& parts, const Transform& pose) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (const Mesh& part : parts) {
    const auto first = static_cast<VertexId>(positions.size());
    for (const Vec3& p : part.positions()) positions.push_back(pose(p));
    for (const Corners& c : part.triangles()) triangles.push_back({first + c[0], first + c[1], first + c[2]});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Mesh loft(const std::vector<Ring>& rings, Ends ends) {
  const bool joined = ends == Ends::joined;
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  std::vector<VertexId> first;
  for (const Ring& ring : rings) {
    first.push_back(static_cast<VertexId>(positions.size()));
    positions.insert(positions.end(), ring.begin(), ring.end());
  }
  const std::size_t last = rings.size() - 1, sides = std::max(rings[0].size(), rings[1].size());
  const auto is_tip = [&](std::size_t ring) { return rings[ring].size() == 1; };
  const auto id = [&](std::size_t ring, std::size_t i) {
    return first[ring] + static_cast<VertexId>(i % rings[ring].size());
  };
  for (std::size_t from = 0; from < (joined ? rings.size() : last); ++from) {
    const std::size_t to = from == last ? 0 : from + 1;
    for (std::size_t i = 0; i < sides; ++i) {
      if (!is_tip(from)) triangles.push_back({id(from, i), id(from, i + 1), id(to, i + 1)});
      if (!is_tip(to)) triangles.push_back({id(from, i), id(to, i + 1), id(to, i)});
    }
  }
  for (std::size_t i = 1; !joined && i + 1 < sides; ++i) {
    if (!is_tip(0)) triangles.push_back({id(0, 0), id(0, i + 1), id(0, i)});
    if (!is_tip(last)) triangles.push_back({id(last, 0), id(last, i), id(last, i + 1)});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Ring circle(std::uint32_t sides, double radius, double z, double angle) {
  Ring ring;
  for (std::uint32_t i = 0; i < (radius > 0 ? sides : 1); ++i) {
    const double phi = angle + 2 * std::numbers::pi * i / sides;
    ring.push_back({radius * cosine(phi), radius * sine(phi), z});
  }
  return ring;
}

std::vector<Ring> circles_along(const std::function<Vec3(double t)>& curve, std::uint32_t segments, std::uint32_t sides,
                                double radius, Ends ends) {
  constexpr double step = 0x1p-12;
  const Ring unit = circle(sides, 1, 0);
  std::vector<Ring> rings;
  for (std::uint32_t k = 0; k < segments + (ends == Ends::capped ? 1 : 0); ++k) {
    const double t = static_cast<double>(k) / segments;
    const Vec3 along = curve(t + step) - curve(t - step), beside = cross({0, 0, 1}, along), up = cross(along, beside);
    const Vec3 x = beside * (radius / length(beside)), y = up * (radius / length(up));
    Ring ring;
    for (const Vec3& p : unit) ring.push_back(curve(t) + x * p.x + y * p.y);
    rings.push_back(std::move(ring));
  }
  return rings;
}

Mesh lathe(const std::vector<ProfilePoint>& profile, std::uint32_t sides, std::uint32_t pieces) {
  std::vector<Ring> rings = {circle(sides, profile[0].radius, profile[0].z)};
  for (std::size_t k = 1; k < profile.size(); ++k) {
    const auto &a = profile[k - 1], &b = profile[k];
    for (std::uint32_t i = 1; i < pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      rings.push_back(circle(sides, a.radius + t * (b.radius - a.radius), a.z + t * (b.z - a.z)));
    }
    rings.push_back(circle(sides, b.radius, b.z));
  }
  return loft(rings, Ends::capped);
}

}  // namespace limber::scenes
