// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels one SIMD lane at a time: what every instruction set is compared with, bit by bit.
#define LIMBER_SCALAR_KERNELS
#include "kernels/bound_children-inl.h"
#include "kernels/bound_far_point-inl.h"
#include "kernels/bound_point-inl.h"
#include "kernels/compare_segments-inl.h"
#include "kernels/compare_triangles-inl.h"
#include "kernels/extend_box-inl.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/find_close_elements-inl.h"
#include "kernels/find_crossed-inl.h"
#include "kernels/fit_leaves-inl.h"
#include "kernels/least_of_few-inl.h"
#include "kernels/max_displacement-inl.h"
#include "kernels/merge_bounds-inl.h"
#include "kernels/overlapping_boxes-inl.h"
#include "simd/kernels.h"

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
