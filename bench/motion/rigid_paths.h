// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/support/report.h"

namespace limber::bench {

/// Times the first impact of a bunny that flies past or into an armadillo and turns by half a turn, next to FCL's
/// conservative advancement. Appends its table.
void compare_rigid_paths(const Options& options, Checker& checker, Table& table);

}  // namespace limber::bench
