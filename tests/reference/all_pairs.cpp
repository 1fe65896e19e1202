// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of all pairs of triangles, compared one by one. They check that the traversals leave nothing out, not how two
// triangles are compared: they call the same functions of geometry/ for that, which have exact oracles of their own.
#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "reference/place.h"
#include "reference/reference.h"

namespace limber::reference {
namespace {

/// Whether two triangles of a mesh share a vertex.
bool are_neighbors(const Corners& a, const Corners& b) {
  for (const VertexId v : a) {
    for (const VertexId w : b) {
      if (v == w) return true;
    }
  }
  return false;
}

/// Calls visit(i, j) for every two triangles, i < j.
template <typename Visit>
void for_all_pairs(MeshView mesh, const Visit& visit) {
  for (TriangleId i = 0; i < mesh.triangles.size(); ++i) {
    for (TriangleId j = i + 1; j < mesh.triangles.size(); ++j) visit(i, j);
  }
}

/// Whether a mesh is closed, and its triangles are turned alike: each edge has as many triangles on one side as on the
/// other. A side between equal ids counts on neither.
bool is_closed_and_oriented(MeshView mesh) {
  std::map<std::pair<VertexId, VertexId>, int> balance;
  for (const Corners& c : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = c[k], w = c[(k + 1) % 3];
      if (v != w) balance[std::minmax(v, w)] += v < w ? 1 : -1;
    }
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Which faces count as oriented if nothing is said: those of meshes that are closed.
OrientedFaces oriented_by_default(MeshView a, MeshView b) {
  if (is_closed_and_oriented(a)) return is_closed_and_oriented(b) ? OrientedFaces::both : OrientedFaces::of_a;
  return is_closed_and_oriented(b) ? OrientedFaces::of_b : OrientedFaces::none;
}

/// Whether two triangles of a mesh meet elsewhere than in the vertices that they share.
bool meet_elsewhere(MeshView mesh, TriangleId i, TriangleId j) {
  return geometry::meets_elsewhere(mesh.triangle(i), mesh.triangles[i], mesh.triangle(j), mesh.triangles[j]);
}

/// Sorts contacts by distance, equal ones by their ids, and keeps the first `count`.
std::vector<Contact> nearest(std::vector<Contact> contacts, std::size_t count) {
  std::sort(contacts.begin(), contacts.end(), [](const Contact& c, const Contact& d) {
    return std::tie(c.distance, c.triangle_a, c.triangle_b) < std::tie(d.distance, d.triangle_a, d.triangle_b);
  });
  contacts.resize(std::min(count, contacts.size()));
  return contacts;
}

using EdgeEnds = std::vector<std::set<VertexId>>;  // the other end of each edge, by vertex

EdgeEnds edge_ends_of(MeshView mesh) {
  EdgeEnds ends(mesh.positions.size());
  for (const Corners& corners : mesh.triangles) {
    for (const VertexId v : corners) ends[v].insert(corners.begin(), corners.end());
  }
  return ends;
}

constexpr std::uint32_t unreached = std::numeric_limits<std::uint32_t>::max();

/// How many edges each vertex is away from one.
std::vector<std::uint32_t> path_lengths(const EdgeEnds& ends, VertexId from) {
  std::vector<std::uint32_t> lengths(ends.size(), unreached);
  lengths[from] = 0;
  std::deque<VertexId> waiting{from};
  for (; !waiting.empty(); waiting.pop_front()) {
    const VertexId v = waiting.front();
    for (const VertexId w : ends[v]) {
      if (lengths[w] == unreached) lengths[w] = lengths[v] + 1, waiting.push_back(w);
    }
  }
  return lengths;
}

}  // namespace

std::vector<TrianglePair> intersections(const Placed& a, const Placed& b) {
  const base::DefaultFloatEnvironment environment;
  const std::vector<Triangle> triangles_a = place(a), triangles_b = place(b);
  std::vector<TrianglePair> pairs;
  for (TriangleId i = 0; i < triangles_a.size(); ++i) {
    for (TriangleId j = 0; j < triangles_b.size(); ++j) {
      if (geometry::intersects(triangles_a[i], triangles_b[j])) pairs.push_back({i, j});
    }
  }
  return pairs;
}

std::vector<Contact> contacts(const Placed& a, const Placed& b, double margin,
                              std::optional<OrientedFaces> oriented_faces) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::contacts");
  const std::vector<Triangle> triangles_a = place(a), triangles_b = place(b);
  const OrientedFaces oriented = oriented_faces.value_or(oriented_by_default(a.mesh, b.mesh));
  std::vector<Contact> found;
  for (TriangleId i = 0; i < triangles_a.size(); ++i) {
    for (TriangleId j = 0; j < triangles_b.size(); ++j) {
      const Contact contact{geometry::contact(triangles_a[i], triangles_b[j], oriented), i, j};
      if (contact.distance <= margin) found.push_back(contact);
    }
  }
  return found;
}

std::vector<TrianglePair> self_intersections(MeshView mesh) {
  const base::DefaultFloatEnvironment environment;
  std::vector<TrianglePair> pairs;
  for_all_pairs(mesh, [&](TriangleId i, TriangleId j) {
    if (meet_elsewhere(mesh, i, j)) pairs.push_back({i, j});
  });
  return pairs;
}

std::vector<Contact> self_contacts(MeshView mesh, double margin, std::optional<OrientedFaces> oriented_faces) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::self_contacts");
  const OrientedFaces of_all = oriented_faces.value_or(oriented_by_default(mesh, mesh));
  std::vector<Contact> found;
  for_all_pairs(mesh, [&](TriangleId i, TriangleId j) {
    // Neighbors are a contact only where they meet elsewhere. The surface is folded there, so that the sides of their
    // faces say nothing of where inside is (contacts.h).
    const bool share_vertex = are_neighbors(mesh.triangles[i], mesh.triangles[j]);
    if (share_vertex && !meet_elsewhere(mesh, i, j)) return;
    const bool are_oriented = of_all != OrientedFaces::none && !share_vertex;
    const OrientedFaces oriented = are_oriented ? OrientedFaces::both : OrientedFaces::none;
    const Contact contact{geometry::contact(mesh.triangle(i), mesh.triangle(j), oriented), i, j};
    if (contact.distance <= margin) found.push_back(contact);
  });
  return found;
}

std::vector<Contact> closest_pairs(const Placed& a, const Placed& b, std::size_t count) {
  return nearest(contacts(a, b, std::numeric_limits<double>::max()), count);
}

std::vector<Contact> self_closest_pairs(MeshView mesh, std::size_t count) {
  return nearest(self_contacts(mesh, std::numeric_limits<double>::max()), count);
}

std::vector<TrianglePair> near_pairs(MeshView mesh, std::uint32_t edges) {
  const EdgeEnds ends = edge_ends_of(mesh);
  std::vector<TrianglePair> pairs;
  for (TriangleId i = 0; i < mesh.triangles.size(); ++i) {
    std::set<TriangleId> near;
    for (const VertexId from : mesh.triangles[i]) {
      const std::vector<std::uint32_t> lengths = path_lengths(ends, from);
      for (TriangleId j = i + 1; j < mesh.triangles.size(); ++j) {
        for (const VertexId v : mesh.triangles[j]) {
          if (lengths[v] != unreached && lengths[v] <= edges) near.insert(j);
        }
      }
    }
    for (const TriangleId j : near) pairs.push_back({i, j});
  }
  return pairs;
}

}  // namespace limber::reference
