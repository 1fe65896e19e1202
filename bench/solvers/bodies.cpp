// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do the contacts of all pairs of many falling bodies cost a solver, in each of its frames?
// Workload        2 000 bodies, balls of 1 088 triangles, boxes and rings, that have fallen into a heap: each touches
//                 some of its neighbors, and moves and turns a little in each frame. The margin is a hundredth of a
//                 radius.
// Metric          Time of a frame by the number of its contacts: poses set, commit, candidate pairs, contacts of all
//                 pairs. Frames on one thread and on two take turns. Least and median.
// Expected shape  A microsecond or less a contact; twice as fast on two threads.
// Checked         The contacts are those of visit_contacts() for each pair, on one thread and on two.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/solvers/heap.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/contacts.h"
#include "limber/scene.h"

namespace limber::bench {
namespace {

constexpr double margin = 0.01;

bool are_same(const Contact& s, const Contact& t) {
  return s.triangle_a == t.triangle_a && s.triangle_b == t.triangle_b && s.distance == t.distance &&
         s.depth == t.depth && s.point_a == t.point_a && s.point_b == t.point_b && s.normal == t.normal;
}

/// Whether the contacts are those of each pair alone.
void check_contacts(const Scene& scene, std::span<const ObjectPair> pairs, const ObjectContacts& all,
                    Checker& checker) {
  std::vector<Contact> expected;
  for (const ObjectPair& pair : pairs) {
    visit_contacts(scene.object(pair.a), scene.object(pair.b), margin,
                   [&](const Contact& contact) { return expected.push_back(contact), true; });
  }
  checker.check(std::equal(all.contacts.begin(), all.contacts.end(), expected.begin(), expected.end(), are_same),
                "{} contacts of all pairs, {} pair by pair, or others", all.contacts.size(), expected.size());
}

void run(const Options& options, Checker& checker) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, 2);
  Heap heap;
  std::vector<ObjectPair> pairs(64 * heap.ids.size());
  std::vector<double> us_a_contact[2], processor_us_a_contact[2];
  ObjectContacts found;
  std::size_t pair_count = 0, contact_count = 0;
  oneapi::tbb::task_arena arenas[2] = {oneapi::tbb::task_arena(1), oneapi::tbb::task_arena(2)};
  for (int frame = 0, frames = options.quick ? 2 : 30; frame < frames; ++frame) {
    heap.move();
    for (std::size_t k = 0; k < 2; ++k) {
      const Stopwatch watch;
      const std::clock_t before = std::clock();
      arenas[k].execute([&] {
        heap.scene.set_poses(heap.ids, heap.poses);
        heap.scene.commit();
        pair_count = heap.scene.candidate_pairs(margin, pairs).count;
        heap.scene.contacts(std::span(pairs).first(pair_count), margin, found);
      });
      const double us = watch.us(), processor_us = 1e6 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
      contact_count = found.contacts.size();
      us_a_contact[k].push_back(us / static_cast<double>(contact_count));
      processor_us_a_contact[k].push_back(processor_us / static_cast<double>(contact_count));
      if (frame == 0) check_contacts(heap.scene, std::span(pairs).first(pair_count), found, checker);
    }
  }
  if (!checker.all_right()) return;
  Table text(options, "bodies.md");
  text.line("# Contacts of a heap of bodies, as printed by `limber_bench_bodies`\n");
  text.line("{} bodies, {} candidate pairs, {} contacts within a hundredth of a radius in the last frame.\n",
            heap.ids.size(), pair_count, contact_count);
  text.line("| threads | us a contact, least | median | of processors, least | median | times as fast |");
  text.line("|--:|--:|--:|--:|--:|--:|");
  const Summary one = summarize(us_a_contact[0]);
  for (std::size_t k = 0; k < 2; ++k) {
    const Summary us = summarize(us_a_contact[k]), processor = summarize(processor_us_a_contact[k]);
    text.line("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |", k + 1, us.min, us.median, processor.min,
              processor.median, one.median / us.median);
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What do the contacts of all pairs of many falling bodies cost?",
                                  limber::bench::run);
}
