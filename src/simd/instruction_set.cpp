// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/base.h"
#include "simd/kernels.h"

namespace limber {

const char* instruction_set() noexcept { return simd::kernels().name; }

}  // namespace limber
