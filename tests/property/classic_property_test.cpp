// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The classic engine: random sequences of updates and queries on random soups, in every maintenance mode, loose and
// tight.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "reference/classic/classic.h"
#include "reference/reference.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

using classic::Maintenance;

/// A soup of up to `most` triangles: half the time on a lattice, where everything is degenerate.
Mesh arbitrary_soup(Rng& rng, std::size_t most) {
  const std::size_t count = 1 + rng.below(most);
  const bool on_lattice = rng.below(2) == 0;
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    triangles.push_back(on_lattice ? lattice_triangle(rng) : uniform_triangle(rng));
  }
  if (rng.below(3) == 0) triangles.push_back(triangles.front());  // a duplicate is ordinary
  return soup(triangles);
}

classic::ModelOptions arbitrary_options(Rng& rng) {
  classic::ModelOptions options;
  options.maintenance = static_cast<Maintenance>(rng.below(3));
  if (rng.below(2) == 0) options.looseness = {rng.uniform(0, 0.5), rng.uniform(1, 2)};
  return options;
}

Vec3 arbitrary_position(Rng& rng) { return rng.below(2) == 0 ? lattice_point(rng) : uniform_point(rng, -1, 4); }

/// One random update; some move a vertex twice, some move all.
void update(Rng& rng, classic::Model& model) {
  const std::size_t vertex_count = model.mesh().positions().size();
  std::vector<Vec3> positions;
  if (rng.below(10) == 0) {
    for (std::size_t v = 0; v < vertex_count; ++v) positions.push_back(arbitrary_position(rng));
    return model.move_all(positions).value();
  }
  std::vector<VertexId> ids;
  for (std::uint64_t i = 0, count = 1 + rng.below(6); i < count; ++i) {
    ids.push_back(static_cast<VertexId>(rng.below(vertex_count)));
    positions.push_back(arbitrary_position(rng));
  }
  model.move_vertices(ids, positions).value();
}

/// Whether a sphere holds a point: decided by float64 where rounding cannot matter, otherwise in exact arithmetic.
bool holds(const Sphere& sphere, const Vec3& p) {
  const Vec3 off = p - sphere.center;
  const bool may_underflow = sphere.radius < 0x1p-400;
  const bool is_certain = !may_underflow && dot(off, off) <= (1 - 0x1p-45) * sphere.radius * sphere.radius;
  return is_certain || exactly_inside(sphere, p);
}

/// Every sphere above a triangle holds its corners.
void require_exact_enclosure(const classic::Model& model) {
  const classic::Tree& tree = model.tree();
  for (TriangleId t = 0; t < model.mesh().triangles().size(); ++t) {
    const Triangle triangle = model.mesh().triangle(t);
    for (std::uint32_t n = tree.leaf_of[t]; n != no_id; n = tree.nodes[n].parent) {
      const Sphere& sphere = tree.nodes[n].sphere;
      for (std::size_t k = 0; k < 3; ++k) RC_ASSERT(holds(sphere, triangle[k]));
    }
  }
}

/// All promises of the classic engine about two placed models, compared with brute force.
void require_right_answers(Rng& rng, const classic::Placed& a, const classic::Placed& b) {
  const reference::Placed brute_a{a.model().mesh(), a.pose}, brute_b{b.model().mesh(), b.pose};
  const double size = 16 + length(a.pose.translation) + length(b.pose.translation);
  const Truth truth{reference::distance(brute_a, brute_b).upper, 1e-14 * size};
  RC_ASSERT(reference::collide(brute_a, brute_b).is_yes() == (truth.distance == 0));
  RC_ASSERT(wrong_answer(classic::collide(a, b), 0, a, b, truth) == "");
  for (const double error : {0.0, 0.01, 0.1, rng.uniform(0, 2), 1e6}) {
    const DistanceOptions options{.relative_error = error};
    const DistanceResult found = classic::distance(a, b, options);
    RC_ASSERT(wrong_answer(found, options, a, b, truth) == "");
    // Without rounding: of equal pairs of triangles it is that of brute force.
    RC_ASSERT(found.lower <= truth.distance && found.upper >= truth.distance);
    RC_ASSERT(found.upper <= truth.distance * (1 + error) * (1 + 1e-15));
    if (error == 0) RC_ASSERT(found.upper == truth.distance);
    if (found.upper > 0) continue;
    const auto placed = [](const classic::Placed& model, TriangleId id) {
      const Triangle t = model.model().mesh().triangle(id);
      return Triangle{model.pose(t.v0), model.pose(t.v1), model.pose(t.v2)};
    };
    RC_ASSERT(intersects(placed(a, found.witness->triangle_a), placed(b, found.witness->triangle_b)));
  }
}

RC_GTEST_PROP(ClassicModel, StaysSoundAndRightThroughAnySequenceOfUpdates, (std::uint64_t seed)) {
  Rng rng(seed);
  classic::Model a(arbitrary_soup(rng, 20), arbitrary_options(rng));
  classic::Model b(arbitrary_soup(rng, 20), arbitrary_options(rng));
  for (int step = 0; step < 4; ++step) {
    for (classic::Model* model : {&a, &b}) {
      for (std::uint64_t i = 0, count = rng.below(4); i < count; ++i) update(rng, *model);
      model->commit();
      RC_ASSERT(model->is_committed());
      RC_ASSERT(static_cast<bool>(model->validate()));
      require_exact_enclosure(*model);
    }
    const Transform pose_a = rng.below(2) == 0 ? Transform{} : random_pose(rng, 3);
    const Transform pose_b = rng.below(2) == 0 ? Transform{} : random_pose(rng, 3);
    require_right_answers(rng, {a, pose_a}, {b, pose_b});
  }
}

}  // namespace
}  // namespace limber::testing
