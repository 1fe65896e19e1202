// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/access.h"
#include "model/model_impl.h"

namespace limber::testing {

/// What is behind the public interface of a model.
inline const bvh::Tree& tree_of(const Model& model) { return Access::impl(model).tree; }

}  // namespace limber::testing
