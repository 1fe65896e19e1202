// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bench/contacts/peer_answers.h"
#include "bench/contacts/peer_points.h"
#include "bench/support/report.h"

/// What `limber_bench_contacts` has measured, and how it is shown.
namespace limber::bench {

/// Medians.
struct Timed {
  double us = 0, processor_us = 0;
};

/// What another library took for a question.
struct PeerTime {
  std::string library, setting, count;
  Timed time;
};

struct Row {
  std::string question, mesh;
  Timed time;
  std::string count;
  std::vector<PeerTime> peers;
};

/// Writes contacts.md and contacts.csv.
void write_tables(const Options& options, const std::vector<PeerRow>& rows_of_peers, const std::vector<Row>& rows,
                  const std::vector<Difference>& differences, const std::vector<PointDifference>& point_differences);

}  // namespace limber::bench
