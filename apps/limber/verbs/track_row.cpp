// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/track_row.h"

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
  const std::string of_pair = contact_columns(ContactDetail::all);
  for (const std::string& name : contact_names) {
    header += fmt::format(",{0}_us,{0}_count,{0}_intersecting", name);
    for (const std::string_view column : fields_of(of_pair, ',')) header += fmt::format(",{}_{}", name, column);
  }
  return header + '\n';
}

Json to_json(const TrackRow& row) {
  Json json = {{"frame", row.frame}, {"update_us", row.update.elapsed_us}, {"query_us", row.query_us}};
  append_distance(json, row.result, row.witness);
  json["moved_vertices"] = row.update.done.moved_vertices;
  json["refits"] = row.update.done.refits;
  json["absorbed"] = row.update.done.absorbed;
  json["node_tests"] = row.result.stats.node_tests;
  json["triangle_tests"] = row.result.stats.triangle_tests;
  for (const auto& [name, found] : row.contacts) {
    json[name] = {{"query_us", found.elapsed_us},
                  {"count", found.count},
                  {"intersecting", found.intersecting_count},
                  {"pair", found.first.empty() ? Json(nullptr) : to_json(found.first.front(), found.detail)}};
  }
  return json;
}

}  // namespace limber::program
