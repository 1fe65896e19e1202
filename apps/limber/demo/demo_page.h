// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "demo/demo_run.h"

namespace limber::program {

/// A page that plays the run, with charts and its summary. The command line is what the page says about its making.
std::string demo_page(const DemoRun& run, const std::string& command_line);

}  // namespace limber::program
