// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// One revision of the library behind an interface without its types, so that two revisions can be in one program.
namespace against {

struct RawMesh {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct RawPose {
  std::array<double, 9> rotation;  // by rows
  std::array<double, 3> translation;
};

enum class Question { collide, exact, within_10_percent, within_limit, warm_exact };

/// Two models and the queries between them. Poses are those of b; a stays at the origin.
class Engine {
 public:
  virtual ~Engine() = default;

  /// The distance, or 0 and 1 for no and yes.
  virtual double ask(Question question, const RawPose& pose) = 0;

  /// Moves all vertices of a, or those with the given ids, and commits.
  virtual void move_all(const std::vector<std::array<double, 3>>& positions) = 0;
  virtual void move(const std::vector<std::uint32_t>& ids, const std::vector<std::array<double, 3>>& positions) = 0;

  /// Builds the tree of a anew.
  virtual void build() = 0;
};

}  // namespace against

/// Defined once for each revision: engine.cpp is compiled against the headers of either.
std::unique_ptr<against::Engine> make_engine_before(const against::RawMesh& a, const against::RawMesh& b);
std::unique_ptr<against::Engine> make_engine_now(const against::RawMesh& a, const against::RawMesh& b);
