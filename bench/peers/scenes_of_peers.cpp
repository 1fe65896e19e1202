// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/scenes_of_peers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {

Transform at_gap(const Model& a, const Model& b, Transform pose, const Vec3& outward, double gap) {
  for (int step = 0; step < 200; ++step) {
    const double found = distance({a}, {b, pose}).upper;
    if (std::abs(found - gap) <= 1e-9) break;
    pose.translation += outward * (gap - found);
  }
  return pose;
}

PeerScene turned_ball_and_square(std::size_t pose_count) {
  scenes::Rng rng(11);
  const Mat3 turn = scenes::random_rotation(rng);
  const Mesh square = scenes::thesis_square(), ball = scenes::thesis_ball();
  std::vector<Vec3> positions = square.positions();
  for (Vec3& p : positions) p = turn * p;
  PeerScene scene{"ball over square, turned", Mesh::create(std::move(positions), square.triangles()).value(), ball, {}};
  for (const double separation :
       {64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.01, 0.001, 0.0, -0.001, -0.1, -0.5, -1.0}) {
    Situation situation{fmt::format("{:g}", separation), separation == 0, {}};
    for (std::uint32_t i = 0; i < pose_count; ++i) {
      situation.poses.push_back(Transform{turn, {}} * scenes::ball_over_square(ball, separation, i));
    }
    scene.situations.push_back(std::move(situation));
  }
  return scene;
}

PeerScene two_scans(const std::string& name, const std::filesystem::path& a, const std::filesystem::path& b,
                    std::size_t pose_count) {
  PeerScene scene{name, normalised(load_mesh(a).value()), normalised(load_mesh(b).value()), {}};
  const Model model_a(scene.a), model_b(scene.b);
  scene.situations = {{"overlap", false, {}}, {"near", false, {}}, {"mid", false, {}}, {"far", false, {}}};
  scenes::Rng rng(0x5EED0002);
  for (std::size_t i = 0; i < pose_count; ++i) {
    Transform pose{scenes::random_rotation(rng), {}};
    const Vec3 outward = scenes::random_rotation(rng).row0;
    pose.translation = outward * 3;
    std::size_t situation = scene.situations.size();
    for (const double gap : {1.0, 0.05, 0.001}) {
      pose = at_gap(model_a, model_b, pose, outward, gap);
      scene.situations[--situation].poses.push_back(pose);
    }
    pose.translation -= outward * 0.011;
    scene.situations[0].poses.push_back(pose);
  }
  return scene;
}

Mesh normalised(const Mesh& mesh) {
  std::vector<Corners> triangles;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle c = mesh.triangle(t);
    if (!(length_sq(cross(c.v1 - c.v0, c.v2 - c.v0)) > 0)) continue;
    triangles.push_back(mesh.triangles()[t]);
    low = min(low, min(min(c.v0, c.v1), c.v2)), high = max(high, max(max(c.v0, c.v1), c.v2));
  }
  const Vec3 center = (low + high) * 0.5;
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p = (p - center) * (1 / length(high - low));
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Mesh subdivided(const Mesh& mesh) {
  std::vector<Vec3> positions = mesh.positions();
  std::vector<Corners> triangles;
  std::map<std::pair<VertexId, VertexId>, VertexId> midpoints;
  const auto midpoint = [&](VertexId v, VertexId w) {
    const auto [it, is_new] = midpoints.try_emplace(std::minmax(v, w), static_cast<VertexId>(positions.size()));
    if (is_new) positions.push_back((positions[v] + positions[w]) * 0.5);
    return it->second;
  };
  for (const Corners& c : mesh.triangles()) {
    const VertexId m0 = midpoint(c[1], c[2]), m1 = midpoint(c[2], c[0]), m2 = midpoint(c[0], c[1]);
    triangles.insert(triangles.end(), {{c[0], m2, m1}, {m2, c[1], m0}, {m1, m0, c[2]}, {m0, m1, m2}});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

}  // namespace limber::bench
