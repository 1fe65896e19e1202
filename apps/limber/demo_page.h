// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "demo_run.h"

namespace limber::program {

/// A self-contained page: pictures, curves and the summary of a run.
std::string demo_page(const DemoRun& run);

}  // namespace limber::program
