// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/track_report.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "command/bad_input.h"
#include "command/options.h"

namespace limber::program {
namespace {

/// The sequence, if a page has room for it.
Replay::Sequence checked(Replay::Sequence sequence) {
  if (sequence.row_count > Replay::most_rows) {
    throw BadInput(fmt::format("--report: a page has room for {} frames, and there are {}", Replay::most_rows,
                               sequence.row_count));
  }
  return sequence;
}

}  // namespace

void add_track_report(CLI::App& command, TrackReportArguments& arguments) {
  CLI::Option* const report = add_report(
      command, arguments, "also write a page that plays the frames, with charts of distances, times and contacts");
  add_count(command, "--max-report-mb", arguments.max_megabytes, 1, 2000,
            "how many megabytes the page may have; frames of longer sequences are thinned out")
      ->needs(report);
}

TrackReport::TrackReport(const TrackReportArguments& arguments, const Names& inputs, Replay::Sequence sequence,
                         const std::array<ReplayedModel, 2>& models)
    : arguments_(arguments), file_(arguments, inputs), replay_(checked(std::move(sequence)), models) {}

void TrackReport::write() {
  if (replay_.stride() > 1) {
    warn("track", fmt::format("--report: the page has 1 of every {} frames, as more would exceed {} MB",
                              replay_.stride(), arguments_.max_megabytes));
  }
  file_.write(replay_.to_json());
}

}  // namespace limber::program
