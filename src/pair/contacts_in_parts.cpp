// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/contacts_in_parts.h"

#include <vector>

#include "base/span_filler.h"
#include "pair/collectors/all_intersections.h"
#include "pair/collectors/pairs_within.h"
#include "pair/search.h"

namespace limber {
namespace {

/// make_collector(visitor) makes one for a part of the search.
template <typename Collector, typename Pair, typename Make>
PairCount count_in_parts(const pair::PlacedPair& placed, const Make& make_collector,
                         FunctionRef<bool(const Pair&)> visit) {
  PairCount result;
  const auto parts = pair::search_all_in_parts<Collector, base::ListFiller<Pair>>(
      placed, make_collector, [](Collector&) {}, result.stats);
  for (const base::ListFiller<Pair>& part : parts) {
    for (const Pair& found : part.list()) {
      ++result.count;
      result.is_complete = visit(found);
      if (!result.is_complete) return result;
    }
  }
  return result;
}

template <typename Pairs>
PairCount intersections_of(const pair::PlacedPair& placed, const Pairs& pairs, TrianglePairVisitor visit) {
  using Collector = pair::AllIntersections<Pairs>;
  return count_in_parts<Collector, TrianglePair>(
      placed, [&](TrianglePairVisitor visitor) { return Collector(pairs, visitor); }, visit);
}

template <typename Pairs>
PairCount contacts_of(const pair::PlacedPair& placed, const Pairs& pairs, double margin, ContactVisitor visit) {
  using Collector = pair::PairsWithin<Pairs>;
  return count_in_parts<Collector, Contact>(
      placed, [&](ContactVisitor visitor) { return Collector(pairs, margin, visitor); }, visit);
}

}  // namespace

PairCount pair::visit_intersections_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs,
                                             TrianglePairVisitor visit) {
  return intersections_of(placed, pairs, visit);
}

PairCount pair::visit_intersections_in_parts(const PlacedPair& placed, const PairsOfOne& pairs,
                                             TrianglePairVisitor visit) {
  return intersections_of(placed, pairs, visit);
}

PairCount pair::visit_contacts_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, double margin,
                                        ContactVisitor visit) {
  return contacts_of(placed, pairs, margin, visit);
}

PairCount pair::visit_contacts_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, double margin,
                                        ContactVisitor visit) {
  return contacts_of(placed, pairs, margin, visit);
}

}  // namespace limber
