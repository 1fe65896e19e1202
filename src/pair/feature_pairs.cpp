// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// feature_pairs() and self_feature_pairs(): the pairs of elements, by the features that hold their closest points.
//
// Two vertices, or a vertex and an edge, are the closest features of several pairs of elements, and are looked up in a
// table. Other features belong to one pair alone.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "limber/elements.h"
#include "limber/model.h"

namespace limber {

struct FeaturePairs::Impl {
  /// Where a pair of features is that may come again. It is in use if its call is the last one.
  struct Place {
    std::uint64_t ids;
    std::uint32_t call, pair;
    FeatureKind kind_a, kind_b;
  };

  /// Forgets all pairs, and keeps the memory.
  void start();
  /// The number of a pair of features that may come again; that of the next pair if it is new.
  std::uint32_t find(FeatureKind kind_a, std::uint32_t a, FeatureKind kind_b, std::uint32_t b);

  std::vector<FeaturePair> pairs;

 private:
  Place& place(const Place& wanted);
  void grow();

  std::vector<Place> table_;  // a power of two, at most half in use
  std::size_t used_ = 0;
  std::uint32_t call_ = 0;
};

FeaturePairs::FeaturePairs() = default;
FeaturePairs::FeaturePairs(FeaturePairs&&) noexcept = default;
FeaturePairs& FeaturePairs::operator=(FeaturePairs&&) noexcept = default;
FeaturePairs::~FeaturePairs() = default;

FeaturePairs::Impl& FeaturePairs::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

std::span<const FeaturePair> FeaturePairs::list() const {
  return impl_ == nullptr ? std::span<const FeaturePair>() : impl_->pairs;
}

void FeaturePairs::Impl::start() {
  pairs.clear();
  used_ = 0;
  if (++call_ != 0) return;
  for (Place& p : table_) p.call = 0;
  call_ = 1;
}

/// The place of a pair, or the one that it gets. Pre: the table has one that is not in use.
FeaturePairs::Impl::Place& FeaturePairs::Impl::place(const Place& wanted) {
  const std::size_t mask = table_.size() - 1;
  const std::uint64_t kinds = wanted.kind_a == FeatureKind::edge ? 1 : wanted.kind_b == FeatureKind::edge ? 2 : 0;
  // The golden ratio's digits: products with odd numbers spread consecutive ids.
  const std::uint64_t mixed = (wanted.ids ^ wanted.ids >> 29 ^ kinds << 62) * 0x9e3779b97f4a7c15U;
  for (std::size_t i = mixed >> 20;; ++i) {
    Place& p = table_[i & mask];
    if (p.call != call_) return p;
    if (p.ids == wanted.ids && p.kind_a == wanted.kind_a && p.kind_b == wanted.kind_b) return p;
  }
}

void FeaturePairs::Impl::grow() {
  std::vector<Place> before(std::max<std::size_t>(64, 2 * table_.size()));
  std::swap(before, table_);
  for (const Place& p : before) {
    if (p.call == call_) place(p) = p;
  }
}

std::uint32_t FeaturePairs::Impl::find(FeatureKind kind_a, std::uint32_t a, FeatureKind kind_b, std::uint32_t b) {
  if (2 * used_ >= table_.size()) grow();
  const auto next = static_cast<std::uint32_t>(pairs.size());
  const Place wanted{std::uint64_t{a} << 32 | b, call_, next, kind_a, kind_b};
  Place& p = place(wanted);
  if (p.call == call_) return p.pair;
  p = wanted, ++used_;
  return next;
}

namespace {

using geometry::near_unit;

/// A feature of one model, with what may be known of its closest point.
struct FeatureOf {
  FeatureKind kind;
  std::uint32_t id;
  Vec3 weights;
};

/// What a vector is made of that is perpendicular to both, of length 1; nothing if they are parallel or one is 0.
Vec3 perpendicular_to(const Vec3& u, const Vec3& v) {
  if (max_abs(u) == 0 || max_abs(v) == 0) return {};
  const Vec3 n = cross(near_unit(u), near_unit(v));
  return max_abs(n) == 0 ? Vec3{} : geometry::unit(n);
}

/// The normal of features that meet, as feature_pairs() says.
Vec3 normal_of_contact(const FeaturePair& pair, const Triangle& a, const Triangle& b) {
  // An edge has its vector first, and a vertex none. The order of the two gives the side of a face.
  const Vec3 u = pair.kind_b == FeatureKind::face ? b.v2 - b.v0 : a.v1 - a.v0;
  const Vec3 v = pair.kind_a == FeatureKind::face ? a.v2 - a.v0 : b.v1 - b.v0;
  const Vec3 n = perpendicular_to(u, v);
  if (max_abs(n) > 0) return n;
  if (max_abs(u) > 0) return geometry::perpendicular_to(near_unit(u));
  return max_abs(v) > 0 ? geometry::perpendicular_to(near_unit(v)) : Vec3{0, 0, 1};
}

/// From the closest point of a to that of b. Differences with one vertex of a keep what far places would round away.
Vec3 from_a_to_b(const FeaturePair& pair, const Triangle& a, const Triangle& b) {
  const Vec3 &w = pair.weights_a, &x = pair.weights_b;
  return (b.v0 - a.v0) + ((x.y * (b.v1 - b.v0) + x.z * (b.v2 - b.v0)) - (w.y * (a.v1 - a.v0) + w.z * (a.v2 - a.v0)));
}

/// One model of a query.
struct Surface {
  const Mesh& mesh;
  const MeshEdges& edges;
  Transform pose;

  explicit Surface(const Placed& placed)
      : mesh(placed.model().mesh()), edges(placed.model().edges()), pose(placed.pose) {}

  std::array<VertexId, 3> vertices(const FeatureOf& f) const {
    if (f.kind == FeatureKind::vertex) return {f.id, f.id, f.id};
    if (f.kind == FeatureKind::face) return mesh.triangles()[f.id];
    const auto [from, to] = edges.vertices()[f.id];
    return {from, to, from};
  }
  Triangle placed(const std::array<VertexId, 3>& v) const {
    const std::vector<Vec3>& p = mesh.positions();
    return {pose(p[v[0]]), pose(p[v[1]]), pose(p[v[2]])};
  }
  /// The feature of a triangle that a point of these weights is on, and of an edge by a parameter.
  FeatureOf of_face(TriangleId t, const Vec3& weights) const {
    const Feature f = geometry::feature_of(weights);
    if (f.kind == FeatureKind::face) return {f.kind, t, weights};
    if (f.kind == FeatureKind::vertex) return {f.kind, mesh.triangles()[t][f.index], {1, 0, 0}};
    const EdgeId edge = edges.of_triangles()[t][f.index];
    LIMBER_ASSERT(edge != no_id);  // between corners of one vertex there is no inside
    return {f.kind, edge, {}};
  }
  FeatureOf of_edge(EdgeId e, double parameter) const {
    if (parameter > 0 && parameter < 1) return {FeatureKind::edge, e, {1 - parameter, parameter, 0}};
    return {FeatureKind::vertex, edges.vertices()[e][parameter > 0 ? 1 : 0], {1, 0, 0}};
  }
};

/// Takes pairs of elements, and lists their features.
class FeatureCollector {
 public:
  FeatureCollector(const Placed& a, const Placed& b, bool is_self, FeaturePairs::Impl& found)
      : surfaces_{Surface(a), Surface(b)}, is_self_(is_self), found_(found) {
    found_.start();
  }

  bool take(const VertexFacePair& p) {
    const FeatureOf vertex{FeatureKind::vertex, p.vertex, {1, 0, 0}};
    const FeatureOf face = surfaces_[p.is_vertex_of_b ? 0 : 1].of_face(p.triangle, p.weights);
    return p.is_vertex_of_b ? add(face, vertex, p.distance) : add(vertex, face, p.distance);
  }
  bool take(const EdgeEdgePair& p) {
    return add(surfaces_[0].of_edge(p.a, p.parameter_a), surfaces_[1].of_edge(p.b, p.parameter_b), p.distance);
  }

 private:
  bool add(const FeatureOf& a, const FeatureOf& b, double distance) {
    if (is_self_ && std::pair(b.kind, b.id) < std::pair(a.kind, a.id)) return add(b, a, distance);
    const bool is_alone = a.kind == FeatureKind::face || b.kind == FeatureKind::face ||
                          (a.kind == FeatureKind::edge && b.kind == FeatureKind::edge);
    std::vector<FeaturePair>& pairs = found_.pairs;
    const std::size_t number = is_alone ? pairs.size() : found_.find(a.kind, a.id, b.kind, b.id);
    if (number == pairs.size()) append(a, b, is_alone ? distance : -1);
    ++pairs[number].multiplicity;
    return true;
  }

  /// A negative distance is not known, nor are the weights of an edge then.
  void append(const FeatureOf& a, const FeatureOf& b, double distance) {
    FeaturePair& pair = found_.pairs.emplace_back();
    pair.kind_a = a.kind, pair.kind_b = b.kind, pair.a = a.id, pair.b = b.id;
    pair.vertices_a = surfaces_[0].vertices(a), pair.vertices_b = surfaces_[1].vertices(b);
    const Triangle at_a = surfaces_[0].placed(pair.vertices_a), at_b = surfaces_[1].placed(pair.vertices_b);
    pair.weights_a = a.weights, pair.weights_b = b.weights, pair.distance = distance;
    if (distance < 0) measure(pair, at_a, at_b);
    pair.point_a = geometry::point_at(at_a, pair.weights_a), pair.point_b = geometry::point_at(at_b, pair.weights_b);
    const Vec3 between = from_a_to_b(pair, at_a, at_b);
    const bool is_apart = pair.distance > 0 && max_abs(between) > 0;
    pair.normal = is_apart ? geometry::unit(between) : normal_of_contact(pair, at_a, at_b);
  }

  /// The closest points of a vertex and a vertex or an edge.
  static void measure(FeaturePair& pair, const Triangle& a, const Triangle& b) {
    const auto [distance, s, t] = geometry::closest_on(Segment{a.v0, a.v1}, Segment{b.v0, b.v1});
    pair.distance = distance, pair.weights_a = {1 - s, s, 0}, pair.weights_b = {1 - t, t, 0};
  }

  Surface surfaces_[2];
  bool is_self_;
  FeaturePairs::Impl& found_;
};

}  // namespace

ElementPairCount feature_pairs(const Placed& a, const Placed& b, double margin, FeaturePairs& found,
                               const FeaturePairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::feature_pairs");
  for (const Placed& body : {a, b}) base::check_has_no_radius(body, "limber::feature_pairs");
  FeatureCollector features(a, b, false, Access::impl(found));
  const auto take = [&](const auto& pair) { return features.take(pair); };
  return visit_element_pairs(a, b, margin, take, take, {.budget = options.budget});
}

ElementPairCount self_feature_pairs(const Model& model, double margin, FeaturePairs& found,
                                    const FeaturePairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::self_feature_pairs");
  FeatureCollector features({model}, {model}, true, Access::impl(found));
  const auto take = [&](const auto& pair) { return features.take(pair); };
  return visit_self_element_pairs(model, margin, take, take, {.budget = options.budget});
}

}  // namespace limber
