// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/random_scene.h"

/// All operations on a deforming model as data, so that they can be drawn at random, printed, and shrunk.
namespace limber::testing {

/// A mesh, determined by a kind and two numbers.
struct Shape {
  enum class Kind { ball, sheet, uniform_soup, lattice_soup, small_soup, needles, count };
  Kind kind = Kind::ball;
  std::uint32_t size = 1;  ///< of soups: triangles; otherwise of the order of its root
  std::uint32_t seed = 0;

  Mesh mesh() const;
};
std::ostream& operator<<(std::ostream& out, const Shape& shape);

/// The initial state of a Subject.
struct Start {
  Shape shape, still;
  double motion_margin = 0;
  RebuildPolicy rebuild_policy = RebuildPolicy::off;
  std::optional<double> rebuild_budget_us = ModelOptions::automatic;  // memory is allocated beforehand if there is one
};
std::ostream& operator<<(std::ostream& out, const Start& start);

struct Update {
  enum class Kind {
    move,               ///< `count` vertices by up to 10^exponent, some of them twice
    move_to_own,        ///< `count` vertices to positions that are the model's own
    move_all,           ///< by up to 10^exponent
    stay,               ///< all, to the model's own positions
    collapse,           ///< all to one point, 10^exponent or 10^(4 exponent) from the origin
    regrow,             ///< all to where they were at first
    scale,              ///< all to 2^(draw % 121 - 60) times where they were at first
    reject,             ///< updates that are refused
    set_motion_margin,  ///< to 0 or 10^exponent
    rebuild,
    reset,   ///< to the present mesh, moved by up to 10^exponent
    commit,  ///< and give a worker time
    check,   ///< commit and compare
    count
  };
  Kind kind = Kind::check;
  std::uint32_t count = 1;  ///< 1 to 5
  std::int32_t exponent = 0;
  std::uint32_t draw = 0;  ///< seed of all random choices
};
std::ostream& operator<<(std::ostream& out, const Update& update);

/// A model under test, and the mesh that it should have.
class Subject {
 public:
  explicit Subject(const Start& start);

  /// Returns what went wrong, or nothing.
  std::string apply(const Update& update);
  /// Commits, and compares with brute force. Returns what went wrong, or nothing.
  std::string check(std::uint32_t draw);

  const Model& model() const { return model_; }

 private:
  std::string move(const Update& update, Rng& rng);
  std::string move_to_own(const Update& update, Rng& rng);
  std::string move_all_to(const std::vector<Vec3>& positions);
  std::string reject(Rng& rng);
  std::string compare(const Transform& pose);

  Mesh mesh_;  // the mesh that the model should have
  std::vector<Vec3> first_;
  Model model_, still_;
  QueryCache cache_;
};

}  // namespace limber::testing
