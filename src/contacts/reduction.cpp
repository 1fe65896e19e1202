// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  The reduction of contact manifolds in Bullet, Jolt and Rapier: the deepest contact, then those that span
//           most.
// Differs   Those reduce the contacts of one pair of convex shapes. Here patches come first: by distance and normal
//           from the deepest contact that is in none yet, found in a grid. Further contacts of a patch are sampled
//           farthest first [Gonzalez1985], which serves any number of them.
#include "limber/contacts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"

namespace limber {
namespace {

constexpr std::uint32_t no_patch = std::numeric_limits<std::uint32_t>::max();
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

/// The cells of one coordinate that numbers fall into: each a little wider than twice what counts as near.
///
/// A cell is named by its number, which is exact below 2^53. Where numbers would be larger, different coordinates are
/// never near each other: there each coordinate is a cell of its own, named by itself.
class Cells {
 public:
  /// Pre      near > 0.
  explicit Cells(double near) : reach_(near * (1 + 0x1p-10)), per_unit_(1 / std::max(2 * reach_, 0x1p-1020)) {}

  double of(double x) const {
    const double at = x * per_unit_;
    return std::abs(at) < most ? std::floor(at) : x;
  }

  /// All cells that may have a number near x: two, or a few more where rounding makes steps as large as cells. Rounding
  /// keeps the order of numbers, so what is within reach of x is in these.
  struct Range {
    double first, last;
  };
  Range around(double x) const {
    if (!(std::abs(x * per_unit_) < most)) return {x, x};
    constexpr double largest = std::numeric_limits<double>::max();
    const double low = std::max(x - reach_, -largest), high = std::min(x + reach_, largest);
    return {std::floor(low * per_unit_), std::floor(high * per_unit_)};
  }

 private:
  static constexpr double most = 0x1p53;
  double reach_, per_unit_;
};

/// What a contact is found by: its position and its normal.
using Place = std::array<double, 6>;

Place place_of(const Contact& c) {
  const Vec3 p = position_of(c);
  return {p.x, p.y, p.z, c.normal.x, c.normal.y, c.normal.z};
}

double chord_of(double angle) { return 2 * std::sin(angle / 2); }

/// Contacts that belong together.
struct Patch {
  std::size_t first;     // contact
  std::uint32_t before;  // patch in the same bucket
  std::size_t end;       // of its members, in the list of all
};

/// Patches in a hash table of cells, by the places of their first contacts.
class RegionGrid {
 public:
  RegionGrid(const ReductionOptions& options, std::size_t capacity)
      : positions_(options.radius),
        normals_(std::max(chord_of(options.max_angle), 0x1p-500)),
        axis_count_(chord_of(options.max_angle) < 0.0625 ? 6 : 3),
        last_in_(std::bit_ceil(2 * capacity + 1), no_patch) {
    patches_.reserve(capacity);
  }

  std::vector<Patch>& patches() { return patches_; }

  void add(const Place& place, std::size_t first_contact) {
    std::uint64_t hash = 0;
    for (std::size_t axis = 0; axis < axis_count_; ++axis) hash = mixed(hash, cells(axis).of(place[axis]));
    std::uint32_t& last = last_in_[hash & (last_in_.size() - 1)];
    patches_.push_back({first_contact, last, 0});
    last = static_cast<std::uint32_t>(patches_.size() - 1);
  }

  /// Calls visit(patch) for all that may be near, some of them more than once.
  template <typename Visit>
  void visit_near(const Place& place, const Visit& visit) const {
    visit_near(place, 0, 0, visit);
  }

 private:
  const Cells& cells(std::size_t axis) const { return axis < 3 ? positions_ : normals_; }

  // Cells that share a bucket cost time only.
  static std::uint64_t mixed(std::uint64_t hash, double cell) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(cell + 0.0)) * 0x9e37'79b9'7f4a'7c15U;  // + 0.0: one zero of two
    return hash ^ hash >> 32U;
  }

  template <typename Visit>
  void visit_near(const Place& place, std::size_t axis, std::uint64_t hash, const Visit& visit) const {
    if (axis == axis_count_) {
      std::uint32_t i = last_in_[hash & (last_in_.size() - 1)];
      for (; i != no_patch; i = patches_[i].before) visit(i);
      return;
    }
    const Cells::Range range = cells(axis).around(place[axis]);
    LIMBER_ASSERT(range.first <= range.last);
    for (double cell = range.first;; ++cell) {
      visit_near(place, axis + 1, mixed(hash, cell), visit);
      if (cell >= range.last) return;
    }
  }

  // Normals tell places apart only where they must be so close that many patches fit around one point. Squares of
  // differences below 2^-500 vanish, so these count as none.
  Cells positions_, normals_;
  std::size_t axis_count_;
  std::vector<std::uint32_t> last_in_;  // of each bucket
  std::vector<Patch> patches_;
};

/// Where a contact belongs.
struct Membership {
  std::uint32_t patch;
  bool is_kept = false;
};

/// Which contacts belong together: each to the first patch it is close enough to. Sets the patch of each.
std::vector<Patch> patches_of(std::span<const Contact> contacts, const ReductionOptions& options,
                              std::span<Membership> memberships) {
  RegionGrid grid(options, contacts.size());
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

/// A contact of a patch, on the plane across the normal of its first one.
struct Member {
  std::size_t contact;
  Vec3 flat;                                                  // from the first one, in radii
  double apart_sq = std::numeric_limits<double>::infinity();  // from the nearest that is kept
};

/// Calls keep(contact) for the first, and for those that span most.
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
  // First how many each has, then where each begins; that becomes the end as members are added.
  for (const Membership& m : memberships) ++patches[m.patch].end;
  std::size_t begin = 0;
  for (Patch& r : patches) begin += std::exchange(r.end, begin);
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
                            std::span<std::uint32_t> patches) {
  const base::DefaultFloatEnvironment environment;
  check(contacts, options);
  if (contacts.empty()) return 0;
  std::vector<Contact> sorted(contacts.begin(), contacts.end());
  std::sort(sorted.begin(), sorted.end(), is_deeper);
  std::vector<Membership> memberships(sorted.size());
  std::vector<Patch> found = patches_of(sorted, options, memberships);
  std::vector<Member> members = members_of(found, sorted, memberships, options.radius);
  std::size_t next = 0, begin = 0;
  for (std::size_t r = 0; r < found.size(); ++r) {
    const std::span<Member> all = std::span(members).subspan(begin, found[r].end - begin);
    keep_spanning(all, options.max_points, [&](std::size_t i) {
      memberships[i].is_kept = true;
      if (next < patches.size()) patches[next] = static_cast<std::uint32_t>(r);
      contacts[next++] = sorted[i];
    });
    begin = found[r].end;
  }
  const std::size_t kept = next;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!memberships[i].is_kept) contacts[next++] = sorted[i];
  }
  LIMBER_ASSERT(next == contacts.size());
  return kept;
}

}  // namespace limber
