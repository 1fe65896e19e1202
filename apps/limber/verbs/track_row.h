// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "verbs/answers.h"
#include "verbs/deforming_model.h"
#include "verbs/track_contacts.h"

/// What `limber track` says about each frame.
namespace limber::program {

/// Work done on trees between two frames.
struct TreeUpdate {
  double elapsed_us = 0;
  DeformingWork done;

  TreeUpdate& operator+=(const TreeUpdate& other);
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
std::string csv_line(const TrackRow& row);
std::string json_line(const TrackRow& row);

}  // namespace limber::program
