// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reference/reference.h"

namespace limber::testing {

/// The distance that reference::distance finds, to the bit, for tests that ask for it thousands of times: all pairs of
/// triangles, but of those whose boxes are farther apart than the closest pair so far only the boxes.
double brute_force_distance(const reference::Placed& a, const reference::Placed& b);

}  // namespace limber::testing
