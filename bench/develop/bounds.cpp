// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  Which bounding volume at the nodes of a wide tree lets an exact distance query prune most pairs?
// Workload  Ball over square (aligned, and both turned together) and any two mesh files, at gaps of 0.0001 to 10 times
//           the size, 8 seeded poses each.
// Metric    Medians over the poses, and the worst: pairs of nodes compared and pairs of leaves not pruned, with the
//           true distance as the prune distance from the start, so that the order of the traversal does not matter;
//           pairs of triangles not pruned along the direction of the witness.
// Shape     Spheres grow with the number of triangles; a slab along the surface's normal makes the counts nearly
//           independent of it where the surface is smooth; boxes do the same where it is aligned with the axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "limber/classic.h"
#include "limber/io.h"
#include "scenes/scenes.h"

namespace limber {
namespace {

struct Bound {
  Vec3 center;  // of the sphere and of the box
  double radius = 0;
  Vec3 half;                 // of the box, along the model's axes
  Vec3 normal;               // of the slab, unit length
  double low = 0, high = 0;  // of the slab, relative to the center
};

struct Node {
  Bound bound;
  std::array<std::uint32_t, 8> child{};
  std::uint32_t child_count = 0;     // 0 for a leaf
  std::uint32_t begin = 0, end = 0;  // triangles of a leaf in `order`
};

struct WideTree {
  const Mesh& mesh;
  std::vector<TriangleId> order;
  std::vector<Node> nodes;
};

Bound bound_of(const WideTree& tree, std::uint32_t begin, std::uint32_t end) {
  Bound b;
  Vec3 low = tree.mesh.triangle(tree.order[begin]).v0, high = low;
  Vec3 normal, reference;
  double largest = -1;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Triangle t = tree.mesh.triangle(tree.order[i]);
    for (std::size_t k = 0; k < 3; ++k) low = min(low, t[k]), high = max(high, t[k]);
    const Vec3 n = cross(t.v1 - t.v0, t.v2 - t.v0);
    if (length_sq(n) > largest) largest = length_sq(n), reference = n;
  }
  b.center = (low + high) * 0.5;
  b.half = (high - low) * 0.5;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Triangle t = tree.mesh.triangle(tree.order[i]);
    const Vec3 n = cross(t.v1 - t.v0, t.v2 - t.v0);
    normal += dot(n, reference) < 0 ? -n : n;
    for (std::size_t k = 0; k < 3; ++k) b.radius = std::max(b.radius, length(t[k] - b.center));
  }
  const double size = length(normal);
  b.normal = size > 0 ? normal * (1 / size) : Vec3{0, 0, 1};
  b.low = b.high = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Triangle t = tree.mesh.triangle(tree.order[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = dot(b.normal, t[k] - b.center);
      b.low = std::min(b.low, h), b.high = std::max(b.high, h);
    }
  }
  return b;
}

std::uint32_t build(WideTree& tree, const std::vector<Vec3>& centers, std::uint32_t begin, std::uint32_t end,
                    std::uint32_t arity, std::uint32_t leaf_size) {
  const auto id = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes.push_back({bound_of(tree, begin, end), {}, 0, begin, end});
  if (end - begin <= leaf_size) return id;
  std::vector<std::uint32_t> splits{begin, end};
  while (splits.size() - 1 < arity) {  // halve the largest part along its longest axis
    std::size_t widest = 0;
    for (std::size_t i = 1; i + 1 < splits.size(); ++i) {
      if (splits[i + 1] - splits[i] > splits[widest + 1] - splits[widest]) widest = i;
    }
    const std::uint32_t first = splits[widest], last = splits[widest + 1];
    if (last - first <= leaf_size) break;
    Vec3 low = centers[tree.order[first]], high = low;
    for (std::uint32_t i = first; i < last; ++i) {
      low = min(low, centers[tree.order[i]]), high = max(high, centers[tree.order[i]]);
    }
    const Vec3 side = high - low;
    const std::size_t axis = side.x >= side.y ? (side.x >= side.z ? 0 : 2) : (side.y >= side.z ? 1 : 2);
    // Parts are whole leaves, so that leaves are full.
    const std::uint32_t leaves = (last - first + leaf_size - 1) / leaf_size;
    const std::uint32_t half = first + (leaves + 1) / 2 * leaf_size;
    std::nth_element(
        tree.order.begin() + first, tree.order.begin() + half, tree.order.begin() + last,
        [&](TriangleId s, TriangleId t) { return std::pair(centers[s][axis], s) < std::pair(centers[t][axis], t); });
    splits.insert(splits.begin() + static_cast<std::ptrdiff_t>(widest) + 1, half);
  }
  for (std::size_t i = 0; i + 1 < splits.size(); ++i) {
    const std::uint32_t child = build(tree, centers, splits[i], splits[i + 1], arity, leaf_size);
    tree.nodes[id].child[tree.nodes[id].child_count++] = child;
  }
  return id;
}

WideTree wide_tree(const Mesh& mesh, std::uint32_t arity, std::uint32_t leaf_size) {
  WideTree tree{mesh, std::vector<TriangleId>(mesh.triangles().size()), {}};
  std::iota(tree.order.begin(), tree.order.end(), TriangleId{0});
  std::vector<Vec3> centers(tree.order.size());
  for (TriangleId t = 0; t < centers.size(); ++t) centers[t] = enclosing_sphere(mesh.triangle(t)).center;
  build(tree, centers, 0, static_cast<std::uint32_t>(centers.size()), arity, leaf_size);
  return tree;
}

enum Part : unsigned { sphere = 0, box = 1, slab = 2, direction = 4 };

/// Bounds of pairs of nodes, b placed in the frame of a.
class PairBound {
 public:
  PairBound(unsigned parts, const Transform& a_from_b, const Vec3& witness_direction)
      : parts_(parts), a_from_b_(a_from_b), b_from_a_(transpose(a_from_b.rotation)), witness_(witness_direction) {}

  double operator()(const Bound& a, const Bound& b) const {
    const Vec3 between = a_from_b_(b.center) - a.center;
    const double distance = length(between);
    double best = distance - a.radius - b.radius;
    if ((parts_ & box) != 0) {
      best = std::max(best, gap_along_axes(between, a.half, turned_half(a_from_b_.rotation, b.half)));
      best = std::max(best, gap_along_axes(b_from_a_ * between, turned_half(b_from_a_, a.half), b.half));
    }
    if ((parts_ & slab) != 0) {
      const Vec3 normal_b = a_from_b_.rotation * b.normal;
      best = std::max(best, across(a.normal, a, b, normal_b, between, distance));
      best = std::max(best, across(normal_b, a, b, normal_b, between, distance));
    }
    if ((parts_ & direction) != 0) {
      const Vec3 normal_b = a_from_b_.rotation * b.normal;
      best = std::max(best, dot(witness_, between) - support(a, witness_, a.normal, witness_) -
                                support(b, -witness_, normal_b, -(b_from_a_ * witness_)));
    }
    return best;
  }

 private:
  static Vec3 turned_half(const Mat3& r, const Vec3& half) {
    return {dot(abs(r.row0), half), dot(abs(r.row1), half), dot(abs(r.row2), half)};
  }
  static double gap_along_axes(const Vec3& between, const Vec3& half_a, const Vec3& half_b) {
    const Vec3 gap = max(abs(between) - half_a - half_b, Vec3{});
    return length(gap);
  }
  /// The support of a sphere, intersected with its slab, along the unit vector `u`.
  static double slab_support(const Bound& n, const Vec3& normal, const Vec3& u) {
    const double c = dot(u, normal);
    const double limit = c >= 0 ? n.high : -n.low;
    const double cosine = std::abs(c);
    if (n.radius * cosine <= limit) return n.radius;
    const double flat = std::min(limit, n.radius);
    return flat * cosine + std::sqrt(std::max(0.0, (1 - cosine * cosine) * (n.radius * n.radius - flat * flat)));
  }
  double support(const Bound& n, const Vec3& u, const Vec3& normal, const Vec3& u_in_box_frame) const {
    double r = n.radius;
    if ((parts_ & box) != 0) r = std::min(r, dot(abs(u_in_box_frame), n.half));
    if ((parts_ & slab) != 0) r = std::min(r, slab_support(n, normal, u));
    return r;
  }
  /// Gap along u, combined with the gap across u of the discs onto which the spheres project.
  double across(const Vec3& u, const Bound& a, const Bound& b, const Vec3& normal_b, const Vec3& between,
                double distance) const {
    const double h = dot(u, between);
    const double forth = h - slab_support(a, a.normal, u) - slab_support(b, normal_b, -u);
    const double back = -h - slab_support(a, a.normal, -u) - slab_support(b, normal_b, u);
    const double along = std::max({0.0, forth, back});
    const double y = std::sqrt(std::max(0.0, distance * distance - h * h));
    const double aside = std::max(0.0, y - a.radius - b.radius);
    return std::sqrt(along * along + aside * aside);
  }

  unsigned parts_;
  Transform a_from_b_;
  Mat3 b_from_a_;
  Vec3 witness_;
};

struct Counts {
  std::uint64_t node_pairs = 0, leaf_pairs = 0, triangle_pairs = 0;
};

class Counter {
 public:
  Counter(const WideTree& a, const WideTree& b, const PairBound& bound, const Transform& a_from_b, const Vec3& witness,
          double distance, bool expand_both)
      : a_(a),
        b_(b),
        bound_(bound),
        a_from_b_(a_from_b),
        witness_(witness),
        distance_(distance),
        expand_both_(expand_both) {}

  Counts run() {
    visit(0, 0);
    return counts_;
  }

 private:
  void visit(std::uint32_t na, std::uint32_t nb) {
    const Node &a = a_.nodes[na], &b = b_.nodes[nb];
    if (a.child_count == 0 && b.child_count == 0) return compare_leaves(a, b);
    const double ratio = a.bound.radius / b.bound.radius;
    const bool both = expand_both_ && a.child_count != 0 && b.child_count != 0 && ratio <= 2 && ratio >= 0.5;
    const bool expand_a = both || b.child_count == 0 || (a.child_count != 0 && ratio >= 1);
    const bool expand_b = both || !expand_a;
    for (std::uint32_t i = 0; i < (expand_a ? a.child_count : 1); ++i) {
      for (std::uint32_t j = 0; j < (expand_b ? b.child_count : 1); ++j) {
        const std::uint32_t ca = expand_a ? a.child[i] : na, cb = expand_b ? b.child[j] : nb;
        ++counts_.node_pairs;
        if (bound_(a_.nodes[ca].bound, b_.nodes[cb].bound) < distance_) visit(ca, cb);
      }
    }
  }
  void compare_leaves(const Node& a, const Node& b) {
    ++counts_.leaf_pairs;
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      const Triangle s = a_.mesh.triangle(a_.order[i]);
      const double end_of_s = std::max({dot(witness_, s.v0), dot(witness_, s.v1), dot(witness_, s.v2)});
      for (std::uint32_t j = b.begin; j < b.end; ++j) {
        const Triangle t = b_.mesh.triangle(b_.order[j]);
        const double start_of_t =
            std::min({dot(witness_, a_from_b_(t.v0)), dot(witness_, a_from_b_(t.v1)), dot(witness_, a_from_b_(t.v2))});
        if (start_of_t - end_of_s < distance_ * (1 - 1e-12)) ++counts_.triangle_pairs;
      }
    }
  }

  const WideTree &a_, &b_;
  const PairBound& bound_;
  Transform a_from_b_;
  Vec3 witness_;
  double distance_;
  bool expand_both_;
  Counts counts_;
};

double diagonal(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return length(high - low);
}

Vec3 center_of(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return (low + high) * 0.5;
}

/// Slides b along `outward` until the gap is `gap`. No step goes too far, because its length is a distance.
Transform placed_at_gap(const classic::Model& a, const classic::Model& b, Transform a_from_b, const Vec3& outward,
                        double gap) {
  for (int step = 0; step < 60; ++step) {
    const double distance = classic::distance({a}, {b, a_from_b}, {.relative_error = 1e-3}).lower;
    if (std::abs(distance - gap) <= 0.02 * gap) break;
    a_from_b.translation += outward * (gap - distance);
  }
  return a_from_b;
}

struct Variant {
  const char* name;
  unsigned parts;
  std::uint32_t leaf_size;
  bool expand_both;
};

/// Medians over the poses of all three counts, and the worst number of node pairs.
std::string cell(std::vector<Counts> counts) {
  const auto median = [&](auto count_of) {
    std::ranges::nth_element(counts, counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2), {}, count_of);
    return std::to_string(counts[counts.size() / 2].*count_of);
  };
  if (counts.empty()) return "-";
  const std::uint64_t worst = std::ranges::max(counts, {}, &Counts::node_pairs).node_pairs;
  return median(&Counts::node_pairs) + " / " + median(&Counts::leaf_pairs) + " / " + median(&Counts::triangle_pairs) +
         " (" + std::to_string(worst) + ")";
}

void measure(const char* scene, const Mesh& mesh_a, const Mesh& mesh_b, bool aligned) {
  const classic::Model a(mesh_a), b(mesh_b);
  const double size = std::max(diagonal(mesh_a), diagonal(mesh_b));
  const Variant variants[] = {
      {"sphere", sphere, 4, true},
      {"sphere+box", box, 4, true},
      {"sphere+slab", slab, 4, true},
      {"sphere+box+slab", box | slab, 4, true},
      {"sphere, n*", direction, 4, true},
      {"sphere+box, n*", box | direction, 4, true},
      {"sphere+slab, n*", slab | direction, 4, true},
      {"sphere+box+slab, n*", box | slab | direction, 4, true},
      {"sphere+slab, n*, leaf 8", slab | direction, 8, true},
      {"sphere+slab, n*, one side", slab | direction, 4, false},
  };
  const int poses = 8;
  std::printf("\n### %s\n\n| node pairs / leaf pairs / triangle pairs (most node pairs), gap |", scene);
  const double gaps[] = {1e-4, 1e-2, 0.1, 1, 10};
  for (const double gap : gaps) std::printf(" %g |", gap);
  std::printf("\n|:--|");
  for ([[maybe_unused]] const double gap : gaps) std::printf("--:|");
  std::printf("\n");
  std::vector<std::vector<std::vector<Counts>>> table(std::size(variants),
                                                      std::vector<std::vector<Counts>>(std::size(gaps)));
  const WideTree trees_a[] = {wide_tree(mesh_a, 8, 4), wide_tree(mesh_a, 8, 8)};
  const WideTree trees_b[] = {wide_tree(mesh_b, 8, 4), wide_tree(mesh_b, 8, 8)};
  scenes::Rng rng(7);
  for (int p = 0; p < poses; ++p) {
    Transform start{scenes::random_rotation(rng), {}};
    Vec3 outward = scenes::random_rotation(rng).row0;
    if (aligned) outward = {0, 0, 1};
    start.translation = center_of(mesh_a) + outward * (3 * size) - start.rotation * center_of(mesh_b);
    for (std::size_t g = 0; g < std::size(gaps); ++g) {
      const Transform pose = placed_at_gap(a, b, start, outward, gaps[g] * size);
      const DistanceResult truth = classic::distance({a}, {b, pose});
      if (truth.upper == 0) continue;
      const Vec3 witness = (truth.witness->point_b - truth.witness->point_a) * (1 / truth.upper);
      for (std::size_t v = 0; v < std::size(variants); ++v) {
        const std::size_t tree = variants[v].leaf_size == 4 ? 0 : 1;
        const PairBound bound(variants[v].parts, pose, witness);
        const Counts c =
            Counter(trees_a[tree], trees_b[tree], bound, pose, witness, truth.upper, variants[v].expand_both).run();
        table[v][g].push_back(c);
      }
    }
  }
  for (std::size_t v = 0; v < std::size(variants); ++v) {
    std::printf("| %s |", variants[v].name);
    for (std::size_t g = 0; g < std::size(gaps); ++g) {
      std::printf(" %s |", cell(table[v][g]).c_str());
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

Mesh turned(const Mesh& mesh, const Mat3& rotation) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p = rotation * p;
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

}  // namespace
}  // namespace limber

int main(int argc, char** argv) {
  using namespace limber;
  scenes::Rng rng(11);
  const Mat3 rotation = scenes::random_rotation(rng);
  measure("Ball over square", scenes::thesis_square(), scenes::thesis_ball(), true);
  measure("Ball and square, turned together", turned(scenes::thesis_square(), rotation), scenes::thesis_ball(), false);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto a = load_mesh(argv[i]), b = load_mesh(argv[i + 1]);
    if (!a || !b) return std::fprintf(stderr, "%s\n", (!a ? a : b).error().text.c_str()), 2;
    measure((std::string(argv[i]) + " and " + argv[i + 1]).c_str(), *a, *b, false);
  }
}
