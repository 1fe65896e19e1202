// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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

/// The first numbers of each line, which may be nan or inf. None if the file is missing. Throws std::runtime_error if
/// there are fewer.
template <std::size_t count>
std::optional<std::vector<std::array<double, count>>> read_numbers(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::vector<std::array<double, count>> all;
  for (std::string line; std::getline(file, line);) {
    const char* next = line.c_str();
    for (double& number : all.emplace_back()) {
      char* end = nullptr;
      number = std::strtod(next, &end);
      if (end == next) throw std::runtime_error(path.string() + ": not as expected: " + line);
      next = end;
    }
  }
  return all;
}

/// Pairs of triangles, sorted, each once.
using IdPairs = std::vector<std::pair<TriangleId, TriangleId>>;
void sort_pairs(IdPairs& pairs);

/// Pairs of triangles that a peer has written. None if the file is missing.
std::optional<IdPairs> read_pairs(const std::filesystem::path& file);

/// Two meshes, or one mesh and itself; then pairs have the smaller id first.
struct MeshPair {
  MeshView a, b;
  bool is_self = false;
};

/// Pairs of elements of one mesh, sorted.
struct ElementIds {
  std::vector<std::pair<VertexId, TriangleId>> vertex_face;
  std::vector<std::array<VertexId, 4>> edge_edge;  ///< two edges, each with the smaller vertex id first, in order
};

/// Those that the IPC Toolkit has written. None if a file is missing.
std::optional<ElementIds> read_ipc_elements(const std::filesystem::path& edge_edge,
                                            const std::filesystem::path& face_vertex);

/// The pairs of triangles of the mesh that share no vertex, and to which a pair of elements belongs. Throws
/// std::out_of_range if these are not elements of the mesh.
IdPairs triangles_of(const ElementIds& elements, MeshView mesh);

/// How two answers differ, and why.
struct Difference {
  std::string mesh, question, library;
  std::size_t ours = 0, theirs = 0, both = 0;
  std::map<std::string, std::size_t> only_ours = {}, only_theirs = {};  ///< how many, by reason
};

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

/// How the distances of points by a library differ from ours. Lengths are parts of the mesh's size.
struct PointDifference {
  std::string question, mesh, library;
  double tolerance = 0;
  std::size_t points = 0, agree = 0;  ///< `agree`: up to the tolerance
  double largest_of_agreeing = 0, largest = 0;
  std::map<std::string, std::size_t> others = {};  ///< how many do not agree, by reason
};

}  // namespace limber::bench
