// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "verbs/answers.h"
#include "verbs/contact_answers.h"
#include "verbs/deforming_model.h"

/// What `limber track` says about each frame.
namespace limber::program {

/// Work done on trees between two frames.
struct TreeUpdate {
  double elapsed_us = 0;
  DeformingWork done;

  TreeUpdate& operator+=(const TreeUpdate& other);
};

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
  std::vector<FrameContacts> contacts;
};

/// The first line of CSV; `contact_names` are the words that columns of contacts start with.
std::string track_csv_header(const std::vector<std::string>& contact_names);
/// The line, whose values are the cells under the header.
Json to_json(const TrackRow& row);

}  // namespace limber::program
