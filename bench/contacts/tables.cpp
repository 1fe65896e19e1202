// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/contacts/tables.h"

#include <map>

namespace limber::bench {
namespace {

std::string in_words(const std::map<std::string, std::size_t>& reasons) {
  std::string text;
  for (const auto& [reason, count] : reasons) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, reason);
  return text.empty() ? "0" : text;
}

/// A number with at least three digits, without an exponent.
std::string digits(double value) {
  return value >= 100 ? fmt::format("{:.0f}", value) : value > 0 ? fmt::format("{:.3g}", value) : "";
}

void write_differences(Markdown& text, const std::vector<Difference>& differences) {
  text.line("\n## Answers\n\nPairs of triangles, and why they are in one of both answers alone.\n");
  text.line("| question | mesh | library | ours | theirs | in both | only ours | only theirs |");
  text.line("|:--|:--|:--|--:|--:|--:|:--|:--|");
  for (const Difference& d : differences) {
    text.line("| {} | {} | {} | {} | {} | {} | {} | {} |", d.question, d.mesh, d.library, d.ours, d.theirs, d.both,
              in_words(d.only_ours), in_words(d.only_theirs));
  }
}

void write_point_differences(Markdown& text, const std::vector<PointDifference>& differences) {
  text.line("\n## Answers about points\n\nDistances next to ours. Lengths are parts of the mesh's size.\n");
  text.line(
      "| question | mesh | library | points | tolerance | agree | largest difference of these | others | by up to |");
  text.line("|:--|:--|:--|--:|--:|--:|--:|:--|--:|");
  for (const PointDifference& d : differences) {
    text.line("| {} | {} | {} | {} | {:.2g} | {} | {:.2g} | {} | {} |", d.question, d.mesh, d.library, d.points,
              d.tolerance, d.agree, d.largest_of_agreeing, in_words(d.others),
              d.largest > 0 ? fmt::format("{:.2g}", d.largest) : "");
  }
}

}  // namespace

void write_tables(const Options& options, const std::vector<PeerRow>& rows_of_peers, const std::vector<Row>& rows,
                  const std::vector<Difference>& differences, const std::vector<PointDifference>& point_differences) {
  Markdown text(options, "contacts.md");
  CsvFile csv(options, "contacts.csv",
              "question,mesh,us_median,processor_us_median,count,library,setting,library_us_median,"
              "library_processor_us_median,library_count,ratio,ratio_processor");
  text.line("# Pairs of triangles and closest points, as printed by `limber_bench_contacts`\n");
  text.line(
      "Medians in us, on one thread unless a row says two; `points` are all of one call. Ratios are those of the");
  text.line(
      "other library to ours: by the clock, and by the processor's time. [README](../../contacts/README.md) says what "
      "each");
  text.line("library answers.\n");
  for (const PeerRow& row : rows_of_peers) {
    if (row.question == "version" || row.question == "processor") {
      text.line("- {}: {}", row.peer == "machine" ? "other libraries measured on" : row.peer, row.details);
    }
  }
  if (rows_of_peers.empty()) text.line("No other library was measured.");
  text.line("\n| question | mesh | ours, us | count | library | setting | us | count | ratio | of processor's time |");
  text.line("|:--|:--|--:|--:|:--|:--|--:|--:|--:|--:|");
  for (const Row& row : rows) {
    const std::string ours =
        fmt::format("| {} | {} | {} | {} |", row.question, row.mesh, digits(row.time.us), row.count);
    const std::string values = fmt::format("\"{}\",{},{:.6g},{},{}", row.question, row.mesh, row.time.us,
                                           digits(row.time.processor_us), row.count);
    if (row.peers.empty()) {
      text.line("{} | | | | | |", ours);
      csv.row("{},,,,,,,", values);
    }
    for (const PeerTime& peer : row.peers) {
      const double ratio = peer.time.us / row.time.us, of_processor = peer.time.processor_us / row.time.processor_us;
      text.line("{} {} | {} | {} | {} | {:.3g} | {:.3g} |", ours, peer.library, peer.setting, digits(peer.time.us),
                peer.count, ratio, of_processor);
      csv.row("{},\"{}\",{},{:.6g},{:.6g},{},{:.4g},{:.4g}", values, peer.library, peer.setting, peer.time.us,
              peer.time.processor_us, peer.count, ratio, of_processor);
    }
  }
  if (!differences.empty()) write_differences(text, differences);
  if (!point_differences.empty()) write_point_differences(text, point_differences);
}

}  // namespace limber::bench
