// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Costs of refits, in ns. Only the ratios matter, and those are much the same on all machines.
namespace limber::bvh {

/// In a commit: the refit of a dirty node, and that of each node where the whole tree is fitted
/// (docs/design/deforming.md).
inline constexpr double ns_per_refit = 330, ns_per_refit_in_pass = 225;

/// In a rebuild, which does them one by one, so that nothing is prefetched: the refit of a node on the lowest level,
/// and of one above (docs/design/real_time.md).
inline constexpr double ns_per_lowest_node = 600, ns_per_upper_node = 200;

}  // namespace limber::bvh
