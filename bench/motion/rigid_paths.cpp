// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/motion/rigid_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/limber.h"
#include "limber/path.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

using scenes::Rng;

Vec3 random_direction(Rng& rng) { return scenes::random_rotation(rng).row0; }

/// A mesh moved and scaled so that its bounding sphere is that of radius 1 about the origin.
Mesh normalized(const Mesh& mesh) {
  const Sphere sphere = Model(mesh).bounding_sphere();
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p = (1 / sphere.radius) * (p - sphere.center);
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// Flies by the origin within two radii, and turns by 150 degrees.
RigidMotion random_flight(Rng& rng) {
  const Vec3 along = random_direction(rng), axis = random_direction(rng);
  const Vec3 across = cross(along, random_direction(rng));
  const Vec3 offset = (2 * rng.uniform() / length(across)) * across;
  const Transform start{scenes::random_rotation(rng), offset - 3 * along};
  const double c = std::cos(5 * std::numbers::pi / 12), s = std::sin(5 * std::numbers::pi / 12);
  const Mat3 turn = transform_from_quaternion({}, c, s * axis.x, s * axis.y, s * axis.z).value().rotation;
  return {start, {turn * start.rotation, offset + 3 * along}};
}

/// The times that a library needs and finds.
struct Flights {
  std::vector<double> ms;
  std::vector<std::optional<double>> time;

  Flights(const std::vector<RigidMotion>& motions, const FindImpact& find) {
    for (const RigidMotion& motion : motions) {
      std::optional<double> found;
      ms.push_back(1e-3 * mean_us(1, [&] { found = find(motion.start(), motion.end()); }));
      time.push_back(found);
    }
  }

  auto touching() const {
    return std::count_if(time.begin(), time.end(), [](const auto& t) { return t.has_value(); });
  }
};

}  // namespace

void compare_rigid_paths(const Options& options, Checker& checker, Table& table) {
  const Mesh bunny = normalized(load_mesh(options.meshes / "stanford-bunny.obj").value());
  const Mesh armadillo = normalized(load_mesh(options.meshes / "armadillo.obj").value());
  const Model a(bunny), b(armadillo);
  Rng rng(600);
  std::vector<RigidMotion> motions;
  for (int i = 0; i < (options.quick ? 4 : 100); ++i) motions.push_back(random_flight(rng));

  table.line("\n## A bunny flies past or into an armadillo: {} paths\n", motions.size());
  table.line("| by | median ms | mean ms | touch | distances: median | p90 | most |\n|:--|--:|--:|--:|--:|--:|--:|");
  for (const double error : {1e-3, 1e-6}) {
    std::vector<double> distances;
    const Flights found(motions, [&](const Transform& start, const Transform& end) -> std::optional<double> {
      const PathImpact impact = time_of_impact(a, RigidMotion(start, end), b, {}, {.distance_error = error});
      distances.push_back(static_cast<double>(impact.distance_count));
      return impact.status == ImpactStatus::clear ? std::nullopt : std::optional(impact.time);
    });
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!found.time[i]) continue;
      const double there = distance({a, motions[i].at(*found.time[i])}, {b}).upper;
      checker.check(there <= 1.001 * error, "path {}: the models are {} apart where they touch", i, there);
    }
    std::sort(distances.begin(), distances.end());
    table.line("| limber, to {:g} of the radius | {:.2f} | {:.2f} | {} | {} | {} | {} |", error, median(found.ms),
               mean(found.ms), found.touching(), median(distances), distances[distances.size() * 9 / 10],
               distances.back());
  }
#ifdef LIMBER_PEER_FCL
  for (const std::size_t samples : {100, 1000}) {
    const Flights found(motions, fcl_impact(bunny, armadillo, samples));
    table.line("| FCL, {} samples | {:.2f} | {:.2f} | {} | | | |", samples, median(found.ms), mean(found.ms),
               found.touching());
  }
  motions.resize(std::min<std::size_t>(motions.size(), 10));  // it takes seconds for each
  const Flights found(motions, fcl_impact(bunny, armadillo, 0));
  table.line("| FCL, conservative advancement, {} of the paths | {:.0f} | {:.0f} | {} | | | |", motions.size(),
             median(found.ms), mean(found.ms), found.touching());
#endif
}

}  // namespace limber::bench
