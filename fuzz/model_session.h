// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fuzz/byte_reader.h"
#include "limber/distance.h"
#include "limber/model.h"

namespace limber::fuzz {

/// Two models, their poses, and a query cache. The bytes of the input choose calls of the whole public interface. Each
/// model has a copy of the mesh that it should have; each committed state and each answer is checked.
class ModelSession {
 public:
  explicit ModelSession(ByteReader bytes);

  /// Reads operations until the input or the time for brute force is used up, then commits and checks.
  void run();

 private:
  struct Body {
    Model model;
    std::vector<Vec3> positions;  // that the mesh should have
    std::vector<Corners> triangles;
    Transform pose;
  };

  static Body body(ByteReader& bytes, double factor);

  void step();
  void move_some(Body& moving);
  void move_all(Body& moving);
  void move_aliased(Body& moving);
  void reject(Body& target);
  void set_motion_margin(Body& target);
  void take_new_mesh(Body& target);
  void pass_through_other_model(Body& target);
  void change_pose(Body& target);
  void misuse(Body& target);
  void commit(Body& target);
  void query();

  Vec3 new_position(const Vec3& old);
  double some_length();
  std::size_t vertex_in(const Body& target);
  void check_committed(const Body& target) const;

  ByteReader bytes_;
  std::uint8_t environment_;
  double factor_;  // by which coordinates are multiplied
  std::array<Body, 2> bodies_;
  QueryCache cache_;
  std::size_t brute_force_tests_ = 0;
};

}  // namespace limber::fuzz
