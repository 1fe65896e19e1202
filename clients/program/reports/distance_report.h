// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "answers/answers.h"
#include "answers/models.h"
#include "reports/page_template.h"

/// The page of `limber distance --report`.
namespace limber::program {

/// All that the page shows: the answer, both meshes, and the triangles that intersect.
Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer);

}  // namespace limber::program
