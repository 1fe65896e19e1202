// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/mesh.h"
#include "limber/motion.h"
#include "limber/points.h"
#include "limber/scene.h"

/// Brute-force twins of every query: each triangle of one mesh against each of the other, no tree and no tricks.
///
/// They are what every engine is tested against, and share the semantics of distance.h, contacts.h and points.h.
namespace limber::reference {

struct Placed {
  MeshView mesh;
  Transform pose{};  ///< world_from_model
};

/// Whether the meshes meet, with the first intersecting pair in the order of ids.
///
/// Pre      Both meshes are sound.
/// Throws   std::invalid_argument unless both poses are rigid; distance() and within() also for bad options.
/// Cost     O(n m).
/// Threads  Reentrant.
CollideResult collide(const Placed& a, const Placed& b);

/// Shortest distance, with the first pair in the order of ids that attains it.
///
/// The exact answer serves any error, so of the options only `max_distance` makes a difference.
/// Cost     O(n m).
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});

/// Whether the meshes are at most `max_distance` apart, with the closest pair.
///
/// Cost     O(n m).
CollideResult within(const Placed& a, const Placed& b, double max_distance);

/// All pairs of contacts.h, in the order of ids: first of the triangles of a, then of those of b.
///
/// Throws   As above; also unless the margin is finite and >= 0.
/// Cost     O(n m); O(n^2) for a mesh with itself.
std::vector<TrianglePair> intersections(const Placed& a, const Placed& b);
std::vector<Contact> contacts(const Placed& a, const Placed& b, double margin,
                              std::optional<OrientedFaces> oriented_faces = std::nullopt);
std::vector<TrianglePair> self_intersections(MeshView mesh);
std::vector<Contact> self_contacts(MeshView mesh, double margin,
                                   std::optional<OrientedFaces> oriented_faces = std::nullopt);

/// The closest pairs, at most `count`, nearest first; of equally close ones the first in the order of ids.
std::vector<Contact> closest_pairs(const Placed& a, const Placed& b, std::size_t count);
std::vector<Contact> self_closest_pairs(MeshView mesh, std::size_t count);

/// The pairs of different triangles that are near as NeighborRings says, in the order of ids, by a search from each
/// vertex.
///
/// Pre      The mesh is sound.
/// Cost     O(n^2).
std::vector<TrianglePair> near_pairs(MeshView mesh, std::uint32_t edges);

/// What reduce_contacts() keeps, in its order.
///
/// Pre      The options and the contacts are what reduce_contacts() takes.
/// Cost     O(n^2).
std::vector<Contact> reduced_contacts(std::span<const Contact> contacts, double radius,
                                      const ReductionOptions& options);

/// Pairs of elements, as elements.h says.
struct ElementPairs {
  std::vector<VertexFacePair> vertex_face;  ///< vertices of a before those of b, then in the order of ids
  std::vector<EdgeEdgePair> edge_edge;      ///< in the order of ids
};

/// All pairs of elements.h.
///
/// Throws   As contacts().
/// Cost     O(n m); O(n^2) for a mesh with itself.
ElementPairs element_pairs(const Placed& a, const Placed& b, double margin);
ElementPairs self_element_pairs(MeshView mesh, double margin);

/// The features that are closest in these pairs, each pair once, in the order of kinds and ids: of a, then of b.
/// Normals, weights and vertices are not set.
///
/// Throws   As element_pairs().
std::vector<FeaturePair> feature_pairs(const Placed& a, const Placed& b, double margin);
std::vector<FeaturePair> self_feature_pairs(MeshView mesh, double margin);

/// A mesh whose vertices move from their positions, placed by one pose, to others, placed by another.
struct MovingMesh {
  MeshView mesh;
  std::span<const Vec3> end_positions;
  Transform start_pose{}, end_pose{};
};

/// All pairs of elements that touch, as visit_impacts() says: vertices of a with faces of b, faces of a with vertices
/// of b, edges, each in the order of ids.
///
/// Throws   As time_of_impact().
/// Cost     O(n m); O(n^2) for a mesh with itself.
std::vector<Impact> impacts(const MovingMesh& a, const MovingMesh& b, const ElementImpactOptions& options);
std::vector<Impact> self_impacts(const MovingMesh& mesh, const ElementImpactOptions& options);

/// The point of the mesh that is closest to a point of the world; of several triangles that are equally close, to the
/// bit, it is that of the lowest id.
///
/// Throws   As above; also unless the point is finite and at most `max_coordinate` in size.
/// Cost     O(n).
PointResult closest_point(const Placed& mesh, const Vec3& point, const PointOptions& options = {});

/// Whether a mesh that is closed and oriented, as ClosedSurface says, encloses a point, or the point lies on it.
///
/// Throws   As above.
/// Cost     O(n).
bool contains(const Placed& mesh, const Vec3& point);

/// The generalized winding number.
///
/// Throws   As above.
/// Cost     O(n).
double winding_number(const Placed& mesh, const Vec3& point);

/// The pairs of some objects, whose ids are their indices, that are at most `max_distance` apart, in the order of ids.
///
/// Cost     O(n^2) for n triangles together.
std::vector<ObjectPair> pairs_within(std::span<const Placed> objects, double max_distance);

/// The closest two of some objects, whose ids are their indices.
///
/// Cost     O(n^2) for n triangles together.
ClosestObjectsResult closest_objects(std::span<const Placed> objects, const DistanceOptions& options = {});

}  // namespace limber::reference
