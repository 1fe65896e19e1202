// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/contact_list.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "command/stopwatch.h"

namespace limber::program {
namespace {

/// The deepest first, then the nearest; ids decide where these are equal, so that the order is that of no traversal.
bool is_before(const Contact& a, const Contact& b) {
  return std::tie(b.depth, a.distance, a.triangle_a, a.triangle_b) <
         std::tie(a.depth, b.distance, b.triangle_a, b.triangle_b);
}

}  // namespace

bool ContactCollector::operator()(const Contact& contact) {
  ++found_.count;
  if (contact.distance == 0) ++found_.intersecting_count;
  std::vector<FoundContact>& first = found_.first;
  if (first.size() == room_) {
    if (room_ == 0 || !is_before(contact, first.front())) return true;
    std::pop_heap(first.begin(), first.end(), is_before);
    first.pop_back();
  }
  first.push_back({contact});
  std::push_heap(first.begin(), first.end(), is_before);
  return true;
}

bool ContactCollector::operator()(const TrianglePair& pair) {
  Contact contact;
  contact.triangle_a = pair.a;
  contact.triangle_b = pair.b;
  return (*this)(contact);
}

FoundContacts ContactCollector::take() {
  std::sort_heap(found_.first.begin(), found_.first.end(), is_before);
  return std::exchange(found_, {});
}

PairCount visit_closest(std::uint64_t count, std::uint64_t pair_count,
                        const std::function<PairCount(std::span<Contact>)>& closest_pairs, ContactCollector& visit) {
  std::vector<Contact> closest(std::min(count, pair_count));
  const PairCount found = closest_pairs(closest);
  for (std::size_t i = 0; i < found.count; ++i) visit(closest[i]);
  return found;
}

FoundContacts collect_contacts(std::size_t room, ContactDetail detail,
                               const std::function<PairCount(ContactCollector&)>& query) {
  ContactCollector collector(room);
  const Stopwatch asking;
  const PairCount counted = query(collector);
  const double elapsed_us = asking.microseconds();
  FoundContacts found = collector.take();
  found.detail = detail;
  found.stats = counted.stats;
  found.elapsed_us = elapsed_us;
  return found;
}

}  // namespace limber::program
