// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <oneapi/tbb/task_arena.h>

#include <array>
#include <bit>
#include <cstdint>

#include "limber/geometry.h"

namespace limber::testing {

/// Calls something on several threads, also where the machine has one.
template <typename Call>
void on_threads(const Call& call) {
  oneapi::tbb::task_arena arena(4);
  arena.execute(call);
}

/// For comparing answers to the bit.
inline std::array<std::uint64_t, 3> bits_of(const Vec3& v) { return std::bit_cast<std::array<std::uint64_t, 3>>(v); }

}  // namespace limber::testing
