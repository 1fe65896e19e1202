// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does a query cost at a given separation, and what do the kind of answer and contact do to it?
// Workload        A ball of 1024 triangles and diameter 2 over a flat square of 8192 triangles and 8 x 8 units, from 64
//                 units of separation down to 1 unit of penetration. Collision, exact distance, approximate distance;
//                 the classic sphere tree; one thread.
// Metric          Time per query: minimum, median and 99th percentile over rounds in each of which every query runs
//                 once at every separation. Beside them the pairs of spheres and of triangles compared.
// Expected shape  Collision: next to nothing far away, steeply up towards contact, sharply down in contact. Exact
//                 distance: most expensive far away, where all pairs are alike, and ever cheaper down into contact.
//                 Approximate distance: like collision from afar, like exact distance close by, cheaper the larger the
//                 error allowed.
// Checked         Before anything is timed: exact distance against the separation known by construction, contact
//                 against its sign, approximate answers against their error, witness points against the distance, and
//                 two separations against brute force.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "reference/classic/classic.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

constexpr std::array separations = {64.0, 32.0, 16.0,  8.0, 4.0,    2.0,  1.0,  0.5, 0.25,
                                    0.1,  0.01, 0.001, 0.0, -0.001, -0.1, -0.5, -1.0};
constexpr std::array brute_force_separations = {0.1, -0.1};
constexpr double tolerance = 8 * 1e-12;  // 1e-12 of the square's edge

struct Query {
  const char* name;
  double relative_error;  // of a distance; collisions have none

  bool is_collision() const { return std::string_view(name) == "collide"; }
};
constexpr std::array<Query, 6> queries = {
    {{"collide", 0}, {"distance", 0}, {"distance", 0.01}, {"distance", 0.1}, {"distance", 0.5}, {"distance", 1}}};

struct Scene {
  classic::Model square{scenes::thesis_square()};
  classic::Model ball{scenes::thesis_ball()};
};

/// One query's answer in the terms all queries share.
struct Answer {
  bool collision = false;
  DistanceResult distance;  // of a collision query only the counters
};

Answer ask(const Scene& scene, const Query& query, const Transform& pose) {
  const classic::Placed square{scene.square}, ball{scene.ball, pose};
  Answer answer;
  if (query.is_collision()) {
    const CollideResult result = classic::collide(square, ball);
    answer.collision = result.is_yes();
    answer.distance.stats = result.stats;
  } else {
    answer.distance = classic::distance(square, ball, {.relative_error = query.relative_error});
    answer.collision = answer.distance.status == DistanceStatus::collision;
  }
  return answer;
}

/// One query at one separation.
struct Case {
  Query query;
  double separation;
  Transform pose;
  Answer answer;
  std::size_t repetitions = 1;
  std::vector<double> samples_us;

  std::string name() const {
    return fmt::format("{} with error {} at {}", query.name, query.relative_error, separation);
  }
};

std::vector<Case> all_cases(const Scene& scene) {
  std::vector<Case> cases;
  for (const double separation : separations) {
    const Transform pose = scenes::ball_over_square(scene.ball.mesh(), separation, 0);
    for (const Query& query : queries) cases.push_back({query, separation, pose, {}, 1, {}});
  }
  return cases;
}

void check_witness(Checker& checker, const Scene& scene, const Case& c) {
  const Witness& w = *c.answer.distance.witness;
  const Triangle on_square = scene.square.mesh().triangle(w.triangle_a);
  const Triangle model = scene.ball.mesh().triangle(w.triangle_b);
  const Triangle on_ball{c.pose(model.v0), c.pose(model.v1), c.pose(model.v2)};
  checker.check(closest_points(w.point_a, on_square).distance <= tolerance &&
                    closest_points(w.point_b, on_ball).distance <= tolerance,
                "{}: a witness point is off its triangle", c.name());
  const double apart = length(w.point_a - w.point_b);
  checker.check(std::abs(apart - c.answer.distance.upper) <= tolerance, "{}: witness {} apart, distance {}", c.name(),
                apart, c.answer.distance.upper);
}

/// Checks against the distance `truth`. Models at distance 0 are only certain to meet when they overlap.
void check_against(Checker& checker, const Case& c, double truth, bool contact_is_certain) {
  if (contact_is_certain) {
    checker.check(c.answer.collision == (truth == 0), "{}: collision is {}", c.name(), c.answer.collision);
  }
  if (c.query.is_collision()) return;
  const DistanceResult& result = c.answer.distance;
  checker.check(result.upper >= truth - tolerance && result.upper <= truth * (1 + c.query.relative_error) + tolerance,
                "{}: {} instead of {}", c.name(), result.upper, truth);
  checker.check(result.lower <= truth + tolerance, "{}: lower bound {} above {}", c.name(), result.lower, truth);
  checker.check(c.answer.collision == (result.upper == 0), "{}: status against distance", c.name());
}

void answer_and_check(Checker& checker, const Scene& scene, std::vector<Case>& cases) {
  bool collides = false;
  for (Case& c : cases) {
    const Stopwatch watch;
    c.answer = ask(scene, c.query, c.pose);
    c.repetitions = repetitions_for(watch.us());
    check_against(checker, c, std::max(c.separation, 0.0), c.separation != 0);
    if (c.query.is_collision()) {
      collides = c.answer.collision;  // the first query at each separation
    } else {
      checker.check(c.answer.collision == collides, "{}: distance {} although collide says {}", c.name(),
                    c.answer.distance.upper, collides);
      check_witness(checker, scene, c);
    }
  }
}

void check_by_brute_force(Checker& checker, const Scene& scene, const std::vector<Case>& cases) {
  for (const double separation : brute_force_separations) {
    const Transform pose = scenes::ball_over_square(scene.ball.mesh(), separation, 0);
    const reference::Placed square{scene.square.mesh()}, ball{scene.ball.mesh(), pose};
    const double truth = reference::distance(square, ball).upper;
    checker.check(reference::collide(square, ball).is_yes() == (truth == 0), "brute force contradicts itself");
    for (const Case& c : cases) {
      if (c.separation == separation) check_against(checker, c, truth, true);
    }
  }
}

void time_rounds(Checker& checker, const Scene& scene, std::vector<Case>& cases, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Case& c : cases) {
      std::uint64_t node_tests = 0;
      c.samples_us.push_back(
          mean_us(c.repetitions, [&] { node_tests += ask(scene, c.query, c.pose).distance.stats.node_tests; }));
      checker.check(node_tests == c.repetitions * c.answer.distance.stats.node_tests, "{}: not repeatable", c.name());
    }
  }
}

void report(const Options& options, const std::vector<Case>& cases) {
  Table csv(options, "thesis_queries.csv");
  csv.line("query,relative_error,separation,min_us,median_us,p99_us,node_tests,primitive_tests,upper");
  for (const Case& c : cases) {
    const Summary us = summarize(c.samples_us);
    const QueryStats& stats = c.answer.distance.stats;
    csv.line("{},{},{},{:.4f},{:.4f},{:.4f},{},{},{}", c.query.name, c.query.relative_error, c.separation, us.min,
             us.median, us.p99, stats.node_tests, stats.primitive_tests,
             c.query.is_collision() ? "" : fmt::format("{}", c.answer.distance.upper));
  }
}

void run(const Options& options, Checker& checker) {
  const int rounds = options.quick ? 3 : 61;
  const Scene scene;
  std::vector<Case> cases = all_cases(scene);
  answer_and_check(checker, scene, cases);
  check_by_brute_force(checker, scene, cases);
  if (!checker.all_right()) return;

  time_rounds(checker, scene, cases, rounds);
  if (!checker.all_right()) return;

  report(options, cases);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "Time per query against the separation of ball and square",
                                  limber::bench::run);
}
