// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "limber/scene.h"

namespace limber::bench {

/// The broad phase of another library, over bodies that all have the same shape.
class Manager {
 public:
  virtual ~Manager() = default;
  virtual std::string name() const = 0;
  /// Places a body, and makes the library compute its box.
  virtual void set_pose(std::size_t body, const Transform& pose) = 0;
  /// Gives a body another box.
  virtual void set_box(std::size_t body, const Box& box) = 0;
  /// Takes over the boxes: by the library's own way to update its tree, or by a new tree.
  virtual void update() = 0;
  /// Appends the pairs of bodies whose boxes overlap.
  virtual void find_pairs(std::vector<ObjectPair>& pairs) = 0;
};

/// Each is there if its library was found. `builds_anew` makes update() build a new tree.
std::unique_ptr<Manager> make_coal_manager(const Mesh& shape, std::size_t bodies, bool builds_anew);
std::unique_ptr<Manager> make_fcl_manager(const Mesh& shape, std::size_t bodies, bool builds_anew);

}  // namespace limber::bench
