// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  The reduction of contact manifolds in Bullet, Jolt and Rapier: the deepest contact, then those that span
//           most.
// Differs   Those reduce the contacts of one pair of convex shapes. Here regions come first: by distance and normal
//           from the deepest contact that is in none yet, found in a grid. Further contacts of a region are sampled
//           farthest first [Gonzalez1985], which serves any number of them.
#include "limber/contact_reduction.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "core/check.h"
#include "core/float_environment.h"

namespace limber {
namespace {

constexpr std::uint32_t no_region = std::numeric_limits<std::uint32_t>::max();
// Of the radius: nearer contacts add next to nothing to what a manifold spans.
constexpr double spacing = 0.25;

bool is_all_finite(const Contact& c) {
  return is_finite(c.point_a) && is_finite(c.point_b) && is_finite(c.normal) && std::isfinite(c.distance) &&
         std::isfinite(c.depth);
}

void check(std::span<const Contact> contacts, const ReductionOptions& options) {
  LIMBER_REQUIRE(options.radius > 0 && std::isfinite(options.radius),
                 "limber::reduce_contacts: radius must be finite and above 0");
  LIMBER_REQUIRE(options.max_angle >= 0 && options.max_angle <= 0x1.921fb54442d18p+1,
                 "limber::reduce_contacts: max_angle must be at least 0 and at most pi");
  LIMBER_REQUIRE(options.max_points >= 1, "limber::reduce_contacts: max_points must be at least 1");
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    LIMBER_REQUIRE(
        is_all_finite(contacts[i]),
        ("limber::reduce_contacts: contact " + std::to_string(i) + " has a number that is not finite").c_str());
  }
}

// Halves first: the sum may be too large.
Vec3 position_of(const Contact& c) { return 0.5 * c.point_a + 0.5 * c.point_b; }

/// The deepest first; what follows makes equal depths independent of the input's order.
bool is_deeper(const Contact& c, const Contact& d) {
  const double gap_c = c.distance - c.depth, gap_d = d.distance - d.depth;
  if (gap_c != gap_d) return gap_c < gap_d;
  const auto key = [](const Contact& x) {
    return std::tie(x.triangle_a, x.triangle_b, x.point_a.x, x.point_a.y, x.point_a.z, x.point_b.x, x.point_b.y,
                    x.point_b.z, x.normal.x, x.normal.y, x.normal.z, x.distance);
  };
  return key(c) < key(d);
}

/// Component by component: the inverse of a tiny length may be too large.
Vec3 divided(const Vec3& v, double by) { return {v.x / by, v.y / by, v.z / by}; }

/// From one contact to another, in radii: squares of that neither underflow nor overflow where they matter.
Vec3 offset(const Contact& from, const Contact& to, double radius) {
  return divided(position_of(to) - position_of(from), radius);
}

/// Positions in a hash table of cells, each of which is a little wider than a ball of the radius: what is within the
/// radius of a point is in its cell or in one of the seven that it is next to.
class PositionGrid {
 public:
  PositionGrid(double radius, double largest_coordinate, std::size_t capacity)
      // No more than 2^40 cells a side, so that their numbers are integers; the rounding of these is far below 2^-10.
      : side_(2 * (1 + 0x1p-10) * std::max(radius, largest_coordinate * 0x1p-40)),
        last_in_(std::bit_ceil(2 * capacity + 1), no_region) {
    before_.reserve(capacity);
  }

  /// The next one gets the next number, from 0.
  void add(const Vec3& p) {
    const Vec3 at = divided(p, side_);
    std::uint32_t& last = last_in_[bucket(std::floor(at.x), std::floor(at.y), std::floor(at.z))];
    before_.push_back(last);
    last = static_cast<std::uint32_t>(before_.size() - 1);
  }

  /// Calls visit(number) for all that may be within the radius of a point, some of them more than once.
  template <typename Visit>
  void visit_near(const Vec3& p, const Visit& visit) const {
    const Vec3 at = divided(p, side_);
    const auto other = [](double x) { return x - std::floor(x) < 0.5 ? std::floor(x) - 1 : std::floor(x) + 1; };
    for (const double x : {std::floor(at.x), other(at.x)}) {
      for (const double y : {std::floor(at.y), other(at.y)}) {
        for (const double z : {std::floor(at.z), other(at.z)}) {
          for (std::uint32_t i = last_in_[bucket(x, y, z)]; i != no_region; i = before_[i]) visit(i);
        }
      }
    }
  }

 private:
  // Cells that share a bucket cost time only.
  std::size_t bucket(double x, double y, double z) const {
    constexpr std::uint64_t odd = 0x9e37'79b9'7f4a'7c15U;
    std::uint64_t hash = 0;
    for (const double cell : {x, y, z}) {
      hash = (hash ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell))) * odd;
      hash ^= hash >> 32U;
    }
    return hash & (last_in_.size() - 1);
  }

  double side_;
  std::vector<std::uint32_t> last_in_;  // of each bucket
  std::vector<std::uint32_t> before_;   // in the same bucket
};

/// Which contacts belong together: each to the first region it is close enough to.
struct Regions {
  std::vector<std::uint32_t> region_of;  // each contact
  std::vector<std::size_t> first;        // contact of each region
};

Regions regions_of(std::span<const Contact> contacts, const ReductionOptions& options) {
  double largest = 0;
  for (const Contact& c : contacts) largest = std::max(largest, max_abs(position_of(c)));
  PositionGrid grid(options.radius, largest, contacts.size());
  const double chord = 2 * std::sin(options.max_angle / 2);
  Regions regions;
  regions.region_of.reserve(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    const Vec3 position = position_of(c);
    std::uint32_t joined = no_region;
    grid.visit_near(position, [&](std::uint32_t region) {
      const Contact& first = contacts[regions.first[region]];
      const bool is_near = length_sq(offset(first, c, options.radius)) <= 1;
      if (is_near && length_sq(c.normal - first.normal) <= chord * chord) joined = std::min(joined, region);
    });
    if (joined == no_region) {
      joined = static_cast<std::uint32_t>(regions.first.size());
      regions.first.push_back(i);
      grid.add(position);
    }
    regions.region_of.push_back(joined);
  }
  return regions;
}

/// A contact of a region, on the plane across the normal of its first one.
struct Member {
  std::size_t contact;
  Vec3 flat;                                                  // from the first one, in radii
  double apart_sq = std::numeric_limits<double>::infinity();  // from the nearest that is kept
};

/// Keeps the first, and those that span most.
void keep_spanning(std::span<Member> members, std::size_t max_points, std::vector<std::size_t>& kept) {
  LIMBER_ASSERT(!members.empty() && max_points >= 1);
  std::size_t next = 0;
  for (std::size_t count = 0; count < max_points; ++count) {
    if (count > 0 && members[next].apart_sq <= spacing * spacing) return;
    kept.push_back(members[next].contact);
    const Vec3 at = members[next].flat;
    next = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      members[i].apart_sq = std::min(members[i].apart_sq, length_sq(members[i].flat - at));
      if (members[i].apart_sq > members[next].apart_sq) next = i;
    }
  }
}

/// The contacts that are kept, region by region. Sets the end of each region in that list.
std::vector<std::size_t> kept_of(std::span<const Contact> contacts, const Regions& regions,
                                 const ReductionOptions& options, std::vector<std::size_t>& ends) {
  // Where each region's members begin in one array.
  std::vector<std::size_t> begin(regions.first.size() + 1, 0);
  for (const std::uint32_t region : regions.region_of) ++begin[region + 1];
  for (std::size_t r = 0; r < regions.first.size(); ++r) begin[r + 1] += begin[r];
  std::vector<Member> members(contacts.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t region = regions.region_of[i];
    const Contact& first = contacts[regions.first[region]];
    const Vec3 apart = offset(first, contacts[i], options.radius);
    members[next[region]++] = {i, apart - dot(apart, first.normal) * first.normal};
  }
  std::vector<std::size_t> kept;
  for (std::size_t r = 0; r < regions.first.size(); ++r) {
    keep_spanning(std::span(members).subspan(begin[r], begin[r + 1] - begin[r]), options.max_points, kept);
    ends.push_back(kept.size());
  }
  return kept;
}

}  // namespace

std::size_t reduce_contacts(std::span<Contact> contacts, const ReductionOptions& options,
                            std::span<std::uint32_t> regions) {
  const core::DefaultFloatEnvironment environment;
  check(contacts, options);
  if (contacts.empty()) return 0;
  std::vector<Contact> sorted(contacts.begin(), contacts.end());
  std::sort(sorted.begin(), sorted.end(), is_deeper);
  std::vector<std::size_t> ends;
  const std::vector<std::size_t> kept = kept_of(sorted, regions_of(sorted, options), options, ends);
  std::vector<bool> is_kept(sorted.size(), false);
  std::size_t next = 0;
  for (const std::size_t i : kept) is_kept[i] = true, contacts[next++] = sorted[i];
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!is_kept[i]) contacts[next++] = sorted[i];
  }
  std::uint32_t region = 0;
  for (std::size_t i = 0; i < std::min(kept.size(), regions.size()); ++i) {
    while (i >= ends[region]) ++region;
    regions[i] = region;
  }
  return kept.size();
}

}  // namespace limber
