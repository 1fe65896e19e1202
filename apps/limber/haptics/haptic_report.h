// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/output.h"
#include "haptics/haptic_run.h"
#include "haptics/percentiles.h"

/// What a haptic loop has measured, in numbers, words, JSON and CSV. Times are in microseconds.
namespace limber::program {

/// A part of the time of a tick.
struct TickPart {
  const char* name;
  const char* key;  ///< in JSON and CSV
  std::uint32_t TickSample::*ns;
};
inline constexpr std::array<TickPart, 5> tick_parts = {{{"whole tick", "work_us", &TickSample::work},
                                                        {"  move and deform", "move_us", &TickSample::move},
                                                        {"  commit", "commit_us", &TickSample::commit},
                                                        {"  query", "query_us", &TickSample::query},
                                                        {"  force", "force_us", &TickSample::force}}};

std::vector<double> times_of(const std::vector<TickSample>& ticks, const TickPart& part);

/// How late ticks started, of those whose time came while the loop waited for it. The others are late because the tick
/// before them was.
std::vector<double> wake_up_times(const std::vector<TickSample>& ticks);

struct HapticSummary {
  std::array<std::optional<Percentiles>, tick_parts.size()> parts;  ///< as tick_parts
  std::optional<Percentiles> wake_up, empty_wake_up;
  std::uint64_t missed = 0;                         ///< ticks that ended after their period
  std::uint64_t late_starts = 0;                    ///< ticks whose time had come before the tick before them ended
  std::map<DistanceStatus, std::uint64_t> answers;  ///< how many of each
  std::optional<Percentiles> interrupted_width;     ///< (upper - lower) / upper of interrupted queries
  double largest_force_n = 0;
  std::uint64_t moved_vertices = 0;
};

/// Sums up a run. In an empty run, missed and late ticks are those of the empty loop.
HapticSummary summary_of(const HapticRun& run);

/// The rows of the table of times: a name, and the percentiles if there are any.
std::vector<std::pair<std::string, std::optional<Percentiles>>> time_rows(const HapticSummary& summary);

/// All else, as pairs of a name and a text with units.
std::vector<std::pair<std::string, std::string>> summary_rows(const HapticRun& run, const HapticSummary& summary);

/// The table and the rows as text.
std::string summary_text(const HapticRun& run, const HapticSummary& summary);

/// The bins that hold anything.
Json json_of(const LogHistogram& histogram);

Json to_json(const HapticRun& run, const HapticSummary& summary);

/// A header, and a row for each tick.
std::string ticks_csv(const HapticRun& run);

/// A page with histograms of the times, the slowest ticks over time, and the summary. Pre: the run is not empty.
std::string haptic_page(const HapticRun& run, const HapticSummary& summary, const std::string& command_line);

}  // namespace limber::program
