// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "command/output.h"
#include "formats/contact_list.h"
#include "verbs/deforming_model.h"

namespace CLI {
class App;
}

/// Pairs of triangles that `limber track` counts in each frame.
namespace limber::program {

struct TrackContactArguments {
  bool contacts = false;  ///< of the two models
  bool self = false;      ///< of each model that deforms with itself
  std::optional<double> margin;
};

/// `--contacts`, `--self`, `--margin`.
void add_track_contacts(CLI::App& command, TrackContactArguments& arguments);

/// Errors   BadInput where an option has no meaning without another, or with that engine.
void check_track_contacts(const TrackContactArguments& arguments, DeformingEngine engine);

/// The pairs of one frame, and the word that their columns start with.
struct FrameContacts {
  std::string name;
  FoundContacts found;
};

/// The time of the query, counts, and the first pair.
std::string frame_contact_columns(const std::string& name);
std::string csv_cells(const FrameContacts& contacts);
void append_contacts(Json& json, const FrameContacts& contacts);

}  // namespace limber::program
