// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "command/text.h"

namespace limber::program {
namespace {

/// What a page takes without its frames: the program, charts of a usual sequence, two meshes.
constexpr double other_bytes = 1.5e6;
constexpr double fewest_frame_bytes = 1e5;

/// Frames that would take more bytes are thinned out. In base64, 3 bytes are 4.
double most_frame_bytes(std::uint64_t max_megabytes) {
  return std::max(fewest_frame_bytes, (1e6 * static_cast<double>(max_megabytes) - other_bytes) * 3 / 4);
}

constexpr std::array row_names = {"lower",     "upper",    "status",         "too_close", "depth",
                                  "update_us", "query_us", "moved_vertices", "witness"};
constexpr std::array contact_row_names = {"query_us", "count", "intersecting"};

}  // namespace

TreeUpdate& TreeUpdate::operator+=(const TreeUpdate& other) {
  elapsed_us = rounded_us(elapsed_us + other.elapsed_us);
  moved_vertices += other.moved_vertices;
  refits += other.refits;
  absorbed += other.absorbed;
  return *this;
}

TreeUpdate work_since(const MaintenanceStats& before, const limber::Model& model, double elapsed_us) {
  const MaintenanceStats now = model.maintenance_stats();
  return {elapsed_us, now.moved_vertices - before.moved_vertices, now.refits - before.refits,
          now.absorbed - before.absorbed};
}

Json to_json(const TrackRow& row) {
  Json json = {{"frame", row.frame}, {"update_us", row.update.elapsed_us}, {"query_us", row.query_us}};
  append_distance(json, row.result, row.witness);
  json["moved_vertices"] = row.update.moved_vertices;
  json["refits"] = row.update.refits;
  json["absorbed"] = row.update.absorbed;
  json["node_tests"] = row.result.stats.node_tests;
  json["primitive_tests"] = row.result.stats.primitive_tests;
  if (row.too_close) json["too_close"] = *row.too_close;
  if (row.depth) json["depth"] = *row.depth;
  for (const auto& [name, found] : row.contacts) {
    json[name] = {{"query_us", found.elapsed_us},
                  {"count", found.count},
                  {"intersecting", found.intersecting_count},
                  {"pair", found.first.empty() ? Json(nullptr) : to_json(found.first.front(), found.detail)}};
  }
  return json;
}

Replay::Model::Model(const ReplayedModel& model) : model_(model), triangles_(model.first) {
  const std::vector<Vec3> positions = triangles_.in_order(model.first.positions);
  if (model.deforms) {
    frames_.emplace(positions);
  } else {
    shape_ = quantized(positions);
  }
}

void Replay::Model::add(const ReplayedState& state) {
  if (frames_) frames_->add(triangles_.in_order(state.positions));
  if (model_.moves || poses_.empty()) poses_.push_back(state.pose);
}

void Replay::Model::drop_every_second() {
  if (frames_) frames_->drop_every_second();
  if (!model_.moves) return;
  std::size_t i = 0;
  std::erase_if(poses_, [&i](const Transform&) { return i++ % 2 == 1; });
}

std::size_t Replay::Model::byte_count() const {
  return (frames_ ? frames_->byte_count() : 0) + sizeof(Transform) * poses_.size();
}

Json Replay::Model::to_json() const {
  Json json = {{"name", model_.name},
               {"triangles", model_.first.triangles.size()},
               {"vertices", model_.first.positions.size()},
               {"corners", base64_of(triangles_.corners)}};
  if (frames_) {
    json["frames"] = frames_->to_json();
  } else {
    json["positions"] = shape_;
  }
  return json;
}

Json Replay::Model::part(std::size_t number) const {
  return {{"name", model_.name}, {"file", model_.name}, {"model", number}, {"poses", poses_json(poses_)}};
}

Replay::Replay(Sequence sequence, const std::array<ReplayedModel, 2>& models)
    : sequence_(std::move(sequence)), models_{Model(models[0]), Model(models[1])}, contacts_(Json::array()) {
  for (const std::string& name : sequence_.contact_names) contacts_.push_back({{"name", name}});
  if (sequence_.frame_count > most_rows) {
    throw BadInput(
        fmt::format("--report: a page has room for {} frames, and there are {}", most_rows, sequence_.frame_count));
  }
}

void Replay::add(const TrackRow& row, const std::array<ReplayedState, 2>& states) {
  add_row(row);
  if (row.frame % stride_ != 0) return;
  for (std::size_t m = 0; m < models_.size(); ++m) models_[m].add(states[m]);
  while (static_cast<double>(models_[0].byte_count() + models_[1].byte_count()) >
             most_frame_bytes(sequence_.max_megabytes) &&
         row.frame >= stride_) {
    for (Model& model : models_) model.drop_every_second();
    stride_ *= 2;
  }
}

void Replay::add_row(const TrackRow& row) {
  Json json = program::to_json(row);
  json["witness"] = flat_witness(row.witness);
  append_row(rows_, json, row_names);
  for (std::size_t c = 0; c < row.contacts.size(); ++c) {
    append_row(contacts_[c], json[row.contacts[c].name], contact_row_names);
  }
}

Json Replay::to_json() const {
  Json rows = rows_;
  for (std::size_t r = 0; r < rows["witness"].size(); ++r) {
    if (r % stride_ != 0) rows["witness"][r] = nullptr;  // no picture shows it
  }
  Json json = {{"kind", "frames"}, {"engine", sequence_.engine}};
  json.update(settings_of(sequence_.query, sequence_.min_clearance));
  json.update({{"frame_count", sequence_.frame_count},
               {"stride", stride_},
               {"max_megabytes", sequence_.max_megabytes},
               {"rows", std::move(rows)},
               {"contacts", contacts_}});
  for (const Model& model : models_) {
    json["models"].push_back(model.to_json());
    append_row(json["parts"], model.part(json["models"].size() - 1), part_names);
  }
  return json;
}

}  // namespace limber::program
