// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Relations of solids against Nef polyhedra of CGAL, which build all cells in exact arithmetic: of bodies with holes,
// spikes and notches, on a lattice where everything ties, and under poses.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Polyhedron_incremental_builder_3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "limber/contacts.h"
#include "limber/solids.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using NefKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Polyhedron = CGAL::Polyhedron_3<NefKernel>;
using Nef = CGAL::Nef_polyhedron_3<NefKernel>;

class Builder : public CGAL::Modifier_base<Polyhedron::HalfedgeDS> {
 public:
  Builder(const Mesh& mesh, const Transform& pose) : mesh_(mesh), pose_(pose) {}

  void operator()(Polyhedron::HalfedgeDS& structure) override {
    CGAL::Polyhedron_incremental_builder_3<Polyhedron::HalfedgeDS> builder(structure, true);
    builder.begin_surface(mesh_.positions().size(), mesh_.triangles().size());
    for (const Vec3& local : mesh_.positions()) {
      const Vec3 p = pose_(local);
      builder.add_vertex({p.x, p.y, p.z});
    }
    for (const Corners& c : mesh_.triangles()) builder.add_facet(c.begin(), c.end());
    builder.end_surface();
  }

 private:
  const Mesh& mesh_;
  const Transform& pose_;
};

Nef nef_of(const Mesh& mesh, const Transform& pose) {
  Builder builder(mesh, pose);
  Polyhedron polyhedron;
  polyhedron.delegate(builder);
  return Nef(polyhedron);
}

SolidRelation relation_of(const Nef& a, const Nef& b, bool& surfaces_meet) {
  surfaces_meet = !(a.boundary() * b.boundary()).is_empty();
  if ((a.interior() * b.interior()).is_empty()) return surfaces_meet ? SolidRelation::touching : SolidRelation::apart;
  const bool is_a_out = !(a.interior() - b.closure()).is_empty(), is_b_out = !(b.interior() - a.closure()).is_empty();
  if (is_a_out) return is_b_out ? SolidRelation::overlapping : SolidRelation::b_inside_a;
  return is_b_out ? SolidRelation::a_inside_b : SolidRelation::equal;
}

/// A ring or a ball whose vertices are moved, on a lattice or off it; none if it then meets itself.
std::optional<Mesh> body(Rng& rng, bool on_lattice, double scale) {
  const std::uint64_t kind = rng.below(3);
  const auto some = [&](std::uint32_t least, std::uint32_t more) {
    return least + static_cast<std::uint32_t>(rng.below(more));
  };
  const std::uint32_t n = some(3, 4), m = some(3, 2);
  const Mesh base = kind == 0 ? scenes::ring(n, m, 0.5) : scenes::ball(n, m);
  const double spikes = kind == 2 ? 0.7 : 0.2, step = 0.25;
  const Mesh moved = mapped(base, [&](const Vec3& p) {
    const Vec3 q = scale * (p + spikes * uniform_point(rng));
    return on_lattice
               ? Vec3{step * std::round(q.x / step), step * std::round(q.y / step), step * std::round(q.z / step)}
               : q;
  });
  for (const Corners& c : moved.triangles()) {
    const auto& p = moved.positions();
    if (cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]]) == Vec3{}) return std::nullopt;
  }
  if (self_collide(Model(moved)).is_yes()) return std::nullopt;
  return moved;
}

/// The same mesh, or one with a vertex somewhere else on the lattice.
Mesh dented(Rng& rng, const Mesh& mesh) {
  std::vector<Vec3> positions = mesh.positions();
  positions[rng.below(positions.size())] += 0.25 * (lattice_point(rng, 3) - Vec3{1, 1, 1});
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// How far b is moved: not at all, by some steps, to a vertex of a, or so that the boxes of both touch.
Vec3 placement(Rng& rng, const Mesh& a, const Mesh& b) {
  const auto some_vertex = [&](const Mesh& mesh) { return mesh.positions()[rng.below(mesh.positions().size())]; };
  const std::uint64_t kind = rng.below(5);
  if (kind == 0) return {};
  if (kind == 1) return 0.5 * (lattice_point(rng, 5) - Vec3{2, 2, 2});
  Vec3 shift = some_vertex(a) - some_vertex(b);
  if (kind == 2) return shift;
  const std::size_t axis = rng.below(3);
  double high = a.positions()[0][axis], low = b.positions()[0][axis];
  for (const Vec3& p : a.positions()) high = std::max(high, p[axis]);
  for (const Vec3& p : b.positions()) low = std::min(low, p[axis]);
  shift[axis] = high - low;
  return shift;
}

TEST(SolidRelationOracle, NefPolyhedraAgree) {
  Rng rng(2701);
  std::array<std::uint64_t, 6> seen{};
  const std::uint64_t pairs = count_from("LIMBER_ORACLE_SOLIDS", 80);
  for (std::uint64_t i = 0; i < pairs;) {
    const bool on_lattice = rng.below(3) != 0;
    const auto a = body(rng, on_lattice, 1);
    auto b = body(rng, on_lattice, rng.below(2) == 0 ? 0.375 : 1);
    if (!a || !b) continue;
    const bool is_dented = rng.below(3) == 0;
    if (is_dented) b = dented(rng, *a);
    if (self_collide(Model(*b)).is_yes()) continue;
    const Vec3 shift = is_dented ? Vec3{} : placement(rng, *a, *b);
    const Transform pose_a = on_lattice ? Transform{} : random_pose(rng, 1);
    const Transform pose_b = on_lattice ? Transform{{}, shift} : pose_a * random_pose(rng, 2);
    bool surfaces_meet = false;
    const SolidRelation expected = relation_of(nef_of(*a, pose_a), nef_of(*b, pose_b), surfaces_meet);
    const Model model_a(*a), model_b(*b);
    const SolidRelationResult found = solid_relation({ClosedSurface::create(model_a).value(), pose_a},
                                                     {ClosedSurface::create(model_b).value(), pose_b});
    ASSERT_EQ(static_cast<int>(found.relation), static_cast<int>(expected)) << "pair " << i;
    ASSERT_EQ(found.witness.has_value(), surfaces_meet) << "pair " << i;
    ++seen[static_cast<std::size_t>(expected)];
    ++i;
  }
  for (const std::uint64_t count : seen) std::cout << count << " ";
  std::cout << "apart, touching, overlapping, a in b, b in a, equal\n";
}

}  // namespace
}  // namespace limber::testing
