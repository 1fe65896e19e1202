// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "limber/mesh.h"
#include "limber/scene.h"

/// Other libraries behind one interface. Every adapter is one file; those whose library was not found are left out.
namespace limber::bench {

enum class Question { exact, rough, collide };  ///< rough: within a relative error of 0.1
inline constexpr double rough_error = 0.1;
const char* to_text(Question question);

/// Whether two answers can both be right, distances up to `tolerance`.
bool agree(Question question, double a, double b, double tolerance);

/// Two models of one library, ready for queries. a stays at the origin.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  virtual bool answers(Question) const { return false; }
  /// The distance, 0 in contact; for `collide` 0 or 1: 0 means contact.
  virtual double ask(Question, const Transform&) { return 0; }
  /// Moves all vertices of a and updates it in the fastest way that the library has. False if the library has none.
  virtual bool deform(const std::vector<Vec3>&) { return false; }
};

/// A library that takes part, and its models of two meshes.
struct Contestant {
  std::string name;
  std::unique_ptr<Peer> peer;
};

/// The library itself, then those that were found and can update a deforming mesh; some of them in several ways.
std::vector<Contestant> deforming_peers(const Mesh& a, const Mesh& b);

std::unique_ptr<Peer> make_classic(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl_forced(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl_aabb(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_coal(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_embree(const Mesh& a);

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

/// `builds_anew` makes update() build a new tree.
std::unique_ptr<Manager> make_coal_manager(const Mesh& shape, std::size_t bodies, bool builds_anew);
std::unique_ptr<Manager> make_fcl_manager(const Mesh& shape, std::size_t bodies, bool builds_anew);

/// A mesh of one library, ready for queries of closest points.
struct Projector {
  std::string library, setting;
  bool is_float = false;
  std::function<double(const Vec3& point)> distance;  ///< on the calling thread
};
Projector embree_projector(const Mesh& mesh);
Projector cgal_projector(const Mesh& mesh);

}  // namespace limber::bench
