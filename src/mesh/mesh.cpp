// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Meshes: what a valid one is, how positions are read from foreign arrays, updates, and welding. What is checked of
// positions is checked by a kernel of all at once; a loop looks for the first bad one only where there is one.
#include "mesh/updates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/mesh.h"
#include "simd/kernels.h"

namespace limber {
namespace {

// Vertices and triangles have 32-bit ids, and so have the slots of the 8-wide tree over them: each has a bit to spare.
constexpr std::size_t max_elements = std::size_t{1} << 31;

Error size_mismatch(std::size_t positions, std::size_t count, const char* wanted) {
  return {ErrorCode::size_mismatch, std::to_string(positions) + " positions for " + std::to_string(count) + wanted, {}};
}

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

/// Whether each edge is run through as often in one direction as in the other; one from a vertex to itself does not
/// count. No false negatives; false positives with probability 2^-64, if hashes are as good as random.
///
/// Based on  the boundary of a chain of triangles: the sum of their directed edges, in which opposite ones cancel.
/// Differs   Edges are replaced by 64-bit hashes, so that the sum is a number: 0 if the boundary is, and otherwise as
///           random. A table of edges would tell for certain, at many times the cost of all else that is
///           checked of a new mesh.
bool has_no_boundary(std::span<const Corners> triangles) {
  std::uint64_t sum = 0;
  for (const Corners& c : triangles) {
    sum += hash_of_edge(c[0], c[1]) + hash_of_edge(c[1], c[2]) + hash_of_edge(c[2], c[0]);
  }
  return sum == 0;
}

simd::Displacement displacements(std::span<const Vec3> from, std::span<const Vec3> to) {
  return simd::kernels().max_displacement(from.data(), to.data(), to.size(), max_coordinate);
}

/// Whether all positions are finite and within the limit. The kernel says so of the ends of displacements; here each
/// position is the end of its displacement from itself.
bool are_valid(std::span<const Vec3> positions) { return displacements(positions, positions).is_bounded; }

/// Errors name the i-th position as `before`, i, `after`.
Result<void> check_named_positions(std::span<const Vec3> positions, const char* before, const char* after) {
  if (are_valid(positions)) return {};  // all at once, since nearly always all are
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (is_finite(positions[i]) && max_abs(positions[i]) <= max_coordinate) continue;
    const std::string name = before + std::to_string(i) + after;
    if (!is_finite(positions[i])) return Error{ErrorCode::non_finite, name + " is not finite", i};
    return Error{ErrorCode::too_large, name + " has a coordinate above the limit of 2^200", i};
  }
  return {};
}

void require_stride(std::size_t stride_bytes) {
  LIMBER_REQUIRE(stride_bytes <= static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max()),
                 "limber::PositionsView::strided: the stride is negative, or larger than any memory");
}

template <typename Float>
Vec3 position_at(const unsigned char* bytes) {
  Float v[3];
  std::memcpy(v, bytes, sizeof(v));
  return {v[0], v[1], v[2]};
}

}  // namespace

Result<void> check_positions(std::span<const Vec3> positions) {
  return check_named_positions(positions, "vertex ", "");
}

Result<void> check_mesh(MeshView mesh) {
  if (mesh.triangles.empty()) return Error{ErrorCode::empty_mesh, "the mesh has no triangle", {}};
  if (mesh.positions.size() >= max_elements || mesh.triangles.size() >= max_elements) {
    return Error{ErrorCode::too_large, "the mesh has 2^31 or more vertices or triangles", {}};
  }
  if (auto positions = check_positions(mesh.positions); !positions) return positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const VertexId v : mesh.triangles[t]) {
      if (v < mesh.positions.size()) continue;
      return Error{ErrorCode::index_out_of_range,
                   "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + ", but there are only " +
                       std::to_string(mesh.positions.size()) + " vertices",
                   t};
    }
  }
  return {};
}

Result<Mesh> Mesh::create(std::vector<Vec3> positions, std::vector<Corners> triangles) {
  if (auto valid = check_mesh({positions, triangles}); !valid) return valid.error();
  return Mesh(std::move(positions), std::move(triangles));
}

PositionsView PositionsView::packed(std::span<const float> coordinates) {
  LIMBER_REQUIRE(coordinates.size() % 3 == 0, "limber::PositionsView::packed: not three coordinates a vertex");
  return strided(coordinates.data(), coordinates.size() / 3, 3 * sizeof(float));
}

PositionsView PositionsView::packed(std::span<const double> coordinates) {
  LIMBER_REQUIRE(coordinates.size() % 3 == 0, "limber::PositionsView::packed: not three coordinates a vertex");
  return strided(coordinates.data(), coordinates.size() / 3, 3 * sizeof(double));
}

PositionsView PositionsView::strided(const float* first, std::size_t count, std::size_t stride_bytes) {
  require_stride(stride_bytes);
  return {first, count, stride_bytes, true};
}

PositionsView PositionsView::strided(const double* first, std::size_t count, std::size_t stride_bytes) {
  require_stride(stride_bytes);
  return {first, count, stride_bytes, false};
}

Vec3 PositionsView::operator[](std::size_t i) const {
  LIMBER_ASSERT(i < count_);
  const unsigned char* const at = first_ + i * stride_bytes_;
  return is_float32_ ? position_at<float>(at) : position_at<double>(at);
}

void PositionsView::copy_to(std::span<Vec3> positions) const {
  LIMBER_ASSERT(positions.size() == count_);
  for (std::size_t i = 0; i < count_; ++i) positions[i] = (*this)[i];
}

Result<Mesh> Mesh::create(const PositionsView& positions, std::vector<Corners> triangles) {
  std::vector<Vec3> copy(positions.size());
  positions.copy_to(copy);
  return create(std::move(copy), std::move(triangles));
}

Mesh::Mesh(std::vector<Vec3> positions, std::vector<Corners> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)), is_closed_(has_no_boundary(triangles_)) {}

Result<void> Mesh::set_position(VertexId id, const Vec3& position) { return set_positions({&id, 1}, {&position, 1}); }

Result<void> Mesh::set_positions(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  if (auto valid = check_update(*this, ids, positions); !valid) return valid;
  MeshWriter::set_positions(*this, ids, positions);
  return {};
}

Result<void> Mesh::set_positions(std::span<const Vec3> positions) {
  if (auto valid = check_update_of_all(*this, positions); !valid) return valid;
  MeshWriter::set_positions(*this, positions);
  return {};
}

void MeshWriter::set_positions(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions) {
  LIMBER_VALIDATE(check_update(mesh, ids, positions));
  if (overlaps(mesh, positions)) {
    const std::vector<Vec3> copy(positions.begin(), positions.end());
    return set_positions(mesh, ids, copy);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) mesh.positions_[ids[i]] = positions[i];
}

void MeshWriter::set_positions(Mesh& mesh, std::span<const Vec3> positions) {
  LIMBER_VALIDATE(check_update_of_all(mesh, positions));
  if (positions.data() == mesh.positions_.data()) return;
  std::copy(positions.begin(), positions.end(), mesh.positions_.begin());
}

bool overlaps(const Mesh& mesh, std::span<const Vec3> positions) {
  const std::vector<Vec3>& own = mesh.positions();
  const std::less<> before;  // a total order of pointers into different arrays, unlike <
  return before(positions.data(), own.data() + own.size()) && before(own.data(), positions.data() + positions.size());
}

Result<void> check_update(const Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions) {
  if (ids.size() != positions.size()) return size_mismatch(positions.size(), ids.size(), " ids");
  const std::size_t vertex_count = mesh.positions().size();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < vertex_count) continue;
    return Error{ErrorCode::index_out_of_range,
                 "entry " + std::to_string(i) + " of the update names vertex " + std::to_string(ids[i]) +
                     ", but there are only " + std::to_string(vertex_count),
                 i};
  }
  return check_named_positions(positions, "entry ", " of the update");
}

Result<void> check_update_of_all(const Mesh& mesh, std::span<const Vec3> positions) {
  const std::size_t vertex_count = mesh.positions().size();
  if (positions.size() != vertex_count) return size_mismatch(positions.size(), vertex_count, " vertices");
  return check_named_positions(positions, "entry ", " of the update");
}

Result<double> check_displacements(const Mesh& mesh, std::span<const Vec3> positions) {
  if (positions.size() == mesh.positions().size()) {
    const simd::Displacement displacement = displacements(mesh.positions(), positions);
    if (displacement.is_bounded) return displacement.farthest_sq;
  }
  const auto valid = check_update_of_all(mesh, positions);
  LIMBER_ASSERT(!valid);
  return valid.error();
}

Weld weld(std::span<const Vec3> positions) {
  LIMBER_REQUIRE(positions.size() < no_id, "limber::weld: there are more positions than ids can count");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    LIMBER_REQUIRE(!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z),
                   ("limber::weld: vertex " + std::to_string(v) + " has a coordinate that is not a number").c_str());
  }
  std::vector<VertexId> order(positions.size());
  std::iota(order.begin(), order.end(), VertexId{0});
  std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
    const Vec3 &p = positions[a], &q = positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  // For each vertex the one before it at the same position; itself if it is the first.
  std::vector<VertexId> before(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_first = i == 0 || positions[order[i]] != positions[order[i - 1]];
    before[order[i]] = is_first ? order[i] : order[i - 1];
  }
  Weld result;
  result.welded_of.resize(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const bool is_first = before[v] == v;
    result.welded_of[v] = is_first ? static_cast<VertexId>(result.first_of.size()) : result.welded_of[before[v]];
    if (is_first) result.first_of.push_back(static_cast<VertexId>(v));
  }
  return result;
}

WeldedMesh weld(const Mesh& mesh) {
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::weld: the mesh has been moved from");
  Weld vertices = weld(mesh.positions());
  std::vector<Vec3> positions;
  positions.reserve(vertices.first_of.size());
  for (const VertexId v : vertices.first_of) positions.push_back(mesh.positions()[v]);
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& corners : triangles) {
    for (VertexId& v : corners) v = vertices.welded_of[v];
  }
  LIMBER_ASSERT(vertices.welded_of.size() == mesh.positions().size());
  return {Mesh::create(std::move(positions), std::move(triangles)).value(), std::move(vertices)};
}

}  // namespace limber
