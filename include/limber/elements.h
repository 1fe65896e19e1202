// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/mesh.h"
#include "limber/model.h"

/// Pairs of elements that are close, as solvers with one constraint for each take them: vertices with faces, and edges
/// with edges, of two models and of one model with itself; and the features of these that are closest, each pair once.
///
/// An element is closed: a vertex, an edge with its two ends, a face with its boundary. Elements that belong to several
/// triangles come once. Distances are rounded as distance.h says, so a pair whose distance equals the margin up to that
/// rounding may be in or out.
///
/// Order    Pairs come in an order that depends on the models, their history and their poses alone: not on the
///          processor, and not on threads. It is not sorted.
/// Threads  Every function is reentrant; any number of calls may share models.
namespace limber {

using EdgeId = std::uint32_t;

/// The edges of a mesh, each once, and which triangle owns them: Model::edges(). Positions do not matter.
///
/// Shape    Edges are pairs of different vertex ids, the smaller first, in ascending order. Where a triangle names a
///          vertex twice, there is no edge between the two.
/// Representative    The representative of an edge or a vertex is the triangle of the lowest id that has it.
class MeshEdges {
 public:
  std::size_t size() const { return vertices_.size(); }
  std::size_t vertex_count() const { return vertex_representatives_.size(); }
  std::size_t triangle_count() const { return of_triangles_.size(); }

  /// The two vertices of each edge.
  std::span<const std::array<VertexId, 2>> vertices() const { return vertices_; }
  /// The edges of each triangle: from corner 0 to 1, from 1 to 2 and from 2 to 0; no_id where there is none.
  std::span<const std::array<EdgeId, 3>> of_triangles() const { return of_triangles_; }
  /// The representative of each edge.
  std::span<const TriangleId> representatives() const { return representatives_; }
  /// The representative of each vertex; no_id if no triangle has it.
  std::span<const TriangleId> vertex_representatives() const { return vertex_representatives_; }

 private:
  friend struct Access;  // for the library's own use
  explicit MeshEdges(const Mesh& mesh);

  std::vector<std::array<VertexId, 2>> vertices_;
  std::vector<std::array<EdgeId, 3>> of_triangles_;
  std::vector<TriangleId> representatives_, vertex_representatives_;
  std::vector<std::uint8_t> represented_;  // bit masks, one a triangle; Access::represented_by()
};

/// A vertex and a face that are close.
struct VertexFacePair {
  VertexId vertex = no_id;
  TriangleId triangle = no_id;
  bool is_vertex_of_b = false;  ///< the vertex is one of b and the face one of a; false for one model
  double distance = 0;
  Vec3 weights;  ///< of the closest point of the face, by corner: >= 0, together 1 up to rounding
};

/// Two edges that are close. For one model a < b.
struct EdgeEdgePair {
  EdgeId a = no_id, b = no_id;
  double distance = 0;
  double parameter_a = 0, parameter_b = 0;  ///< of closest points: 0 is the first vertex of the edge, 1 the second
};

/// Called for each pair; returns whether to go on.
using VertexFaceVisitor = FunctionRef<bool(const VertexFacePair&)>;
using EdgeEdgeVisitor = FunctionRef<bool(const EdgeEdgePair&)>;

/// How many pairs were found.
struct ElementPairCount {
  std::size_t vertex_face = 0, edge_edge = 0;  ///< all that were found, whether or not they fitted
  bool is_complete = true;                     ///< false if a visitor or the budget has ended the query
  StoppedBy stopped_by = StoppedBy::nothing;   ///< which limit of the budget, if it was that
  QueryStats stats{};                          ///< `primitive_tests` counts the pairs of elements that were compared
};

struct ElementPairOptions {
  QueryBudget budget = {};  ///< when the query has to end; the default has no limits
  /// Whether to search on all threads, as in PairOptions. All pairs of vertices and faces are then visited before the
  /// first pair of edges.
  bool parallel = false;
};

/// The elements of two models that are at most `margin` apart: vertices of a and faces of b, vertices of b and faces of
/// a, edges of a and edges of b.
///
/// Promise  Each pair exactly once. The distance is that of geometry.h for these elements as placed. The second form
///          writes the first pairs that there is room for; the counts say how many there are.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, none has a radius, and the
///          margin is finite and >= 0; as Model::edges(); whatever a visitor throws.
/// Budget   If it is spent first, the pairs are some of all: each right, none twice. The next call starts anew.
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing once the models have their
///          edges, unless it is parallel.
/// Source   docs/algorithms/contacts.md.
LIMBER_API ElementPairCount visit_element_pairs(const Placed& a, const Placed& b, double margin,
                                                VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge,
                                                const ElementPairOptions& options = {});
LIMBER_API ElementPairCount element_pairs(const Placed& a, const Placed& b, double margin,
                                          std::span<VertexFacePair> vertex_face, std::span<EdgeEdgePair> edge_edge,
                                          const ElementPairOptions& options = {});

/// The elements of one model that are at most `margin` apart and share no vertex, by id: vertices and faces of which
/// they are no corner, edges and edges. Neighboring triangles have such elements too. Poses do not matter, so there
/// are none.
///
/// Promise  As visit_element_pairs().
/// Throws   As visit_element_pairs().
/// Cost     O(n) plus the pairs, O(n^2) at worst. Memory as visit_element_pairs().
LIMBER_API ElementPairCount visit_self_element_pairs(const Model& model, double margin,
                                                     VertexFaceVisitor visit_vertex_face,
                                                     EdgeEdgeVisitor visit_edge_edge,
                                                     const ElementPairOptions& options = {});
LIMBER_API ElementPairCount self_element_pairs(const Model& model, double margin, std::span<VertexFacePair> vertex_face,
                                               std::span<EdgeEdgePair> edge_edge,
                                               const ElementPairOptions& options = {});

/// Two features that are close: the smallest ones that hold the closest points of one or more pairs of elements. They
/// are two vertices, a vertex and an edge, a vertex and a face, or two edges, one of a and one of b.
///
/// For one model a is the vertex if the other is none, and otherwise the one of the smaller id.
struct FeaturePair {
  double distance = 0;
  Vec3 point_a, point_b;               ///< closest points of the two features
  Vec3 normal;                         ///< of length 1, from a to b; at distance 0 as feature_pairs() says
  Vec3 weights_a, weights_b;           ///< of the points, by vertex: >= 0, together 1 up to rounding
  std::uint32_t a = no_id, b = no_id;  ///< ids of vertices, of edges as in Model::edges(), or of triangles
  /// The vertices of the features: of an edge as in Model::edges(), of a face by corner. What a feature does not have
  /// repeats its first vertex, with weight 0.
  std::array<VertexId, 3> vertices_a{no_id, no_id, no_id}, vertices_b{no_id, no_id, no_id};
  std::uint32_t multiplicity = 0;  ///< how many pairs of elements have their closest points on these features
  FeatureKind kind_a = FeatureKind::vertex, kind_b = FeatureKind::vertex;
};

/// Pairs of features, and memory to find them in. Kept from call to call, it serves all that find no more pairs than
/// those before.
///
/// Cost     Up to 250 bytes a pair, allocated by calls that need more than those before.
/// Threads  One call at a time. One that has been moved from is as new.
class FeaturePairs {
 public:
  LIMBER_API FeaturePairs();
  LIMBER_API FeaturePairs(FeaturePairs&&) noexcept;
  LIMBER_API FeaturePairs& operator=(FeaturePairs&&) noexcept;
  LIMBER_API ~FeaturePairs();

  /// What the last call has found, until the next one.
  LIMBER_API std::span<const FeaturePair> list() const;

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  Impl& impl();

  std::unique_ptr<Impl> impl_;
};

struct FeaturePairOptions {
  QueryBudget budget = {};  ///< when the query has to end; the default has no limits
};

/// The features of two models that are closest in the pairs of visit_element_pairs(), each pair of features once: what
/// a barrier or a penalty sums over, each term as often as its multiplicity says.
///
/// Promise  Each pair of elements counts for one pair of features: those whose weights and parameters are not exactly
///          0, nor those of the ends 1. So multiplicities add up to the count that is returned. Distance, points and
///          weights depend on the two features alone; the distance is that of geometry.h. A weight within a feature
///          may round to 0. Where rounding or a tie decides what is closest, as between parallel edges, pairs of the
///          same place may have different features.
/// Normal   It has the direction from point_a to point_b before these are rounded. Where they are in one place: the
///          normal of the face by its corners, out of a or into b; the cross product of both edges, a first; a
///          perpendicular of an edge, where these are parallel or there is but one; the z axis.
/// Order    As visit_element_pairs() finds them first.
/// Throws   As visit_element_pairs(); std::bad_alloc. `found` then has no pairs that mean something.
/// Budget   As visit_element_pairs(); multiplicities count the pairs of elements that were found.
/// Cost     That of visit_element_pairs(), and O(1) for each of its pairs.
/// Source   Features and multiplicities as in [LiFerguson2020]; docs/algorithms/contacts.md.
LIMBER_API ElementPairCount feature_pairs(const Placed& a, const Placed& b, double margin, FeaturePairs& found,
                                          const FeaturePairOptions& options = {});

/// The features of one model that are closest in the pairs of visit_self_element_pairs(). All else as feature_pairs().
LIMBER_API ElementPairCount self_feature_pairs(const Model& model, double margin, FeaturePairs& found,
                                               const FeaturePairOptions& options = {});

}  // namespace limber
