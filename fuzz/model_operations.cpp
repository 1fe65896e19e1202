// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as two small meshes and a sequence of operations on their models, against brute force.
#include "fuzz/model_session.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limber::fuzz::ModelSession(limber::fuzz::ByteReader({data, size})).run();
  return 0;
}
