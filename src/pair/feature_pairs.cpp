// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// feature_pairs() and self_feature_pairs(): the pairs of elements, by the features that hold their closest points.
//
// Two vertices, or a vertex and an edge, are the closest features of several pairs of elements, and are looked up in a
// table. Others are those of one pair alone.
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
#include "base/memory.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "pair/collectors/elements.h"
#include "pair/placed_pair.h"
#include "pair/search.h"

namespace limber {

struct FeaturePairs::Impl {
  /// What may come again: two vertices, or a vertex and an edge.
  enum class Kinds : std::uint32_t { vertex_vertex, vertex_edge, edge_vertex };
  struct Key {
    std::uint64_t ids;  // of a, then of b
    Kinds kinds;
  };

  /// Forgets all pairs, and keeps the memory.
  void start();
  /// Has the place of a pair read from memory, for count() to come.
  void prefetch(const Key& key) const;
  /// Counts a pair that may come again. Returns whether it is new, and the next to be listed.
  bool count(const Key& key);
  /// Writes to the list how often its pairs have come.
  void set_multiplicities();

  std::vector<FeaturePair> pairs;

 private:
  /// Where a pair is that may come again. The tag has the kinds and the call that found it: places of others are free.
  struct alignas(16) Place {
    std::uint64_t ids;
    std::uint32_t tag, number;
  };
  /// How often a pair has come. The list is larger than caches, and counting there would miss them.
  struct Count {
    std::uint32_t pair, multiplicity;
  };
  static constexpr std::uint32_t calls = std::uint32_t{1} << 30U;

  std::uint32_t tag(Kinds kinds) const { return call_ << 2U | static_cast<std::uint32_t>(kinds); }
  bool is_free(const Place& p) const { return p.tag >> 2U != call_; }
  std::size_t first_place(const Key& key) const;
  Place& place(const Key& key);
  void grow();

  std::vector<Place> table_ = std::vector<Place>(64);  // a power of two, at most half in use
  std::vector<Count> counts_;
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
  pairs.clear(), counts_.clear();
  if (++call_ < calls) return;
  std::fill(table_.begin(), table_.end(), Place{});
  call_ = 1;
}

std::size_t FeaturePairs::Impl::first_place(const Key& key) const {
  // Multiplied by the digits of the golden ratio, ids that follow each other are spread.
  const std::uint64_t mixed = (key.ids ^ key.ids >> 29U ^ std::uint64_t{tag(key.kinds)} << 40U) * 0x9e3779b97f4a7c15U;
  return mixed >> 32U & (table_.size() - 1);
}

void FeaturePairs::Impl::prefetch(const Key& key) const { base::prefetch(table_[first_place(key)]); }

/// The place of a pair, or the free one that it gets.
FeaturePairs::Impl::Place& FeaturePairs::Impl::place(const Key& key) {
  for (std::size_t i = first_place(key);; i = (i + 1) & (table_.size() - 1)) {
    Place& p = table_[i];
    if (is_free(p) || (p.ids == key.ids && p.tag == tag(key.kinds))) return p;
  }
}

void FeaturePairs::Impl::grow() {
  std::vector<Place> before(2 * table_.size());
  std::swap(before, table_);
  for (const Place& p : before) {
    if (!is_free(p)) place({p.ids, static_cast<Kinds>(p.tag & 3U)}) = p;
  }
}

bool FeaturePairs::Impl::count(const Key& key) {
  if (2 * counts_.size() >= table_.size()) grow();
  Place& p = place(key);
  if (!is_free(p)) return ++counts_[p.number].multiplicity, false;
  p = {key.ids, tag(key.kinds), static_cast<std::uint32_t>(counts_.size())};
  counts_.push_back({static_cast<std::uint32_t>(pairs.size()), 1});
  return true;
}

void FeaturePairs::Impl::set_multiplicities() {
  for (const Count& c : counts_) pairs[c.pair].multiplicity = c.multiplicity;
}

namespace {

using geometry::near_unit;

using FeatureMemory = FeaturePairs::Impl;
using pair::EdgeVertices;
using pair::Side;

/// A feature of one model. Weights of an edge that a vertex is closest to are not known at first.
struct FeatureOf {
  FeatureKind kind;
  std::uint32_t id;
  std::array<VertexId, 3> vertices;
  Vec3 weights;
};

FeatureOf of_vertex(VertexId v) { return {FeatureKind::vertex, v, {v, v, v}, {1, 0, 0}}; }

/// The feature of an edge that the point at a parameter is on.
FeatureOf of_edge(EdgeId e, const EdgeVertices& v, double parameter) {
  if (parameter > 0 && parameter < 1) {
    return {FeatureKind::edge, e, {v[0], v[1], v[0]}, {1 - parameter, parameter, 0}};
  }
  return of_vertex(v[parameter > 0 ? 1 : 0]);
}

/// The feature of a face that the point of these weights is on.
FeatureOf of_face(TriangleId t, const Corners& v, const Vec3& weights, const MeshEdges& edges) {
  const Feature f = geometry::feature_of(weights);
  if (f.kind == FeatureKind::face) return {f.kind, t, v, weights};
  if (f.kind == FeatureKind::vertex) return of_vertex(v[f.index]);
  const EdgeId edge = edges.of_triangles()[t][f.index];
  LIMBER_ASSERT(edge != no_id);  // between corners of one vertex there is no inside
  const auto [from, to] = std::minmax(v[f.index], v[geometry::next_corner[f.index]]);
  return {f.kind, edge, {from, to, from}, {}};
}

/// A vector of length 1 that is perpendicular to both; 0 if they are parallel, or one is 0.
Vec3 perpendicular_to(const Vec3& u, const Vec3& v) {
  if (max_abs(u) == 0 || max_abs(v) == 0) return {};
  const Vec3 n = cross(near_unit(u), near_unit(v));
  return max_abs(n) == 0 ? Vec3{} : geometry::unit(n);
}

/// The normal of features that meet, as feature_pairs() says.
Vec3 normal_of_contact(FeatureKind kind_a, const Triangle& a, FeatureKind kind_b, const Triangle& b) {
  // An edge has its vector first, and a vertex none. The order of the two gives the side of a face.
  const Vec3 u = kind_b == FeatureKind::face ? b.v2 - b.v0 : a.v1 - a.v0;
  const Vec3 v = kind_a == FeatureKind::face ? a.v2 - a.v0 : b.v1 - b.v0;
  const Vec3 n = perpendicular_to(u, v);
  if (max_abs(n) > 0) return n;
  if (max_abs(u) > 0) return geometry::perpendicular_to(near_unit(u));
  return max_abs(v) > 0 ? geometry::perpendicular_to(near_unit(v)) : Vec3{0, 0, 1};
}

/// From the point of a with these weights to that of b. Differences with one vertex keep what far places would round
/// away.
Vec3 from_a_to_b(const Triangle& a, const Vec3& w, const Triangle& b, const Vec3& x) {
  return (b.v0 - a.v0) + ((x.y * (b.v1 - b.v0) + x.z * (b.v2 - b.v0)) - (w.y * (a.v1 - a.v0) + w.z * (a.v2 - a.v0)));
}

/// The sink of ElementsWithin that lists features. Pairs that may come again wait until there are some of them: their
/// places in the table are far from each other, and are read together.
template <bool is_self>
class FeatureSink {
 public:
  FeatureSink(const pair::PlacedPair& placed, const MeshEdges& edges_a, const MeshEdges& edges_b, FeatureMemory& found)
      : placed_(placed), edges_{&edges_a, &edges_b}, found_(found) {
    found_.start();
  }

  bool take(const VertexFacePair& p, const Corners& corners) {
    const FeatureOf of_point = of_vertex(p.vertex);
    const FeatureOf of_other = of_face(p.triangle, corners, p.weights, *edges_[p.is_vertex_of_b ? 0 : 1]);
    p.is_vertex_of_b ? add(of_other, of_point, p.distance) : add(of_point, of_other, p.distance);
    return true;
  }
  bool take(const EdgeEdgePair& p, const EdgeVertices& of_a, const EdgeVertices& of_b) {
    add(of_edge(p.a, of_a, p.parameter_a), of_edge(p.b, of_b, p.parameter_b), p.distance);
    return true;
  }

  /// Lists the pairs that wait.
  void finish() {
    for (const Waiting& w : std::span(waiting_).first(std::exchange(waiting_count_, 0))) {
      if (found_.count(w.key)) append_nearest(w.a, w.b);
    }
  }

 private:
  struct Waiting {
    FeatureOf a, b;
    FeatureMemory::Key key;
  };

  void add(const FeatureOf& a, const FeatureOf& b, double distance) {
    if (is_self && std::pair(b.kind, b.id) < std::pair(a.kind, a.id)) return add(b, a, distance);
    const bool is_edge_a = a.kind == FeatureKind::edge, is_edge_b = b.kind == FeatureKind::edge;
    if (a.kind == FeatureKind::face || b.kind == FeatureKind::face || (is_edge_a && is_edge_b)) {
      return append(a, b, distance);
    }
    using Kinds = FeatureMemory::Kinds;
    const Kinds kinds = is_edge_a ? Kinds::edge_vertex : is_edge_b ? Kinds::vertex_edge : Kinds::vertex_vertex;
    Waiting& w = waiting_[waiting_count_++];
    w = {a, b, {std::uint64_t{a.id} << 32U | b.id, kinds}};
    found_.prefetch(w.key);
    if (waiting_count_ == std::size(waiting_)) finish();
  }

  Triangle placed(Side s, const FeatureOf& f) const {
    return is_self ? placed_.local_triangle(s, f.vertices) : placed_.triangle(s, f.vertices);
  }

  /// Lists two vertices, or a vertex and an edge.
  void append_nearest(FeatureOf a, FeatureOf b) {
    const Triangle at_a = placed(Side::a, a), at_b = placed(Side::b, b);
    const auto [distance, s, t] = geometry::closest_on(Segment{at_a.v0, at_a.v1}, Segment{at_b.v0, at_b.v1});
    a.weights = {1 - s, s, 0}, b.weights = {1 - t, t, 0};
    append(a, b, distance);
  }
  void append(const FeatureOf& a, const FeatureOf& b, double distance) {
    const Triangle at_a = placed(Side::a, a), at_b = placed(Side::b, b);
    const Vec3 between = from_a_to_b(at_a, a.weights, at_b, b.weights);
    const bool is_apart = distance > 0 && max_abs(between) > 0;
    found_.pairs.push_back(
        {.distance = distance,
         .point_a = geometry::point_at(at_a, a.weights),
         .point_b = geometry::point_at(at_b, b.weights),
         .normal = is_apart ? geometry::unit(between) : normal_of_contact(a.kind, at_a, b.kind, at_b),
         .weights_a = a.weights,
         .weights_b = b.weights,
         .a = a.id,
         .b = b.id,
         .vertices_a = a.vertices,
         .vertices_b = b.vertices,
         .multiplicity = 1,
         .kind_a = a.kind,
         .kind_b = b.kind});
  }

  const pair::PlacedPair& placed_;
  const MeshEdges* edges_[2];
  FeatureMemory& found_;
  std::size_t waiting_count_ = 0;
  std::array<Waiting, 16> waiting_;
};

template <bool is_self>
ElementPairCount find_features(const pair::PlacedPair& placed, const MeshEdges& edges_a, const MeshEdges& edges_b,
                               double margin, FeaturePairs& found, const QueryBudget& budget) {
  FeatureSink<is_self> sink(placed, edges_a, edges_b, Access::impl(found));
  pair::ElementsWithin<is_self, FeatureSink<is_self>&> collector(placed, edges_a, edges_b, margin, sink);
  ElementPairCount result;
  pair::BudgetMeter meter(budget);
  result.stopped_by = pair::search_all(placed, collector, meter, result.stats);
  sink.finish();
  Access::impl(found).set_multiplicities();
  result.vertex_face = collector.vertex_face_count, result.edge_edge = collector.edge_edge_count;
  result.is_complete = result.stopped_by == StoppedBy::nothing;
  return result;
}

}  // namespace

ElementPairCount feature_pairs(const Placed& a, const Placed& b, double margin, FeaturePairs& found,
                               const FeaturePairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::feature_pairs");
  for (const Placed& body : {a, b}) base::check_has_no_radius(body, "limber::feature_pairs");
  const pair::PlacedPair placed(a, b);
  return find_features<false>(placed, a.model().edges(), b.model().edges(), margin, found, options.budget);
}

ElementPairCount self_feature_pairs(const Model& model, double margin, FeaturePairs& found,
                                    const FeaturePairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::self_feature_pairs");
  const pair::PlacedPair placed(Placed{model}, Placed{model});
  return find_features<true>(placed, model.edges(), model.edges(), margin, found, options.budget);
}

}  // namespace limber
