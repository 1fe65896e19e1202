// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  the boundary of a chain of triangles: the sum of their directed edges, in which opposite ones cancel.
// Differs   Edges are replaced by 64-bit hashes, so that the sum is a number. It is 0 if the boundary is, and otherwise
//           as good as random. A table of edges would tell for certain, at many times the cost of all else that a new
//           mesh has checked.
#include "mesh/boundary.h"

#include <cstdint>

namespace limber {
namespace {

/// The hash of the edge from v to w; that of the opposite edge is its negative, modulo 2^64. No branch depends on ids,
/// which come in no order.
std::uint64_t hash_of_edge(VertexId v, VertexId w) {
  const std::uint64_t forward = std::uint64_t{v} << 32U | w, back = std::uint64_t{w} << 32U | v;
  // Multiplications carry bits up, shifts bring them down, as in the finalizer of SplitMix64.
  std::uint64_t hash = (forward < back ? forward : back) * 0xbf58'476d'1ce4'e5b9U;
  hash = (hash ^ hash >> 32U) * 0x94d0'49bb'1331'11ebU;
  hash ^= hash >> 29U;
  const std::uint64_t is_back = forward > back ? 1 : 0, counts = forward != back ? 1 : 0;
  return ((hash ^ (0 - is_back)) + is_back) & (0 - counts);
}

}  // namespace

bool has_no_boundary(std::span<const Corners> triangles) {
  std::uint64_t sum = 0;
  for (const Corners& c : triangles) {
    sum += hash_of_edge(c[0], c[1]) + hash_of_edge(c[1], c[2]) + hash_of_edge(c[2], c[0]);
  }
  return sum == 0;
}

}  // namespace limber
