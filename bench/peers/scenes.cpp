// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "scenes/surfaces.h"

namespace limber::bench {
namespace {

/// The pose after b has slid along `outward` until the gap is right. No step goes too far, because its length is a
/// distance.
Transform at_gap(const Model& a, const Model& b, Transform pose, const Vec3& outward, double gap) {
  for (int step = 0; step < 200; ++step) {
    const double found = distance({a}, {b, pose}).upper;
    if (std::abs(found - gap) <= 1e-9) break;
    pose.translation += outward * (gap - found);
  }
  return pose;
}

/// Slides b from `pose` to gaps of 1, 0.05 and 0.001, which are the last three of the scene's situations, from behind.
/// Returns the last pose.
Transform add_at_gaps(PeerScene& scene, const Model& a, const Model& b, Transform pose, const Vec3& outward) {
  std::size_t situation = scene.situations.size();
  for (const double gap : {1.0, 0.05, 0.001}) {
    pose = at_gap(a, b, pose, outward, gap);
    scene.situations[--situation].poses.push_back(pose);
  }
  return pose;
}

using scenes::boxes;

constexpr std::uint64_t mesh_seed = 0x5EED0010, pose_seed = 0x5EED0011;

Mesh crate() { return boxes({{{-0.4, -0.3, -0.25}, {0.4, 0.3, 0.25}}}); }
Mesh floor_slab() { return boxes({{{-5, -5, -0.05}, {5, 5, 0.05}}}); }

/// A slab that stands upright, turned so that nothing is aligned with an axis.
Mesh turned_wall() {
  scenes::Rng rng(mesh_seed);
  return scenes::together({boxes({{{-0.05, -5, -1.5}, {0.05, 5, 1.5}}})}, {scenes::random_rotation(rng), {}});
}

/// A room of 4 by 4 by 2.5 with walls, a doorway, a table and a column.
Mesh room() {
  return boxes({{{-2.1, -2.1, -1.35}, {2.1, 2.1, -1.25}},
                {{-2.1, -2.1, 1.25}, {2.1, 2.1, 1.35}},
                {{-2.1, -2, -1.25}, {-2, 2, 1.25}},
                {{2, -2, -1.25}, {2.1, 2, 1.25}},
                {{-2.1, 2, -1.25}, {2.1, 2.1, 1.25}},
                {{-2.1, -2.1, -1.25}, {-0.5, -2, 1.25}},
                {{0.5, -2.1, -1.25}, {2.1, -2, 1.25}},
                {{-0.5, -2.1, 0.8}, {0.5, -2, 1.25}},
                {{-1.5, 0.2, -0.6}, {0, 1.2, -0.5}},
                {{1, -0.2, -1.25}, {1.3, 0.1, 1.25}}});
}

/// A maze of 12 by 12 cells with one way between any two: each cell has a wall at its west or at its south side.
Mesh maze() {
  scenes::Rng rng(mesh_seed);
  constexpr double cell = 1.4, half = 0.05, height = 1.4;
  constexpr int cells = 12;
  constexpr double width = cells * cell;
  std::vector<Box> walls = {{{0, 0, -0.1}, {width, width, 0}},
                            {{width - half, 0, 0}, {width + half, width, height}},
                            {{0, width - half, 0}, {width, width + half, height}}};
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const double x = i * cell, y = j * cell;
      const bool west = j == 0 || (i > 0 && rng.below(2) == 0);
      walls.push_back(west ? Box{{x - half, y, 0}, {x + half, y + cell, height}}
                           : Box{{x, y - half, 0}, {x + cell, y + half, height}});
    }
  }
  return boxes(walls);
}

/// Legs of 50 frames, each from a pose of the situation: b slides straight on by 1/500 of its size, and turns by 1/200,
/// from frame to frame.
std::vector<Transform> path_from(const Situation& situation, const Mesh& b, scenes::Rng& rng) {
  const Box box = Model(b).bounding_box();
  const double step = length(box.high - box.low) / 500;
  std::vector<Transform> path;
  for (std::size_t leg = 0; leg < std::min<std::size_t>(4, situation.poses.size()); ++leg) {
    const Transform& start = situation.poses[leg];
    const Vec3 along = scenes::random_rotation(rng).row0, axis = scenes::random_rotation(rng).row0;
    for (int frame = 0; frame < 50; ++frame) {
      const double half_angle = frame / 400.0;
      const Vec3 v = axis * scenes::sine(half_angle);
      const Mat3 turn = transform_from_quaternion({}, scenes::cosine(half_angle), v.x, v.y, v.z).value().rotation;
      path.push_back({start.rotation * turn, start.translation + along * (step * frame)});
    }
  }
  return path;
}

/// Random turns and directions of b: at gaps, and overlapping, anywhere between the first touch and common centers.
PeerScene at_gaps(const std::string& name, const Mesh& a, const Mesh& b, std::size_t pose_count) {
  scenes::Rng rng(pose_seed);
  const Model model_a(a), model_b(b);
  PeerScene scene{name, a, b, {{"overlapping", {}}, {"0.001", {}}, {"0.05", {}}, {"1", {}}}};
  for (std::size_t i = 0; i < pose_count; ++i) {
    const Vec3 outward = scenes::random_rotation(rng).row0;
    const Transform pose = add_at_gaps(scene, model_a, model_b, {scenes::random_rotation(rng), outward * 20}, outward);
    Transform inside = pose;
    do {
      inside.translation = pose.translation * rng.uniform();
    } while (!collide({model_a}, {model_b, inside}).is_yes());
    scene.situations[0].poses.push_back(inside);
  }
  scene.path = path_from(scene.situations[2], b, rng);
  return scene;
}

/// Random poses of b, its origin within the box of a: `pose_count` in which the meshes meet, and as many in which they
/// are apart. There may be fewer of those that come less than once in 400 tries.
PeerScene scattered(const std::string& name, const Mesh& a, const Mesh& b, std::size_t pose_count) {
  scenes::Rng rng(pose_seed);
  const Model model_a(a), model_b(b);
  PeerScene scene{name, a, b, {{meeting_name, {}}, {apart_name, {}}}};
  const auto [low, high] = model_a.bounding_box();
  const auto is_short = [&](const Situation& s) { return s.poses.size() < pose_count; };
  for (std::size_t tries = 0; tries < 400 * pose_count; ++tries) {
    if (std::none_of(scene.situations.begin(), scene.situations.end(), is_short)) break;
    const Vec3 place{rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
    const Transform pose{scenes::random_rotation(rng), place};
    Situation& situation = scene.situations[collide({model_a}, {model_b, pose}).is_yes() ? 0 : 1];
    if (is_short(situation)) situation.poses.push_back(pose);
  }
  scene.path = path_from(scene.situations[1], b, rng);
  return scene;
}

PeerScene ball_over_square(std::size_t pose_count) {
  scenes::Rng rng(pose_seed);
  PeerScene scene = turned_ball_and_square(pose_count);
  scene.name = "ball over square";
  std::erase_if(scene.situations, [](const Situation& s) {
    constexpr std::array kept{"64", "1", "0.01", "-0.1"};
    return std::find(kept.begin(), kept.end(), s.name) == kept.end();
  });
  scene.path = path_from(scene.situations[2], scene.b, rng);
  return scene;
}

PeerScene rings(std::size_t pose_count) {
  scenes::Rng rng(pose_seed);
  const Mesh ring = scenes::ring(400, 80, 0.1);
  PeerScene scene{"linked rings", ring, ring, {{"linked", {}}}};
  for (std::uint32_t i = 0; i < pose_count; ++i) scene.situations[0].poses.push_back(scenes::linked_ring(i));
  scene.path = path_from(scene.situations[0], ring, rng);
  return scene;
}

}  // namespace

PeerScene turned_ball_and_square(std::size_t pose_count) {
  scenes::Rng rng(11);
  const Mat3 turn = scenes::random_rotation(rng);
  const Mesh ball = scenes::thesis_ball();
  PeerScene scene{"ball over square, turned", scenes::together({scenes::thesis_square()}, {turn, {}}), ball, {}};
  for (const double separation :
       {64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.01, 0.001, 0.0, -0.001, -0.1, -0.5, -1.0}) {
    Situation situation{fmt::format("{:g}", separation), {}};
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
  scene.situations = {{"overlap", {}}, {"near", {}}, {"mid", {}}, {"far", {}}};
  scenes::Rng rng(0x5EED0002);
  for (std::size_t i = 0; i < pose_count; ++i) {
    const Mat3 rotation = scenes::random_rotation(rng);
    const Vec3 outward = scenes::random_rotation(rng).row0;
    Transform pose = add_at_gaps(scene, model_a, model_b, {rotation, outward * 3}, outward);
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

void for_each_mix_scene(const std::filesystem::path& meshes, std::size_t pose_count,
                        const std::function<void(const PeerScene&)>& use, const std::vector<std::string>& name_parts) {
  using Make = std::function<Mesh()>;  // nothing is made of scenes that are not wanted
  const auto have = [&](const std::string& file) { return !meshes.empty() && exists(meshes / file); };
  const auto original = [&](const std::string& file) { return load_mesh(meshes / file).value(); };
  const auto of_size_1 = [&](const std::string& file) { return [=] { return normalised(original(file)); }; };
  const auto wanted = [&](const std::string& name) {
    const auto is_in_name = [&](const std::string& part) { return name.find(part) != std::string::npos; };
    return name_parts.empty() || std::any_of(name_parts.begin(), name_parts.end(), is_in_name);
  };
  const auto use_at_gaps = [&](const std::string& name, const Make& a, const Make& b) {
    if (wanted(name)) use(at_gaps(name, a(), b(), pose_count));
  };
  const auto use_scattered = [&](const std::string& name, const Make& a, const Make& b) {
    if (wanted(name)) use(scattered(name, a(), b(), pose_count));
  };

  constexpr std::pair<const char*, const char*> pairs[] = {{"spot.obj", "cow.obj"},
                                                           {"fandisk.obj", "spot.obj"},
                                                           {"teapot.obj", "beetle.obj"},
                                                           {"armadillo.obj", "spot.obj"},
                                                           {"cloth_ball_92.ply", "cow.obj"},
                                                           {"armadillo_rollers_326.ply", "fandisk.obj"},
                                                           {"stanford-bunny.obj", "armadillo.obj"}};
  for (const auto& [a, b] : pairs) {
    if (!have(a) || !have(b)) continue;
    const auto stem = [](const char* file) { return std::filesystem::path(file).stem().string(); };
    use_at_gaps(fmt::format("{} and {}", stem(a), stem(b)), of_size_1(a), of_size_1(b));
  }
  if (have("fcl_env.obj") && have("fcl_rob.obj")) {
    use_scattered(
        "fcl_env and fcl_rob", [&] { return original("fcl_env.obj"); }, [&] { return original("fcl_rob.obj"); });
  }
  use_at_gaps("floor and crate", floor_slab, crate);
  if (have("spot.obj")) use_at_gaps("floor and spot", floor_slab, of_size_1("spot.obj"));
  if (have("armadillo.obj")) use_at_gaps("wall and armadillo", turned_wall, of_size_1("armadillo.obj"));
  if (have("fandisk.obj")) use_scattered("room and fandisk", room, of_size_1("fandisk.obj"));
  if (have("cow.obj")) use_scattered("maze and cow", maze, of_size_1("cow.obj"));

  constexpr std::pair<const char*, scenes::PlanningScene (*)(double detail)> planning[] = {
      {"sculptures", scenes::sculptures},
      {"house", scenes::house},
      {"twisty wall", scenes::twisty_wall},
      {"cubicles", scenes::cubicles},
      {"alpha puzzle", scenes::alpha_puzzle},
      {"bug trap", scenes::bug_trap},
      {"spiral tunnel", scenes::spiral_tunnel},
      {"furnished flat", scenes::furnished_flat},
      {"assembly", scenes::assembly}};
  for (const auto& [short_name, make] : planning) {
    for (const double detail : {1.0, 10.0}) {
      const std::string name = detail > 1 ? fmt::format("{} x {:g}", short_name, detail) : short_name;
      if (!wanted(name)) continue;
      const auto [environment, robot] = make(detail);
      use(scattered(name, environment, robot, pose_count));
    }
  }

  if (wanted("ball over square")) use(ball_over_square(pose_count));
  if (wanted("linked rings")) use(rings(pose_count));
  scenes::Rng rng(mesh_seed);
  const Mesh soup = normalised(scenes::random_soup(rng, 5000, 0.2));
  const Mesh lattice = normalised(scenes::lattice_soup(rng, 300, 8));
  use_at_gaps(
      "soup and soup", [&] { return soup; }, [&] { return soup; });
  use_at_gaps(
      "lattice and lattice", [&] { return lattice; }, [&] { return lattice; });
}

}  // namespace limber::bench
