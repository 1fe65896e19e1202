// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/parts.h"

#include <atomic>
#include <limits>
#include <vector>

#include "pair/collectors/all_intersections.h"
#include "pair/collectors/pairs_within.h"
#include "pair/search.h"

namespace limber {
namespace {

/// make_collector(visitor) makes one for a part of the search.
template <typename Collector, typename Pair, typename Make>
PairCount count_in_parts(const pair::PlacedPair& placed, const Make& make_collector,
                         FunctionRef<bool(const Pair&)> visit, const QueryBudget& budget) {
  PairCount result;
  const auto parts =
      pair::search_all_in_parts<Collector, base::ListFiller<Pair>>(placed, make_collector, budget, result.stats);
  pair::visit_found(parts, visit, result);
  return result;
}

template <typename Pairs>
PairCount intersections_of(const pair::PlacedPair& placed, const Pairs& pairs, TrianglePairVisitor visit,
                           const QueryBudget& budget) {
  using Collector = pair::AllIntersections<Pairs>;
  return count_in_parts<Collector, TrianglePair>(
      placed, [&](TrianglePairVisitor visitor) { return Collector(pairs, visitor); }, visit, budget);
}

template <typename Pairs>
PairCount contacts_of(const pair::PlacedPair& placed, const Pairs& pairs, double margin, ContactVisitor visit,
                      const QueryBudget& budget) {
  using Collector = pair::PairsWithin<Pairs>;
  return count_in_parts<Collector, Contact>(
      placed, [&](ContactVisitor visitor) { return Collector(pairs, margin, visitor); }, visit, budget);
}

/// The collector of intersect_in_parts(): all parts end when one has found a pair.
template <typename Pairs>
class AnyIntersection {
 public:
  static constexpr pair::Hits hits = pair::Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  AnyIntersection(const Pairs& pairs, std::atomic<bool>& has_found) : pairs_(pairs), has_found_(has_found) {}

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return has_found_.load(std::memory_order_relaxed); }

  void compare(const pair::PlacedTriangle& a, const pair::PlacedTriangle& b) {
    if (pairs_.meet(a, b)) has_found_.store(true, std::memory_order_relaxed);
  }

 private:
  const Pairs& pairs_;
  std::atomic<bool>& has_found_;
};

template <typename Pairs>
bool any_in_parts(const pair::PlacedPair& placed, const Pairs& pairs, const QueryBudget& budget, QueryStats& stats) {
  struct Nothing {};
  using Collector = AnyIntersection<Pairs>;
  std::atomic<bool> has_found = false;
  pair::search_all_in_parts<Collector, Nothing>(
      placed, [&](Nothing&) { return Collector(pairs, has_found); }, budget, stats);
  return has_found;
}

}  // namespace

bool pair::intersect_in_parts(const Placed& a, const Placed& b, bool is_self, const QueryBudget& budget,
                              QueryStats& stats) {
  if (!is_self) return any_in_parts(PlacedPair(a, b), PairsOfTwo(a, b, {}), budget, stats);
  const Placed model{a.model()};
  return any_in_parts(PlacedPair(model, model), PairsOfOne(a.model().mesh(), {}), budget, stats);
}

PairCount pair::visit_intersections_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs,
                                             TrianglePairVisitor visit, const QueryBudget& budget) {
  return intersections_of(placed, pairs, visit, budget);
}

PairCount pair::visit_intersections_in_parts(const PlacedPair& placed, const PairsOfOne& pairs,
                                             TrianglePairVisitor visit, const QueryBudget& budget) {
  return intersections_of(placed, pairs, visit, budget);
}

PairCount pair::visit_contacts_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, double margin,
                                        ContactVisitor visit, const QueryBudget& budget) {
  return contacts_of(placed, pairs, margin, visit, budget);
}

PairCount pair::visit_contacts_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, double margin,
                                        ContactVisitor visit, const QueryBudget& budget) {
  return contacts_of(placed, pairs, margin, visit, budget);
}

}  // namespace limber
