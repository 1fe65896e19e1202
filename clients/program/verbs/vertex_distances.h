// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "command/run_files.h"
#include "verbs/models.h"

namespace CLI {
class App;
}

/// The distance of each vertex of a model from another model, in files for other programs.
namespace limber::program {

/// `--vertices-a` and `--vertices-b`; empty where no file is asked for.
struct VertexFiles {
  std::string a, b;
};
void add_vertex_files(CLI::App& command, VertexFiles& target);

/// The help about these files.
inline constexpr const char* vertex_files_help = R"(
--vertices-a writes how far each vertex of A is from the surface of B, and --vertices-b the same the other way round.
A file .csv has the columns vertex, x, y, z and distance; vertices count from 0 in the mesh's order, at their places in
the world. A file .ply is the placed mesh, with a property distance of each vertex.
)";

/// Opens both files, and writes them when it is told to.
class VertexDistances {
 public:
  /// Errors   BadInput as OutputFile, and where a name ends in neither .csv nor .ply.
  explicit VertexDistances(const VertexFiles& files);

  /// Errors   OutputFailed; BadInput where a vertex as placed is above `max_coordinate`.
  void write(const PlacedModel& a, const PlacedModel& b);

 private:
  VertexFiles files_;
  std::optional<OutputFile> a_, b_;
};

}  // namespace limber::program
