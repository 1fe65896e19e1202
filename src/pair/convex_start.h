// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace limber::pair {

/// The corners of the last simplex, for the next query of the two bodies.
struct ConvexStart {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 3> a{}, b{};
};

}  // namespace limber::pair
