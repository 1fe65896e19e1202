// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// reduce_contacts() of limber/contacts.h: sorts contacts by depth, groups them into patches, and keeps a few of each
// patch. A contact joins the first patch whose first, deepest contact is near in position and normal; else it begins a
// patch. A hash grid finds the patches near a contact. Of a patch, the first contact is kept, then always the one that
// is farthest from those that are kept.
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
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"

namespace limber {
namespace {

constexpr std::uint32_t no_patch = std::numeric_limits<std::uint32_t>::max();
// A contact within this many radii of one that is kept adds next to nothing to what the patch spans.
constexpr double spacing = 0.25;

bool is_all_finite(const Contact& c) {
  return is_finite(c.point_a) && is_finite(c.point_b) && is_finite(c.normal) && std::isfinite(c.distance) &&
         std::isfinite(c.depth);
}

void check(std::span<const Contact> contacts, const ReductionOptions& options) {
  LIMBER_REQUIRE(options.radius > 0 && std::isfinite(options.radius),
                 "limber::reduce_contacts: radius must be finite and above 0");
  LIMBER_REQUIRE(options.max_angle >= 0 && options.max_angle <= std::numbers::pi,
                 "limber::reduce_contacts: max_angle must be at least 0 and at most pi");
  LIMBER_REQUIRE(options.max_points >= 1, "limber::reduce_contacts: max_points must be at least 1");
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    LIMBER_REQUIRE(
        is_all_finite(contacts[i]),
        ("limber::reduce_contacts: contact " + std::to_string(i) + " has a number that is not finite").c_str());
  }
}

// The middle of the two points. Halves are added, because the sum of two points may overflow.
Vec3 position_of(const Contact& c) { return 0.5 * c.point_a + 0.5 * c.point_b; }

/// The order of contacts: by how far the triangles are apart, less their depth. Ties are broken by all other numbers,
/// so that the order does not depend on that of the input.
bool is_deeper(const Contact& c, const Contact& d) {
  const double gap_c = c.distance - c.depth, gap_d = d.distance - d.depth;
  if (gap_c != gap_d) return gap_c < gap_d;
  const auto key = [](const Contact& x) {
    return std::tie(x.triangle_a, x.triangle_b, x.point_a.x, x.point_a.y, x.point_a.z, x.point_b.x, x.point_b.y,
                    x.point_b.z, x.normal.x, x.normal.y, x.normal.z, x.distance);
  };
  return key(c) < key(d);
}

/// v / by, component by component: 1 / by may overflow.
Vec3 divided(const Vec3& v, double by) { return {v.x / by, v.y / by, v.z / by}; }

/// From one contact to another, in radii, so that squares near 1 cannot underflow or overflow.
Vec3 offset(const Contact& from, const Contact& to, double radius) {
  return divided(position_of(to) - position_of(from), radius);
}

/// The cells of a grid along one axis. A cell is a little wider than twice `near`, so all coordinates near a given one
/// are in two cells, or a few more because of rounding.
///
/// A cell is named by its number, as long as that is below 2^53 and exact. Coordinates beyond are more than `near`
/// apart unless they are equal: floating-point numbers of that size have larger steps. So there each coordinate is a
/// cell of its own, named by the coordinate.
class AxisCells {
 public:
  /// Pre      near > 0.
  explicit AxisCells(double near)
      : reach_(near * (1 + 0x1p-10)), cells_per_length_(1 / std::max(2 * reach_, 0x1p-1020)) {}

  double cell_of(double x) const {
    const double at = x * cells_per_length_;
    return std::abs(at) < most ? std::floor(at) : x;
  }

  /// The cells that may have a coordinate near x. None is missed: rounding keeps the order of numbers, and a coordinate
  /// below 2^53 cells, which has a numbered cell, differs by at least one cell from one above, which names its own.
  struct Range {
    double first, last;
  };
  Range around(double x) const {
    if (!(std::abs(x * cells_per_length_) < most)) return {x, x};
    constexpr double largest = std::numeric_limits<double>::max();
    const double low = std::max(x - reach_, -largest), high = std::min(x + reach_, largest);
    return {std::floor(low * cells_per_length_), std::floor(high * cells_per_length_)};
  }

 private:
  static constexpr double most = 0x1p53;
  double reach_, cells_per_length_;
};

/// A point of the grid: position and normal of a contact.
using Place = std::array<double, 6>;

Place place_of(const Contact& c) {
  const Vec3 p = position_of(c);
  return {p.x, p.y, p.z, c.normal.x, c.normal.y, c.normal.z};
}

/// The distance of two unit vectors at an angle. Normals are compared by it.
double chord_of(double angle) { return 2 * std::sin(angle / 2); }

/// Contacts that belong together.
struct Patch {
  std::size_t first;             // the index of its first contact
  std::uint32_t next_in_bucket;  // the patch that was added before to the same bucket
  std::size_t end;               // where its members end in the list of all members; until then, see members_of()
};

/// Patches in a hash table of grid cells, by the places of their first contacts.
class PatchGrid {
 public:
  PatchGrid(const ReductionOptions& options, std::size_t capacity)
      : positions_(options.radius),
        normals_(std::max(chord_of(options.max_angle), 0x1p-500)),
        axis_count_(chord_of(options.max_angle) < small_chord ? 6 : 3),
        last_in_(std::bit_ceil(2 * capacity + 1), no_patch) {
    patches_.reserve(capacity);
  }

  std::vector<Patch>& patches() { return patches_; }

  void add(const Place& place, std::size_t first_contact) {
    std::uint64_t hash = 0;
    for (std::size_t axis = 0; axis < axis_count_; ++axis) hash = mixed(hash, cells(axis).cell_of(place[axis]));
    std::uint32_t& last = last_in_[hash & (last_in_.size() - 1)];
    patches_.push_back({first_contact, last, 0});
    last = static_cast<std::uint32_t>(patches_.size() - 1);
  }

  /// Calls visit(patch) for every patch that is near, for some more than once, and for others in the same buckets.
  template <typename Visit>
  void visit_near(const Place& place, const Visit& visit) const {
    visit_near(place, 0, 0, visit);
  }

 private:
  const AxisCells& cells(std::size_t axis) const { return axis < 3 ? positions_ : normals_; }

  // Multiplies by 2^64 over the golden ratio (Fibonacci hashing). Cells that share a bucket cost time only.
  static std::uint64_t mixed(std::uint64_t hash, double cell) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(cell + 0.0)) * 0x9e37'79b9'7f4a'7c15U;  // + 0.0: -0 becomes 0
    return hash ^ hash >> 32U;
  }

  /// Goes through the near cells of one axis after the other: as a rule two for each, so 2^6 buckets at most.
  template <typename Visit>
  void visit_near(const Place& place, std::size_t axis, std::uint64_t hash, const Visit& visit) const {
    if (axis == axis_count_) {
      std::uint32_t i = last_in_[hash & (last_in_.size() - 1)];
      for (; i != no_patch; i = patches_[i].next_in_bucket) visit(i);
      return;
    }
    const AxisCells::Range range = cells(axis).around(place[axis]);
    LIMBER_ASSERT(range.first <= range.last);
    for (double cell = range.first;; ++cell) {  // beyond 2^53, where ++ would do nothing, first and last are equal
      visit_near(place, axis + 1, mixed(hash, cell), visit);
      if (cell >= range.last) return;
    }
  }

  // Normals are part of the hash only if max_angle is so small that many patches may be at one point.
  static constexpr double small_chord = 1. / 16;

  // Cells of normals are at least 2^-500 wide: squares of smaller differences underflow.
  AxisCells positions_, normals_;
  std::size_t axis_count_;
  std::vector<std::uint32_t> last_in_;  // of each bucket
  std::vector<Patch> patches_;
};

/// What has been decided about a contact.
struct Membership {
  std::uint32_t patch;
  bool is_kept = false;
};

/// Groups contacts: each joins the earliest, so deepest, patch that it is near to, or begins a new one. Sets the patch
/// of each. Pre: the contacts are sorted by depth.
std::vector<Patch> patches_of(std::span<const Contact> contacts, const ReductionOptions& options,
                              std::span<Membership> memberships) {
  PatchGrid grid(options, contacts.size());
  std::vector<Patch>& patches = grid.patches();
  const double chord = chord_of(options.max_angle);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    const Place place = place_of(c);
    std::uint32_t joined = no_patch;
    grid.visit_near(place, [&](std::uint32_t patch) {
      const Contact& first = contacts[patches[patch].first];
      const bool is_near = length_sq(offset(first, c, options.radius)) <= 1;
      if (is_near && length_sq(c.normal - first.normal) <= chord * chord) joined = std::min(joined, patch);
    });
    if (joined == no_patch) {
      joined = static_cast<std::uint32_t>(patches.size());
      grid.add(place, i);
    }
    memberships[i].patch = joined;
  }
  return std::move(patches);
}

/// A contact of a patch, projected along the normal of the patch's first contact.
struct Member {
  std::size_t contact;
  Vec3 flat;                                                  // its projection, relative to the first contact, in radii
  double apart_sq = std::numeric_limits<double>::infinity();  // squared distance from the nearest that is kept
};

/// Calls keep(contact) for the first member, and then always for the one that is farthest from those that are kept.
template <typename Keep>
void keep_spanning(std::span<Member> members, std::size_t max_points, const Keep& keep) {
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

/// All contacts, patch by patch. Sets the ends of the patches.
std::vector<Member> members_of(std::span<Patch> patches, std::span<const Contact> contacts,
                               std::span<const Membership> memberships, double radius) {
  // A counting sort. `end` is first how many members a patch has, then where they begin, and in the end, as members are
  // added, where they end.
  for (const Membership& m : memberships) ++patches[m.patch].end;
  std::size_t begin = 0;
  for (Patch& patch : patches) begin += std::exchange(patch.end, begin);
  LIMBER_ASSERT(begin == contacts.size() && memberships.size() == contacts.size());
  std::vector<Member> members(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Patch& patch = patches[memberships[i].patch];
    const Contact& first = contacts[patch.first];
    const Vec3 apart = offset(first, contacts[i], radius);
    members[patch.end++] = {i, apart - dot(apart, first.normal) * first.normal};
  }
  return members;
}

}  // namespace

std::size_t reduce_contacts(std::span<Contact> contacts, const ReductionOptions& options,
                            std::span<std::uint32_t> patch_ids) {
  const base::DefaultFloatEnvironment environment;
  check(contacts, options);
  if (contacts.empty()) return 0;
  std::vector<Contact> sorted(contacts.begin(), contacts.end());
  std::sort(sorted.begin(), sorted.end(), is_deeper);
  std::vector<Membership> memberships(sorted.size());
  std::vector<Patch> patches = patches_of(sorted, options, memberships);
  std::vector<Member> members = members_of(patches, sorted, memberships, options.radius);
  // The kept contacts come first in the caller's span, patch by patch, then all others.
  std::size_t next = 0, begin = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const std::span<Member> all = std::span(members).subspan(begin, patches[p].end - begin);
    keep_spanning(all, options.max_points, [&](std::size_t i) {
      memberships[i].is_kept = true;
      if (next < patch_ids.size()) patch_ids[next] = static_cast<std::uint32_t>(p);
      contacts[next++] = sorted[i];
    });
    begin = patches[p].end;
  }
  const std::size_t kept = next;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!memberships[i].is_kept) contacts[next++] = sorted[i];
  }
  LIMBER_ASSERT(next == contacts.size());
  return kept;
}

}  // namespace limber
