// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model_impl.h"

namespace limber::testing {

/// What is behind the public interface of a model.
inline const bvh::Tree& tree_of(const Model& model) { return model.impl().tree; }

}  // namespace limber::testing
