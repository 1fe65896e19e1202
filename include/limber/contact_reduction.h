// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "limber/contacts.h"

/// Fewer contacts for solvers of rigid bodies: from all pairs of triangles to one small manifold for each region.
namespace limber {

struct ReductionOptions {
  double radius = 0;           ///< of a region, in the length unit of the meshes; finite, above 0: there is no default
  double max_angle = 0.5;      ///< between normals of one region, in radians; from 0 to pi
  std::size_t max_points = 4;  ///< contacts that are kept of a region; at least 1
};

/// Keeps a few contacts of each region, and moves them to the front.
///
/// The contacts are taken from the deepest to the farthest, by distance - depth. The position of a contact is the
/// middle of its two points. A contact joins the deepest region whose first contact is at most `radius` away and has a
/// normal within `max_angle`; if there is none, it is the first of a new region. Of each region the first contact is
/// kept, then one at a time the one that is farthest from those kept, as seen along the normal of the first. That ends
/// where there are max_points, or where all others are within a quarter of the radius of one that is kept.
///
/// Shape    `contacts` as contacts() and self_contacts() write them, of any number of pairs of models. Returns how many
///          are kept. They are in front, region by region, the deepest region and the first of a region first. The
///          removed ones are behind them, the deepest first. regions[i] becomes the number of the region of contact i,
///          from 0, for the kept contacts that there is room for.
/// Promise  Each removed contact is at most `radius` away from a kept one that is at least as deep and whose normal is
///          within `max_angle`, up to rounding. First contacts of regions are farther apart than that.
///          The result does not depend on the order of the input, but for contacts that are equal in all numbers.
/// Throws   std::invalid_argument unless the options are what their comments say, and all numbers of the contacts are
///          finite; std::bad_alloc. The contacts are then as they were.
/// Cost     O(n log n) for n contacts wherever they are, times at most the number of regions that fit around one point:
///          about 16 / max_angle^2, and never more than some thousand, where normals differ so much there. Allocates
///          O(n), in five pieces.
/// Threads  Reentrant.
/// Source   Deepest contact first, then those that span most, as in Bullet, Jolt and Rapier;
///          docs/algorithms/contacts.md.
LIMBER_API std::size_t reduce_contacts(std::span<Contact> contacts, const ReductionOptions& options,
                                       std::span<std::uint32_t> regions = {});

}  // namespace limber
