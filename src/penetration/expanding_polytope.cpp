// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "penetration/expanding_polytope.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/check.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"

namespace limber::penetration {

using geometry::next_corner;
using pair::DifferenceCorner;

void ExpandingPolytope::run(const pair::Simplex& simplex, double relative_error, QueryStats& stats) {
  const double enough = difference_.rounding();
  nearest_ = simplex;
  if (start(simplex)) {
    while (upper_ > enough) {
      ++stats.node_tests;
      const std::uint16_t face = nearest_face();
      const Vec3 normal = faces_[face].normal;
      const DifferenceCorner& near = corners_[faces_[face].corners[0]];
      difference_.start_at(near.a, near.b);
      const DifferenceCorner corner = farthest(normal);
      const double left = dot(normal, corner.way) - faces_[face].distance;
      if (left <= std::max(enough / 8, relative_error / (1 + relative_error) * upper_) || has(corner)) break;
      if (!grow(face, corner)) break;
    }
    prove_lower();
  }
  upper_ = std::max(0.0, -difference_.least_height(-normal_)) + difference_.rounding();
  lower_ = std::clamp(lower_ - difference_.rounding(), 0.0, upper_);
}

DifferenceCorner ExpandingPolytope::farthest(const Vec3& direction) {
  const DifferenceCorner corner = difference_.lowest(-direction);
  const double height = dot(direction, corner.way);
  if (height < upper_) upper_ = height, normal_ = direction;
  return corner;
}

/// Makes a first polytope. False if bodies only touch, or are flat, so that there is none.
bool ExpandingPolytope::start(const pair::Simplex& simplex) {
  const double little = difference_.rounding();
  for (std::uint32_t i = 0; i < simplex.count; ++i) add_corner(simplex.corners[i]);
  const auto at = [&](std::size_t i) { return corners_[i].way; };
  if (corner_count_ == 1) {
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      const DifferenceCorner corner = farthest(axis);
      if (upper_ <= little) return false;
      if (corner_count_ == 1) add_corner(corner);
    }
  }
  if (corner_count_ == 2) {
    const Vec3 edge = at(1) - at(0);
    if (max_abs(edge) == 0) return false;
    const DifferenceCorner corner = farthest(geometry::perpendicular_to(geometry::unit(edge)));
    if (upper_ <= little) return false;
    add_corner(corner);
  }
  if (corner_count_ == 3) {
    const Vec3 normal = cross(at(1) - at(0), at(2) - at(0));
    if (max_abs(normal) == 0) return false;
    const Vec3 up = geometry::unit(normal);
    add_corner(farthest(up));
    farthest(-up);
    if (upper_ <= little) return false;
  }
  const bool is_turned = dot(cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0)) > 0;
  if (is_turned) std::swap(corners_[0], corners_[1]);
  return make_faces({{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}});
}

std::uint16_t ExpandingPolytope::add_corner(const DifferenceCorner& corner) {
  corners_[corner_count_] = corner;
  return corner_count_++;
}

bool ExpandingPolytope::has(const DifferenceCorner& corner) const {
  return std::any_of(corners_.begin(), corners_.begin() + corner_count_,
                     [&](const DifferenceCorner& c) { return c.a == corner.a && c.b == corner.b; });
}

/// False if the face has no area.
bool ExpandingPolytope::make_face(Face& face, std::uint16_t p, std::uint16_t q, std::uint16_t r) const {
  const Vec3 &at_p = corners_[p].way, &at_q = corners_[q].way, &at_r = corners_[r].way;
  const Vec3 normal = cross(at_q - at_p, at_r - at_p);
  const double size = length(normal);
  if (!(size > 0)) return false;
  face.corners = {p, q, r}, face.is_seen = false;
  face.normal = normal * (1 / size);
  face.distance = std::min({dot(face.normal, at_p), dot(face.normal, at_q), dot(face.normal, at_r)});
  // The volume under the face is off by some 20 u times the product of three coordinates.
  const double reach = std::max({max_abs(at_p), max_abs(at_q), max_abs(at_r)});
  face.is_sure = face.distance * size > 0x1p-46 * reach * reach * reach;
  return true;
}

bool ExpandingPolytope::make_faces(std::initializer_list<std::array<std::uint16_t, 3>> faces) {
  for (const auto& [p, q, r] : faces) {
    if (!make_face(faces_[alive_count_], p, q, r)) return false;
    alive_[alive_count_] = alive_count_;
    ++alive_count_;
  }
  for (std::uint16_t f = most_faces; f-- > alive_count_;) free_[free_count_++] = f;
  for (std::uint16_t f = 0; f < alive_count_; ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint16_t from = faces_[f].corners[i], to = faces_[f].corners[next_corner[i]];
      for (std::uint16_t g = 0; g < alive_count_; ++g) {
        const auto& c = faces_[g].corners;
        for (std::size_t k = 0; k < 3; ++k) {
          if (c[k] == to && c[next_corner[k]] == from) faces_[f].next[i] = g;
        }
      }
    }
  }
  return true;
}

std::uint16_t ExpandingPolytope::nearest_face() const {
  return *std::min_element(alive_.begin(), alive_.begin() + alive_count_,
                           [&](std::uint16_t f, std::uint16_t g) { return faces_[f].distance < faces_[g].distance; });
}

/// Lists the faces that a corner sees, all connected, and the edges around them.
void ExpandingPolytope::find_horizon(std::uint16_t first, const Vec3& corner) {
  const double flat = difference_.rounding() / 4;
  seen_count_ = horizon_count_ = 0;
  faces_[first].is_seen = true, seen_[seen_count_++] = first;
  for (std::uint16_t i = 0; i < seen_count_; ++i) {
    for (const std::uint16_t g : faces_[seen_[i]].next) {
      if (faces_[g].is_seen || dot(faces_[g].normal, corner) <= faces_[g].distance + flat) continue;
      faces_[g].is_seen = true, seen_[seen_count_++] = g;
    }
  }
  for (std::uint16_t i = 0; i < seen_count_; ++i) {
    const Face& face = faces_[seen_[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      if (faces_[face.next[k]].is_seen) continue;
      horizon_[horizon_count_++] = {face.corners[k], face.corners[next_corner[k]], face.next[k]};
    }
  }
}

/// Replaces the faces that a corner sees, `first` among them, by those between it and the edges around them. False, and
/// nothing has changed, if that is no simple cone, or there is no room.
bool ExpandingPolytope::grow(std::uint16_t first, const DifferenceCorner& corner) {
  if (corner_count_ == most_corners) return false;
  find_horizon(first, corner.way);
  const auto undo = [&] {
    for (std::uint16_t i = 0; i < seen_count_; ++i) faces_[seen_[i]].is_seen = false;
    return false;
  };
  // Where rounding has it that all faces are seen, there is no edge around them.
  if (horizon_count_ < 3 || horizon_count_ > free_count_) return undo();
  constexpr std::uint16_t none = most_faces;
  std::array<std::uint16_t, most_corners> face_from;
  face_from.fill(none);
  corners_[corner_count_] = corner;
  for (std::uint16_t i = 0; i < horizon_count_; ++i) {
    const HorizonEdge& edge = horizon_[i];
    const std::uint16_t f = free_[free_count_ - 1 - i];
    if (face_from[edge.from] != none || !make_face(faces_[f], edge.from, edge.to, corner_count_)) return undo();
    face_from[edge.from] = f;
  }
  for (std::uint16_t i = 0; i < horizon_count_; ++i) {
    const HorizonEdge& edge = horizon_[i];
    const std::uint16_t f = face_from[edge.from], g = face_from[edge.to];
    LIMBER_ASSERT(g != none);
    faces_[f].next[0] = edge.beyond, faces_[f].next[1] = g, faces_[g].next[2] = f;
    Face& beyond = faces_[edge.beyond];
    for (std::size_t k = 0; k < 3; ++k) {
      if (beyond.corners[k] == edge.to && beyond.corners[next_corner[k]] == edge.from) beyond.next[k] = f;
    }
  }
  ++corner_count_;
  free_count_ = static_cast<std::uint16_t>(free_count_ - horizon_count_);
  const auto end =
      std::remove_if(alive_.begin(), alive_.begin() + alive_count_, [&](std::uint16_t f) { return faces_[f].is_seen; });
  alive_count_ = static_cast<std::uint16_t>(end - alive_.begin());
  for (std::uint16_t i = 0; i < horizon_count_; ++i) alive_[alive_count_++] = face_from[horizon_[i].from];
  for (std::uint16_t i = 0; i < seen_count_; ++i) free_[free_count_++] = seen_[i];
  return true;
}

void ExpandingPolytope::prove_lower() {
  const double least = faces_[nearest_face()].distance, most = least + difference_.rounding();
  // Of faces in one plane, one has the foot of the origin.
  nearest_.distance = std::numeric_limits<double>::infinity();
  for (std::uint16_t i = 0; i < alive_count_; ++i) {
    const Face& face = faces_[alive_[i]];
    if (face.distance > most) continue;
    pair::Simplex simplex;
    simplex.count = 3;
    for (std::size_t k = 0; k < 3; ++k) simplex.corners[k] = corners_[face.corners[k]];
    pair::reduce(simplex);
    if (simplex.distance < nearest_.distance) nearest_ = simplex;
  }
  const bool is_behind_all = std::all_of(alive_.begin(), alive_.begin() + alive_count_, [&](std::uint16_t f) {
    const auto& [p, q, r] = faces_[f].corners;
    return faces_[f].is_sure || geometry::orient3d(corners_[p].way, corners_[q].way, corners_[r].way, Vec3{}) <= 0;
  });
  if (is_behind_all) lower_ = least;
}

}  // namespace limber::penetration
