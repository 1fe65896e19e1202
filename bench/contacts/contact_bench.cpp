// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/contacts/contact_bench.h"

#include <chrono>
#include <ctime>
#include <thread>

#include "bench/support/sampling.h"
#include "limber/contacts.h"

namespace limber::bench {
namespace {

PeerTime as_time(const std::string& library, const PeerRow& row) {
  const std::string key = "processor=";
  const std::size_t at = row.details.find(key);
  const double processor_us = at == std::string::npos ? 0 : std::stod(row.details.substr(at + key.size()));
  return {library, row.setting(), row.count, {row.us, processor_us}};
}

/// The times of some calls.
class Samples {
 public:
  void take(const std::function<void()>& call) {
    const std::clock_t before = std::clock();
    const Stopwatch watch;
    call();
    us_.push_back(watch.us());
    processor_us_.push_back(1e6 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    sum_us_ += us_.back();
  }
  double sum_us() const { return sum_us_; }
  Timed medians() const { return {summarize(us_).median, summarize(processor_us_).median}; }

 private:
  std::vector<double> us_, processor_us_;
  double sum_us_ = 0;
};

}  // namespace

ContactBench::ContactBench(const Settings& settings)
    : settings_(settings), rows_of_peers_(read_peer_rows(settings.peers)), runs_(settings.options.quick ? 3 : 15) {}

int ContactBench::report() const {
  if (checker_.all_right()) write_tables(settings_.options, rows_of_peers_, rows_, differences_, point_differences_);
  return checker_.all_right() ? 0 : 1;
}

Timed ContactBench::time(const std::function<void()>& call, const std::function<void()>& prepare) const {
  Samples samples;
  for (int run = -1; run < runs_ && (run < 3 || samples.sum_us() < 2e6); ++run) {
    if (prepare) prepare();
    run < 0 ? call() : samples.take(call);
  }
  return samples.medians();
}

std::vector<Timed> ContactBench::time_in_turn(const std::vector<std::function<void()>>& calls) const {
  std::vector<Samples> samples(calls.size());
  for (int run = -1; run < 7 * runs_ && (run < 3 || samples.front().sum_us() < 2e6); ++run) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      // Until other threads of the call before have gone to sleep: their waiting counts as processor's time.
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      run < 0 ? calls[i]() : samples[i].take(calls[i]);
    }
  }
  std::vector<Timed> times;
  for (const Samples& of_call : samples) times.push_back(of_call.medians());
  return times;
}

std::optional<IdPairs> ContactBench::pairs_of(const std::string& file) const {
  return settings_.answers.empty() ? std::nullopt : read_pairs(settings_.answers / (file + ".txt"));
}

std::optional<IdPairs> ContactBench::ipc_pairs_of(const std::string& mesh, MeshView view) const {
  if (settings_.answers.empty()) return std::nullopt;
  return read_ipc_pairs(settings_.answers / ("ipctk_" + mesh + "_edge_edge.txt"),
                        settings_.answers / ("ipctk_" + mesh + "_face_vertex.txt"), view);
}

void ContactBench::add_peer(Row& row, const std::string& library, const std::string& peer, const std::string& mesh,
                            const std::string& question, const std::string& part) const {
  if (const auto found = fastest(rows_of_peers_, peer, mesh, question, part))
    row.peers.push_back(as_time(library, *found));
}

void ContactBench::add_both_parts(Row& row, const std::string& mesh) const {
  const auto candidates = fastest(rows_of_peers_, "ipctk", mesh, "candidates", "LBVH; inflation=0.0005 of");
  const auto distances = fastest(rows_of_peers_, "ipctk", mesh, "distances");
  if (!candidates || !distances) return;
  PeerTime both = as_time("IPC Toolkit, candidates and distances", *distances);
  const PeerTime first = as_time("", *candidates);
  both.setting = "LBVH", both.time.us += first.time.us, both.time.processor_us += first.time.processor_us;
  row.peers.push_back(both);
}

double diagonal(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return length(high - low);
}

IdPairs self_pairs_within(const Model& model, double margin) {
  IdPairs pairs;
  visit_self_contacts(model, margin,
                      [&](const Contact& c) { return pairs.emplace_back(c.triangle_a, c.triangle_b), true; });
  sort_pairs(pairs);
  return pairs;
}

IdPairs pairs_within(const Placed& a, const Placed& b, double margin) {
  IdPairs pairs;
  visit_contacts(a, b, margin, [&](const Contact& c) { return pairs.emplace_back(c.triangle_a, c.triangle_b), true; });
  sort_pairs(pairs);
  return pairs;
}

}  // namespace limber::bench
