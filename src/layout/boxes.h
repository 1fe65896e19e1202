// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "layout/node.h"

namespace limber::bvh {

/// Up to `width` boxes along the axes, as a structure of arrays in float64. Slots beyond them are empty: low is
/// +infinity, high -infinity.
struct alignas(64) BoxNode {
  double low[3][width], high[3][width];
};
static_assert(sizeof(BoxNode) == 48 * width);

}  // namespace limber::bvh
