// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "reports/report_file.h"
#include "verbs/replay.h"

/// The page of `limber track --report`.
namespace limber::program {

struct TrackReportArguments : ReportArguments {
  std::uint64_t max_megabytes = 60;
};

/// `--report` and `--max-report-mb`.
void add_track_report(CLI::App& command, TrackReportArguments& arguments);

/// The replay of a sequence, and the file that it is written to.
class TrackReport {
 public:
  /// Errors   BadInput as ReportFile, or where there are more rows than a page has room for.
  TrackReport(const TrackReportArguments& arguments, const Names& inputs, Replay::Sequence sequence,
              const std::array<ReplayedModel, 2>& models);

  /// As Replay::add().
  void add(const TrackRow& row, const std::array<ReplayedState, 2>& states) { replay_.add(row, states); }

  /// Writes the page; warns where frames have been left out. Errors as ReportFile::write().
  void write();

 private:
  TrackReportArguments arguments_;
  ReportFile file_;
  Replay replay_;
};

}  // namespace limber::program
