// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/contact_answers.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace limber::program {
namespace {

/// Pairs that have been joined.
class JoinedPairs {
 public:
  explicit JoinedPairs(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0U); }

  void join(std::uint32_t i, std::uint32_t j) { parents_[root_of(i)] = root_of(j); }

  std::uint32_t root_of(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

/// A vertex of A and one of B as one number, and a pair of triangles that has both.
using VertexPair = std::pair<std::uint64_t, std::uint32_t>;

/// Joins pairs that have a vertex of A and one of B in common: these are the neighbors.
JoinedPairs joined_neighbors(const std::vector<Contact>& contacts, MeshView a, MeshView b) {
  std::vector<VertexPair> vertices;
  vertices.reserve(9 * contacts.size());
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    for (const VertexId v : a.triangles[contacts[i].triangle_a]) {
      for (const VertexId w : b.triangles[contacts[i].triangle_b])
        vertices.emplace_back(std::uint64_t{v} << 32U | w, i);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  JoinedPairs joined(contacts.size());
  for (std::size_t k = 1; k < vertices.size(); ++k) {
    if (vertices[k].first == vertices[k - 1].first) joined.join(vertices[k].second, vertices[k - 1].second);
  }
  return joined;
}

void add(ContactRegion& region, const Contact& contact) {
  if (region.count++ == 0) {
    region.depth = contact.depth;
    region.distance = contact.distance;
    region.low = region.high = contact.point_a;
  }
  if (contact.distance == 0) ++region.intersecting_count;
  region.depth = std::max(region.depth, contact.depth);
  region.distance = std::min(region.distance, contact.distance);
  for (const Vec3& p : {contact.point_a, contact.point_b}) {
    region.low = min(region.low, p);
    region.high = max(region.high, p);
  }
}

}  // namespace

ContactRegions regions_of(const std::vector<Contact>& contacts, MeshView a, MeshView b) {
  JoinedPairs joined = joined_neighbors(contacts, a, b);
  std::vector<ContactRegion> by_root(contacts.size());
  for (std::uint32_t i = 0; i < contacts.size(); ++i) add(by_root[joined.root_of(i)], contacts[i]);
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    if (by_root[i].count > 0) roots.push_back(i);
  }
  const auto is_before = [&](std::uint32_t i, std::uint32_t j) {
    const ContactRegion &r = by_root[i], &s = by_root[j];
    return std::tuple(s.depth, r.distance, s.count, r.low.x, r.low.y, r.low.z) <
           std::tuple(r.depth, s.distance, r.count, s.low.x, s.low.y, s.low.z);
  };
  std::sort(roots.begin(), roots.end(), is_before);
  ContactRegions found;
  std::vector<std::uint32_t> number_of(contacts.size());
  for (std::uint32_t r = 0; r < roots.size(); ++r) {
    number_of[roots[r]] = r;
    found.regions.push_back(by_root[roots[r]]);
  }
  for (std::uint32_t i = 0; i < contacts.size(); ++i) found.region_of.push_back(number_of[joined.root_of(i)]);
  return found;
}

}  // namespace limber::program
