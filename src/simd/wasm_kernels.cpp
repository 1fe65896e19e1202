// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels in WebAssembly's vectors, in place of kernels.cpp: a module has one instruction set, so there is nothing
// to choose at run time. clients/javascript/README.md says why not by Highway.
#define LIMBER_WASM_KERNELS
#include "kernels/all-inl.h"
#include "simd/kernels.h"

namespace limber::simd {
namespace {

const Kernels wasm_kernels = wasm::table("WASM");

const Kernels* chosen_kernels = &wasm_kernels;

}  // namespace

const Kernels& kernels() { return *chosen_kernels; }

std::span<const Kernels> all_kernels() {
  static const Kernels all[] = {wasm_kernels, scalar_kernels};
  return all;
}

void use_kernels(const Kernels* chosen) { chosen_kernels = chosen != nullptr ? chosen : &wasm_kernels; }

}  // namespace limber::simd
