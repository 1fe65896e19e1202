// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "position_frames.h"
#include "report_file.h"
#include "track_row.h"

/// The page of `limber track --report`.
namespace limber::program {

struct TrackReportArguments : ReportArguments {
  std::uint64_t max_megabytes = 60;
};

/// `--report` and `--max-report-mb`.
void add_track_report(CLI::App& command, TrackReportArguments& arguments);

/// A model as it enters a report.
struct ReplayedModel {
  std::string name;
  MeshView first;  ///< in the first frame; its arrays must outlive the report
  bool deforms = false;
  bool moves = false;
};

/// A model in one frame.
struct ReplayedState {
  std::span<const Vec3> positions;
  Transform pose;  ///< world_from_model
};

/// Gathers the frames of a sequence, and writes the page. Of a sequence whose frames would make the page too large it
/// keeps every 2nd, 4th, ... frame; charts have all rows.
class TrackReport {
 public:
  struct Sequence {
    std::size_t frame_count = 0, row_count = 0;  ///< a sequence that is played again has more rows than frames
    std::vector<std::string> contact_names;
    std::string engine;  ///< in words
    DistanceOptions query;
  };

  /// Errors   BadInput as ReportFile, or where there are more rows than a page has room for.
  TrackReport(const TrackReportArguments& arguments, const Names& inputs, Sequence sequence,
              const std::array<ReplayedModel, 2>& models);

  /// Adds a row, and the frame if it has not been added yet. Errors as PositionFrames::add().
  void add(const TrackRow& row, const std::array<ReplayedState, 2>& states);

  /// Writes the page; warns where frames have been left out. Errors as ReportFile::write().
  void write();

 private:
  class Model {
   public:
    explicit Model(const ReplayedModel& model);

    void add(const ReplayedState& state);
    void drop_every_second();
    std::size_t byte_count() const;
    Json to_json() const;

   private:
    ReplayedModel model_;
    PageTriangles triangles_;
    Json shape_;                            // positions of a mesh that does not deform
    std::optional<PositionFrames> frames_;  // of one that does
    PoseFrames poses_;
  };

  void add_row(const TrackRow& row);

  TrackReportArguments arguments_;
  ReportFile file_;
  Sequence sequence_;
  std::array<Model, 2> models_;
  std::size_t stride_ = 1;  // every so many frames are kept
  Json rows_, contacts_;
};

}  // namespace limber::program
