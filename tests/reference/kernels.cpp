// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// For builds with shared libraries, which do not show their kernels: here the geometry of single triangles has the
// scalar ones, which give the same bits.
#include "simd/kernels.h"

namespace limber::simd {

const Kernels& kernels() { return scalar_kernels; }

}  // namespace limber::simd
