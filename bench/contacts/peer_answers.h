// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/report.h"
#include "limber/mesh.h"

/// What peers.py has measured and answered, and what sets its answers apart from ours.
namespace limber::bench {

/// What is thrown for a line of a file that is not as expected.
std::runtime_error bad_line(const std::filesystem::path& file, const std::string& line);

/// A row of contact_peers.csv.
struct PeerRow {
  std::string peer, mesh, question, details;
  double us = 0;
  std::string count;

  /// The library's part of the details, up to the first semicolon: its setting.
  std::string setting() const { return details.substr(0, details.find(';')); }
};

/// All rows; none if the file is missing. Throws std::runtime_error if a line is not a row.
std::vector<PeerRow> read_peer_rows(const std::filesystem::path& csv);

/// The row with the shortest time; `part` occurs in its details.
std::optional<PeerRow> fastest(const std::vector<PeerRow>& rows, const std::string& peer, const std::string& mesh,
                               const std::string& question, const std::string& part = "");

/// Pairs of triangles, sorted, each once.
using IdPairs = std::vector<std::pair<TriangleId, TriangleId>>;
void sort_pairs(IdPairs& pairs);

/// Pairs of triangles that a peer has written: the first two numbers of each line. None if the file is missing.
std::optional<IdPairs> read_pairs(const std::filesystem::path& file);

/// Two meshes, or one mesh and itself; then pairs have the smaller id first.
struct MeshPair {
  MeshView a, b;
  bool is_self = false;
};

/// The pairs of triangles of one mesh that share no vertex, and to which a pair of elements written by the IPC Toolkit
/// belongs: two edges, or a vertex and a face, within the margin. None if a file is missing.
///
/// Throws   std::runtime_error or std::out_of_range if a line does not name elements of the mesh.
std::optional<IdPairs> read_ipc_pairs(const std::filesystem::path& edge_edge, const std::filesystem::path& face_vertex,
                                      MeshView mesh);

/// How two answers differ, and why.
struct Difference {
  std::string mesh, question, library;
  std::size_t ours = 0, theirs = 0, both = 0;
  std::map<std::string, std::size_t> only_ours, only_theirs;  ///< how many, by reason
};

/// Pairs of elements of one mesh, sorted.
struct ElementIds {
  std::vector<std::pair<VertexId, TriangleId>> vertex_face;
  std::vector<std::array<VertexId, 4>> edge_edge;  ///< two edges, each with the smaller vertex id first, in order
};
/// Those that the IPC Toolkit has written. None if a file is missing.
///
/// Throws   std::runtime_error if a line is not as expected.
std::optional<ElementIds> read_ipc_elements(const std::filesystem::path& edge_edge,
                                            const std::filesystem::path& face_vertex);

/// Compares pairs of elements with those of the IPC Toolkit. A difference is right if the distance is at the margin, up
/// to a billionth.
Difference compare_elements(const std::string& mesh, MeshView view, double margin, const ElementIds& ours,
                            const ElementIds& theirs, Checker& checker);

/// Compares intersecting pairs with those of a peer that takes positions as float, and counts those alone that pass
/// through each other: an edge of one through the inside of the other, and not triangles that share an edge. A
/// difference without a reason, and one in which ours is not the exact answer for this pair of triangles, is wrong.
Difference compare_crossings(const std::string& mesh, const std::string& library, const MeshPair& meshes,
                             const IdPairs& ours, const IdPairs& theirs, Checker& checker);

/// How well a peer's distances are known.
struct Tolerance {
  double relative = 0, absolute = 0;
  bool finds_intersections = true;  ///< if not, pairs that intersect may be missing
};

/// Compares pairs within a margin. A difference is right if the distance is so near to the margin that the peer's
/// tolerance explains it.
Difference compare_within(const std::string& mesh, const std::string& library, const MeshPair& meshes, double margin,
                          const IdPairs& ours, const IdPairs& theirs, const Tolerance& tolerance, Checker& checker);

}  // namespace limber::bench
