// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels in WebAssembly's vectors, in place of kernels.cpp: a module has one instruction set, so there is nothing
// to choose at run time. docs/design/web.md says why not by Highway.
#define LIMBER_WASM_KERNELS
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
