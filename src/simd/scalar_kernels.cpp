// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels one SIMD lane at a time: what every instruction set is compared with, bit by bit.
#define LIMBER_SCALAR_KERNELS
#include "simd/bound_children-inl.h"
#include "simd/bound_far_point-inl.h"
#include "simd/bound_point-inl.h"
#include "simd/compare_segments-inl.h"
#include "simd/compare_triangles-inl.h"
#include "simd/extend_box-inl.h"
#include "simd/find_candidates-inl.h"
#include "simd/find_close_elements-inl.h"
#include "simd/find_crossed-inl.h"
#include "simd/fit_leaves-inl.h"
#include "simd/kernels.h"
#include "simd/least_of_few-inl.h"
#include "simd/max_displacement-inl.h"
#include "simd/merge_bounds-inl.h"
#include "simd/overlapping_boxes-inl.h"

namespace limber::simd {

const Kernels scalar_kernels{"scalar",
                             scalar::bound_children,
                             scalar::find_candidates,
                             scalar::find_close_elements,
                             scalar::bound_children_to_point,
                             scalar::bound_children_along,
                             scalar::bound_triangles_to_point,
                             scalar::bound_triangles_along,
                             scalar::find_crossed_children,
                             scalar::find_crossed_triangles,
                             scalar::fit_leaves,
                             scalar::merge_bounds,
                             scalar::max_displacement,
                             scalar::extend_box,
                             scalar::least_of_few,
                             scalar::overlapping_boxes,
                             scalar::overlapping_pairs,
                             scalar::compare_triangles,
                             scalar::compare_segments};

}  // namespace limber::simd
