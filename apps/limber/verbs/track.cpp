// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/options.h"
#include "command/output.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv_inputs.h"
#include "limber/distance.h"
#include "limber/io.h"
#include "reports/page_template.h"
#include "verbs/contact_answers.h"
#include "verbs/deforming_model.h"
#include "verbs/models.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

constexpr std::uint64_t max_loops = 1'000'000;

struct ModelArguments {
  std::vector<std::string> frames;
  std::string poses;  // empty: at the origin
};

struct TrackArguments {
  ModelArguments a, b;
  DistanceOptions query;
  DeformingOptions model;
  bool contacts = false;         // pairs of triangles of the two models are counted
  bool self_contacts = false;    // pairs of triangles of each deforming model with itself are counted
  std::optional<double> margin;  // of both kinds of pairs
  std::uint64_t loops = 1;
  bool json = false;
  ReportArguments report;
  std::uint64_t max_report_megabytes = 60;
};

/// Throws BadInput where an option has no meaning without another, or with the engine.
void check_contact_options(const TrackArguments& arguments) {
  if (!arguments.contacts && !arguments.self_contacts) {
    if (arguments.margin) throw BadInput("--margin: belongs to --contacts and --self");
  } else if (arguments.model.engine != DeformingEngine::fast) {
    throw BadInput(fmt::format("{}: belongs to --engine fast", arguments.contacts ? "--contacts" : "--self"));
  }
}

/// The frames of one model: a single mesh, or several that differ in their positions only.
///
/// Errors   BadInput, from every function that reads.
class MeshFrames {
 public:
  /// Reads the first frame. Pre: there is at least one argument.
  explicit MeshFrames(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
    const std::string& first_argument = arguments_.front();
    if (is_scene(first_argument)) {
      scene_ = load_mesh_argument(first_argument);
    } else {
      sequence_ = value_or_bad_input(MeshSequence::open(first_argument));
    }
    for (const std::string& argument : arguments_) {
      if (is_scene(argument) == scene_.has_value()) continue;
      throw BadInput(fmt::format("{} and {}: frames are either files or scenes, not both", first_argument, argument));
    }
  }

  std::size_t count() const { return arguments_.size(); }
  const MeshFile& first() const { return sequence_ ? sequence_->first() : *scene_; }

  /// The positions of one frame. Frame 0 is in memory; any other is read, and nothing of it is kept.
  std::vector<Vec3> positions(std::size_t frame) const {
    if (frame == 0) return first().mesh.positions();
    if (!scene_) return value_or_bad_input(sequence_->read_positions(arguments_[frame], frame));
    const Mesh mesh = load_mesh_argument(arguments_[frame]).mesh, &first_mesh = scene_->mesh;
    if (mesh.positions().size() == first_mesh.positions().size() && mesh.triangles() == first_mesh.triangles()) {
      return mesh.positions();
    }
    throw BadInput(fmt::format("{}: frame {} has {} vertices and {} triangles, the first frame {} and {}{}",
                               arguments_[frame], frame, mesh.positions().size(), mesh.triangles().size(),
                               first_mesh.positions().size(), first_mesh.triangles().size(),
                               mesh.triangles().size() == first_mesh.triangles().size() ? ", differently joined" : ""));
  }

 private:
  std::vector<std::string> arguments_;
  // One of the two is set: the sequence if the frames are files, the scene if they are named scenes.
  std::optional<MeshSequence> sequence_;
  std::optional<MeshFile> scene_;
};

/// A list with one entry for every frame, or one entry for all frames.
struct FrameList {
  const char* name;  ///< as the user knows it
  std::size_t length;
};

/// The length of the longest list. Throws BadInput naming two lists that are longer than one and differ.
std::size_t common_frame_count(const std::vector<FrameList>& lists) {
  FrameList longest{"", 1};
  for (const FrameList& list : lists) {
    if (list.length == 1) continue;
    if (longest.length > 1 && list.length != longest.length) {
      throw BadInput(
          fmt::format("{} has {} frames, but {} has {}", longest.name, longest.length, list.name, list.length));
    }
    longest = list;
  }
  return longest.length;
}

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
  ReplayedState state() const { return {model_.mesh().positions(), pose()}; }
  std::uint32_t face_of(TriangleId triangle) const { return frames_.first().face_of_triangle[triangle]; }

  /// Moves to a frame of the lists. Only vertices whose position differs are moved; reading is not timed.
  TreeUpdate go_to(std::size_t frame) {
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

/// Which pairs of triangles are counted in each frame: those of two models, or of one with itself.
struct AskedContacts {
  std::string name;
  const TrackedModel *a, *b;
};

std::vector<AskedContacts> asked_contacts(const TrackArguments& arguments, const TrackedModel& a,
                                          const TrackedModel& b) {
  std::vector<AskedContacts> asked;
  if (arguments.contacts) asked.push_back({"contact", &a, &b});
  if (!arguments.self_contacts) return asked;
  if (a.mesh_count() == 1 && b.mesh_count() == 1) {
    throw BadInput("--self: neither model deforms; limber self tells about one that does not");
  }
  if (a.mesh_count() > 1) asked.push_back({"self_a", &a, &a});
  if (b.mesh_count() > 1) asked.push_back({"self_b", &b, &b});
  return asked;
}

FrameContacts find_contacts(const AskedContacts& asked, double margin) {
  // One is kept, the worst; the others are only counted.
  FrameContacts answer{asked.name, collect_contacts(1, ContactDetail::all, [&](ContactCollector& visit) {
                         const Model &a = asked.a->model().fast(), &b = asked.b->model().fast();
                         if (&a == &b) return visit_self_contacts(a, margin, visit);
                         return visit_contacts({a, asked.a->pose()}, {b, asked.b->pose()}, margin, visit);
                       })};
  set_faces(answer.found, *asked.a, *asked.b);
  return answer;
}

TrackRow track_frame(TrackedModel& a, TrackedModel& b, std::size_t frame, const DistanceOptions& options) {
  TrackRow row;
  row.update += a.go_to(frame);
  row.update += b.go_to(frame);
  const Stopwatch asking;
  row.result = DeformingModel::distance(a.model(), a.pose(), b.model(), b.pose(), options);
  row.query_us = asking.microseconds();
  row.witness = with_faces(row.result.witness, a, b);
  return row;
}

ReplayedModel replayed(const ModelArguments& arguments, const TrackedModel& model) {
  return {shown_name(arguments.frames.front()), model.model().mesh(), model.mesh_count() > 1, model.pose_count() > 1};
}

/// All files that are read, so that the report does not overwrite one of them.
Names inputs_of(const TrackArguments& arguments) {
  Names inputs = {arguments.a.poses, arguments.b.poses};
  for (const ModelArguments* const model : {&arguments.a, &arguments.b}) {
    inputs.insert(inputs.end(), model->frames.begin(), model->frames.end());
  }
  return inputs;
}

ExitCode run(const TrackArguments& arguments) {
  check_contact_options(arguments);
  TrackedModel a(arguments.a, arguments.model, arguments.loops > 1);
  TrackedModel b(arguments.b, arguments.model, arguments.loops > 1);
  const std::size_t frame_count = common_frame_count(
      {{"--a", a.mesh_count()}, {"--b", b.mesh_count()}, {"--poses-a", a.pose_count()}, {"--poses-b", b.pose_count()}});
  const std::size_t row_count = frame_count * arguments.loops;
  const std::vector<AskedContacts> asked = asked_contacts(arguments, a, b);
  std::vector<std::string> contact_names;
  contact_names.reserve(asked.size());
  for (const AskedContacts& contacts : asked) contact_names.push_back(contacts.name);
  std::optional<ReportFile> page;
  std::optional<Replay> replay;
  if (!arguments.report.path.empty()) {
    page.emplace(arguments.report, inputs_of(arguments));
    replay.emplace(Replay::Sequence{frame_count, row_count, contact_names, words_of(arguments.model), arguments.query,
                                    arguments.max_report_megabytes},
                   std::array{replayed(arguments.a, a), replayed(arguments.b, b)});
  }
  ProgressBar bar(row_count, "frames");
  if (!arguments.json) write(track_csv_header(contact_names));
  for (std::size_t r = 0; r < row_count; ++r) {
    bar.draw(r);
    TrackRow row = track_frame(a, b, r % frame_count, arguments.query);
    row.frame = r;
    for (const AskedContacts& contacts : asked) {
      row.contacts.push_back(find_contacts(contacts, arguments.margin.value_or(0)));
    }
    if (replay) replay->add(row, {a.state(), b.state()});
    if (isatty(STDOUT_FILENO) != 0) bar.clear();
    write((arguments.json ? to_line : csv_line)(to_json(row)));
    flush();
  }
  if (!replay) return ExitCode::answered;
  if (replay->stride() > 1) {
    warn("track", fmt::format("--report: the page has 1 of every {} frames, as more would exceed {} MB",
                              replay->stride(), arguments.max_report_megabytes));
  }
  page->write(replay->to_json());
  return ExitCode::answered;
}

constexpr const char* track_help = R"(
All frames of one model have the same faces. Lists of one entry hold for every frame; others agree in length.

A row of a file of poses is tx,ty,tz,qw,qx,qy,qz: translation in the mesh's length unit, quaternion of any length. A
first row of names is a header: it names the columns in any order, and others are ignored. Blank lines and those that
start with # are skipped.

The answer is CSV with a header, or with --json an object for each frame. lower <= true distance <= upper; where the
models are farther apart than --max-distance, status is beyond_limit, and upper and the witness are empty in CSV and
null in JSON. Times are in microseconds: update_us is for moving vertices and refitting trees, without reading files.
Whether one model lies inside the other is not looked at.

--report writes one HTML file that needs no network: the frames in 3D with the closest points, to be played, and charts
of the distance, of times, and of contacts where they are counted. A vertex of a deforming mesh is shown within 2^-16 of
the diagonal of its first frame in each coordinate.

--contacts adds columns that start with contact_, and --self those that start with self_a_ and self_b_ for each model
that deforms: us, the time of the query; count, of all pairs at most --margin apart; intersecting, those at distance 0;
and the deepest pair or else the nearest, under the names that limber contacts has. Its cells are empty where there is
no pair. In JSON they are an object contact, self_a or self_b, with query_us, count, intersecting and pair, or null.
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
    command
        .add_option(
            is_a ? "--poses-a" : "--poses-b", model->poses,
            fmt::format("where {} stands in each frame: a pose per row; the identity without it", is_a ? "A" : "B"))
        ->type_name("CSV");
  }
  add_distance_options(command, arguments->query);
  add_deforming(command, arguments->model);
  command.add_flag("--contacts", arguments->contacts,
                   "fast: also count the pairs of triangles of the two models that intersect or are close");
  command.add_flag("--self", arguments->self_contacts,
                   "fast: also count the pairs of triangles of each deforming model with itself");
  add_margin(command, arguments->margin,
             "with --contacts and --self: how far apart pairs are at most; without it they have to intersect");
  add_count(command, "--loop", arguments->loops, {1, max_loops}, "how often the sequence is played");
  add_json(command, arguments->json, "answer with one JSON object per frame instead of CSV");
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
