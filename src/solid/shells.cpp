// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// 1. meetings_of() lists for each facet the others that it meets, of both surfaces.
// 2. find_sides() finds on which sides of the facet each of them is, and whether it crosses the facet in a cut.
// 3. join_neighbors() joins half-facets into shells: of neighbors across an edge, if no facet crosses them and none is
//    between them there.
// 4. look_into_shells() makes one probe for each shell, whose half-facets all border one cell. A half-facet that is
//    crossed is a shell of its own.
// 5. look_along_cuts() looks into the cells that pieces of crossed half-facets border, by lines along cuts. It leaves
//    cuts out whose cells step 4 or other cuts look into.
//
// Based on  Half-facets and shells of Nef polyhedra [HachenbergerEtAl2007].
// Differs   No arrangement is built, as only the kinds of cells are asked for; docs/algorithms/solids.md has the proof.
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

bool has(const Signs& signs, int sign) { return std::find(signs.begin(), signs.end(), sign) != signs.end(); }

/// A corner that is off a plane, where no other one is on the same side of it. Pre: there is one.
std::size_t lone_corner(const Signs& signs) {
  const auto is_lone = [&](std::size_t i) {
    return signs[i] != 0 && std::count(signs.begin(), signs.end(), signs[i]) == 1;
  };
  LIMBER_ASSERT(is_lone(0) || is_lone(1) || is_lone(2));
  return is_lone(0) ? 0 : is_lone(1) ? 1 : 2;
}

/// Whether two triangles meet the line in which their planes cross in intervals that overlap, as in
/// [GuigueDevillers2003]. Pre: each has a lone corner off the plane of the other one.
bool share_a_segment(const Triangle& a, const Signs& of_a, const Triangle& b, const Signs& of_b) {
  const std::size_t i = lone_corner(of_a), j = lone_corner(of_b);
  std::size_t a1 = next_corner[i], a2 = next_corner[a1], b1 = next_corner[j], b2 = next_corner[b1];
  // Each triangle is turned so that the lone corner of the other one is in front of it.
  if (of_b[j] < 0) std::swap(a1, a2);
  if (of_a[i] < 0) std::swap(b1, b2);
  // The line then passes the edges from the lone corner of a to a2 and to a1 in this order, and those of b to b1 and to
  // b2. A volume of two edges tells which of them it passes first: here that to b1 before that to a1, and a2 before b2.
  return geometry::orient3d(a[i], a[a1], b[j], b[b1]) < 0 && geometry::orient3d(a[i], a[a2], b[b2], b[j]) < 0;
}

/// Where another triangle lies, seen from t, which it meets.
Sides sides_of(const Triangle& other, const Triangle& t) {
  const Signs signs = sides_of_corners(other, t);
  Sides sides = 0;
  if (has(signs, 1)) sides |= in_front;
  if (has(signs, -1)) sides |= behind;
  if (sides == 0) return 0;
  const bool is_one_sided = sides != (in_front | behind);
  if (is_one_sided && std::count(signs.begin(), signs.end(), 0) < 2) return sides;  // it touches the plane in a corner
  const Signs own_signs = sides_of_corners(t, other);
  const bool is_t_on_both_sides = has(own_signs, 1) && has(own_signs, -1);  // else a segment is at the border of t
  if (is_t_on_both_sides && share_a_segment(t, own_signs, other, signs)) sides |= across;
  return sides;
}

/// The meetings of each facet, in the order of the others, of each surface and between both. Their sides are not known
/// yet. If the budget is spent, nobody may read the lists: entries may not be written. The meter stays spent, so asking
/// it first is enough.
mesh::VertexLists<Meeting> meetings_of(Cells& cells, const std::deque<TrianglePair>& contacts, FacetId count_of_a,
                                       FacetId count) {
  std::deque<TrianglePair> of_one[2];
  for (const pair::Side s : {pair::Side::a, pair::Side::b}) {
    if (cells.is_stopped()) break;
    const auto add = [&](const TrianglePair& p) { return of_one[pair::index(s)].push_back(p), true; };
    cells.meter.stop(pair::visit_placed_self_intersections(cells.placed(s), add, cells.budget, cells.meter.stats));
    // Two triangles of the same three vertices meet in all of them, but are no self-intersection. They are neighbors
    // across all three edges; that between the two smaller ids finds them.
    const MeshView& mesh = cells.model(s).mesh();
    const auto add_copies = [&](VertexId, std::span<const mesh::TriangleSide> sides) {
      LIMBER_ASSERT(sides.size() == 2);
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
        add_item(f, {other, 0});
        add_item(other, {f, 0});
      }
    };
    add(contacts, 0, count_of_a);
    add(of_one[0], 0, 0);
    add(of_one[1], count_of_a, count_of_a);
  });
  // Each meeting is in the lists of both, so transposing them gives the same lists again; as f only grows, each is now
  // in the order of `other`. Unlike a sort, this takes steps that the budget counts.
  return Lists(count, [&](const auto& add_item) {
    std::size_t steps = 0;
    for (FacetId f = 0; f < count && !cells.meter.is_spent_at(f); ++f) {
      for (const Meeting& m : unordered.of(f)) {
        if (cells.meter.is_spent_at(++steps)) return;
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
      shells_(std::size_t{2} * count_, cells.meter) {}

void Shells::find_sides() {
  for (FacetId f = 0; f < count_ && !cells_.meter.is_spent_at(f); ++f) {
    const Triangle t = triangle(f);
    is_degenerate_[f] = geometry::are_collinear(t.v0, t.v1, t.v2);
  }
  bool equal_jumps = true, opposite_jumps = true;
  std::size_t steps = 0;
  for (FacetId f = 0; f < count_; ++f) {
    const std::span<Meeting> meetings = meetings_.of(f);
    if (cells_.meter.is_spent_at(f)) return;
    if (is_degenerate_[f]) continue;  // a triangle without area keeps no cells apart
    const Triangle t = triangle(f);
    WindingNumbers jump{};  // by how much winding numbers are larger behind f and its copies than in front of them
    jump[pair::index(side_of(f))] = 1;
    for (Meeting& m : meetings) {
      if (cells_.meter.is_spent_at(++steps)) return;
      if (is_degenerate_[m.other]) continue;
      const Triangle other = triangle(m.other);
      m.sides = sides_of(other, t);
      if (m.sides == 0) {
        const int orientation = orientation_of_copy(other, t);  // 0 if it is none
        jump[pair::index(side_of(m.other))] += orientation;
        is_copy_[f] = is_copy_[f] || (orientation != 0 && m.other < f);
      }
      if ((m.sides & across) != 0) cut_halves_[f] |= m.sides & (in_front | behind);
      if (m.is_through()) is_crossed_through_[f] = true;
    }
    equal_jumps = equal_jumps && jump[0] == jump[1];
    opposite_jumps = opposite_jumps && jump[0] == -jump[1];
  }
  if (!equal_jumps && !opposite_jumps) return;
  // Both numbers are then equal everywhere, but for the sign: no cell is in one solid alone (*Copies* in solids.md).
  cells_.note_missing(in_a_alone);
  cells_.note_missing(in_b_alone);
}

bool Shells::may_be_between(FacetId f, FacetId neighbor, Sides half, bool is_convex, const Segment& edge) const {
  std::size_t steps = 0;
  for (const Meeting& m : meetings_.of(f)) {
    if (cells_.meter.is_spent_at(++steps)) return true;
    // A convex wedge is on this side of both facets, any other on that of one at least.
    const bool is_there = (m.sides & half) != 0, is_at_neighbor = (sides_between(neighbor, m.other) & half) != 0;
    const bool may_be_in_wedge = is_convex ? is_there && is_at_neighbor : is_there || is_at_neighbor;
    if (!may_be_in_wedge) continue;
    const Triangle t = triangle(m.other);
    const geometry::PlaneSides plane(t.v0, t.v1, t.v2);
    // It contains a part of the edge, or is elsewhere in a plane through it. What contains a part of the edge meets f,
    // as no other triangle shares the edge by ids.
    if (plane.of(edge.p0) == 0 && plane.of(edge.p1) == 0) return true;
  }
  return false;
}

void Shells::join_neighbors(pair::Side s, FacetId first) {
  const MeshView& mesh = cells_.model(s).mesh();
  std::size_t edges = 0;
  const auto join = [&](VertexId, std::span<const mesh::TriangleSide> sides) {
    LIMBER_ASSERT(sides.size() == 2);
    if (cells_.meter.is_spent_at(steps_of_decisions * ++edges)) return;
    const FacetId f = first + sides[0].triangle, neighbor = first + sides[1].triangle;
    if (is_degenerate_[f] || is_degenerate_[neighbor]) return;
    const Triangle t = triangle(f);
    const std::size_t corner = sides[0].corner;
    const Segment edge{t[corner], t[next_corner[corner]]};
    const Vec3 apex = triangle(neighbor)[(sides[1].corner + 2) % 3], own_apex = t[(corner + 2) % 3];
    const int side = geometry::orient3d(t.v0, t.v1, t.v2, apex);
    if (side == 0) {  // flat, or folded on each other, so that they are not joined
      const std::size_t axis = *geometry::faithful_axis(t.v0, t.v1, t.v2);
      const auto side_of_edge = [&](const Vec3& p) { return geometry::orient2d(edge.p0, edge.p1, p, axis); };
      if (side_of_edge(apex) == side_of_edge(own_apex)) return;
    }
    for (const Sides half : {in_front, behind}) {
      if (((cut_halves_[f] | cut_halves_[neighbor]) & half) != 0) continue;
      const bool is_convex = side == (half == in_front ? 1 : -1);
      if (may_be_between(f, neighbor, half, is_convex, edge)) continue;
      shells_.unite(half_facet(f, half), half_facet(neighbor, half));
    }
  };
  mesh::for_each_edge(mesh.triangles, mesh.positions.size(), join,
                      [&](std::size_t k) { return !cells_.meter.is_spent_at(k); });
}

void Shells::look_into_shells() {
  for (FacetId f = 0; f < count_ && !cells_.are_all_known() && !cells_.meter.is_spent_at(f); ++f) {
    if (is_degenerate_[f]) continue;
    for (const Sides half : {in_front, behind}) {
      const std::size_t i = half_facet(f, half);
      const bool represents_its_shell = shells_.find(i) == i;
      if (!represents_its_shell) continue;
      // Of a half-facet that is crossed this is the piece at corner 0. Cuts lead to it, too, but this often ends the
      // search.
      const Triangle t = triangle(f);
      cells_.look(CornerProbe(t, 0, *direction_off(t, half == in_front ? 1 : -1)));
    }
  }
}

void Shells::look_along_cuts() {
  for (FacetId f = 0; f < count_ && !cells_.are_all_known() && !cells_.meter.is_spent_at(f); ++f) {
    if (cut_halves_[f] == 0 || is_copy_[f]) continue;
    for (const Meeting& m : meetings_.of(f)) {
      if (cells_.are_all_known() || cells_.meter.is_spent()) return;
      if ((m.sides & across) != 0 && !is_copy_[m.other]) look_along_cut(f, m);
    }
  }
}

void Shells::look_along_cut(FacetId f, const Meeting& cutter) {
  const FacetId x = cutter.other;
  // By point 5 of *Where to look*: if nothing crosses x, its shell is found; if x comes before f, then f is not the
  // first on the border of any cell beside this cut.
  if (cut_halves_[x] == 0 || is_looked_into_before(x, f)) return;
  Cut cut(triangle(f), side_of(f), triangle(x), side_of(x));
  add_crossers(cut, f, x);
  if (!cutter.is_through()) return cut.look(cells_, (cutter.sides & in_front) != 0 ? 1 : -1);  // x ends at f
  if (!cut.is_shared()) return cut.look_everywhere(cells_);                                    // all wedges, by one ray
  // Another facet may divide each of the four wedges, so that it needs a line next to f and one next to x.
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
    next = std::lower_bound(next, many.end(), m.other, Meeting::comes_before);
    if (next == many.end()) return;
    if (next->other == m.other && !is_degenerate_[m.other]) cut.add(triangle(m.other), side_of(m.other));
  }
}

}  // namespace limber::solid
