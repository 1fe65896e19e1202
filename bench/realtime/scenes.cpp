// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/realtime/scenes.h"

#include <algorithm>
#include <utility>

#include "bench/peers/scenes.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

Mesh scaled(const Mesh& mesh, double factor) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p *= factor;
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// One triangle many times, its corners in turn.
Mesh stacked_triangle(std::uint32_t count) {
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < count; ++i) triangles.push_back({i % 3, (i + 1) % 3, (i + 2) % 3});
  return Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::move(triangles)).value();
}

/// Triangles in one plane that grow around a common center.
Mesh concentric_triangles(std::uint32_t count) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double r = 1 + i * 1e-6;
    const auto first = static_cast<VertexId>(positions.size());
    positions.insert(positions.end(), {{r, 0, 0}, {-0.5 * r, 0.8 * r, 0}, {-0.5 * r, -0.8 * r, 0}});
    triangles.push_back({first, first + 1, first + 2});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A cube of bars: a lattice of thin boxes that another one fits into.
Mesh bars(std::uint32_t per_side) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  const double thin = 0.1 / per_side;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < per_side * per_side; ++i) {
      const Vec3 at{static_cast<double>(i % per_side) / per_side, static_cast<double>(i / per_side) / per_side, 0};
      const auto first = static_cast<VertexId>(positions.size());
      for (std::uint32_t k = 0; k < 6; ++k) {
        const double u = at.x + (k % 3 == 1 ? thin : 0), v = at.y + (k % 3 == 2 ? thin : 0), w = k < 3 ? 0 : 1;
        positions.push_back(axis == 0 ? Vec3{u, v, w} : axis == 1 ? Vec3{w, u, v} : Vec3{v, w, u});
      }
      for (std::uint32_t k = 0; k < 3; ++k) {
        const VertexId p = first + k, q = first + (k + 1) % 3;
        triangles.insert(triangles.end(), {{p, q, p + 3}, {q, q + 3, p + 3}});
      }
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Transform at(double x, double y, double z) { return {{}, {x, y, z}}; }

}  // namespace

std::vector<RealTimeScene> real_time_scenes(const std::filesystem::path& meshes) {
  std::vector<RealTimeScene> all;
  const auto add = [&](const std::string& name, const Mesh& a, const Mesh& b, const Transform& pose) {
    Model model_a(a), model_b(b);
    const double size = 2 * std::min(model_a.bounding_sphere().radius, model_b.bounding_sphere().radius);
    all.push_back({name, std::move(model_a), std::move(model_b), pose, size});
  };
  const Mesh square = scenes::thesis_square(), ball = scenes::thesis_ball(), sheet = scenes::wave_sheet(150, 150, 0);
  for (const double gap : {64., 1., 0.01}) {
    add("ball over square, " + std::to_string(gap).substr(0, 4), square, ball, at(0.1, 0.2, gap + 1));
  }
  add("ball over a wavy sheet", sheet, ball, at(2, 2, 2.5));
  add("ball in a wavy sheet", sheet, ball, at(2, 2, 0.9));
  add("sheets on each other", sheet, sheet, at(0, 0, 1e-3));
  const Mesh shell = scenes::ball(120, 61);
  add("ball in a shell 1 % larger", scaled(shell, 1.01), shell,
      transform_from_quaternion({}, 1, 0.1, 0.2, 0.3).value());
  const Mesh lattice = bars(12);
  add("interlocked bars", lattice, lattice, at(0.03, 0.035, 0.04));
  add("one triangle 2000 times", stacked_triangle(2000), stacked_triangle(2000), at(0, 0, 1));
  add("concentric triangles", concentric_triangles(1000), concentric_triangles(1000), at(0, 0, 1));
  add("linked rings", scenes::ring(200, 50, 0.3), scenes::ring(200, 50, 0.3), scenes::linked_ring(0));
  scenes::Rng rng(5);
  add("soups", scenes::random_soup(rng, 4000, 0.1), scenes::random_soup(rng, 4000, 0.1), at(1.1, 0.1, 0));
  if (meshes.empty()) return all;
  const PeerScene scans = two_scans("bunny and armadillo", meshes / "stanford-bunny.obj", meshes / "armadillo.obj", 1);
  for (const Situation& situation : scans.situations) {
    add(scans.name + ", " + situation.name, scans.a, scans.b, situation.poses.front());
  }
  return all;
}

std::vector<Transform> real_time_path(const RealTimeScene& scene, double step, std::size_t frames) {
  scenes::Rng rng(7);
  std::vector<Transform> poses;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = step * static_cast<double>(f);
    const Vec3 axis =
        step > 0 ? t * Vec3{0.6, -0.3, 0.7} : Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const Transform turn = transform_from_quaternion({}, 1, axis.x, axis.y, axis.z).value();
    const Vec3 slide = step > 0 ? scene.size * t * Vec3{0.15, 0.4, -0.1} : scene.size * 0.3 * axis;
    poses.push_back({turn.rotation * scene.pose.rotation, scene.pose.translation + slide});
  }
  return poses;
}

}  // namespace limber::bench
