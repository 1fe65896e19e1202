// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "answers/answers.h"
#include "answers/contact_answers.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "reports/page_data.h"

/// What `limber track` says about each frame, and what the viewer plays: two models that move and deform, and what was
/// asked about them.
namespace limber::program {

/// Work done on trees between two frames.
struct TreeUpdate {
  double elapsed_us = 0;
  std::uint64_t moved_vertices = 0;
  std::uint64_t refits = 0;    ///< 8-nodes
  std::uint64_t absorbed = 0;  ///< moves of vertices that needed no refit

  TreeUpdate& operator+=(const TreeUpdate& other);
};
TreeUpdate work_since(const MaintenanceStats& before, const limber::Model& model, double elapsed_us);

/// The pairs of triangles of one frame, and the word that their columns start with.
struct FrameContacts {
  std::string name;
  FoundContacts found;
};

/// One line of the answer.
struct TrackRow {
  std::size_t frame = 0;
  TreeUpdate update;
  double query_us = 0;
  DistanceResult result;
  std::optional<FoundWitness> witness;
  /// Whether the models are closer than a clearance that is required, or overlap; empty where none is.
  std::optional<bool> too_close;
  std::optional<double> depth;  ///< of closed models in each other, as proven_depth() has it, where that is asked
  std::vector<FrameContacts> contacts;
};

Json to_json(const TrackRow& row);

/// A model as it enters a replay.
struct ReplayedModel {
  std::string name;
  MeshView first;  ///< in the first frame; its arrays must outlive the replay
  bool deforms = false;
  bool moves = false;
};

/// A model in one frame.
struct ReplayedState {
  std::span<const Vec3> positions;
  Transform pose;  ///< world_from_model
};

/// Gathers the frames of a sequence. Where they would make the page too large it keeps every 2nd, 4th, ... frame;
/// charts have all rows.
class Replay {
 public:
  static constexpr std::size_t most_rows = 100'000;  ///< that charts have room for

  struct Sequence {
    std::size_t frame_count = 0;
    Names contact_names;
    std::string engine;  ///< its settings in words
    DistanceOptions query;
    std::optional<double> min_clearance;
    std::uint64_t max_megabytes = 0;  ///< that the page may have
  };

  /// Errors   BadInput unless there are at most `most_rows` rows.
  Replay(Sequence sequence, const std::array<ReplayedModel, 2>& models);

  /// Adds a row, and the frame if it has not been added yet. Errors as PositionFrames::add().
  void add(const TrackRow& row, const std::array<ReplayedState, 2>& states);

  /// Every so many frames are kept.
  std::size_t stride() const { return stride_; }

  /// The data of the page.
  Json to_json() const;

 private:
  class Model {
   public:
    explicit Model(const ReplayedModel& model);

    void add(const ReplayedState& state);
    void drop_every_second();
    std::size_t byte_count() const;
    Json to_json() const;
    /// Where it stands, as the model of that number.
    Json part(std::size_t number) const;

   private:
    ReplayedModel model_;
    PageTriangles triangles_;
    Json shape_;                            // positions of a mesh that does not deform
    std::optional<PositionFrames> frames_;  // of one that does
    std::vector<Transform> poses_;
  };

  void add_row(const TrackRow& row);

  Sequence sequence_;
  std::array<Model, 2> models_;
  std::size_t stride_ = 1;
  Json rows_, contacts_;
};

}  // namespace limber::program
