// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/contacts/contact_bench.h"

#include <chrono>
#include <ctime>
#include <map>
#include <optional>
#include <utility>

#include "bench/support/sampling.h"

namespace limber::bench {
namespace {

PeerTime as_time(const std::string& library, const PeerRow& row) {
  const std::string key = "processor=";
  const std::size_t at = row.details.find(key);
  const double processor_us = at == std::string::npos ? 0 : std::stod(row.details.substr(at + key.size()));
  return {library, row.setting(), row.count, {row.us, processor_us}};
}

/// The row with the shortest time; `part` occurs in its details.
std::optional<PeerRow> fastest(const std::vector<PeerRow>& rows, const std::string& peer, const std::string& mesh,
                               const std::string& question, const std::string& part = "") {
  std::optional<PeerRow> best;
  for (const PeerRow& row : rows) {
    if (row.peer != peer || row.mesh != mesh || row.question != question) continue;
    if (row.us <= 0 || row.details.find(part) == std::string::npos) continue;
    if (!best || row.us < best->us) best = row;
  }
  return best;
}

/// The times of some calls.
class Samples {
 public:
  void take(const std::function<void()>& call) {
    const std::clock_t before = std::clock();
    us_.push_back(mean_us(1, call));
    processor_us_.push_back(1e6 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    sum_us_ += us_.back();
  }
  double sum_us() const { return sum_us_; }
  Timed medians() const { return {median(us_), median(processor_us_)}; }

 private:
  std::vector<double> us_, processor_us_;
  double sum_us_ = 0;
};

std::string in_words(const std::map<std::string, std::size_t>& reasons) {
  std::string text;
  for (const auto& [reason, count] : reasons) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, reason);
  return text.empty() ? "0" : text;
}

/// A number with at least three digits, without an exponent.
std::string digits(double value) {
  return value >= 100 ? fmt::format("{:.0f}", value) : value > 0 ? fmt::format("{:.3g}", value) : "";
}

}  // namespace

ContactBench::ContactBench(Settings settings, Checker& checker)
    : settings_(std::move(settings)),
      checker_(checker),
      rows_of_peers_(read_peer_rows(settings_.peers)),
      runs_(settings_.quick ? 3 : 15) {}

Timed ContactBench::time(const std::function<void()>& call, const std::function<void()>& prepare) const {
  Samples samples;
  for (int run = -1; run < runs_ && (run < 3 || samples.sum_us() < 2e6); ++run) {
    if (prepare) prepare();
    run < 0 ? call() : samples.take(call);
  }
  return samples.medians();
}

void ContactBench::add_peer(Row& row, const std::string& library, const std::string& peer, const std::string& question,
                            const std::string& part) const {
  if (const auto found = fastest(rows_of_peers_, peer, row.mesh, question, part)) {
    row.peers.push_back(as_time(library, *found));
  }
}

void ContactBench::add_both_parts(Row& row) const {
  const auto candidates = fastest(rows_of_peers_, "ipctk", row.mesh, "candidates", "LBVH; inflation=0.0005 of");
  const auto distances = fastest(rows_of_peers_, "ipctk", row.mesh, "distances");
  if (!candidates || !distances) return;
  PeerTime both = as_time("IPC Toolkit, candidates and distances", *distances);
  const PeerTime first = as_time("", *candidates);
  both.setting = "LBVH", both.time.us += first.time.us, both.time.processor_us += first.time.processor_us;
  row.peers.push_back(both);
}

void ContactBench::add_ipc_frames(Row& row) const {
  add_peer(row, "IPC Toolkit, candidates alone", "ipctk", "frame_candidates");
  add_peer(row, "IPC Toolkit", "ipctk", "frame");
}

void ContactBench::write(Table& text) const {
  text.line("# Pairs of triangles and closest points, as printed by `limber_bench_contacts`\n");
  text.line("Medians in us, on one thread; `points` are all of one call. Ratios are those of the");
  text.line(
      "other library to ours: by the clock, and by the processor's time. [README](../../contacts/README.md) says what "
      "each");
  text.line("library answers.\n");
  for (const PeerRow& row : rows_of_peers_) {
    if (row.question == "version" || row.question == "processor") {
      text.line("- {}: {}", row.peer == "machine" ? "other libraries measured on" : row.peer, row.details);
    }
  }
  if (rows_of_peers_.empty()) text.line("No other library was measured.");
  text.line("\n| question | mesh | ours, us | count | library | setting | us | count | ratio | of processor's time |");
  text.line("|:--|:--|--:|--:|:--|:--|--:|--:|--:|--:|");
  for (const Row& row : rows_) {
    const std::string ours =
        fmt::format("| {} | {} | {} | {} |", row.question, row.mesh, digits(row.time.us), row.count);
    if (row.peers.empty()) text.line("{} | | | | | |", ours);
    for (const PeerTime& peer : row.peers) {
      text.line("{} {} | {} | {} | {} | {:.3g} | {:.3g} |", ours, peer.library, peer.setting, digits(peer.time.us),
                peer.count, peer.time.us / row.time.us, peer.time.processor_us / row.time.processor_us);
    }
  }
  if (!differences_.empty()) {
    text.line("\n## Answers\n\nPairs of triangles, and why they are in one of both answers alone.\n");
    text.line("| question | mesh | library | ours | theirs | in both | only ours | only theirs |");
    text.line("|:--|:--|:--|--:|--:|--:|:--|:--|");
  }
  for (const Difference& d : differences_) {
    text.line("| {} | {} | {} | {} | {} | {} | {} | {} |", d.question, d.mesh, d.library, d.ours, d.theirs, d.both,
              in_words(d.only_ours), in_words(d.only_theirs));
  }
  if (!point_differences_.empty()) {
    text.line("\n## Answers about points\n\nDistances next to ours. Lengths are parts of the mesh's size.\n");
    text.line(
        "| question | mesh | library | points | tolerance | agree | largest difference of these | others | by up to |");
    text.line("|:--|:--|:--|--:|--:|--:|--:|:--|--:|");
  }
  for (const PointDifference& d : point_differences_) {
    text.line("| {} | {} | {} | {} | {:.2g} | {} | {:.2g} | {} | {} |", d.question, d.mesh, d.library, d.points,
              d.tolerance, d.agree, d.largest_of_agreeing, in_words(d.others),
              d.largest > 0 ? fmt::format("{:.2g}", d.largest) : "");
  }
}

double diagonal(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return length(high - low);
}

}  // namespace limber::bench
