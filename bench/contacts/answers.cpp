// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/contacts/answers.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <sstream>

#include "limber/geometry.h"
#include "reference/reference.h"

namespace limber::bench {
namespace {

std::size_t shared_vertices(const Corners& a, const Corners& b) {
  std::size_t count = 0;
  for (const VertexId id : a) count += static_cast<std::size_t>(std::count(b.begin(), b.end(), id));
  return count;
}

/// Whether an edge of `a` passes through the inside of `b`, exactly.
bool has_edge_through(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = a[i], &q = a[(i + 1) % 3];
    if (orient3d(b.v0, b.v1, b.v2, p) * orient3d(b.v0, b.v1, b.v2, q) >= 0) continue;
    const int first = orient3d(p, q, b.v0, b.v1);
    if (first != 0 && first == orient3d(p, q, b.v1, b.v2) && first == orient3d(p, q, b.v2, b.v0)) return true;
  }
  return false;
}

bool pass_through_each_other(const Triangle& a, const Triangle& b) {
  return has_edge_through(a, b) || has_edge_through(b, a);
}

Triangle as_float(const Triangle& t) {
  const auto rounded = [](const Vec3& v) {
    return Vec3{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  return {rounded(t.v0), rounded(t.v1), rounded(t.v2)};
}

/// Whether one pair meets, by brute force.
bool meets(const MeshPair& meshes, TriangleId a, TriangleId b) {
  if (!meshes.is_self) return intersects(meshes.a.triangle(a), meshes.b.triangle(b));
  const std::array<Corners, 2> both{meshes.a.triangles[a], meshes.a.triangles[b]};
  return !reference::self_intersections({meshes.a.positions, both}).empty();
}

/// Why a pair is in one of the answers alone; empty without a reason.
std::string reason_of_crossing(const MeshPair& meshes, TriangleId id_a, TriangleId id_b, bool is_ours) {
  if (meets(meshes, id_a, id_b) != is_ours) return "";
  const std::size_t shared = meshes.is_self ? shared_vertices(meshes.a.triangles[id_a], meshes.a.triangles[id_b]) : 0;
  if (shared >= 2) return is_ours ? "share an edge" : "";
  const Triangle a = meshes.a.triangle(id_a), b = meshes.b.triangle(id_b);
  if (is_ours && !pass_through_each_other(a, b)) {
    return shared == 1 ? "share a vertex, touch elsewhere" : "touch only";
  }
  return pass_through_each_other(as_float(a), as_float(b)) != is_ours ? "positions as float" : "";
}

std::string reason_of_distance(double distance, double margin, bool is_ours, const Tolerance& tolerance) {
  if (distance <= margin * (1 - 1e-12) && !is_ours) return "";  // ours lacks it
  if (distance > margin * (1 + 1e-12) && is_ours) return "";    // ours has it without reason
  if (std::abs(distance - margin) <= tolerance.relative * margin + tolerance.absolute) return "distance at the margin";
  return is_ours && distance == 0 && !tolerance.finds_intersections ? "intersect" : "";
}

/// Takes differences apart; reason(pair, is_ours) says why a pair is in one of the answers alone.
template <typename Pairs, typename Reason>
void compare(Difference& difference, const Pairs& ours, const Pairs& theirs, Checker& checker, const Reason& reason) {
  difference.ours += ours.size(), difference.theirs += theirs.size();
  for (const bool is_ours : {true, false}) {
    const Pairs &one = is_ours ? ours : theirs, &other = is_ours ? theirs : ours;
    Pairs only;
    std::set_difference(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(only));
    if (is_ours) difference.both += one.size() - only.size();
    std::size_t unexplained = 0;
    for (const auto& pair : only) {
      const std::string why = reason(pair, is_ours);
      ++(is_ours ? difference.only_ours : difference.only_theirs)[why.empty() ? "no reason" : why];
      if (!why.empty() || ++unexplained > 5) continue;  // a few are enough on the console
      checker.check(false, "{}, {}: the pair {} is only in {}", difference.mesh, difference.question, pair,
                    is_ours ? "ours" : difference.library + "'s");
    }
  }
}

/// The triangles at each vertex, in the order of ids.
class Incidence {
 public:
  explicit Incidence(MeshView mesh) : at_(mesh.positions.size()) {
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
      for (const VertexId v : mesh.triangles[t]) at_[v].push_back(t);
    }
  }
  const std::vector<TriangleId>& at(VertexId v) const { return at_.at(v); }
  std::vector<TriangleId> at(VertexId v, VertexId w) const {
    std::vector<TriangleId> common;
    std::set_intersection(at(v).begin(), at(v).end(), at(w).begin(), at(w).end(), std::back_inserter(common));
    return common;
  }

 private:
  std::vector<std::vector<TriangleId>> at_;
};

}  // namespace

std::vector<PeerRow> read_peer_rows(const std::filesystem::path& csv) {
  std::vector<PeerRow> rows;
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    PeerRow row;
    std::string us;
    for (std::string* cell : {&row.peer, &row.mesh, &row.question, &us, &row.count}) {
      if (!std::getline(cells, *cell, ',')) {
        throw std::runtime_error(csv.string() + ": not as expected: " + line);
      }
    }
    std::getline(cells, row.details);
    std::erase(row.details, '"');  // around details that have commas
    if (!us.empty()) row.us = std::stod(us);
    rows.push_back(row);
  }
  return rows;
}

void sort_pairs(IdPairs& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

std::optional<IdPairs> read_pairs(const std::filesystem::path& file) {
  const auto lines = read_numbers<2>(file);
  if (!lines) return std::nullopt;
  IdPairs pairs;
  for (const auto& [a, b] : *lines) pairs.emplace_back(static_cast<TriangleId>(a), static_cast<TriangleId>(b));
  sort_pairs(pairs);
  return pairs;
}

std::optional<ElementIds> read_ipc_elements(const std::filesystem::path& edge_edge,
                                            const std::filesystem::path& face_vertex) {
  const auto edges = read_numbers<4>(edge_edge);
  const auto faces = read_numbers<2>(face_vertex);
  if (!edges || !faces) return std::nullopt;
  ElementIds found;
  for (const std::array<double, 4>& ends : *edges) {
    std::transform(ends.begin(), ends.end(), found.edge_edge.emplace_back().begin(),
                   [](double id) { return static_cast<VertexId>(id); });
  }
  for (const auto& [face, v] : *faces) {
    found.vertex_face.emplace_back(static_cast<VertexId>(v), static_cast<TriangleId>(face));
  }
  std::sort(found.edge_edge.begin(), found.edge_edge.end());
  std::sort(found.vertex_face.begin(), found.vertex_face.end());
  return found;
}

IdPairs triangles_of(const ElementIds& elements, MeshView mesh) {
  const Incidence incidence(mesh);
  IdPairs pairs;
  const auto add = [&](TriangleId a, TriangleId b) {
    if (shared_vertices(mesh.triangles[a], mesh.triangles[b]) == 0) pairs.emplace_back(std::minmax(a, b));
  };
  for (const std::array<VertexId, 4>& v : elements.edge_edge) {
    for (const TriangleId a : incidence.at(v[0], v[1])) {
      for (const TriangleId b : incidence.at(v[2], v[3])) add(a, b);
    }
  }
  for (const auto& [v, face] : elements.vertex_face) {
    if (face >= mesh.triangles.size()) throw std::out_of_range("a face of the IPC Toolkit");
    for (const TriangleId b : incidence.at(v)) add(face, b);
  }
  sort_pairs(pairs);
  return pairs;
}

Difference compare_elements(const std::string& mesh, MeshView view, double margin, const ElementIds& ours,
                            const ElementIds& theirs, Checker& checker) {
  Difference difference{mesh, fmt::format("self_element_pairs within {:.4g}", margin), "IPC Toolkit"};
  const Tolerance tolerance{.relative = 1e-9};
  const auto& at = view.positions;
  compare(difference, ours.vertex_face, theirs.vertex_face, checker, [&](const auto& pair, bool is_ours) {
    const double distance = closest_points(at[pair.first], view.triangle(pair.second)).distance;
    return reason_of_distance(distance, margin, is_ours, tolerance);
  });
  compare(difference, ours.edge_edge, theirs.edge_edge, checker, [&](const auto& v, bool is_ours) {
    const Segment a{at[v[0]], at[v[1]]}, b{at[v[2]], at[v[3]]};
    return reason_of_distance(closest_points(a, b).distance, margin, is_ours, tolerance);
  });
  return difference;
}

Difference compare_crossings(const std::string& mesh, const std::string& library, const MeshPair& meshes,
                             const IdPairs& ours, const IdPairs& theirs, Checker& checker) {
  Difference difference{mesh, meshes.is_self ? "self_intersections" : "intersections", library};
  compare(difference, ours, theirs, checker,
          [&](const auto& pair, bool is_ours) { return reason_of_crossing(meshes, pair.first, pair.second, is_ours); });
  return difference;
}

Difference compare_within(const std::string& mesh, const std::string& library, const MeshPair& meshes, double margin,
                          const IdPairs& ours, const IdPairs& theirs, const Tolerance& tolerance, Checker& checker) {
  const char* const kind = meshes.is_self ? "self_contacts" : "contacts";
  Difference difference{mesh, fmt::format("{} within {:.4g}", kind, margin), library};
  compare(difference, ours, theirs, checker, [&](const auto& pair, bool is_ours) {
    const double distance = closest_points(meshes.a.triangle(pair.first), meshes.b.triangle(pair.second)).distance;
    return reason_of_distance(distance, margin, is_ours, tolerance);
  });
  return difference;
}

}  // namespace limber::bench
