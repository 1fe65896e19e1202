// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/contacts/answers.h"
#include "bench/support/report.h"
#include "limber/mesh.h"
#include "limber/model.h"

namespace limber::bench {

struct Settings {
  std::filesystem::path meshes, peers, answers;
  bool quick = false;
};

/// Medians.
struct Timed {
  double us = 0, processor_us = 0;
};

/// What another library took for a question.
struct PeerTime {
  std::string library, setting, count;
  Timed time;
};

struct Row {
  std::string question, mesh;
  Timed time;
  std::string count;
  std::vector<PeerTime> peers = {};
};

/// Asks limber the questions of `limber_bench_contacts`, compares its answers with those of other libraries, and keeps
/// the times.
class ContactBench {
 public:
  ContactBench(Settings settings, Checker& checker);

  // contacts.cpp
  void one_mesh(const std::string& name, const Mesh& mesh);
  void elements(const std::string& name, const Mesh& mesh);
  void two_meshes(const std::string& name, const Mesh& a, const Mesh& b, bool with_given_margin);
  /// All vertices of a cloth move; then its contacts with a ball and with itself are found.
  void frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);
  /// As frames(), with pairs of elements, as IPC has them, in place of contacts.
  void element_frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);

  // points.cpp
  /// Closest points of a mesh to the points of one kind that peers.py has made.
  void points(const std::string& name, const Mesh& mesh, const std::string& kind);

  /// Writes contacts.md.
  void write(Table& text) const;

 private:
  /// As peers.py takes times: an untimed call first, then up to 15, fewer of long ones. prepare() is not timed.
  Timed time(const std::function<void()>& call, const std::function<void()>& prepare = {}) const;
  /// A file of answers that a peer may have written.
  std::filesystem::path answer(const std::string& name) const { return settings_.answers / (name + ".txt"); }
  /// Compares with what the IPC Toolkit has within the margin of a mesh, if it was asked. `mesh_count` is the number of
  /// triangles of ours; pairs of others alone are left out.
  void compare_with_ipc(const std::string& name, MeshView mesh, std::size_t own_triangles, double margin,
                        const IdPairs& ours);
  /// The row of the setting of a peer that was fastest, if it was asked.
  void add_peer(Row& row, const std::string& library, const std::string& peer, const std::string& question,
                const std::string& part = "") const;
  /// IPC's candidates by LBVH and their distances, if it was asked.
  void add_both_parts(Row& row) const;
  void add_ipc_frames(Row& row) const;

  Settings settings_;
  Checker& checker_;
  std::vector<PeerRow> rows_of_peers_;
  int runs_;
  std::vector<Row> rows_;
  std::vector<Difference> differences_;
  std::vector<PointDifference> point_differences_;
};

/// The diagonal of the bounding box.
double diagonal(const Mesh& mesh);

}  // namespace limber::bench
