// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Half-facets and shells of Nef polyhedra [HachenbergerEtAl2007].
// Differs   No arrangement is built. What is asked is which kinds of cells exist, so one probe of each shell, and a
//           line along each cut of a half-facet that is crossed, is enough; docs/algorithms/solids.md has the proof.
//
// look() takes these steps: find_sides() notes of each pair of facets that meet on which sides of one the other is;
// join_neighbors() joins half-facets that nothing crosses into shells; one probe for each shell; then probes along the
// cuts of the half-facets that are crossed, by look_into_pieces().
#include "solid/shells.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "base/check.h"
#include "geometry/plane_sides.h"
#include "geometry/primitives.h"
#include "pair/parts.h"

namespace limber::solid {
namespace {

using geometry::next_corner;
using Signs = std::array<int, 3>;

/// On which sides of the plane of t the corners of another triangle are.
Signs sides_of_corners(const Triangle& other, const Triangle& t) {
  const geometry::PlaneSides plane(t.v0, t.v1, t.v2);
  return {plane.of(other.v0), plane.of(other.v1), plane.of(other.v2)};
}

/// The order of the meetings of a facet.
bool comes_before(const Meeting& m, FacetId other) { return m.other < other; }

/// Whether a part of a facet that crosses another one is on either side of it.
bool is_through(const Meeting& m) { return m.sides == (in_front | behind | across); }

bool has(const Signs& signs, int sign) { return std::find(signs.begin(), signs.end(), sign) != signs.end(); }

/// A corner that is off a plane, where no other one is on the same side of it.
std::size_t lone_corner(const Signs& signs) {
  const auto is_lone = [&](std::size_t i) {
    return signs[i] != 0 && std::count(signs.begin(), signs.end(), signs[i]) == 1;
  };
  return is_lone(0) ? 0 : is_lone(1) ? 1 : 2;
}

/// Whether two triangles meet the line in which their planes cross in intervals that overlap: by two volumes, as in
/// [GuigueDevillers2003]. Pre: each has a corner off the plane of the other one, alone on its side.
bool share_a_segment(const Triangle& a, const Signs& of_a, const Triangle& b, const Signs& of_b) {
  const std::size_t i = lone_corner(of_a), j = lone_corner(of_b);
  const std::size_t a1 = next_corner[i], a2 = next_corner[a1], b1 = next_corner[j], b2 = next_corner[b1];
  const bool turns_a = of_b[j] < 0, turns_b = of_a[i] < 0;
  return geometry::orient3d(a[i], a[turns_a ? a2 : a1], b[j], b[turns_b ? b2 : b1]) < 0 &&
         geometry::orient3d(a[i], a[turns_a ? a1 : a2], b[turns_b ? b1 : b2], b[j]) < 0;
}

/// The sides of t where another triangle that meets it is.
Sides sides_of(const Triangle& other, const Triangle& t) {
  const Signs signs = sides_of_corners(other, t);
  Sides sides = 0;
  if (has(signs, 1)) sides |= in_front;
  if (has(signs, -1)) sides |= behind;
  if (sides == 0) return 0;
  const bool is_one_sided = sides != (in_front | behind);
  if (is_one_sided && std::count(signs.begin(), signs.end(), 0) < 2) return sides;  // a corner at most touches
  const Signs own_signs = sides_of_corners(t, other);
  if (has(own_signs, 1) && has(own_signs, -1) && share_a_segment(t, own_signs, other, signs)) sides |= across;
  return sides;
}

/// The facets that each facet meets, and its copies, of both surfaces and between them, in their order. Incomplete if
/// the budget is spent.
mesh::VertexLists<Meeting> meetings_of(Cells& cells, const std::deque<TrianglePair>& contacts, FacetId count_of_a,
                                       FacetId count) {
  std::deque<TrianglePair> of_one[2];
  for (const pair::Side s : {pair::Side::a, pair::Side::b}) {
    const auto add = [&](const TrianglePair& p) { return of_one[pair::index(s)].push_back(p), true; };
    cells.meter.stop(pair::visit_placed_self_intersections(cells.placed(s), add, cells.budget, cells.meter.stats));
    // Two triangles of the same three vertices meet in all of them, but are no self-intersection. They are neighbors
    // across all three edges; that between the two smaller ids finds them.
    const MeshView& mesh = cells.model(s).mesh();
    const auto add_copies = [&](VertexId, std::span<const mesh::TriangleSide> sides) {
      const auto apex = [&](const mesh::TriangleSide& side) {
        return mesh.triangles[side.triangle][next_corner[next_corner[side.corner]]];
      };
      if (apex(sides[0]) == apex(sides[1]) && apex(sides[0]) > sides[0].high)
        add({sides[0].triangle, sides[1].triangle});
    };
    mesh::for_each_edge(mesh.triangles, mesh.positions.size(), add_copies,
                        [&](std::size_t k) { return !cells.meter.is_spent_at(k); });
  }
  using Lists = mesh::VertexLists<Meeting>;
  const Lists unordered(count, [&](const auto& add_item) {
    const auto add = [&](const std::deque<TrianglePair>& pairs, FacetId first, FacetId first_other) {
      for (std::size_t i = 0; i < pairs.size() && !cells.meter.is_spent_at(i); ++i) {
        const FacetId f = first + pairs[i].a, other = first_other + pairs[i].b;
        add_item(f, {other, 0}), add_item(other, {f, 0});
      }
    };
    add(contacts, 0, count_of_a), add(of_one[0], 0, 0), add(of_one[1], count_of_a, count_of_a);
  });
  // Who meets f has f in its list. This takes steps that can be counted, unlike sorting.
  return Lists(count, [&](const auto& add_item) {
    std::size_t i = 0;
    for (FacetId f = 0; f < count && !cells.meter.is_spent_at(f); ++f) {
      for (const Meeting& m : unordered.of(f)) {
        if (cells.meter.is_spent_at(++i)) return;
        add_item(m.other, {f, 0});
      }
    }
  });
}

}  // namespace

Shells::Shells(Cells& cells, const std::deque<TrianglePair>& contacts)
    : cells_(cells),
      count_of_a_(static_cast<FacetId>(cells.model(pair::Side::a).mesh().triangles.size())),
      count_(count_of_a_ + static_cast<FacetId>(cells.model(pair::Side::b).mesh().triangles.size())),
      meetings_(meetings_of(cells, contacts, count_of_a_, count_)),
      is_degenerate_(count_),
      is_copy_(count_),
      cut_halves_(count_),
      shells_(std::size_t{2} * count_, cells.meter) {}

Triangle Shells::triangle(FacetId f) const {
  LIMBER_ASSERT(f < count_);
  const point::PlacedModel& model = cells_.model(side_of(f));
  return model.triangle(model.mesh().triangles[f < count_of_a_ ? f : f - count_of_a_]);
}

Sides Shells::sides_between(FacetId f, FacetId other) const {
  const std::span<const Meeting> meetings = meetings_.of(f);
  const auto found = std::lower_bound(meetings.begin(), meetings.end(), other, comes_before);
  return found == meetings.end() || found->other != other ? Sides{0} : found->sides;
}

void Shells::find_sides() {
  for (FacetId f = 0; f < count_ && !cells_.meter.is_spent_at(f); ++f) {
    const Triangle t = triangle(f);
    is_degenerate_[f] = geometry::are_collinear(t.v0, t.v1, t.v2);
  }
  bool is_same = true, is_opposite = true;
  std::size_t i = 0;
  for (FacetId f = 0; f < count_; ++f) {
    const std::span<Meeting> meetings = meetings_.of(f);
    if (cells_.meter.is_spent_at(f)) return;
    if (is_degenerate_[f]) continue;  // a triangle without area keeps no cells apart
    const Triangle t = triangle(f);
    WindingNumbers jump{};  // by how much they are larger behind f and its copies than in front of them
    jump[pair::index(side_of(f))] = 1;
    for (Meeting& m : meetings) {
      if (cells_.meter.is_spent_at(++i)) return;
      if (is_degenerate_[m.other]) continue;
      const Triangle other = triangle(m.other);
      m.sides = sides_of(other, t);
      if (m.sides == 0) {
        const int copy = is_copy(other, t);
        jump[pair::index(side_of(m.other))] += copy;
        is_copy_[f] = is_copy_[f] || (copy != 0 && m.other < f);
      }
      if ((m.sides & across) != 0) cut_halves_[f] |= m.sides & (in_front | behind);
      if (is_through(m)) cut_halves_[f] |= across;
    }
    is_same = is_same && jump[0] == jump[1], is_opposite = is_opposite && jump[0] == -jump[1];
  }
  // If they are equal everywhere, but for the sign, no cell is in one solid alone.
  if (is_same || is_opposite) cells_.note_missing(in_a_alone), cells_.note_missing(in_b_alone);
}

bool Shells::cuts_wedge(FacetId f, FacetId neighbor, Sides half, bool is_convex, const Segment& edge) const {
  std::size_t i = 0;
  for (const Meeting& m : meetings_.of(f)) {
    if (cells_.meter.is_spent_at(++i)) return true;
    const bool is_there = (m.sides & half) != 0, is_at_neighbor = (sides_between(neighbor, m.other) & half) != 0;
    if (is_convex ? !(is_there && is_at_neighbor) : !(is_there || is_at_neighbor)) continue;
    const Triangle t = triangle(m.other);
    const geometry::PlaneSides plane(t.v0, t.v1, t.v2);
    if (plane.of(edge.p0) == 0 && plane.of(edge.p1) == 0) return true;
  }
  return false;
}

void Shells::join_neighbors(pair::Side s, FacetId first) {
  const MeshView& mesh = cells_.model(s).mesh();
  std::size_t i = 0;
  const auto join = [&](VertexId, std::span<const mesh::TriangleSide> sides) {
    LIMBER_ASSERT(sides.size() == 2);
    if (cells_.meter.is_spent_at(4 * ++i)) return;
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
    for (const Sides half : {in_front, behind}) {
      if (((cut_halves_[f] | cut_halves_[neighbor]) & half) != 0) continue;
      const bool is_convex = side == (half == in_front ? 1 : -1);
      if (cuts_wedge(f, neighbor, half, is_convex, edge)) continue;
      shells_.unite(half_facet(f, half), half_facet(neighbor, half));
    }
  };
  mesh::for_each_edge(mesh.triangles, mesh.positions.size(), join,
                      [&](std::size_t k) { return !cells_.meter.is_spent_at(k); });
}

void Shells::look() {
  find_sides();
  if (!cells_.are_all_known() && !cells_.is_stopped()) join_neighbors(pair::Side::a, 0);
  if (!cells_.are_all_known() && !cells_.is_stopped()) join_neighbors(pair::Side::b, count_of_a_);
  for (FacetId f = 0; f < count_ && !cells_.are_all_known() && !cells_.meter.is_spent_at(f); ++f) {
    if (is_degenerate_[f]) continue;
    for (const Sides half : {in_front, behind}) {
      const std::size_t i = half_facet(f, half);
      // Of a half-facet that is cut, it finds the piece at a corner, where no cut begins if others only touch.
      if ((cut_halves_[f] & half) == 0 && shells_.find(i) != i) continue;
      const Triangle t = triangle(f);
      cells_.look(CornerProbe(t, 0, *direction_off(t, half == in_front ? 1 : -1)));
    }
  }
  for (FacetId f = 0; f < count_ && !cells_.are_all_known() && !cells_.meter.is_spent_at(f); ++f) {
    if (cut_halves_[f] != 0 && !is_copy_[f]) look_into_pieces(f);
  }
}

void Shells::look_into_pieces(FacetId f) {
  for (const Meeting& m : meetings_.of(f)) {
    if (cells_.are_all_known() || cells_.meter.is_spent()) return;
    if ((m.sides & across) != 0 && !is_copy_[m.other]) look_along_cut(f, m);
  }
}

bool Shells::is_looked_into_before(FacetId x, FacetId f) const {
  const Sides of_x = cut_halves_[x] & across, of_f = cut_halves_[f] & across;
  return of_x != of_f ? of_x != 0 : x < f;
}

void Shells::look_along_cut(FacetId f, const Meeting& cutter) {
  const FacetId x = cutter.other;
  const Sides halves = cut_halves_[x] & (in_front | behind);
  if (halves == 0 || is_looked_into_before(x, f)) return;
  Cut cut(triangle(f), side_of(f), triangle(x), side_of(x));
  add_crossers(cut, f, x);
  if (!is_through(cutter)) return cut.look(cells_, (cutter.sides & in_front) != 0 ? 1 : -1);
  if (!cut.is_shared()) return cut.look_everywhere(cells_);
  for (const int side : {1, -1}) cut.look(cells_, side);
  Cut turned(triangle(x), side_of(x), triangle(f), side_of(f));
  add_crossers(turned, x, f);
  for (const int side : {1, -1}) turned.look(cells_, side);
}

void Shells::add_crossers(Cut& cut, FacetId f, FacetId other) const {
  std::span<const Meeting> few = meetings_.of(f);
  std::span<const Meeting> many = meetings_.of(other);
  if (few.size() > many.size()) std::swap(few, many);
  auto next = many.begin();
  for (const Meeting& m : few) {
    if (cells_.meter.is_spent()) return;
    next = std::lower_bound(next, many.end(), m.other, comes_before);
    if (next == many.end()) return;
    if (next->other == m.other && !is_degenerate_[m.other]) cut.add(triangle(m.other), side_of(m.other));
  }
}

}  // namespace limber::solid
