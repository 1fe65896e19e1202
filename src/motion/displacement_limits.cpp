// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Two elements at a distance d stay at least the separation s apart if the vertices of one go no farther than x and
// those of the other no farther than y, with x + y = d - s: a point of an element goes no farther than its farthest
// vertex. Pairs are taken one after the other. Numbers only become smaller, so what a pair has been given stays safe.
// Along motions the same is said of two parallel planes that are between the elements, a gap d apart: vertices may
// approach along their normal by x and y. What leads away or sideways is free.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "limber/motion.h"
#include "motion/impact_search.h"
#include "motion/moving_pair.h"
#include "pair/placed_pair.h"

namespace limber {
namespace motion {
namespace {

using base::inward;

/// Displacements are up to 2^200, fractions up to 1.
void check_numbers(std::span<const double> numbers, std::size_t vertex_count, double most, const char* function) {
  const bool are_fractions = most == 1;
  require(numbers.size() == vertex_count, function,
          are_fractions ? "fractions: there must be one for each vertex"
                        : "displacements: there must be one for each vertex");
  require(std::all_of(numbers.begin(), numbers.end(), [&](double x) { return x >= 0 && x <= most; }), function,
          are_fractions ? "fractions must be from 0 to 1" : "displacements must be from 0 to 2^200");
}

void check_separation(double separation, const char* function) {
  require(separation >= 0 && separation <= max_coordinate, function, "the separation must be from 0 to 2^200");
}

/// The largest of the numbers of the vertices that belong to a triangle. The others are in no pair of elements, which
/// therefore does not limit them.
double largest_of(const Mesh& mesh, std::span<const double> numbers) {
  double result = 0;
  if (numbers.empty()) return result;
  for (const Corners& corners : mesh.triangles()) {
    for (const VertexId v : corners) result = std::max(result, numbers[v]);
  }
  return result;
}

double mean_length(const Mesh& mesh, std::span<const std::array<VertexId, 2>> edges) {
  double sum = 0;
  for (const auto& [p, q] : edges) sum += length(mesh.positions()[p] - mesh.positions()[q]);
  return sum / static_cast<double>(edges.size());
}

/// What the corners of two elements would like to do.
struct Wishes {
  std::size_t count;                // of corners of the first element; the others are those of the second
  std::array<double*, 4> number{};  // what limits a corner; null if it stays, or is one of the corners before
  std::array<double, 4> approach{};

  Wishes(std::span<double> of_a, std::span<double> of_b, const std::array<VertexId, 4>& vertices, std::size_t of_first)
      : count(of_first) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::span<double> numbers = i < count ? of_a : of_b;
      const auto before = vertices.begin() + (i < count ? 0 : count), here = vertices.begin() + i;
      if (numbers.empty() || std::find(before, here, *here) != here) continue;
      number[i] = &numbers[*here], approach[i] = *number[i];
    }
  }
  double first_wants() const { return std::max(0.0, *std::max_element(approach.begin(), approach.begin() + count)); }
  double second_wants() const { return std::max(0.0, *std::max_element(approach.begin() + count, approach.end())); }

  /// Shares the room between two elements; but for rounding.
  void share(double room, double rounding = 0) const {
    const double first = first_wants(), second = second_wants();
    if (first + second <= room + rounding) return;
    // What one does not want of its half is left to the other.
    const double half = 0.5 * room;
    for (std::size_t i = 0; i < 4; ++i) {
      const double most = std::max(half, room - (i < count ? second : first));
      if (approach[i] > most + rounding) *number[i] *= most / approach[i] * inward;
    }
  }
};

/// How much room pairs of elements have beyond the separation.
class Room {
 public:
  Room(const pair::PlacedPair& placed, double separation)
      : separation_(separation), rounding_(distance_errors * placed.error()) {}

  /// That of elements at a distance, rounded down.
  double at(double distance) const { return std::max((distance * inward - separation_ - rounding_) * inward, 0.0); }
  /// Elements that are farther apart have more room than is wanted.
  double margin(double wanted) const { return (separation_ + wanted + rounding_) / (inward * inward * inward); }

 private:
  // The part of a distance's error that does not grow with it is at most that of placing vertices, 2^-45 of the
  // magnitude of the query, and 2^-46 of an extent that is at most twice the magnitude. The other part is within
  // `inward`.
  static constexpr double distance_errors = 4;

  double separation_, rounding_;
};

/// Shares the room of all pairs that a query visits.
template <typename Visit>
void share_displacements(const Placed& a, const Placed& b, double separation, std::span<double> of_a,
                         std::span<double> of_b, const char* function, const Visit& visit_pairs) {
  const Mesh &mesh_a = a.model().mesh(), &mesh_b = b.model().mesh();
  check_separation(separation, function);
  check_numbers(of_a, mesh_a.positions().size(), max_coordinate, function);
  if (!of_b.empty()) check_numbers(of_b, mesh_b.positions().size(), max_coordinate, function);
  const Room room(pair::PlacedPair(a, b), separation);
  const auto edges_a = a.model().edges().vertices(), edges_b = b.model().edges().vertices();
  const auto share_within = [&](double margin) {
    visit_pairs(
        margin,
        [&](const VertexFacePair& pair) {
          const auto& [p, q, r] = (pair.is_vertex_of_b ? mesh_a : mesh_b).triangles()[pair.triangle];
          const Wishes wishes = pair.is_vertex_of_b ? Wishes(of_a, of_b, {p, q, r, pair.vertex}, 3)
                                                    : Wishes(of_a, of_b, {pair.vertex, p, q, r}, 1);
          return wishes.share(room.at(pair.distance)), true;
        },
        [&](const EdgeEdgePair& pair) {
          const auto &p = edges_a[pair.a], &q = edges_b[pair.b];
          return Wishes(of_a, of_b, {p[0], p[1], q[0], q[1]}, 2).share(room.at(pair.distance)), true;
        });
  };
  // First pairs about an edge apart: in one mesh they leave no wish much larger, so few others or none are left.
  double shared = 0;
  for (const double most : {mean_length(mesh_a, edges_a), std::numeric_limits<double>::infinity()}) {
    const double margin = room.margin(std::min(most, largest_of(mesh_a, of_a) + largest_of(mesh_b, of_b)));
    if (margin > shared) share_within(shared = margin);
  }
}

/// The collector of limits along motions.
class SharedMotions {
 public:
  static constexpr bool at_any_pace = true;

  SharedMotions(const MovingPair& models, double separation, std::span<double> of_a, std::span<double> of_b)
      : models_(models), separation_(separation), of_a_(of_a), of_b_(of_b) {}

  double max_time() const { return 1; }
  bool is_done() const { return false; }
  bool wants_contacts_only() const { return false; }
  bool stays(Side s, const bvh::Leaf& leaf) const {
    const std::span<const double> fractions = s == Side::a ? of_a_ : of_b_;
    const MovingModel::Impl& model = models_.model(s);
    const auto vertex_stays = [&](VertexId v) { return fractions[v] == 0 || model.start[v] == model.end[v]; };
    const auto triangle_stays = [&](const auto& corners) {
      return std::all_of(corners.begin(), corners.end(), vertex_stays);
    };
    return fractions.empty() || std::all_of(std::begin(leaf.vertices), std::end(leaf.vertices), triangle_stays);
  }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    using enum ElementPair::Kind;
    double largest = 0;  // of coordinates
    for (const auto& corners : elements.corners) {
      for (const Vec3& p : corners) largest = std::max(largest, max_abs(p));
    }
    // Squares of tiny lengths would vanish. What is granted is a part, which no unit changes.
    const double unit = 0 < largest && largest < 0x1p-300 ? std::ldexp(1.0, std::min(-std::ilogb(largest), 1000)) : 1;
    const double rounding = 0x1p-47 * unit * largest;  // of positions
    Vec3 start[4], end[4];
    for (std::size_t k = 0; k < 4; ++k) {
      start[k] = unit * elements.corners[0][k], end[k] = unit * elements.corners[1][k];
    }
    const std::size_t count = pair.kind == edge_edge ? 2 : pair.kind == vertex_face ? 1 : 3;
    Wishes wishes(of_a_, of_b_, models_.vertices(pair), count);
    Vec3 at[4], way[4];
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t k = pair.kind == face_vertex ? (i + 1) % 4 : i;  // of `elements` the vertex is the first
      at[i] = start[k] - start[0], way[i] = wishes.approach[i] * (end[k] - start[k]);
      wishes.approach[i] = length(way[i]);
    }
    const ClosestPoints closest =
        count == 2 ? geometry::closest_points(Segment{start[0], start[1]}, Segment{start[2], start[3]})
                   : geometry::closest_points(start[0], Triangle{start[1], start[2], start[3]});
    if (closest.distance <= rounding) return wishes.share(0);
    // Normals of planes: between the closest points; that of the face, or across both edges; and where these may be
    // parallel, across one and the motion as seen from the other, and across one alone.
    const Vec3 shortest = closest.point_b - closest.point_a;
    const Vec3 edge = count == 2 ? start[1] - start[0] : start[2] - start[1];
    std::array<Vec3, 4> normals{cross(edge, count == 2 ? start[3] - start[2] : start[3] - start[1]), shortest};
    if (count == 2) {
      const auto across = [&](const Vec3& v) {
        return v - edge * (dot(edge, v) / std::max(length_sq(edge), 0x1p-1000));
      };
      normals[2] = cross(edge, way[0] + way[1] - way[2] - way[3]);
      normals[3] = across(across(shortest));  // again: rounding has left something along the edge
    }
    const double kept = std::min(unit * separation_, closest.distance);
    double best_room = 0, best = -1;  // the part of their wishes that elements are granted; without planes they stay
    Wishes chosen = wishes;
    for (std::size_t k = 0; k < 8; ++k) {
      const double size = length(normals[k / 2]);
      if (!(size > 0)) continue;
      const Vec3 n = (k % 2 == 0 ? 1 / size : -1 / size) * normals[k / 2];
      double first = -std::numeric_limits<double>::infinity(), second = -first;
      for (std::size_t i = 0; i < 4; ++i) {
        wishes.approach[i] = (i < count ? 1 : -1) * dot(n, way[i]);
        i < count ? first = std::max(first, dot(n, at[i])) : second = std::min(second, dot(n, at[i]));
      }
      const double gap = second - first, room = std::max(gap - kept, 0.0);
      const double wanted = wishes.first_wants() + wishes.second_wants();
      if (gap <= 0 || gap < kept - rounding) continue;  // no planes are between them
      if (wanted <= room + rounding) return;
      if (room > best * wanted) best = room / wanted, best_room = room, chosen = wishes;
    }
    chosen.share(best_room, rounding);
  }

 private:
  const MovingPair& models_;
  double separation_;
  std::span<double> of_a_, of_b_;
};

void share_motions(const MovingPair& models, double separation, std::span<double> of_a, std::span<double> of_b,
                   const char* function) {
  check_separation(separation, function);
  check_numbers(of_a, models.model(Side::a).start.size(), 1, function);
  if (!of_b.empty()) check_numbers(of_b, models.model(Side::b).start.size(), 1, function);
  SharedMotions collector(models, separation, of_a, of_b);
  pair::BudgetMeter meter;  // without limits
  ImpactSearch<SharedMotions>(models, separation, collector, meter).run();
}

}  // namespace
}  // namespace motion

void limit_self_motions(const MovingModel& model, double separation, std::span<double> fractions) {
  const base::DefaultFloatEnvironment environment;
  motion::share_motions({model, "limber::limit_self_motions"}, separation, fractions, fractions,
                        "limber::limit_self_motions");
}

void limit_motions(const MovingModel& a, const MovingModel& b, double separation, std::span<double> of_a,
                   std::span<double> of_b) {
  const base::DefaultFloatEnvironment environment;
  motion::share_motions({a, b, "limber::limit_motions"}, separation, of_a, of_b, "limber::limit_motions");
}

void limit_self_displacements(const Model& model, double separation, std::span<double> displacements) {
  const base::DefaultFloatEnvironment environment;
  const Placed here{model};
  motion::share_displacements(here, here, separation, displacements, displacements, "limber::limit_self_displacements",
                              [&](double margin, VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge) {
                                visit_self_element_pairs(model, margin, visit_vertex_face, visit_edge_edge);
                              });
}

void limit_displacements(const Placed& a, const Placed& b, double separation, std::span<double> of_a,
                         std::span<double> of_b) {
  const base::DefaultFloatEnvironment environment;
  for (const Placed& body : {a, b}) base::check_has_no_radius(body, "limber::limit_displacements");
  motion::share_displacements(a, b, separation, of_a, of_b, "limber::limit_displacements",
                              [&](double margin, VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge) {
                                visit_element_pairs(a, b, margin, visit_vertex_face, visit_edge_edge);
                              });
}

}  // namespace limber
