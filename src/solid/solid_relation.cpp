// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public question of how two solids lie to each other. What is cheapest to look at comes first: the triangles of
// the first contacts, then whole components of surfaces without a contact, then everything.
#include "limber/solids.h"

#include <deque>
#include <vector>

#include "base/access.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/primitives.h"
#include "limber/contacts.h"
#include "pair/placed_pair.h"
#include "point/placed_model.h"
#include "solid/cut.h"
#include "solid/shells.h"

namespace limber {
namespace {

using pair::Side;
using solid::Cells;

// Contacts whose triangles are looked at as soon as they are found. Bodies that cross rarely need a second one.
constexpr std::size_t first_contacts = 8;

struct InAndOut {
  bool in = false, out = false;
};

/// Where the components of one surface are that has no contact with the other one: each is inside of that or outside,
/// as a whole. Looks at the cells beside one triangle of each.
InAndOut look_at_components(Cells& cells, Side s) {
  const point::PlacedModel& model = cells.model(s);
  const std::span<const Corners> triangles = model.mesh().triangles;
  InAndOut found;
  solid::DisjointSets components(model.mesh().positions.size(), cells.meter);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (cells.meter.is_spent_at(i)) return found;
    const Corners& c = triangles[i];
    components.unite(c[0], c[1]), components.unite(c[0], c[2]);
  }
  std::vector<bool> is_seen(model.mesh().positions.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (cells.meter.is_spent_at(i)) return found;
    const Corners& c = triangles[i];
    const std::size_t component = components.find(c[0]);
    if (is_seen[component]) continue;
    const Triangle t = model.triangle(c);
    if (geometry::are_collinear(t.v0, t.v1, t.v2)) continue;
    if (cells.meter.is_spent()) return found;
    is_seen[component] = true;
    const point::Surrounding around = point::surrounding_of(cells.model(other(s)), t.v0, cells.meter.stats);
    LIMBER_ASSERT(!around.is_on);
    (around.winding_number != 0 ? found.in : found.out) = true;
    cells.look_beside(t, 0);
  }
  return found;
}

/// Without contacts: a cell in both surfaces has a component on its border that is inside of the other surface, and so
/// on.
void look_at_components(Cells& cells) {
  const InAndOut a = look_at_components(cells, Side::a), b = look_at_components(cells, Side::b);
  if (cells.is_stopped()) return;
  if (!a.in && !b.in) cells.note_missing(solid::in_both);
  if (!a.out && !b.in) cells.note_missing(solid::in_a_alone);
  if (!b.out && !a.in) cells.note_missing(solid::in_b_alone);
}

SolidRelation relation_of(const Cells& cells, bool have_contact) {
  if (cells.is_stopped() && !cells.are_all_known()) return SolidRelation::undecided;
  if (!cells.has(solid::in_both)) return have_contact ? SolidRelation::touching : SolidRelation::apart;
  const bool is_a_out = cells.has(solid::in_a_alone), is_b_out = cells.has(solid::in_b_alone);
  if (is_a_out) return is_b_out ? SolidRelation::overlapping : SolidRelation::b_inside_a;
  return is_b_out ? SolidRelation::a_inside_b : SolidRelation::equal;
}

}  // namespace

SolidRelationResult solid_relation(const PlacedSurface& a, const PlacedSurface& b,
                                   const SolidRelationOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const Placed placed_a = Access::placed(a), placed_b = Access::placed(b);
  const pair::PlacedPair placed(placed_a, placed_b);
  SolidRelationResult result;
  ++result.stats.node_tests;
  if (placed.root_bound() > 0) return result;

  Cells cells(placed_a, placed_b, options.budget);
  std::deque<TrianglePair> contacts;  // which grows without being copied
  const auto visit = [&](const TrianglePair& contact) {
    contacts.push_back(contact);
    if (contacts.size() > first_contacts) return true;
    const Triangle ta = placed.triangle(Side::a, contact.a), tb = placed.triangle(Side::b, contact.b);
    if (!result.witness) {
      const Vec3 point = geometry::shared_point(ta, tb);
      result.witness = Witness{point, point, contact.a, contact.b};
    }
    for (std::size_t corner = 0; corner < 3 && !cells.are_all_known(); ++corner) {
      cells.look_beside(ta, corner), cells.look_beside(tb, corner);
    }
    return !cells.are_all_known();
  };
  const PairCount found = visit_intersections(placed_a, placed_b, visit, {.budget = options.budget});
  cells.meter.stop(found.stopped_by);
  if (contacts.empty() && !cells.is_stopped()) look_at_components(cells);
  if (!cells.are_all_known() && !cells.is_stopped()) solid::Shells(cells, contacts).look();
  result.relation = relation_of(cells, !contacts.empty());
  if (result.relation == SolidRelation::undecided) result.stopped_by = cells.meter.stopped_by();
  result.stats += found.stats, result.stats += cells.meter.stats;
  return result;
}

void solid_relation_many(std::span<const std::optional<PlacedSurface>> surfaces, std::span<const ObjectPair> pairs,
                         std::span<SolidRelationResult> results, const SolidRelationOptions& options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(pairs.size() == results.size(),
                 "limber::solid_relation_many: results: there are not as many as pairs");
  const auto is_named = [&](ObjectId id) { return id < surfaces.size() && surfaces[id].has_value(); };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ObjectPair& pair = pairs[i];
    LIMBER_REQUIRE_ENTRY(is_named(pair.a) && is_named(pair.b), "limber::solid_relation_many: pairs", i,
                         "names no surface");
    pair::PlacedPair(Access::placed(*surfaces[pair.a]), Access::placed(*surfaces[pair.b]));  // which checks both
  }
  base::parallel_for(pairs.size(), 1, [&](std::size_t i) {
    results[i] = solid_relation(*surfaces[pairs[i].a], *surfaces[pairs[i].b], options);
  });
}

}  // namespace limber
