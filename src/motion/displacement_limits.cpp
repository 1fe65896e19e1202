// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Two elements at a distance d stay at least the separation s apart if the vertices of one go no farther than x and
// those of the other no farther than y, with x + y = d - s: a point of an element goes no farther than its farthest
// vertex. Pairs are taken one after the other. Numbers only become smaller, so what a pair has been given stays safe.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "limber/motion.h"
#include "pair/placed_pair.h"

namespace limber {
namespace motion {
namespace {

// Rounds numbers down that have been computed by a few operations.
constexpr double inward = 1 - 0x1p-40;

bool is_length(double x) { return x >= 0 && x <= max_coordinate; }

void check_displacements(std::span<const double> displacements, const Mesh& mesh, const char* function) {
  LIMBER_REQUIRE(displacements.size() == mesh.positions().size(),
                 (std::string(function) + ": there must be a displacement for each vertex").c_str());
  LIMBER_REQUIRE(std::all_of(displacements.begin(), displacements.end(), is_length),
                 (std::string(function) + ": displacements must be from 0 to 2^200").c_str());
}

void check_separation(double separation, const char* function) {
  LIMBER_REQUIRE(is_length(separation), (std::string(function) + ": the separation must be from 0 to 2^200").c_str());
}

double largest(std::span<const double> numbers) {
  return numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end());
}

/// The displacements of the vertices of one model; none if it stands still.
class Displacements {
 public:
  explicit Displacements(std::span<double> of_vertices) : of_vertices_(of_vertices) {}

  double largest_of(std::span<const VertexId> vertices) const {
    double most = 0;
    for (const VertexId v : vertices) most = std::max(most, of(v));
    return most;
  }
  void limit(std::span<const VertexId> vertices, double most) {
    for (const VertexId v : vertices) {
      if (!of_vertices_.empty()) of_vertices_[v] = std::min(of_vertices_[v], most);
    }
  }

 private:
  double of(VertexId v) const { return of_vertices_.empty() ? 0 : of_vertices_[v]; }

  std::span<double> of_vertices_;
};

/// Shares the room between two elements.
void share(double room, Displacements& a, std::span<const VertexId> of_a, Displacements& b,
           std::span<const VertexId> of_b) {
  room = std::max(room, 0.0);
  const double wants_a = a.largest_of(of_a), wants_b = b.largest_of(of_b);
  if (wants_a + wants_b <= room) return;
  // What one does not want of its half is left to the other.
  const double half = 0.5 * room;
  a.limit(of_a, wants_b < half ? (room - wants_b) * inward : half);
  b.limit(of_b, wants_a < half ? (room - wants_a) * inward : half);
}

/// How much room pairs of elements have beyond the separation.
class Room {
 public:
  Room(const pair::PlacedPair& placed, const Placed& a, const Placed& b, double separation)
      : mesh_a_(a.model().mesh()),
        mesh_b_(b.model().mesh()),
        separation_(separation),
        rounding_(distance_errors * placed.error()) {}

  /// That of elements at a distance, rounded down.
  double at(double distance) const { return (distance * inward - separation_ - rounding_) * inward; }
  /// Elements that are farther apart have more room than is wanted.
  double margin(double wanted) const { return (separation_ + wanted + rounding_) / (inward * inward * inward); }

  void limit_vertex_face(const VertexFacePair& pair, Displacements& a, Displacements& b) const {
    const std::array<VertexId, 1> vertex{pair.vertex};
    if (pair.is_vertex_of_b) {
      share(at(pair.distance), a, mesh_a_.triangles()[pair.triangle], b, vertex);
    } else {
      share(at(pair.distance), a, vertex, b, mesh_b_.triangles()[pair.triangle]);
    }
  }

 private:
  const Mesh &mesh_a_, &mesh_b_;
  // The part of a distance's error that does not grow with it is at most that of placing vertices, 2^-45 of the
  // magnitude of the query, and 2^-46 of an extent that is at most twice the magnitude. The other part is within
  // `inward`.
  static constexpr double distance_errors = 4;

  double separation_, rounding_;
};

}  // namespace
}  // namespace motion

void limit_self_displacements(const Model& model, double separation, std::span<double> displacements) {
  const base::DefaultFloatEnvironment environment;
  motion::check_separation(separation, "limber::limit_self_displacements");
  motion::check_displacements(displacements, model.mesh(), "limber::limit_self_displacements");
  const Placed here{model};
  const motion::Room room(pair::PlacedPair(here, here), here, here, separation);
  motion::Displacements own(displacements);
  const auto edges = model.edges().vertices();
  visit_self_element_pairs(
      model, room.margin(2 * motion::largest(displacements)),
      [&](const VertexFacePair& pair) {
        room.limit_vertex_face(pair, own, own);
        return true;
      },
      [&](const EdgeEdgePair& pair) {
        motion::share(room.at(pair.distance), own, edges[pair.a], own, edges[pair.b]);
        return true;
      });
}

void limit_displacements(const Placed& a, const Placed& b, double separation, std::span<double> of_a,
                         std::span<double> of_b) {
  const base::DefaultFloatEnvironment environment;
  motion::check_separation(separation, "limber::limit_displacements");
  motion::check_displacements(of_a, a.model().mesh(), "limber::limit_displacements");
  if (!of_b.empty()) motion::check_displacements(of_b, b.model().mesh(), "limber::limit_displacements");
  for (const Placed& body : {a, b}) base::check_has_no_radius(body, "limber::limit_displacements");
  const motion::Room room(pair::PlacedPair(a, b), a, b, separation);
  motion::Displacements displacements_a(of_a), displacements_b(of_b);
  const auto edges_a = a.model().edges().vertices(), edges_b = b.model().edges().vertices();
  visit_element_pairs(
      a, b, room.margin(motion::largest(of_a) + motion::largest(of_b)),
      [&](const VertexFacePair& pair) {
        room.limit_vertex_face(pair, displacements_a, displacements_b);
        return true;
      },
      [&](const EdgeEdgePair& pair) {
        motion::share(room.at(pair.distance), displacements_a, edges_a[pair.a], displacements_b, edges_b[pair.b]);
        return true;
      });
}

}  // namespace limber
