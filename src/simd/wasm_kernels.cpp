// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels in WebAssembly's vectors, in place of kernels.cpp: a module has one instruction set, so there is nothing
// to choose at run time. docs/design/web.md says why not by Highway.
#define LIMBER_WASM_KERNELS
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
namespace {

const Kernels wasm_kernels{"WASM",
                           wasm::bound_children,
                           wasm::find_candidates,
                           wasm::find_close_elements,
                           wasm::bound_children_to_point,
                           wasm::bound_children_along,
                           wasm::bound_triangles_to_point,
                           wasm::bound_triangles_along,
                           wasm::find_crossed_children,
                           wasm::find_crossed_triangles,
                           wasm::fit_leaves,
                           wasm::merge_bounds,
                           wasm::max_displacement,
                           wasm::extend_box,
                           wasm::least_of_few,
                           wasm::overlapping_boxes,
                           wasm::overlapping_pairs,
                           wasm::compare_triangles,
                           wasm::compare_segments};

const Kernels* chosen_kernels = &wasm_kernels;

}  // namespace

const Kernels& kernels() { return *chosen_kernels; }

std::span<const Kernels> all_kernels() {
  static const Kernels all[] = {wasm_kernels, scalar_kernels};
  return all;
}

void use_kernels(const Kernels* chosen) { chosen_kernels = chosen != nullptr ? chosen : &wasm_kernels; }

}  // namespace limber::simd
