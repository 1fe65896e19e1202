// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bad_input.h"
#include "deforming_model.h"
#include "number_text.h"
#include "options.h"
#include "output.h"
#include "pose_text.h"
#include "progress_bar.h"
#include "stopwatch.h"
#include "track_inputs.h"
#include "verb.h"

namespace limber::program {
namespace {

constexpr std::uint64_t max_loops = 1'000'000;

struct ModelArguments {
  std::vector<std::string> frames;
  std::string poses;  // empty: at the origin
};

struct Arguments {
  ModelArguments a, b;
  DistanceOptions query;
  DeformingOptions model;
  std::uint64_t loops = 1;
  bool json = false;
};

/// Work done on trees between two frames.
struct Update {
  double elapsed_us = 0;
  DeformingWork done;

  Update& operator+=(const Update& other) {
    elapsed_us += other.elapsed_us;
    done += other.done;
    return *this;
  }
};

/// One of the two models, which is moved from frame to frame.
class TrackedModel {
 public:
  TrackedModel(const ModelArguments& arguments, const DeformingOptions& options, bool is_repeated)
      : frames_(arguments.frames),
        poses_(arguments.poses.empty() ? std::vector<Transform>(1) : read_poses(arguments.poses)),
        model_(frames_.first().mesh, options),
        cached_(is_repeated ? frames_.count() : 0) {}

  std::size_t mesh_count() const { return frames_.count(); }
  std::size_t pose_count() const { return poses_.size(); }
  const DeformingModel& model() const { return model_; }
  const Transform& pose() const { return poses_[pose_]; }
  std::uint32_t face_of(TriangleId triangle) const { return frames_.first().face_of_triangle[triangle]; }

  /// Moves to a frame of the lists. Only vertices whose position differs are moved; reading is not timed.
  Update go_to(std::size_t frame) {
    if (poses_.size() > 1) pose_ = frame;
    if (frames_.count() == 1) return {};
    const DeformingWork before = model_.work();
    const double elapsed_us = move_to(positions(frame));
    return {elapsed_us, model_.work() - before};
  }

 private:
  /// The frame's positions; frames that come again are read once.
  std::vector<Vec3> positions(std::size_t frame) {
    if (cached_.empty()) return frames_.positions(frame);
    if (!cached_[frame]) cached_[frame] = frames_.positions(frame);
    return *cached_[frame];
  }

  double move_to(const std::vector<Vec3>& target) {
    const std::vector<Vec3>& current = model_.mesh().positions();
    std::vector<VertexId> moved_ids;
    std::vector<Vec3> moved_positions;
    for (VertexId v = 0; v < target.size(); ++v) {
      if (target[v] == current[v]) continue;
      moved_ids.push_back(v);
      moved_positions.push_back(target[v]);
    }
    const bool all_moved = moved_ids.size() == target.size();
    const Stopwatch updating;
    value_or_bad_input(all_moved ? model_.move_all(target) : model_.move_vertices(moved_ids, moved_positions));
    model_.commit();
    return updating.microseconds();
  }

  MeshFrames frames_;
  std::vector<Transform> poses_;  // world_from_model
  std::size_t pose_ = 0;
  DeformingModel model_;
  std::vector<std::optional<std::vector<Vec3>>> cached_;  // by frame; empty when no frame comes twice
};

/// One line of the answer.
struct Row {
  std::size_t frame = 0;
  Update update;
  double query_us = 0;
  DistanceResult result;
  std::uint32_t face_a = 0, face_b = 0;
};

constexpr const char* csv_header =
    "frame,update_us,query_us,status,lower,upper,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
    "triangle_a,triangle_b,face_a,face_b,moved_vertices,refits,absorbed,node_tests,triangle_tests\n";

std::string csv_line(const Row& row) {
  const Witness witness = row.result.witness.value_or(Witness{});
  return fmt::format("{},{:.3f},{:.3f},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.frame, row.update.elapsed_us,
                     row.query_us, to_text(row.result.status), to_text(row.result.lower), to_text(row.result.upper),
                     to_text(witness.point_a, ","), to_text(witness.point_b, ","), witness.triangle_a,
                     witness.triangle_b, row.face_a, row.face_b, row.update.done.moved_vertices, row.update.done.refits,
                     row.update.done.absorbed, row.result.stats.node_tests, row.result.stats.triangle_tests);
}

std::string json_line(const Row& row) {
  const Witness witness = row.result.witness.value_or(Witness{});
  return to_line({
      {"frame", row.frame},
      {"update_us", row.update.elapsed_us},
      {"query_us", row.query_us},
      {"status", to_text(row.result.status)},
      {"lower", row.result.lower},
      {"upper", row.result.upper},
      {"point_a", to_json(witness.point_a)},
      {"point_b", to_json(witness.point_b)},
      {"triangle_a", witness.triangle_a},
      {"triangle_b", witness.triangle_b},
      {"face_a", row.face_a},
      {"face_b", row.face_b},
      {"moved_vertices", row.update.done.moved_vertices},
      {"refits", row.update.done.refits},
      {"absorbed", row.update.done.absorbed},
      {"node_tests", row.result.stats.node_tests},
      {"triangle_tests", row.result.stats.triangle_tests},
  });
}

Row track_frame(TrackedModel& a, TrackedModel& b, std::size_t frame, const DistanceOptions& options) {
  Row row;
  row.update += a.go_to(frame);
  row.update += b.go_to(frame);
  const Stopwatch asking;
  row.result = DeformingModel::distance(a.model(), a.pose(), b.model(), b.pose(), options);
  row.query_us = asking.microseconds();
  row.face_a = a.face_of(row.result.witness->triangle_a);
  row.face_b = b.face_of(row.result.witness->triangle_b);
  return row;
}

void run(const Arguments& arguments) {
  TrackedModel a(arguments.a, arguments.model, arguments.loops > 1);
  TrackedModel b(arguments.b, arguments.model, arguments.loops > 1);
  const std::size_t frame_count = common_frame_count(
      {{"--a", a.mesh_count()}, {"--b", b.mesh_count()}, {"--poses-a", a.pose_count()}, {"--poses-b", b.pose_count()}});
  const std::size_t row_count = frame_count * arguments.loops;
  ProgressBar bar(row_count);
  if (!arguments.json) write(csv_header);
  for (std::size_t r = 0; r < row_count; ++r) {
    bar.draw(r);
    Row row = track_frame(a, b, r % frame_count, arguments.query);
    row.frame = r;
    if (isatty(STDOUT_FILENO) != 0) bar.clear();
    write(arguments.json ? json_line(row) : csv_line(row));
    flush();
  }
}

}  // namespace

Verb add_track(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("track", "Distance of two models frame by frame while they move and deform");
  command.add_option("--a", arguments->a.frames, "one mesh, or the frames of a deforming mesh")
      ->type_name("MODEL")
      ->required();
  command.add_option("--b", arguments->b.frames, "as --a, in the same length unit")->type_name("MODEL")->required();
  command.add_option("--poses-a", arguments->a.poses, "where A stands in each frame; default: the origin")
      ->type_name("CSV");
  command.add_option("--poses-b", arguments->b.poses, "where B stands in each frame; default: the origin")
      ->type_name("CSV");
  add_relative_error(command, arguments->query.relative_error);
  add_deforming(command, arguments->model);
  add_count(command, "--loop", arguments->loops, 1, max_loops, "how often the sequence is played");
  add_json(command, arguments->json, "answer with one JSON object per frame instead of CSV");
  command.footer(
      "Models are mesh files (.obj .ply .stl .off .gltf .glb) or scene:NAME; all frames of one have the same faces.\n"
      "Rows of pose files are tx,ty,tz,qw,qx,qy,qz: translation in the mesh's length unit, quaternion of any length; "
      "a\n"
      "header and lines that start with # are skipped. Lists of one entry hold for every frame, others agree in "
      "length.\n"
      "Times are in microseconds: update_us is for moving vertices and refitting trees, without reading files.");
  return {&command, [arguments] { run(*arguments); }};
}

}  // namespace limber::program
