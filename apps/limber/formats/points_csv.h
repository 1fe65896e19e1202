// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "limber/math.h"

namespace limber::program {

/// The points of a CSV file, one per row. A first row of names alone is a header: it names the columns x, y and z, in
/// any order, and others may stand between them. Without a header a row has the three numbers alone.
///
/// Errors   BadInput naming the file and, where there are some, line and column; also for a number that is not finite
///          or above `max_coordinate` in size.
std::vector<Vec3> read_points(const std::string& path);

}  // namespace limber::program
