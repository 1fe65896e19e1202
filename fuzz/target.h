// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

/// What every fuzz target defines: runs one input, and ends the process when a property does not hold.
///
/// libFuzzer calls it with inputs of its making, replay_main.cpp with files. The name is libFuzzer's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
