// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  Do this build, this processor and this number of threads answer as others do?
// Workload  Queries of every kind (scenes/answer_hash.cpp), some 4 000 for each unit of --scale.
// Metric    A hash of all answers of each kind, and one of them all.
// Expected  The same hashes on all instruction sets and numbers of threads, as the tests demand at scale 1; and for all
//           compilers and revisions that do not mean to change an answer.
#include <CLI/CLI.hpp>

#include "bench/support/report.h"
#include "limber/base.h"
#include "scenes/scenes.h"

int main(int argc, char** argv) {
  using namespace limber;
  std::uint32_t scale = 50;
  const auto run = [&](const bench::Options& options, bench::Checker&) {
    bench::Table table(options, "answers.md");
    table.line("| queries | how many | hash, on {} |\n|:--|--:|:--|", instruction_set());
    const std::vector<scenes::AnswerHash> hashes = scenes::answer_hashes(scale);
    std::uint64_t queries = 0;
    for (const scenes::AnswerHash& h : hashes) {
      table.line("| {} | {} | {:016x} |", h.kind, h.queries, h.hash);
      queries += h.queries;
    }
    table.line("| all | {} | {:016x} |", queries, scenes::total(hashes));
  };
  return bench::run_bench(argc, argv, "A hash of the answers to queries of every kind.", run,
                          [&](CLI::App& app) { app.add_option("--scale", scale, "how many queries there are"); });
}
