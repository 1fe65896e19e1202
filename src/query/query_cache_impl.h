// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/model.h"
#include "query/front.h"

namespace limber {

struct QueryCache::Impl {
  TriangleId triangle_a = no_id, triangle_b = no_id;  // the last answer
  query::Front front;
};

}  // namespace limber
