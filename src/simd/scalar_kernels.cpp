// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels one SIMD lane at a time: what every instruction set is compared with, bit by bit.
#define LIMBER_SCALAR_KERNELS
#include "kernels/all-inl.h"
#include "limber/base.h"
#include "simd/kernels.h"

namespace limber {

constinit const simd::Kernels simd::scalar_kernels = scalar::table("scalar");

const char* instruction_set() noexcept { return simd::kernels().name; }

}  // namespace limber
