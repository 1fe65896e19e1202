// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Times of impact of moving models against brute force over all pairs of elements: in random scenes, of two models and
// of one with itself, on every instruction set, with separations and with budgets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "reference/reference.h"
#include "scenes/scenes.h"
#include "simd/kernels.h"
#include "support/keys.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

constexpr double no_time = std::numeric_limits<double>::infinity();

/// All that a first impact says, and the work.
auto with_stats(const ImpactResult& r) { return std::tuple(key_of(r), key_of(r.stats)); }

const auto by_ids = [](const Impact& p, const Impact& q) { return ids_of(p) < ids_of(q); };

std::vector<Impact> in_order(std::vector<Impact> impacts) {
  std::sort(impacts.begin(), impacts.end(), by_ids);
  return impacts;
}

/// Two meshes, or one that counts twice, and where they go.
struct MovingScene {
  Mesh mesh_a, mesh_b;
  std::vector<Vec3> end_a, end_b;
  Transform start_pose_a, start_pose_b, end_pose_a, end_pose_b;
  double size;  // a length that is not small next to the meshes
  ImpactOptions options;

  ElementImpactOptions of_elements() const { return {options.max_time, options.time_error, options.min_separation}; }
  std::vector<Impact> brute_force(const ElementImpactOptions& of_pairs) const {
    return reference::impacts({mesh_a, end_a, start_pose_a, end_pose_a}, {mesh_b, end_b, start_pose_b, end_pose_b},
                              of_pairs);
  }
  std::vector<Impact> self_brute_force(const ElementImpactOptions& of_pairs) const {
    return reference::self_impacts({mesh_a, end_a, start_pose_a, end_pose_a}, of_pairs);
  }
};

/// Where vertices go: far, hardly, as a whole, to lattice points, into a plane, some of them, inside out.
std::vector<Vec3> arbitrary_motion(Rng& rng, const Mesh& mesh, double scale) {
  const std::uint64_t kind = rng.below(9);
  const Vec3 common = uniform_point(rng, -4, 4);
  const double little = std::ldexp(1.0, -static_cast<int>(rng.below(40)));
  std::vector<Vec3> end;
  for (const Vec3& from : mesh.positions()) {
    const Vec3 p = from * (1 / scale), own = uniform_point(rng);
    const bool is_some = rng.below(4) == 0;
    const auto to = [&]() -> Vec3 {
      switch (kind) {
        case 0:
          return p + 4 * own;
        case 1:
          return p + little * own;
        case 2:
          return p + common;
        case 3:  // along an axis: faces that are parallel to a plane of coordinates touch all at once
          return p + Vec3{0, 0, std::round(common.z)};
        case 4:
          return {std::round(p.x + own.x), std::round(p.y + own.y), std::round(p.z + own.z)};
        case 5:
          return {p.x, p.y, common.z};
        case 6:
          return is_some ? p + own : p;
        case 7:
          return -p;
        default:
          return p;
      }
    };
    end.push_back(scale * to());
  }
  return end;
}

MovingScene arbitrary_moving_scene(Rng& rng) {
  const double scale = rng.below(4) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150) : 1;
  const Vec3 offset = rng.below(4) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
  const std::size_t most = rng.below(8) == 0 ? 100 : 20;
  const Mesh mesh_a = arbitrary_mesh(rng, most, offset, scale), mesh_b = arbitrary_mesh(rng, most, offset, scale);
  const std::vector<Vec3> end_a = arbitrary_motion(rng, mesh_a, scale), end_b = arbitrary_motion(rng, mesh_b, scale);
  Transform poses[4];
  for (Transform& pose : poses) {
    if (offset == Vec3{} && rng.below(3) == 0) pose = random_pose(rng, 3);
    pose.translation *= scale;
  }
  ImpactOptions options;
  if (rng.below(3) == 0) options.max_time = rng.below(2) == 0 ? rng.uniform() : std::ldexp(1.0, -20);
  if (rng.below(3) == 0) options.time_error = std::ldexp(1.1, -static_cast<int>(rng.below(50)));
  return {mesh_a, mesh_b, end_a, end_b, poses[0], poses[1], poses[2], poses[3], scale, options};
}

/// A sheet: a strip around a point, whose ends may come to lie over each other, a bent or a plane one. Its vertices go
/// their own ways, too, from hardly at all to past their neighbors; so most pairs of triangles are neighbors that stay
/// apart, and some hardly touch.
MovingScene moving_sheet(Rng& rng) {
  const auto columns = static_cast<std::uint32_t>(1 + rng.below(8)),
             rows = static_cast<std::uint32_t>(1 + rng.below(4));
  const Mesh plane = scenes::grid(columns, rows, 0, 0, 1.0 / columns, 1.0 / rows);
  const std::uint64_t kind = rng.below(3);
  const double inner = rng.below(2) == 0 ? 0.01 : rng.uniform(0.1, 2), rise = rng.below(2) == 0 ? 0 : rng.uniform();
  std::vector<Vec3> positions[2];
  const Transform pose = rng.below(2) == 0 ? Transform{} : random_pose(rng, 1);
  for (std::vector<Vec3>& to : positions) {
    const double span = rng.uniform(0.5, kind == 0 ? 7 : 3), noise = std::pow(10.0, rng.uniform(-4, 0)) / columns;
    for (const Vec3& p : plane.positions()) {
      const double angle = span * p.x, radius = inner + p.y;
      const Vec3 at = kind == 0   ? Vec3{radius * std::cos(angle), radius * std::sin(angle), rise * p.x}
                      : kind == 1 ? Vec3{std::sin(angle), p.y, std::cos(angle)}
                                  : p;
      to.push_back(pose(at + noise * uniform_point(rng)));
    }
  }
  const Mesh mesh = Mesh::create(positions[0], plane.triangles()).value();
  return {mesh, mesh, positions[1], positions[1], {}, {}, {}, {}, 1, {}};
}

/// Two neighbors. A corner of one goes through the other, or just past it, at the edge from the corner that they share.
/// Some are mirrored at that edge, so that the mean direction from one to the other is perpendicular to it.
MovingScene grazing_neighbors(Rng& rng) {
  const bool are_mirrored = rng.below(2) == 0;
  Vec3 p[5];
  for (Vec3& at : p) at = uniform_point(rng);
  if (are_mirrored) p[0].z = p[1].z = p[2].z = 0;
  const double nearly = std::pow(10.0, rng.uniform(-9, -5)) * (rng.below(4) == 0 ? -1 : 1),
               part = rng.uniform(0.2, 0.9);
  const Vec3 e = p[1] - p[0], f = p[2] - p[0], met = p[0] + part * e + nearly * f;
  Vec3 way{};
  way[are_mirrored ? 2 : rng.below(3)] = rng.uniform();
  p[3] = met + way;
  if (are_mirrored) p[4] = p[0] + (1 - part) * e + (2 * dot(e, f) / dot(e, e)) * e - f;
  std::vector<Vec3> end(p, p + 5);
  end[3] = met - way;
  const Mesh mesh = Mesh::create({p, p + 5}, {{0, 1, 2}, {4, 0, 3}}).value();
  return {mesh, mesh, end, end, {}, {}, {}, {}, 1, {}};
}

/// The queries of two models, or of one with itself.
struct ImpactQueries {
  Model model_a, model_b;
  MovingModel a, b;
  bool is_self;

  ImpactQueries(const MovingScene& s, bool self)
      : model_a(s.mesh_a), model_b(s.mesh_b), a(model_a), b(model_b), is_self(self) {
    a.set_motion(s.end_a, s.start_pose_a, s.end_pose_a).value();
    b.set_motion(s.end_b, s.start_pose_b, s.end_pose_b).value();
  }
  ImpactResult first(const ImpactOptions& options) const {
    return is_self ? self_time_of_impact(a, options) : time_of_impact(a, b, options);
  }
  std::vector<Impact> all(const ImpactOptions& options) const {
    std::vector<Impact> found;
    const auto visit = [&](const Impact& i) { return found.push_back(i), true; };
    const PairCount count = is_self ? visit_self_impacts(a, visit, options) : visit_impacts(a, b, visit, options);
    EXPECT_EQ(count.count, found.size());
    EXPECT_TRUE(count.is_complete);
    return found;
  }
};

/// The first time at which two elements of `truth` touch is in here.
ElementImpact first_of(const std::vector<Impact>& truth) {
  ElementImpact first;
  for (const Impact& i : truth) {
    first.lower = std::min(first.lower, i.time.lower), first.upper = std::min(first.upper, i.time.upper);
  }
  if (!truth.empty()) first.status = first.upper == 0 ? ImpactStatus::initial_contact : ImpactStatus::contact;
  return first;
}

/// Whether the first impact is right, where all impacts are those of `truth`, without an error in time.
void expect_first(const ImpactResult& found, const std::vector<Impact>& truth, double time_error) {
  const ElementImpact first = first_of(truth);
  EXPECT_EQ(found.status, first.status);
  if (truth.empty()) {
    EXPECT_EQ(found.lower, no_time);
    EXPECT_EQ(found.upper, no_time);
    EXPECT_FALSE(found.elements || found.witness);
    return;
  }
  EXPECT_LE(found.lower, first.upper);
  EXPECT_GE(found.upper, first.lower);
  EXPECT_LE(found.upper - found.lower, std::max(time_error, 0x1p-53));
  ASSERT_TRUE(found.elements && found.witness);
  const auto is_found = [&](const Impact& i) {
    return i.elements == *found.elements && i.time.lower <= found.upper && i.time.upper >= found.lower;
  };
  EXPECT_TRUE(std::any_of(truth.begin(), truth.end(), is_found)) << "these elements do not touch then";
}

/// Whether a query that has spent its budget is right.
void expect_interrupted(const ImpactResult& found, const std::vector<Impact>& truth) {
  const ElementImpact first = first_of(truth);
  EXPECT_EQ(found.stopped_by, StoppedBy::max_steps);
  EXPECT_LE(found.lower, first.upper);
  EXPECT_GE(found.upper, first.lower);
  EXPECT_LE(found.lower, found.upper);
}

/// Crossings at the start are those that the queries for pairs of triangles find; other answers do not change.
void check_crossings(const MovingScene& s, const ImpactQueries& queries, const ImpactResult& without) {
  const bool crosses = queries.is_self
                           ? self_collide(queries.model_a).is_yes()
                           : collide({queries.model_a, s.start_pose_a}, {queries.model_b, s.start_pose_b}).is_yes();
  const ImpactResult found = queries.first(s.options);
  if (crosses) {
    EXPECT_EQ(found.status, ImpactStatus::initial_contact);
    EXPECT_EQ(found.upper, 0);
  } else {
    EXPECT_EQ(found.status, without.status);
    EXPECT_EQ(found.lower, without.lower);
  }
}

/// How many scenes were compared, and what they were.
struct ImpactTotals {
  std::size_t scenes = 0, impacts = 0, initial = 0, clear = 0, interrupted = 0;

  void expect_many() const {
    EXPECT_GT(impacts, 10 * scenes);
    EXPECT_GT(initial, scenes / 100);
    EXPECT_GT(clear, scenes / 10);
    EXPECT_GT(interrupted, scenes / 20);
  }
};

/// `truth` has all impacts as asked, `exact` those without an error in time.
void check(Rng& rng, const MovingScene& s, const ImpactQueries& queries, const std::vector<Impact>& truth,
           const std::vector<Impact>& exact, ImpactTotals& totals) {
  ImpactOptions options = s.options;
  options.ignore_crossings = true;
  const std::vector<Impact> all = queries.all(options);
  simd::use_kernels(&simd::scalar_kernels);
  const ImpactResult first = queries.first(options);
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    EXPECT_EQ(with_stats(queries.first(options)), with_stats(first)) << set.name;
  }
  simd::use_kernels(nullptr);
  const std::vector<Impact> sorted = in_order(all), expected = in_order(truth);
  ASSERT_EQ(sorted.size(), expected.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) EXPECT_EQ(key_of(sorted[i]), key_of(expected[i]));
  expect_first(first, exact, options.time_error);
  check_crossings(s, queries, first);
  options.any_contact = true;
  const ImpactResult any = queries.first(options);
  EXPECT_EQ(any.status == ImpactStatus::clear, truth.empty());
  EXPECT_LE(any.lower, first.upper);
  EXPECT_GE(any.upper, first.lower);
  options.any_contact = false;
  options.budget.max_steps = rng.below(40);
  const ImpactResult short_of_steps = queries.first(options);
  if (short_of_steps.status == ImpactStatus::undecided) {
    expect_interrupted(short_of_steps, exact);
    ++totals.interrupted;
  } else {
    EXPECT_EQ(with_stats(short_of_steps), with_stats(first));
  }
  ++totals.scenes, totals.impacts += truth.size();
  totals.initial += first.status == ImpactStatus::initial_contact ? 1 : 0;
  totals.clear += truth.empty() ? 1 : 0;
}

/// With a separation all impacts are those of brute force, but for elements that just come that near. Separations of
/// slivers are rounded up by more than others.
void check_separation(const MovingScene& s, const ImpactQueries& queries, double separation) {
  ImpactOptions options = s.options;
  options.min_separation = separation;
  ElementImpactOptions of_pairs{options.max_time, options.time_error, separation};
  const auto brute_force = [&] { return queries.is_self ? s.self_brute_force(of_pairs) : s.brute_force(of_pairs); };
  const std::vector<Impact> found = in_order(queries.all(options)), truth = in_order(brute_force());
  of_pairs.min_separation = separation * (1 - 0x1p-12);
  const std::vector<Impact> nearer = in_order(brute_force());
  EXPECT_TRUE(std::includes(truth.begin(), truth.end(), found.begin(), found.end(), by_ids)) << "no impact";
  EXPECT_TRUE(std::includes(found.begin(), found.end(), nearer.begin(), nearer.end(), by_ids)) << "one is missing";
  options.ignore_crossings = true;
  const ImpactResult first = queries.first(options);
  EXPECT_EQ(first.status == ImpactStatus::clear, found.empty());
  EXPECT_LE(first.lower, first_of(nearer).upper);
  of_pairs.min_separation = separation * (1 + 0x1p-12);
  EXPECT_GE(first.upper, first_of(brute_force()).lower);
}

/// All pairs that touch are candidates.
void check_candidates(const MovingScene& s, const ImpactQueries& queries, const std::vector<Impact>& truth) {
  std::vector<Impact> found;
  const auto visit = [&](const ElementPair& pair) { return found.push_back({pair, {}}), true; };
  const PairCount count = queries.is_self ? visit_self_impact_candidates(queries.a, visit, s.options)
                                          : visit_impact_candidates(queries.a, queries.b, visit, s.options);
  EXPECT_EQ(count.count, found.size());
  const std::vector<Impact> sorted = in_order(found), expected = in_order(truth);
  const auto same_ids = [](const Impact& p, const Impact& q) { return ids_of(p) == ids_of(q); };
  EXPECT_TRUE(std::includes(sorted.begin(), sorted.end(), expected.begin(), expected.end(), by_ids));
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end(), same_ids), sorted.end()) << "a pair came twice";
}

template <typename Draw>
ImpactTotals check_scenes(std::uint64_t seed, bool is_self, std::uint64_t least_count, const Draw& draw) {
  const std::uint64_t count =
      count_from("LIMBER_IMPACT_SCENES", least_count);  // more by hand than with all other tests
  Rng rng(seed);
  ImpactTotals totals;
  for (std::uint64_t i = 0; i < count && !::testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const MovingScene s = draw(rng);
    const ImpactQueries queries(s, is_self);
    const auto brute_force = [&](const ElementImpactOptions& of_pairs) {
      return is_self ? s.self_brute_force(of_pairs) : s.brute_force(of_pairs);
    };
    const std::vector<Impact> truth = brute_force(s.of_elements());
    check(rng, s, queries, truth, s.options.time_error == 0 ? truth : brute_force({s.options.max_time, 0, 0}), totals);
    check_candidates(s, queries, truth);
    if (i % 8 == 0) check_separation(s, queries, s.size * std::ldexp(1.0, -static_cast<int>(rng.below(12))));
  }
  return totals;
}

TEST(ImpactProperty, OfTwoModelsIsThatOfBruteForce) {
  check_scenes(3201, false, 60, arbitrary_moving_scene).expect_many();
}
TEST(ImpactProperty, OfOneModelIsThatOfBruteForce) {
  check_scenes(3202, true, 60, arbitrary_moving_scene).expect_many();
}
TEST(ImpactProperty, OfNeighborsIsThatOfBruteForce) {
  for (const ImpactTotals& totals :
       {check_scenes(3203, true, 1000, moving_sheet), check_scenes(3204, true, 2000, grazing_neighbors)}) {
    EXPECT_GT(totals.impacts, totals.scenes / 2);
    EXPECT_GT(totals.clear, totals.scenes / 10);
    EXPECT_LT(totals.clear, totals.scenes - totals.scenes / 10);
  }
}

}  // namespace
}  // namespace limber::testing
