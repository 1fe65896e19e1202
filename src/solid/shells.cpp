// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Half-facets and shells of Nef polyhedra [HachenbergerEtAl2007].
// Differs   No arrangement is built. What is asked is which kinds of cells exist, so one probe of each shell, and of
//           each piece of a half-facet that is crossed, is enough; docs/algorithms/solids.md has the proof.
#include "solid/shells.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/check.h"
#include "geometry/collinear.h"
#include "geometry/plane_sides.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "mesh/adjacency.h"
#include "pair/placed_self_intersections.h"

namespace limber::solid {
namespace {

using geometry::next_corner;
using Signs = std::array<int, 3>;

/// On which sides of the plane of t the corners of another triangle are.
Signs sides_of_corners(const Triangle& other, const Triangle& t) {
  const geometry::PlaneSides plane(t.v0, t.v1, t.v2);
  return {plane.of(other.v0), plane.of(other.v1), plane.of(other.v2)};
}

bool has(const Signs& signs, int sign) { return std::find(signs.begin(), signs.end(), sign) != signs.end(); }

/// Whether two triangles have no point in common but a corner of both.
bool meet_in_a_corner(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] == b[j]) return !geometry::meet_beyond_shared_corner(a, i, b, j);
    }
  }
  return false;
}

/// The points in which the edges of t cross a plane, given the sides of its corners. An edge in the plane has its ends.
std::vector<ExactPoint> edge_crossings(const Triangle& t, const Triangle& plane, const Signs& sides, int unit) {
  std::vector<ExactPoint> points;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = next_corner[i];
    if (sides[i] == 0) points.emplace_back(t[i], unit);
    if (sides[i] * sides[k] >= 0) continue;
    points.push_back(*crossing(ExactPoint(t[i], unit), ExactPoint(t[k], unit), plane));
  }
  return points;
}

bool is_near(const ExactPoint& p, const Triangle& t) {
  const double off = p.rounding();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({t.v0[k], t.v1[k], t.v2[k]});
    if (!(p.rounded()[k] >= low - off && p.rounded()[k] <= high + off)) return false;
  }
  return true;
}

}  // namespace

Shells::Shells(Cells& cells, std::span<const TrianglePair> contacts)
    : cells_(cells),
      count_of_a_(cells.model(pair::Side::a).mesh().triangles.size()),
      count_(count_of_a_ + cells.model(pair::Side::b).mesh().triangles.size()),
      is_degenerate_(count_),
      cut_halves_(count_),
      shells_(2 * count_) {
  for (const TrianglePair& c : contacts) {
    meetings_.push_back({c.a, count_of_a_ + c.b});
    meetings_.push_back({count_of_a_ + c.b, c.a});
  }
  find_meetings(pair::Side::a, 0);
  find_meetings(pair::Side::b, count_of_a_);
  std::sort(meetings_.begin(), meetings_.end());
  begin_.resize(count_ + 1);
  for (const Meeting& m : meetings_) ++begin_[m.facet + 1];
  for (FacetId f = 0; f < count_; ++f) begin_[f + 1] += begin_[f];
  LIMBER_ASSERT(begin_[count_] == meetings_.size());
}

/// Of one surface with itself.
void Shells::find_meetings(pair::Side s, FacetId first) {
  const auto add = [&](const TrianglePair& p) {
    meetings_.push_back({first + p.a, first + p.b});
    meetings_.push_back({first + p.b, first + p.a});
    return true;
  };
  pair::visit_placed_self_intersections(cells_.placed(s), add, cells_.stats);
}

Triangle Shells::triangle(FacetId f) const {
  LIMBER_ASSERT(f < count_);
  const point::PlacedModel& model = cells_.model(side_of(f));
  return model.triangle(model.mesh().triangles[f < count_of_a_ ? f : f - count_of_a_]);
}

std::span<const Meeting> Shells::meetings_of(FacetId f) const {
  return std::span(meetings_).subspan(begin_[f], begin_[f + 1] - begin_[f]);
}

Shells::Reach Shells::reach(FacetId f, FacetId other) const {
  const std::span<const Meeting> meetings = meetings_of(f);
  const auto found = std::lower_bound(meetings.begin(), meetings.end(), Meeting{f, other});
  if (found == meetings.end() || found->other != other) return 0;
  return reaches_[begin_[f] + static_cast<std::size_t>(found - meetings.begin())];
}

Shells::Reach Shells::reach_of(const Triangle& other, const Triangle& t) const {
  const Signs sides = sides_of_corners(other, t);
  Reach reach = 0;
  if (has(sides, 1)) reach |= in_front;
  if (has(sides, -1)) reach |= behind;
  if (reach == 0) return 0;
  const bool is_one_sided = reach != (in_front | behind);
  if (is_one_sided && std::count(sides.begin(), sides.end(), 0) < 2) return reach;  // a corner at most touches
  const Signs own_sides = sides_of_corners(t, other);
  if (has(own_sides, 1) && has(own_sides, -1) && !meet_in_a_corner(t, other)) reach |= across;
  return reach;
}

void Shells::find_reaches() {
  for (FacetId f = 0; f < count_; ++f) {
    const Triangle t = triangle(f);
    is_degenerate_[f] = geometry::are_collinear(t.v0, t.v1, t.v2);
  }
  reaches_.reserve(meetings_.size());
  for (const Meeting& m : meetings_) {
    // A triangle without area keeps no cells apart.
    const bool counts = !is_degenerate_[m.facet] && !is_degenerate_[m.other];
    const Reach reach = counts ? reach_of(triangle(m.other), triangle(m.facet)) : Reach{0};
    reaches_.push_back(reach);
    if ((reach & across) != 0) cut_halves_[m.facet] |= reach & (in_front | behind);
  }
}

bool Shells::is_between(FacetId f, FacetId neighbor, Reach half, bool is_convex, const Segment& edge) const {
  const std::span<const Meeting> meetings = meetings_of(f);
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    const FacetId other = meetings[i].other;
    const bool reaches = (reaches_[begin_[f] + i] & half) != 0;
    const bool reaches_from_neighbor = (reach(neighbor, other) & half) != 0;
    if (is_convex ? !(reaches && reaches_from_neighbor) : !(reaches || reaches_from_neighbor)) continue;
    const Triangle t = triangle(other);
    const geometry::PlaneSides plane(t.v0, t.v1, t.v2);
    if (plane.of(edge.p0) == 0 && plane.of(edge.p1) == 0) return true;
  }
  return false;
}

void Shells::join_neighbors(pair::Side s, FacetId first) {
  const MeshView& mesh = cells_.model(s).mesh();
  const auto join = [&](VertexId, std::span<const mesh::TriangleSide> sides) {
    LIMBER_ASSERT(sides.size() == 2);
    const FacetId f = first + sides[0].triangle, neighbor = first + sides[1].triangle;
    if (is_degenerate_[f] || is_degenerate_[neighbor]) return;
    const Triangle t = triangle(f);
    const std::size_t corner = sides[0].corner;
    const Segment edge{t[corner], t[next_corner[corner]]};
    const Vec3 apex = triangle(neighbor)[(sides[1].corner + 2) % 3], own_apex = t[(corner + 2) % 3];
    const int side = geometry::orient3d(t.v0, t.v1, t.v2, apex);
    if (side == 0) {  // flat, or folded back
      const std::size_t axis = *geometry::faithful_axis(t.v0, t.v1, t.v2);
      const auto side_of_edge = [&](const Vec3& p) { return geometry::orient2d(edge.p0, edge.p1, p, axis); };
      if (side_of_edge(apex) == side_of_edge(own_apex)) return;
    }
    for (const Reach half : {in_front, behind}) {
      if (((cut_halves_[f] | cut_halves_[neighbor]) & half) != 0) continue;
      const bool is_convex = side == (half == in_front ? 1 : -1);
      if (is_between(f, neighbor, half, is_convex, edge)) continue;
      const std::size_t back = half == in_front ? 0 : 1;
      shells_.unite(2 * f + back, 2 * neighbor + back);
    }
  };
  mesh::for_each_edge(mesh.triangles, mesh.positions.size(), join);
}

void Shells::look() {
  find_reaches();
  join_neighbors(pair::Side::a, 0);
  join_neighbors(pair::Side::b, count_of_a_);
  const auto look_at = [&](bool at_cut, const auto& look) {
    for (FacetId f = 0; f < count_ && !cells_.are_all_known(); ++f) {
      if (is_degenerate_[f]) continue;
      for (const Reach half : {in_front, behind}) {
        if (((cut_halves_[f] & half) != 0) == at_cut) look(f, half);
      }
    }
  };
  look_at(false, [&](FacetId f, Reach half) {
    const std::size_t i = 2 * f + (half == in_front ? 0 : 1);
    if (shells_.find(i) != i) return;
    const Triangle t = triangle(f);
    cells_.look(CornerProbe(t, 0, *direction_off(t, half == in_front ? 1 : -1)));
  });
  look_at(true, [&](FacetId f, Reach half) { look_into_pieces(f, half); });
}

void Shells::look_into_pieces(FacetId f, Reach half) {
  const Triangle t = triangle(f);
  const AxisDirection off = *direction_off(t, half == in_front ? 1 : -1);
  cells_.look(CornerProbe(t, 0, off));  // where none of those that may cross does
  std::vector<FacetId> cutters;         // ascending
  const std::span<const Meeting> meetings = meetings_of(f);
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    const Reach reach = reaches_[begin_[f] + i];
    if ((reach & across) != 0 && (reach & half) != 0) cutters.push_back(meetings[i].other);
  }
  for (const FacetId cutter : cutters) {
    if (cells_.are_all_known()) return;
    look_beside_cut(t, cutter, cutters, off);
  }
}

void Shells::look_beside_cut(const Triangle& t, FacetId cutter, std::span<const FacetId> cutters,
                             const AxisDirection& off) {
  const Triangle x = triangle(cutter);
  const Signs of_t = sides_of_corners(t, x);
  const int unit = CommonUnit().include(t).include(x).exponent();
  // The cut is on a chord of t. Its pieces begin where the chord does, where the cutter does, or at another cut.
  const std::vector<ExactPoint> chord = edge_crossings(t, x, of_t, unit);
  LIMBER_ASSERT(chord.size() == 2);
  std::vector<ExactPoint> bases = edge_crossings(x, t, sides_of_corners(x, t), unit);
  bases.push_back(chord[0]);
  for (const Meeting& m : meetings_of(cutter)) {
    if (!std::binary_search(cutters.begin(), cutters.end(), m.other)) continue;
    if (const auto base = crossing(chord[0], chord[1], triangle(m.other))) bases.push_back(*base);
  }
  const IntegerVec along = direction(chord[0], chord[1]);
  for (auto base = bases.begin(); base != bases.end(); ++base) {
    if (!is_near(*base, t) || std::find(bases.begin(), base, *base) != base) continue;
    for (const int side : {1, -1}) {
      const auto corner = static_cast<std::size_t>(std::find(of_t.begin(), of_t.end(), side) - of_t.begin());
      cells_.look(CutProbe(*base, along, t[corner], off));
    }
  }
}

}  // namespace limber::solid
