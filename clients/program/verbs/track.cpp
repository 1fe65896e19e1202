// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "answers/answers.h"
#include "answers/contact_answers.h"
#include "answers/models.h"
#include "answers/parts.h"
#include "command/output.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv.h"
#include "limber/distance.h"
#include "limber/io.h"
#include "reports/page_template.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

struct ModelArguments {
  std::vector<std::string> frames;
  std::string poses;  ///< empty: at the origin
};

struct TrackArguments {
  ModelArguments a, b;
  DistanceOptions query;
  std::optional<double> min_clearance;
  ModelOptions model;
  bool depth = false;            // how deep the models are in each other
  bool contacts = false;         // pairs of triangles of the two models are counted
  bool self_contacts = false;    // pairs of triangles of each deforming model with itself are counted
  std::optional<double> margin;  // of both kinds of pairs
  bool json = false;
  std::string out = "-";
  ReportArguments report;
  std::uint64_t max_report_megabytes = 60;
};

/// Throws BadInput where an option has no meaning without another.
void check_options(const TrackArguments& arguments) {
  if (arguments.margin && !arguments.contacts && !arguments.self_contacts) {
    throw BadInput("--margin: belongs to --contacts and --self");
  }
  if (arguments.min_clearance > arguments.query.max_distance) {
    throw BadInput("--max-distance: must be at least --min-clearance");
  }
}

/// The frames of a deforming mesh; nothing where a built-in mesh is named. Reads the first frame, and all others if
/// vertices of the first are welded.
std::optional<MeshSequence> opened(const std::vector<std::string>& names) {
  if (names.size() == 1 && is_scene(names.front())) return std::nullopt;
  for (const std::string& name : names) {
    if (is_scene(name)) throw BadInput(name + ": a built-in mesh is no frame of a sequence");
    add_input(name);
  }
  const std::vector<std::filesystem::path> files(names.begin(), names.end());
  MeshSequence sequence = value_or_bad_input(MeshSequence::open(files));
  for (const std::filesystem::path& path : sequence.first().files) add_input(path);
  return sequence;
}

/// One of the two models, which is moved from frame to frame. Errors: BadInput, from every function that reads.
class TrackedModel {
 public:
  TrackedModel(const ModelArguments& arguments, const ModelOptions& options)
      : names_(arguments.frames),
        sequence_(opened(names_)),
        scene_(sequence_ ? std::optional<MeshFile>() : load_mesh_argument(names_.front())),
        poses_(arguments.poses.empty() ? std::vector<Transform>(1) : read_poses(arguments.poses)),
        model_(first().mesh, options) {}

  const std::string& name() const { return names_.front(); }
  bool deforms() const { return names_.size() > 1; }
  std::size_t mesh_count() const { return names_.size(); }
  std::size_t pose_count() const { return poses_.size(); }
  const Model& model() const { return model_; }
  const Transform& pose() const { return poses_[pose_]; }
  ReplayedState state() const { return {model_.mesh().positions(), pose()}; }
  std::uint32_t face_of(TriangleId triangle) const { return first().face_of_triangle[triangle]; }

  /// Moves to a frame of the lists. Only vertices whose position differs are moved.
  TreeUpdate go_to(std::size_t frame) {
    if (poses_.size() > 1) pose_ = frame;
    if (!deforms()) return {};
    const std::vector<Vec3> target = positions(frame), &current = model_.mesh().positions();
    std::vector<VertexId> moved_ids;
    std::vector<Vec3> moved_positions;
    for (VertexId v = 0; v < target.size(); ++v) {
      if (target[v] == current[v]) continue;
      moved_ids.push_back(v);
      moved_positions.push_back(target[v]);
    }
    const bool all_moved = moved_ids.size() == target.size();
    const MaintenanceStats before = model_.maintenance_stats();
    const Stopwatch updating;
    value_or_bad_input(all_moved ? model_.move_all(target) : model_.move_vertices(moved_ids, moved_positions));
    model_.commit();
    return work_since(before, model_, updating.microseconds());
  }

 private:
  const MeshFile& first() const { return sequence_ ? sequence_->first() : *scene_; }

  /// Frame 0 is in memory; any other is read, and nothing of it is kept.
  std::vector<Vec3> positions(std::size_t frame) const {
    if (frame == 0) return first().mesh.positions();
    // Of glTF alone, a frame may have further files, which the sequence does not name.
    const std::string type = std::filesystem::path(names_[frame]).extension().string();
    if (type.starts_with(".g") || type.starts_with(".G")) load_mesh_argument(names_[frame]);
    return value_or_bad_input(sequence_->read_positions(names_[frame], frame));
  }

  std::vector<std::string> names_;
  std::optional<MeshSequence> sequence_;
  std::optional<MeshFile> scene_;  // set if the sequence is not
  std::vector<Transform> poses_;   // world_from_model
  std::size_t pose_ = 0;
  Model model_;
};

/// The length of the lists that are longer than one. Throws BadInput naming two of them that differ.
std::size_t common_frame_count(const std::vector<std::pair<const char*, std::size_t>>& lists) {
  std::pair<const char*, std::size_t> longest{"", 1};
  for (const auto& [name, length] : lists) {
    if (length == 1) continue;
    if (longest.second > 1 && length != longest.second) {
      throw BadInput(fmt::format("{} has {} frames, but {} has {}", longest.first, longest.second, name, length));
    }
    longest = {name, length};
  }
  return longest.second;
}

/// Two models, or one and itself, whose contacts are counted in each frame, and what their columns start with.
struct AskedPair {
  std::string name;
  const TrackedModel *a, *b;
};

/// What is asked about each frame, besides the distance.
struct Asked {
  std::optional<std::array<ClosedSurface, 2>> bodies;  ///< how deep these are in each other
  std::vector<AskedPair> contacts;
};

Asked asked_about(const TrackArguments& arguments, const TrackedModel& a, const TrackedModel& b) {
  const auto body_of = [](const TrackedModel& model) {
    return value_or_bad_input(ClosedSurface::create(model.model()), "--depth: " + model.name() + ": ");
  };
  Asked asked;
  if (arguments.depth) asked.bodies.emplace(std::array{body_of(a), body_of(b)});
  if (arguments.contacts) asked.contacts.push_back({"contact", &a, &b});
  if (!arguments.self_contacts) return asked;
  if (!a.deforms() && !b.deforms()) {
    throw BadInput("--self: neither model deforms; limber self tells about one that does not");
  }
  if (a.deforms()) asked.contacts.push_back({"self_a", &a, &a});
  if (b.deforms()) asked.contacts.push_back({"self_b", &b, &b});
  return asked;
}

FrameContacts find_contacts(const AskedPair& asked, double margin) {
  // One is kept, the worst; the others are only counted.
  FrameContacts answer{asked.name, collect_contacts(1, ContactDetail::all, [&](ContactCollector& visit) {
                         const Model &a = asked.a->model(), &b = asked.b->model();
                         if (&a == &b) return visit_self_contacts(a, margin, visit);
                         return visit_contacts({a, asked.a->pose()}, {b, asked.b->pose()}, margin, visit);
                       })};
  set_faces(answer.found, *asked.a, *asked.b);
  return answer;
}

TrackRow track_frame(TrackedModel& a, TrackedModel& b, const Asked& asked, std::size_t frame,
                     const TrackArguments& arguments) {
  TrackRow row;
  row.frame = frame;
  row.update += a.go_to(frame);
  row.update += b.go_to(frame);
  const Stopwatch asking;
  row.result = decided_distance(arguments.query, arguments.min_clearance, [&](const DistanceOptions& options) {
    return distance({a.model(), a.pose()}, {b.model(), b.pose()}, options);
  });
  row.query_us = asking.microseconds();
  row.witness = with_faces(row.result.witness, a, b);
  if (asked.bodies) {
    row.depth = proven_depth({asked.bodies->front(), a.pose()}, {asked.bodies->back(), b.pose()});
  }
  for (const AskedPair& pair : asked.contacts) {
    row.contacts.push_back(find_contacts(pair, arguments.margin.value_or(0)));
  }
  if (arguments.min_clearance) {
    row.too_close = row.result.upper < *arguments.min_clearance || row.depth.value_or(0) > 0;
  }
  return row;
}

/// With all columns that a row may have.
TrackRow sample_row(const TrackArguments& arguments, const Asked& asked) {
  TrackRow row;
  row.witness.emplace();
  if (arguments.min_clearance) row.too_close = false;
  if (arguments.depth) row.depth = 0;
  for (const AskedPair& pair : asked.contacts) {
    row.contacts.push_back({pair.name, {}});
    row.contacts.back().found.first.emplace_back();
  }
  return row;
}

ExitCode run(const TrackArguments& arguments) {
  check_options(arguments);
  TrackedModel a(arguments.a, arguments.model), b(arguments.b, arguments.model);
  const std::size_t frame_count = common_frame_count(
      {{"--a", a.mesh_count()}, {"--b", b.mesh_count()}, {"--poses-a", a.pose_count()}, {"--poses-b", b.pose_count()}});
  const Asked asked = asked_about(arguments, a, b);
  std::optional<Replay> replay;
  if (!arguments.report.path.empty()) {
    Names contact_names;
    for (const AskedPair& pair : asked.contacts) contact_names.push_back(pair.name);
    const auto replayed = [](const TrackedModel& model) {
      return ReplayedModel{shown_name(model.name()), model.model().mesh(), model.deforms(), model.pose_count() > 1};
    };
    replay.emplace(Replay::Sequence{frame_count, contact_names, words_of(arguments.model), arguments.query,
                                    arguments.min_clearance, arguments.max_report_megabytes},
                   std::array{replayed(a), replayed(b)});
  }
  OutputFile out("--out", arguments.out);
  std::optional<ReportFile> page;
  if (replay) page.emplace(arguments.report);
  const AnswerColumns columns(to_json(sample_row(arguments, asked)));
  if (!arguments.json) out.write(columns.header());
  ExitCode exit_code = ExitCode::answered;
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    const TrackRow row = track_frame(a, b, asked, frame, arguments);
    if (row.too_close.value_or(false)) exit_code = ExitCode::found;
    if (replay) replay->add(row, {a.state(), b.state()});
    const Json json = to_json(row);
    out.write_rows(arguments.json ? to_line(json) : columns.line(json));
  }
  if (!replay) return exit_code;
  if (replay->stride() > 1) {
    warn("track", fmt::format("--report: the page has 1 of every {} frames, as more would exceed {} MB",
                              replay->stride(), arguments.max_report_megabytes));
  }
  page->write(replay->to_json());
  return exit_code;
}

constexpr const char* track_help = R"(
All frames of one model have the same faces. Lists of one entry hold for every frame; others agree in length.

A row of a file of poses is tx,ty,tz,qw,qx,qy,qz: translation in the mesh's length unit, quaternion of any length. A
first row of names is a header: it names the columns in any order, and others are ignored. Blank lines and those that
start with # are skipped.

The answer is CSV with a header, or with --json an object for each frame. lower <= true distance <= upper; where the
models are farther apart than --max-distance, status is beyond_limit, and upper and the witness are empty in CSV and
null in JSON. Times are in microseconds: update_us is for moving vertices and refitting trees, without reading files.
Only --depth tells whether one model lies inside the other.

--min-clearance adds the column too_close after primitive_tests. It is decided as for an exact distance, whatever the
errors asked for. With --depth it is true, too, where the bodies overlap. How near models come between frames is not
looked at: --path-a of limber distance and limber collide is for rigid models, time_of_impact() in C++ and Python for
those that deform.

--depth adds the column depth after that, as limber distance has it: a length that no translation which takes one body
out of the other is shorter than; 0 where they are apart. Its time is in no column. Both models have to be closed.

--report writes one HTML file that needs no network: the frames in 3D with the closest points, to be played, and charts
of the distance, of times, and of contacts where they are counted. With --min-clearance it says first whether it is
kept, starts with the worst frame, and lists all, the worst first. A vertex of a deforming mesh is shown within 2^-16 of
the diagonal of its first frame in each coordinate.

--contacts adds columns that start with contact_, and --self those that start with self_a_ and self_b_ for each model
that deforms: query_us; count, of all pairs at most --margin apart; intersecting, those at distance 0; and the deepest
pair or else the nearest, under the names that limber contacts has. Its cells are empty where there is no pair. In JSON
they are an object contact, self_a or self_b, with query_us, count, intersecting and pair, or null.
)";

}  // namespace

Verb add_track(CLI::App& app, const std::string& command_line) {
  const auto arguments = std::make_shared<TrackArguments>();
  arguments->report.command_line = command_line;
  CLI::App& command = *app.add_subcommand("track", "Distance of two models frame by frame while they move and deform");
  command
      .add_option("--a", arguments->a.frames,
                  std::string(model_argument_help) + "; or the frames of one deforming mesh")
      ->type_name("MODEL")
      ->required();
  command.add_option("--b", arguments->b.frames, "as --a, in the same length unit")->type_name("MODEL")->required();
  for (auto* const model : {&arguments->a, &arguments->b}) {
    const bool is_a = model == &arguments->a;
    add_file(command, is_a ? "--poses-a" : "--poses-b", model->poses, "CSV",
             fmt::format("where {} stands in each frame: a pose per row; the identity without it", is_a ? "A" : "B"));
  }
  add_distance_options(command, arguments->query);
  add_min_clearance(command, arguments->min_clearance,
                    "exit with 3 instead of 0 when the models are closer than this length in a frame, or with "
                    "--depth overlap; at most --max-distance");
  add_motion_margin(command, arguments->model);
  command.add_flag("--depth", arguments->depth, "also how deep closed models are in each other");
  command.add_flag("--contacts", arguments->contacts,
                   "also count the pairs of triangles of the two models that intersect or are close");
  command.add_flag("--self", arguments->self_contacts,
                   "also count the pairs of triangles of each deforming model with itself");
  add_margin(command, arguments->margin,
             "with --contacts and --self: how far apart pairs are at most; without it they have to intersect");
  command.add_flag("--json", arguments->json, "answer with one JSON object per frame instead of CSV");
  add_out(command, arguments->out);
  CLI::Option* const report =
      add_report(command, arguments->report,
                 "also write a page that plays the frames, with charts of distances, times and contacts");
  add_count(command, "--max-report-mb", arguments->max_report_megabytes, {1, 2000},
            "how many megabytes the page may have; frames of longer sequences are thinned out")
      ->needs(report);
  command.footer(track_help);
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program
