// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <utility>

#include "bench/support/report.h"

namespace limber::bench {

/// Warm starts, growth with the number of triangles, build times and memory.
void measure_more(const Options& options, const std::filesystem::path& meshes, Checker& checker, Markdown& table);

}  // namespace limber::bench
