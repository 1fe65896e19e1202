// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "base/float_environment.h"
#include "reference/reference.h"

namespace limber::reference {
namespace {

/// A contact as the rules see it.
struct Placing {
  Contact contact;
  double gap;
  Vec3 position;
};

Placing placing_of(const Contact& c) { return {c, c.distance - c.depth, 0.5 * c.point_a + 0.5 * c.point_b}; }

bool comes_before(const Placing& p, const Placing& q) {
  const auto key = [](const Placing& x) {
    const Contact& c = x.contact;
    return std::tuple(x.gap, c.triangle_a, c.triangle_b, c.point_a.x, c.point_a.y, c.point_a.z, c.point_b.x,
                      c.point_b.y, c.point_b.z, c.normal.x, c.normal.y, c.normal.z, c.distance, c.weights_a.x,
                      c.weights_a.y, c.weights_a.z, c.weights_b.x, c.weights_b.y, c.weights_b.z);
  };
  return key(p) < key(q);
}

Vec3 radii_between(const Placing& p, const Placing& q, double radius) {
  const Vec3 v = q.position - p.position;
  return {v.x / radius, v.y / radius, v.z / radius};
}

bool belongs_to(const Placing& p, const Placing& first, double radius, double max_angle) {
  const double chord = 2 * std::sin(max_angle / 2);
  return length_sq(radii_between(first, p, radius)) <= 1 &&
         length_sq(p.contact.normal - first.contact.normal) <= chord * chord;
}

/// The squared distance of two contacts of a patch as seen along the normal of its first one, in squared radii.
double seen_apart_sq(const Placing& p, const Placing& q, const Placing& first, double radius) {
  const auto flat = [&](const Placing& x) {
    const Vec3 v = radii_between(first, x, radius);
    return v - dot(v, first.contact.normal) * first.contact.normal;
  };
  return length_sq(flat(p) - flat(q));
}

void append_manifold(const std::vector<Placing>& patch, double radius, std::size_t max_points,
                     std::vector<Contact>& kept) {
  std::vector<Placing> manifold{patch.front()};
  while (manifold.size() < max_points) {
    const Placing* farthest = nullptr;
    double most = 0.25 * 0.25;
    for (const Placing& p : patch) {
      double least = seen_apart_sq(p, manifold.front(), patch.front(), radius);
      for (const Placing& q : manifold) {
        least = std::min(least, seen_apart_sq(p, q, patch.front(), radius));
      }
      if (least > most) most = least, farthest = &p;
    }
    if (farthest == nullptr) break;
    manifold.push_back(*farthest);
  }
  for (const Placing& p : manifold) kept.push_back(p.contact);
}

}  // namespace

std::vector<Contact> reduced_contacts(std::span<const Contact> contacts, double radius,
                                      const ReductionOptions& options) {
  const base::DefaultFloatEnvironment environment;
  std::vector<Placing> sorted;
  for (const Contact& c : contacts) sorted.push_back(placing_of(c));
  std::sort(sorted.begin(), sorted.end(), comes_before);
  std::vector<std::vector<Placing>> patches;
  for (const Placing& p : sorted) {
    const auto joined = std::find_if(patches.begin(), patches.end(), [&](const std::vector<Placing>& r) {
      return belongs_to(p, r.front(), radius, options.max_angle);
    });
    if (joined == patches.end()) {
      patches.push_back({p});
    } else {
      joined->push_back(p);
    }
  }
  std::vector<Contact> kept;
  for (const std::vector<Placing>& patch : patches) append_manifold(patch, radius, options.max_points, kept);
  return kept;
}

}  // namespace limber::reference
