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
#include "answers/impacts.h"
#include "answers/models.h"
#include "answers/tracked_model.h"
#include "command/options.h"
#include "command/output.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"
#include "reports/page_template.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

constexpr std::uint64_t max_loops = 1'000'000;

struct TrackArguments {
  ModelArguments a, b;
  DistanceOptions query;
  std::optional<double> min_clearance;
  ModelOptions model;
  bool depth = false;            // how deep the models are in each other
  bool contacts = false;         // pairs of triangles of the two models are counted
  bool self_contacts = false;    // pairs of triangles of each deforming model with itself are counted
  std::optional<double> margin;  // of both kinds of pairs
  bool continuous = false;       // impacts between frames, of each deforming model with itself too with self_contacts
  bool ignore_crossings = false;
  std::uint64_t loops = 1;
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

/// Two models, or one and itself, that are asked about in each frame, and what the columns of the answer start with.
struct AskedPair {
  std::string name;
  const TrackedModel *a, *b;
};

/// What is asked about each frame, besides the distance.
struct Asked {
  std::optional<std::array<ClosedSurface, 2>> bodies;  ///< how deep these are in each other
  std::vector<AskedPair> contacts, impacts;            ///< of these pairs of models
};

/// Errors   BadInput unless the model is closed.
ClosedSurface body_of(const ModelArguments& arguments, const TrackedModel& model) {
  return value_or_bad_input(ClosedSurface::create(model.model()), "--depth: " + arguments.frames.front() + ": ");
}

Asked asked_pairs(const TrackArguments& arguments, const TrackedModel& a, const TrackedModel& b) {
  Asked asked;
  if (arguments.depth) asked.bodies.emplace(std::array{body_of(arguments.a, a), body_of(arguments.b, b)});
  if (arguments.contacts) asked.contacts.push_back({"contact", &a, &b});
  if (arguments.continuous) asked.impacts.push_back({"impact", &a, &b});
  if (!arguments.self_contacts) return asked;
  if (a.mesh_count() == 1 && b.mesh_count() == 1) {
    throw BadInput("--self: neither model deforms; limber self tells about one that does not");
  }
  for (const auto& [name, model] : {std::pair{"self_a", &a}, {"self_b", &b}}) {
    if (model->mesh_count() == 1) continue;
    asked.contacts.push_back({name, model, model});
    if (arguments.continuous) asked.impacts.push_back({std::string("impact_") + name, model, model});
  }
  return asked;
}

Names names_of(const std::vector<AskedPair>& asked) {
  Names names;
  names.reserve(asked.size());
  for (const AskedPair& pair : asked) names.push_back(pair.name);
  return names;
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

/// No frame comes before the first one of the lists, so nothing is asked about the way to it.
FrameImpact impact_of(const AskedPair& asked, std::size_t row, bool is_first, bool ignore_crossings) {
  if (is_first) return {asked.name};
  FrameImpact impact =
      find_impact(asked.name, row, asked.a->motion(), asked.b->motion(), {.ignore_crossings = ignore_crossings});
  if (impact.touch) impact.touch->at = *with_faces(impact.touch->at.witness, *asked.a, *asked.b);
  return impact;
}

/// Whether the models are closer than the clearance in a frame, or in each other, or touch on the way to it. Pre: all
/// else is set.
bool is_too_close(const TrackRow& row, const Asked& asked, double min_clearance) {
  bool touches = false;
  for (std::size_t i = 0; i < row.impacts.size(); ++i) {
    const bool is_of_both = asked.impacts[i].a != asked.impacts[i].b;
    touches = touches || (is_of_both && row.impacts[i].status.value_or(ImpactStatus::clear) != ImpactStatus::clear);
  }
  return touches || row.result.upper < min_clearance || row.depth.value_or(0) > 0;
}

TrackRow track_frame(TrackedModel& a, TrackedModel& b, const Asked& asked, std::size_t number, std::size_t frame,
                     const TrackArguments& arguments) {
  TrackRow row;
  row.frame = number;
  for (TrackedModel* const model : {&a, &b}) {
    model->aim_at(frame);
    if (arguments.continuous && frame > 0) row.update += model->set_motion();
  }
  for (const AskedPair& pair : asked.impacts) {
    row.impacts.push_back(impact_of(pair, number, frame == 0, arguments.ignore_crossings));
  }
  row.update += a.go();
  row.update += b.go();
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
  if (arguments.min_clearance) row.too_close = is_too_close(row, asked, *arguments.min_clearance);
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
  for (const AskedPair& pair : asked.impacts) {
    row.impacts.push_back({pair.name, ImpactStatus::contact, 0.0, 0.0, FoundTouch()});
  }
  return row;
}

ReplayedModel replayed(const ModelArguments& arguments, const TrackedModel& model) {
  return {shown_name(arguments.frames.front()), model.model().mesh(), model.mesh_count() > 1, model.pose_count() > 1};
}

ExitCode run(const TrackArguments& arguments) {
  check_options(arguments);
  TrackedModel a(arguments.a, arguments.model, arguments.loops > 1);
  TrackedModel b(arguments.b, arguments.model, arguments.loops > 1);
  const std::size_t frame_count = common_frame_count(
      {{"--a", a.mesh_count()}, {"--b", b.mesh_count()}, {"--poses-a", a.pose_count()}, {"--poses-b", b.pose_count()}});
  const std::size_t row_count = frame_count * arguments.loops;
  if (arguments.continuous && frame_count == 1) throw BadInput("--continuous: there is one frame alone");
  const Asked asked = asked_pairs(arguments, a, b);
  const Names contact_names = names_of(asked.contacts), impact_names = names_of(asked.impacts);
  std::optional<Replay> replay;
  if (!arguments.report.path.empty()) {
    replay.emplace(Replay::Sequence{frame_count, row_count, contact_names, impact_names, words_of(arguments.model),
                                    arguments.query, arguments.min_clearance, arguments.max_report_megabytes},
                   std::array{replayed(arguments.a, a), replayed(arguments.b, b)});
  }
  OutputFile out("--out", arguments.out);
  std::optional<ReportFile> page;
  if (replay) page.emplace(arguments.report);
  ProgressBar bar(row_count, "frames");
  const AnswerColumns columns(to_json(sample_row(arguments, asked)));
  if (!arguments.json) out.write(columns.header());
  ExitCode exit_code = ExitCode::answered;
  for (std::size_t r = 0; r < row_count; ++r) {
    bar.draw(r);
    const TrackRow row = track_frame(a, b, asked, r, r % frame_count, arguments);
    if (row.too_close.value_or(false)) exit_code = ExitCode::found;
    if (replay) replay->add(row, {a.state(), b.state()});
    if (out.is_terminal()) bar.clear();
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
null in JSON. Times are in microseconds: update_us is for moving vertices and refitting trees, without reading files,
and with --continuous for setting motions. Only --depth tells whether one model lies inside the other.

--min-clearance adds the column too_close after primitive_tests. It is decided as for an exact distance, whatever the
errors asked for. With --continuous it is true, too, where the models touch on the way from the frame before, and with
--depth where the bodies overlap. How near they come between frames otherwise is not looked at; --path-a of
limber distance is for rigid models.

--depth adds the column depth after that, as limber distance has it: a length that no translation which takes one body
out of the other is shorter than; 0 where they are apart. Its time is in no column. Both models have to be closed.

--report writes one HTML file that needs no network: the frames in 3D with the closest points, to be played, and charts
of the distance, of times, and of contacts where they are counted, with impacts between frames. With --min-clearance it
says first whether it is kept, starts with the worst frame, and lists all, the worst first. A vertex of a deforming mesh
is shown within 2^-16 of the diagonal of its first frame in each coordinate.

--contacts adds columns that start with contact_, and --self those that start with self_a_ and self_b_ for each model
that deforms: query_us; count, of all pairs at most --margin apart; intersecting, those at distance 0; and the deepest
pair or else the nearest, under the names that limber contacts has. Its cells are empty where there is no pair. In JSON
they are an object contact, self_a or self_b, with query_us, count, intersecting and pair, or null.

--continuous adds columns that start with impact_, about the way from the frame before: vertices, as placed, move on
straight lines at constant speed. No contact is missed, however short. With --self, those that start with impact_self_a_
and impact_self_b_ are about each model that deforms: elements that share no vertex. After query_us, status is clear,
contact, or initial_contact where the frame before has one already. The first contact is between lower and upper, times
in frames: 1.25 is a quarter of the way from frame 1 to frame 2. Then feature_a of triangle_a touches feature_b of
triangle_b: "vertex 0" to "vertex 2", "edge 0" to "edge 2" or "face", as in limber contacts. There is none where
triangles cross in the frame before; with --ignore-crossings they may go on, and only these parts count. Points, and the
normal from a to b, are in the world frame. Cells are empty in the first frame, and after status where it is clear. In
JSON they are an object impact, impact_self_a or impact_self_b, with query_us, status, lower, upper and touch. On
straight lines a model that turns shrinks, by 0.4 % at 10 degrees; --path-a of limber collide is for rigid models.
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
                    "--continuous touch between two, or with --depth overlap; at most --max-distance");
  add_motion_margin(command, arguments->model);
  command.add_flag("--depth", arguments->depth, "also how deep closed models are in each other");
  command.add_flag("--contacts", arguments->contacts,
                   "also count the pairs of triangles of the two models that intersect or are close");
  command.add_flag("--self", arguments->self_contacts,
                   "also count the pairs of triangles of each deforming model with itself");
  add_margin(command, arguments->margin,
             "with --contacts and --self: how far apart pairs are at most; without it they have to intersect");
  CLI::Option* const continuous =
      command.add_flag("--continuous", arguments->continuous,
                       "also when the models first touch on the way from each frame to the next, and with --self "
                       "when a model that deforms touches itself");
  command
      .add_flag("--ignore-crossings", arguments->ignore_crossings,
                "with --continuous: what crosses goes on, until a vertex touches a face, or an edge an edge")
      ->needs(continuous);
  add_count(command, "--loop", arguments->loops, {1, max_loops}, "how often the sequence is played");
  add_json(command, arguments->json, "answer with one JSON object per frame instead of CSV");
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
