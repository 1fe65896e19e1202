// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/track_row.h"

#include "command/stopwatch.h"
#include "command/text.h"

namespace limber::program {

TreeUpdate& TreeUpdate::operator+=(const TreeUpdate& other) {
  elapsed_us = rounded_us(elapsed_us + other.elapsed_us);
  done += other.done;
  return *this;
}

std::string track_csv_header(const std::vector<std::string>& contact_names) {
  std::string header =
      fmt::format("frame,update_us,query_us,{},{},moved_vertices,refits,absorbed,node_tests,triangle_tests",
                  distance_columns, witness_columns);
  for (const std::string& name : contact_names) header += ',' + frame_contact_columns(name);
  return header + '\n';
}

std::string csv_line(const TrackRow& row) {
  std::string line =
      fmt::format("{},{},{},{},{},{},{},{},{}", row.frame, to_text(row.update.elapsed_us), to_text(row.query_us),
                  csv_cells(row.result, row.witness), row.update.done.moved_vertices, row.update.done.refits,
                  row.update.done.absorbed, row.result.stats.node_tests, row.result.stats.triangle_tests);
  for (const FrameContacts& contacts : row.contacts) line += ',' + csv_cells(contacts);
  return line + '\n';
}

std::string json_line(const TrackRow& row) {
  Json json = {{"frame", row.frame}, {"update_us", row.update.elapsed_us}, {"query_us", row.query_us}};
  append_distance(json, row.result, row.witness);
  json["moved_vertices"] = row.update.done.moved_vertices;
  json["refits"] = row.update.done.refits;
  json["absorbed"] = row.update.done.absorbed;
  json["node_tests"] = row.result.stats.node_tests;
  json["triangle_tests"] = row.result.stats.triangle_tests;
  for (const FrameContacts& contacts : row.contacts) append_contacts(json, contacts);
  return to_line(json);
}

}  // namespace limber::program
