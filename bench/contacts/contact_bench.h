// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/contacts/peer_answers.h"
#include "bench/contacts/peer_points.h"
#include "bench/contacts/tables.h"
#include "bench/support/report.h"
#include "limber/mesh.h"
#include "limber/model.h"

namespace limber::bench {

constexpr double margin_of_size = 1e-3;

struct Settings {
  Options options;
  std::filesystem::path meshes, peers, answers;
};

/// Asks limber the questions of `limber_bench_contacts`, compares its answers with those of other libraries, and keeps
/// the times.
class ContactBench {
 public:
  explicit ContactBench(const Settings& settings);

  // pairs.cpp
  void one_mesh(const std::string& name, const Mesh& mesh);
  void elements(const std::string& name, const Mesh& mesh);
  void two_meshes(const std::string& name, const Mesh& a, const Mesh& b, bool with_given_margin);

  // frames.cpp: all vertices of a cloth move; then its contacts with a ball and with itself
  void frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);
  /// The same frames with pairs of elements, which is what IPC's are.
  void element_frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);

  // points.cpp
  /// Closest points of a mesh to the points of one kind that peers.py has made, on one thread and on two.
  /// Pre: oneTBB is not held to one thread.
  void points(const std::string& name, const Mesh& mesh, const std::string& kind);

  /// The exit code. Nothing is reported if an answer was wrong.
  int report() const;

 private:
  /// As peers.py takes times: an untimed call first, then up to 15, fewer of long ones. prepare() is not timed.
  Timed time(const std::function<void()>& call, const std::function<void()>& prepare = {}) const;
  /// The same for calls that take turns, so that a disturbance of the machine affects all alike. Up to 105 times each,
  /// because their ratio is to be exact.
  std::vector<Timed> time_in_turn(const std::vector<std::function<void()>>& calls) const;
  std::optional<IdPairs> pairs_of(const std::string& file) const;
  std::optional<IdPairs> ipc_pairs_of(const std::string& mesh, MeshView view) const;
  /// The fastest setting of a peer, if it was asked.
  void add_peer(Row& row, const std::string& library, const std::string& peer, const std::string& mesh,
                const std::string& question, const std::string& part = "") const;
  /// IPC's candidates by LBVH and their distances, if it was asked.
  void add_both_parts(Row& row, const std::string& mesh) const;

  Settings settings_;
  std::vector<PeerRow> rows_of_peers_;
  int runs_;
  Checker checker_;
  std::vector<Row> rows_;
  std::vector<Difference> differences_;
  std::vector<PointDifference> point_differences_;
};

/// The diagonal of the bounding box.
double diagonal(const Mesh& mesh);

/// All pairs of triangles within a margin: of one model, and of two.
IdPairs self_pairs_within(const Model& model, double margin);
IdPairs pairs_within(const Placed& a, const Placed& b, double margin);

}  // namespace limber::bench
