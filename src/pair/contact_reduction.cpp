// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// reduce_contacts() of limber/contacts.h: sorts contacts by depth, groups them into patches, and keeps a few of each
// patch. A contact joins the first patch whose first, deepest contact is near in position and normal; else it begins a
// patch. A hash grid of positions and normals finds the patches near a contact. Of a patch, the first contact is kept,
// then always the one that is farthest from those that are kept.
//
// Based on  The reduction of contact manifolds in Bullet, Jolt and Rapier: the deepest contact, then those that span
//           most.
// Differs   Those reduce the contacts of one pair of convex shapes, so they need no patches, and keep four contacts.
//           Sampling farthest first [Gonzalez1985] serves any number.
#include "limber/contacts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/access.h"
#include "base/check.h"
#include "base/float_environment.h"

namespace limber {

struct ReductionMemory::Impl {
  /// Where a contact is given, and what decides most about its place in the order.
  struct Key {
    double gap;
    std::size_t contact;
  };
  /// Contacts that belong together.
  struct Patch {
    std::size_t first;             // the index of its first contact
    std::uint32_t next_in_bucket;  // the patch that was added before to the same bucket
    std::size_t end;               // where its members end in the list of all members; until then, see list_members()
  };
  /// The decision about one contact.
  struct Membership {
    std::uint32_t patch;
    bool is_kept = false;
  };
  /// A contact of a patch, projected along the normal of the patch's first contact.
  struct Member {
    std::size_t contact;
    Vec3 flat;  // its projection, relative to the first contact, in radii
    double apart_sq = std::numeric_limits<double>::infinity();  // squared distance from the nearest that is kept
  };

  std::vector<Key> keys;
  std::vector<Contact> sorted;          // by depth
  std::vector<Membership> memberships;  // of the sorted contacts
  std::vector<Patch> patches;
  std::vector<std::uint32_t> last_in;  // the patch that was last added to each bucket of the grid
  std::vector<Member> members;         // patch by patch
};

ReductionMemory::ReductionMemory() = default;
ReductionMemory::ReductionMemory(ReductionMemory&&) noexcept = default;
ReductionMemory& ReductionMemory::operator=(ReductionMemory&&) noexcept = default;
ReductionMemory::~ReductionMemory() = default;

ReductionMemory::Impl& ReductionMemory::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

namespace {

using Memory = ReductionMemory::Impl;

constexpr std::uint32_t no_patch = std::numeric_limits<std::uint32_t>::max();
// A contact within this many radii of one that is kept adds next to nothing to what the patch spans.
constexpr double spacing = 0.25;

bool is_all_finite(const Contact& c) {
  return is_finite(c.point_a) && is_finite(c.point_b) && is_finite(c.normal) && std::isfinite(c.distance) &&
         std::isfinite(c.depth) && is_finite(c.weights_a) && is_finite(c.weights_b);
}

void check(std::span<const Contact> contacts, double radius, const ReductionOptions& options) {
  LIMBER_REQUIRE(radius > 0 && std::isfinite(radius), "limber::reduce_contacts: radius must be finite and above 0");
  LIMBER_REQUIRE(options.max_angle >= 0 && options.max_angle <= std::numbers::pi,
                 "limber::reduce_contacts: max_angle must be at least 0 and at most pi");
  LIMBER_REQUIRE(options.max_points >= 1, "limber::reduce_contacts: max_points must be at least 1");
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto text = [i](const char* what) { return "limber::reduce_contacts: contact " + std::to_string(i) + what; };
    LIMBER_REQUIRE(is_all_finite(contacts[i]), text(" has a number that is not finite").c_str());
    // A contact that was never written has a normal of length 0.
    LIMBER_REQUIRE(contacts[i].normal != Vec3{}, text(" has a normal of length 0").c_str());
    // Long ones would make patches at one place many, and spread out their contacts.
    LIMBER_REQUIRE(length_sq(contacts[i].normal) <= 1 + 0x1p-20, text(" has a normal longer than 1").c_str());
  }
}

// The middle of the two points. Halves are added, because the sum of two points may overflow.
Vec3 position_of(const Contact& c) { return 0.5 * c.point_a + 0.5 * c.point_b; }

/// The order of contacts: by their gap, how far the triangles are apart less their depth. Ties are broken by all other
/// numbers, so that the order does not depend on that of the input.
void sort_by_gap(std::span<const Contact> contacts, Memory& memory) {
  memory.keys.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) memory.keys[i] = {contacts[i].distance - contacts[i].depth, i};
  const auto others = [&](const Memory::Key& key) {
    const Contact& x = contacts[key.contact];
    return std::tie(x.triangle_a, x.triangle_b, x.point_a.x, x.point_a.y, x.point_a.z, x.point_b.x, x.point_b.y,
                    x.point_b.z, x.normal.x, x.normal.y, x.normal.z, x.distance, x.weights_a.x, x.weights_a.y,
                    x.weights_a.z, x.weights_b.x, x.weights_b.y, x.weights_b.z);
  };
  std::sort(memory.keys.begin(), memory.keys.end(), [&](const Memory::Key& c, const Memory::Key& d) {
    return c.gap != d.gap ? c.gap < d.gap : others(c) < others(d);
  });
  memory.sorted.clear();
  memory.sorted.reserve(contacts.size());
  for (const Memory::Key& key : memory.keys) memory.sorted.push_back(contacts[key.contact]);
}

/// v / by, component by component: 1 / by may overflow.
Vec3 divided(const Vec3& v, double by) { return {v.x / by, v.y / by, v.z / by}; }

/// From one contact to another, in radii, so that squares near 1 cannot underflow or overflow.
Vec3 offset(const Contact& from, const Contact& to, double radius) {
  return divided(position_of(to) - position_of(from), radius);
}

/// The cells of a grid along one axis. A cell is `width` times as wide as what is near, and a little more: a coordinate
/// and all that are near it are in one cell or two, or in a few more because of rounding.
///
/// A cell is named by its number, as long as that is below 2^53 and exact. Coordinates beyond are more than `near`
/// apart unless they are equal: floating-point numbers of that size have larger steps. So there each coordinate is a
/// cell of its own, named by the coordinate.
class AxisCells {
 public:
  /// Pre      near > 0, width >= 2.
  AxisCells(double near, double width)
      : scale_(near < 0x1p-500 ? 0x1p500 : 1),
        reach_(near * scale_ * (1 + 0x1p-10)),
        cells_per_length_(1 / (width * reach_)) {
    LIMBER_ASSERT(near > 0 && width >= 2);
  }

  double cell_of(double x) const {
    const double at = cells_from(x * scale_);
    return std::abs(at) < most ? std::floor(at) : x;
  }

  /// The cells that may have a coordinate near x. None is missed: rounding keeps the order of numbers, and a coordinate
  /// below 2^53 cells, which has a numbered cell, differs by at least one cell from one above, which names its own.
  struct Range {
    double first, last;
  };
  Range around(double x) const {
    const double scaled = x * scale_;
    if (!(std::abs(cells_from(scaled)) < most)) return {x, x};
    constexpr double largest = std::numeric_limits<double>::max();
    const double low = std::max(scaled - reach_, -largest), high = std::min(scaled + reach_, largest);
    return {std::floor(cells_from(low)), std::floor(cells_from(high))};
  }

 private:
  // Half a cell is added, so that numbers around 0, as those of normals along an axis, are in one cell.
  double cells_from(double scaled) const { return scaled * cells_per_length_ + 0.5; }

  static constexpr double most = 0x1p53;
  double scale_;  // a power of two that leaves no `near` so small that its quotients overflow
  double reach_, cells_per_length_;
};

/// A point of the grid: normal and position of a contact.
constexpr std::size_t axis_count = 6;
using Place = std::array<double, axis_count>;

Place place_of(const Contact& c) {
  const Vec3 p = position_of(c);
  return {c.normal.x, c.normal.y, c.normal.z, p.x, p.y, p.z};
}

/// The distance of two unit vectors at an angle. Normals are compared by it.
double chord_of(double angle) { return 2 * std::sin(angle / 2); }

/// Patches in a hash table of grid cells, by the places of their first contacts.
class PatchGrid {
 public:
  PatchGrid(double radius, double chord, std::size_t capacity, Memory& memory)
      : normals_(reach_of_normals(chord), 8),
        positions_(radius, 2),
        patches_(memory.patches),
        last_in_(memory.last_in) {
    patches_.clear();
    patches_.reserve(capacity);
    last_in_.assign(std::bit_ceil(2 * capacity + 1), no_patch);
  }

  void add(const Place& place, std::size_t first_contact) {
    std::uint64_t hash = 0;
    for (std::size_t axis = 0; axis < axis_count; ++axis) hash = mixed(hash, cells(axis).cell_of(place[axis]));
    std::uint32_t& last = last_in_[hash & (last_in_.size() - 1)];
    patches_.push_back({first_contact, last, 0});
    last = static_cast<std::uint32_t>(patches_.size() - 1);
  }

  /// Calls visit(patch) for every patch that is near, for some more than once, and for others in the same buckets.
  template <typename Visit>
  void visit_near(const Place& place, const Visit& visit) const {
    std::array<AxisCells::Range, axis_count> near;
    for (std::size_t axis = 0; axis < axis_count; ++axis) near[axis] = cells(axis).around(place[axis]);
    visit_cells(near, 0, 0, visit);
  }

 private:
  const AxisCells& cells(std::size_t axis) const { return axis < 3 ? normals_ : positions_; }

  /// Within which normals may be as near as a chord. The comparison of squares takes all for near that differ by less
  /// than 2^-538, and rounds where chords are below 2^-500.
  static double reach_of_normals(double chord) { return chord + std::min(chord, 0x1p-500) + 0x1p-535; }

  // Multiplies by 2^64 over the golden ratio (Fibonacci hashing). Small whole numbers differ in high bits alone, so
  // these are put onto the low ones first. Cells that share a bucket cost time only.
  static std::uint64_t mixed(std::uint64_t hash, double cell) {
    const auto bits = std::bit_cast<std::uint64_t>(cell + 0.0);  // -0 becomes 0
    hash = (hash ^ bits ^ bits >> 32U) * 0x9e37'79b9'7f4a'7c15U;
    return hash ^ hash >> 32U;
  }

  /// Goes through the near cells of one axis after the other: two for each of a position, as a rule one for each of a
  /// normal.
  template <typename Visit>
  void visit_cells(const std::array<AxisCells::Range, axis_count>& near, std::size_t axis, std::uint64_t hash,
                   const Visit& visit) const {
    if (axis == axis_count) {
      std::uint32_t i = last_in_[hash & (last_in_.size() - 1)];
      for (; i != no_patch; i = patches_[i].next_in_bucket) visit(i);
      return;
    }
    const auto [first, last] = near[axis];
    LIMBER_ASSERT(first <= last);
    for (double cell = first;; ++cell) {  // beyond 2^53, where ++ would do nothing, first and last are equal
      visit_cells(near, axis + 1, mixed(hash, cell), visit);
      if (cell >= last) return;
    }
  }

  AxisCells normals_, positions_;
  std::vector<Memory::Patch>& patches_;
  std::vector<std::uint32_t>& last_in_;
};

/// Groups the sorted contacts: each joins the earliest, so deepest, patch that it is near to, or begins a new one.
void find_patches(double radius, double max_angle, Memory& memory) {
  const std::vector<Contact>& contacts = memory.sorted;
  const std::vector<Memory::Patch>& patches = memory.patches;
  memory.memberships.assign(contacts.size(), {no_patch});
  const double chord = chord_of(max_angle);
  PatchGrid grid(radius, chord, contacts.size(), memory);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    const Place place = place_of(c);
    std::uint32_t joined = no_patch;
    grid.visit_near(place, [&](std::uint32_t patch) {
      const Contact& first = contacts[patches[patch].first];
      const bool is_near = length_sq(offset(first, c, radius)) <= 1;
      if (is_near && length_sq(c.normal - first.normal) <= chord * chord) joined = std::min(joined, patch);
    });
    if (joined == no_patch) {
      joined = static_cast<std::uint32_t>(patches.size());
      grid.add(place, i);
    }
    memory.memberships[i].patch = joined;
  }
}

/// Calls keep(contact) for the first member, and then always for the one that is farthest from those that are kept.
template <typename Keep>
void keep_spanning(std::span<Memory::Member> members, std::size_t max_points, const Keep& keep) {
  LIMBER_ASSERT(!members.empty() && max_points >= 1);
  std::size_t next = 0;
  for (std::size_t count = 0; count < max_points; ++count) {
    if (count > 0 && members[next].apart_sq <= spacing * spacing) return;
    keep(members[next].contact);
    const Vec3 at = members[next].flat;
    next = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      members[i].apart_sq = std::min(members[i].apart_sq, length_sq(members[i].flat - at));
      if (members[i].apart_sq > members[next].apart_sq) next = i;
    }
  }
}

/// Lists all contacts, patch by patch. Sets the ends of the patches.
void list_members(double radius, Memory& memory) {
  // A counting sort. `end` is first how many members a patch has, then where they begin, and in the end, as members are
  // added, where they end.
  for (const Memory::Membership& m : memory.memberships) ++memory.patches[m.patch].end;
  std::size_t begin = 0;
  for (Memory::Patch& patch : memory.patches) begin += std::exchange(patch.end, begin);
  LIMBER_ASSERT(begin == memory.sorted.size() && memory.memberships.size() == begin);
  memory.members.resize(begin);
  for (std::size_t i = 0; i < begin; ++i) {
    Memory::Patch& patch = memory.patches[memory.memberships[i].patch];
    const Contact& first = memory.sorted[patch.first];
    const Vec3 apart = offset(first, memory.sorted[i], radius);
    memory.members[patch.end++] = {i, apart - dot(apart, first.normal) * first.normal};
  }
}

}  // namespace

std::size_t reduce_contacts(std::span<Contact> contacts, double radius, const ReductionOptions& options) {
  const base::DefaultFloatEnvironment environment;
  check(contacts, radius, options);
  if (contacts.empty()) return 0;
  Memory own;
  Memory& memory = options.memory == nullptr ? own : Access::impl(*options.memory);
  sort_by_gap(contacts, memory);
  find_patches(radius, options.max_angle, memory);
  list_members(radius, memory);
  // The kept contacts come first in the caller's span, patch by patch, then all others.
  std::size_t next = 0, begin = 0;
  for (std::size_t p = 0; p < memory.patches.size(); ++p) {
    const std::size_t end = memory.patches[p].end;
    keep_spanning(std::span(memory.members).subspan(begin, end - begin), options.max_points, [&](std::size_t i) {
      memory.memberships[i].is_kept = true;
      if (next < options.patch_ids.size()) options.patch_ids[next] = static_cast<std::uint32_t>(p);
      contacts[next++] = memory.sorted[i];
    });
    begin = end;
  }
  const std::size_t kept = next;
  for (std::size_t i = 0; i < memory.sorted.size(); ++i) {
    if (!memory.memberships[i].is_kept) contacts[next++] = memory.sorted[i];
  }
  LIMBER_ASSERT(next == contacts.size());
  return kept;
}

}  // namespace limber
