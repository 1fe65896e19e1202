// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/closedness.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace limber::mesh {
namespace {

/// A triangle that runs through an edge.
struct EdgeUse {
  VertexId low, high;  // the ends
  TriangleId triangle;
  bool is_forward;  // from the low one to the high one
};

Error not_closed(const EdgeUse& use, const std::string& what) {
  return {ErrorCode::not_closed,
          "the surface is not closed: the edge of triangle " + std::to_string(use.triangle) + " between vertices " +
              std::to_string(use.low) + " and " + std::to_string(use.high) + " " + what,
          use.triangle};
}

/// What is wrong with an edge, by all of its uses.
std::string fault_of(std::span<const EdgeUse> uses) {
  if (uses.front().low == uses.front().high) return "is a point";
  if (uses.size() == 1) return "belongs to no other triangle";
  if (uses.size() > 2) return "belongs to " + std::to_string(uses.size()) + " triangles";
  if (uses[0].is_forward == uses[1].is_forward) {
    return "is run through in the same direction by triangle " + std::to_string(uses[1].triangle);
  }
  return {};
}

}  // namespace

Result<void> check_closed(std::span<const Corners> triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (TriangleId t = 0; t < triangles.size(); ++t) {
    const Corners& c = triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId from = c[i], to = c[(i + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  const EdgeUse* worst = nullptr;
  std::string fault;
  for (auto first = uses.begin(); first != uses.end();) {
    const auto last = std::find_if(
        first, uses.end(), [&](const EdgeUse& use) { return use.low != first->low || use.high != first->high; });
    if (worst == nullptr || first->triangle < worst->triangle) {
      const std::string found = fault_of({&*first, static_cast<std::size_t>(last - first)});
      if (!found.empty()) worst = &*first, fault = found;
    }
    first = last;
  }
  if (worst != nullptr) return not_closed(*worst, fault);
  return {};
}

}  // namespace limber::mesh
