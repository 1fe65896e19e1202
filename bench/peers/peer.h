// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "limber/mesh.h"

/// Other libraries behind one interface. Every adapter is one file; those whose library was not found are left out.
namespace limber::bench {

enum class Question { exact, rough, collide };  ///< rough: within a relative error of 0.1
inline constexpr double rough_error = 0.1;

/// Two models of one library, ready for queries. a stays at the origin.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  virtual bool answers(Question question) const = 0;
  /// The distance, 0 in contact; for `collide` 0 or 1: 0 means contact.
  virtual double ask(Question question, const Transform& pose_b) = 0;
  /// The work that a new pose of b needs before a query, where it is not part of ask().
  virtual void move(const Transform&) {}
  /// Moves all vertices of a and updates it in the fastest way that the library has. False if the library has none.
  virtual bool deform(const std::vector<Vec3>&) { return false; }
};

using PeerFactory = std::unique_ptr<Peer> (*)(const Mesh& a, const Mesh& b);

/// The library itself first, then those that were found.
std::vector<std::pair<std::string, PeerFactory>> all_peers();

/// The same, and the classic engine, whose exact distances between large meshes take seconds.
std::vector<std::pair<std::string, PeerFactory>> all_peers_and_classic();

/// Libraries that can update a deforming mesh; some of them in several ways.
std::vector<std::pair<std::string, PeerFactory>> deforming_peers();

/// Nanoseconds a triangle in which a library builds its tree of a mesh on one thread.
using BuildTime = double (*)(const Mesh& mesh);
/// Libraries whose builds are timed.
std::vector<std::pair<std::string, BuildTime>> builders();

std::unique_ptr<Peer> make_limber(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_classic(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl_forced(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_coal(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_fcl_aabb(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_coal_rss(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_embree_triangles(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_cgal(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_bullet(const Mesh& a, const Mesh& b);
std::unique_ptr<Peer> make_embree(const Mesh& a, const Mesh& b);
double fcl_build_ns(const Mesh& mesh);
double embree_morton_build_ns(const Mesh& mesh);
double embree_sah_build_ns(const Mesh& mesh);

}  // namespace limber::bench
