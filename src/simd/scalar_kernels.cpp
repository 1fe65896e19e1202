// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels one SIMD lane at a time: what every instruction set is compared with, bit by bit.
#define LIMBER_SCALAR_KERNELS
#include "kernels/all-inl.h"
#include "simd/kernels.h"

namespace limber::simd {

constinit const Kernels scalar_kernels = scalar::table("scalar");

}  // namespace limber::simd
