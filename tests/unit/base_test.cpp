// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/check.h"
#include "base/error_free.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "base/rounding.h"
#include "bvh/tree.h"
#include "limber/base.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "limber/penetration.h"
#include "limber/points.h"
#include "scenes/scenes.h"
#include "support/random_scene.h"
#include "unit/internals.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace limber::testing {
namespace {

TEST(Result, HoldsAValueOrAnErrorThatItThrows) {
  const Result<int> good = 7;
  ASSERT_TRUE(static_cast<bool>(good));
  EXPECT_EQ(*good, 7);
  EXPECT_EQ(good.value(), 7);
  const Result<int> bad = Error{ErrorCode::non_finite, "vertex 4 is not finite", 4};
  ASSERT_FALSE(static_cast<bool>(bad));
  EXPECT_EQ(bad.error().where, 4U);
  try {
    static_cast<void>(bad.value());
    FAIL() << "no exception";
  } catch (const BadResult& e) {
    EXPECT_STREQ(e.what(), "vertex 4 is not finite");
    EXPECT_EQ(e.error().code, ErrorCode::non_finite);
  }
  const Result<void> nothing = Error{ErrorCode::too_large, "x", {}};
  EXPECT_THROW(nothing.value(), BadResult);
  EXPECT_NO_THROW(Result<void>().value());
  Result<std::unique_ptr<int>> owner = std::make_unique<int>(5);
  EXPECT_EQ(*std::move(owner).value(), 5);
}

TEST(AssertHandler, ThrowsByDefaultAndCanBeReplaced) {
  static const char* seen = nullptr;
  const AssertHandler previous =
      set_assert_handler([](const char* expression, const char*, int) { seen = expression; });
  base::report_violation("1 == 2", "file.cpp", 3);
  set_assert_handler(previous);
  EXPECT_STREQ(seen, "1 == 2");
  EXPECT_THROW(base::report_violation("1 == 2", "file.cpp", 3), std::logic_error);
}

TEST(Rounding, DistancesErrOnTheirSide) {
  const Vec3 a{1, 1, 1}, b{2, 2, 2};
  EXPECT_GT(base::distance_up(a, b), std::sqrt(3.0));
  EXPECT_LT(base::distance_down(a, b), std::sqrt(3.0));
  EXPECT_EQ(base::distance_up(a, a), 0);
  EXPECT_GE(base::distance_up({0, 0, 0}, {1e-200, 1e-200, 1e-200}), 1.7e-200);
  EXPECT_EQ(base::distance_down({0, 0, 0}, {1e-200, 0, 0}), 0);
  EXPECT_LE(base::distance_down({0, 0, 0}, {1.72e-162, 0, 0}), 1.72e-162);  // the square rounds up to a subnormal
}

TEST(Decoded, IsTheNumber) {
  const double numbers[] = {
      1, -1, 0.1, 6, 0x1p200, std::numeric_limits<double>::max(), 0x1p-1022, 0x1.8p-1023, 0x1p-1074, -0x1.fffp-1060};
  for (const double x : numbers) {
    const base::Decoded d(x);
    EXPECT_EQ(std::ldexp(static_cast<double>(d.m), d.exponent), x);
    EXPECT_NE(d.m % 2, 0) << x;
    if (d.exponent < 8 && d.exponent > -8) {
      EXPECT_EQ(d.in<std::int64_t>(-8), std::ldexp(x, 8)) << x;
    }
  }
  EXPECT_EQ(base::Decoded(0).m, 0);
  EXPECT_EQ(base::Decoded(-0.0).in<std::int64_t>(-8), 0);
}

/// Calls something in arenas of one, two and five threads, also where the machine has fewer.
template <typename Call>
void in_small_arenas(const Call& call) {
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 5);
  for (const int threads : {1, 2, 5}) oneapi::tbb::task_arena(threads).execute(call);
}

TEST(ParallelInOrder, TakesEachInOrderAndMakesIntoWhatIsLeft) {
  in_small_arenas([] {
    for (const std::size_t count : {0, 1, 2, 1000}) {
      std::vector<std::size_t> taken;
      std::atomic<int> filled{0};
      // The first one ends after two others. The thread that has made one of these has taken it before it makes the
      // next, if it may be taken before the first. If no second thread comes, the first one does not wait for ever.
      const bool is_overtaken = count > 2 && base::has_several_threads();
      std::atomic<int> made_by_others{0};
      const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      const auto make = [&](std::size_t i, std::vector<std::size_t>& made) {
        if (!made.empty()) ++filled;
        while (i == 0 && is_overtaken && made_by_others < 2 && std::chrono::steady_clock::now() < give_up) {
          std::this_thread::yield();
        }
        made.push_back(i);
        if (i > 0) ++made_by_others;
      };
      const auto take = [&](std::vector<std::size_t>& made) {
        taken.insert(taken.end(), made.begin(), made.end());
        made.clear();
      };
      base::parallel_in_order<std::vector<std::size_t>>(count, make, take);
      std::vector<std::size_t> expected(count);
      std::iota(expected.begin(), expected.end(), std::size_t{0});
      EXPECT_EQ(taken, expected);
      EXPECT_EQ(filled, 0);
    }
  });
}

TEST(ParallelInOrder, PassesOnWhatIsThrown) {
  in_small_arenas([] {
    for (const bool in_take : {false, true}) {
      std::size_t taken = 0;
      const auto make = [&](std::size_t i, std::size_t& made) {
        if (!in_take && i == 50) throw std::runtime_error("made");
        made = i;
      };
      const auto take = [&](std::size_t& made) {
        if (in_take && made == 50) throw std::runtime_error("taken");
        EXPECT_EQ(made, taken++);
      };
      EXPECT_THROW(base::parallel_in_order<std::size_t>(100, make, take), std::runtime_error);
      EXPECT_LE(taken, 50U);
    }
  });
}

// --- the floating-point environment ---

/// A floating-point environment that a calling program may have set: a rounding mode, or flushing of subnormal numbers.
struct Environment {
  std::string name;
  std::function<void()> enter, leave;
};

std::vector<Environment> foreign_environments() {
  std::vector<Environment> all;
  for (const auto& [name, mode] :
       {std::pair("upward", FE_UPWARD), std::pair("downward", FE_DOWNWARD), std::pair("toward zero", FE_TOWARDZERO)}) {
    all.push_back({name, [rounding = mode] { std::fesetround(rounding); }, [] { std::fesetround(FE_TONEAREST); }});
  }
#if defined(__x86_64__)
  constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x40;
  all.push_back({"subnormals flushed", [] { _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero); },
                 [] { _mm_setcsr(_mm_getcsr() & ~(flush_to_zero | denormals_are_zero)); }});
#endif
  return all;
}

/// The bits of all answers of the library about a scene. They must not depend on the environment of the caller.
std::vector<std::uint64_t> answers(const RandomScene& s, Rng rng) {
  std::vector<std::uint64_t> bits;
  const auto put = [&bits](const auto& value) {
    bits.push_back(0);
    std::memcpy(&bits.back(), &value, sizeof(value));
  };
  const auto put_distance = [&](const DistanceResult& r) {
    put(r.lower), put(r.upper), put(r.witness.value().point_a.x), put(r.witness->triangle_b);
  };
  Model model_a(s.mesh_a);
  const Model model_b(s.mesh_b);
  const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
  put_distance(distance(a, b));
  put_distance(distance(a, b, {.relative_error = 0.25}));
  put(collide(a, b).is_yes()), put(within(a, b, 0).is_yes());
  QueryCache first, second, third;
  put_distance(distance(a, b, {.cache = &first})), put_distance(distance(a, b, {.cache = &first}));
  const double limit = distance(a, b, {.cache = &first}).upper;
  put(collide(a, b, {.cache = &second}).is_yes()), put(collide(a, b, {.cache = &second}).stats.node_tests);
  const CollideResult near = within(a, b, limit), near_again = within(a, b, limit, {.cache = &third});
  put(near.is_yes()), put(near.witness.value_or(Witness{}).point_a.y);
  put(near_again.is_yes()), put(near_again.witness.value_or(Witness{}).point_a.y);
  std::vector<Contact> found(100);
  const std::size_t count = contacts(a, b, limit, found).count;
  put(count), put(found[0].point_a.x), put(found[0].normal.z);
  const std::span reduced = std::span(found).first(std::min(count, found.size()));
  put(reduce_contacts(reduced, 1));
  put(closest_pairs(a, b, found).count), put(found[0].point_b.y);
  put(intersections(a, b, {}).count), put(self_intersections(model_a, {}).count), put(self_collide(model_a).is_yes());
  put(self_distance(model_a).upper), put(self_contacts(model_a, 0, found).count);
  put(self_distance(model_a, {.cache = &first}).lower), put(self_collide(model_a, {.cache = &first}).is_yes());
  put(self_closest_pairs(model_a, std::span(found).first(5)).count), put(found[0].distance);
  std::vector<VertexFacePair> vertex_face(1);
  std::vector<EdgeEdgePair> edge_edge(1);
  const ElementPairCount elements = element_pairs(a, b, 1.5 * limit, vertex_face, edge_edge);
  put(elements.vertex_face), put(elements.edge_edge), put(vertex_face[0].distance), put(edge_edge[0].parameter_b);
  put(self_element_pairs(model_a, limit, vertex_face, edge_edge).edge_edge), put(edge_edge[0].distance);
  std::vector<Vec3> points = s.mesh_b.positions();
  points.resize(std::min<std::size_t>(points.size(), 20));
  std::vector<PointResult> closest(points.size());
  closest_point_many(a, points, closest);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const PointResult& r : {closest[i], closest_point(a, points[i])}) {
      put(r.closest.value().distance), put(r.closest->position.x), put(r.closest->weights[1]);
    }
  }
  put(generalized_winding_number(a, points[0]));
  if (const auto surface = ClosedSurface::create(model_a)) {
    std::vector<SignedDistance> distances(points.size());
    surface->signed_distance_many(points, distances, s.pose_a);
    for (std::size_t i = 0; i < points.size(); ++i) {
      put(distances[i].distance()), put(surface->signed_distance(points[i], s.pose_a).distance());
      put(surface->contains(points[i], s.pose_a));
    }
    const SolidDistance with_itself = signed_distance({*surface, s.pose_a}, {*surface, s.pose_b});
    put(with_itself.lower), put(with_itself.upper), put(with_itself.translation.x), put(with_itself.deepest.max_depth);
    put(separating_translation({*surface, s.pose_a}, {*surface, s.pose_b}, {1, 2, 0x1p-1070}).upper);
  }
  put(model_a.bounding_box().high.z), put(model_a.bounding_sphere().radius);
  std::vector<Vec3> positions = s.mesh_a.positions();
  positions[rng.below(positions.size())] = s.mesh_b.positions().front();
  model_a.move_all(positions).value();
  model_a.commit();
  put(static_cast<bool>(model_a.validate()));
  put_distance(distance(a, b));
  const std::vector<VertexId> ids{0};
  const std::vector<Vec3> to{s.mesh_b.positions().back()};
  model_a.set_motion_margin(0.25 * s.size);
  model_a.move_vertices(ids, to).value();
  model_a.commit();
  put(tree_of(model_a).displacement), put(tree_of(model_a).slack), put(static_cast<bool>(model_a.validate()));
  model_a.rebuild();
  put_distance(distance(a, b, {.cache = &first}));
  const Triangle t = s.mesh_a.triangle(0), u = s.mesh_b.triangle(0);
  put(intersects(t, u)), put(closest_points(t, u).distance), put(orient3d(t.v0, t.v1, t.v2, u.v0));
  put(orient2d(t.v0, t.v1, u.v0, 2)), put(intersects(Segment{t.v0, u.v0}, u));
  put(closest_points(Segment{t.v0, t.v1}, Segment{u.v0, u.v1}).distance), put(closest_points(t.v0, u).distance);
  put(closest_features(t, u).distance), put(contact(t, u).normal.x);
  put(is_rigid(s.pose_a)), put(is_rigid({s.pose_b.rotation * s.pose_a.rotation, {}}));
  const Mat3 turned = transform_from_quaternion(t.v0, rng.uniform(-1, 1), 0.1, 0x1p-1070, 0.3).value().rotation;
  put(turned.row0.x), put(turned.row1.z), put(turned.row2.y);
  return bits;
}

TEST(FloatEnvironment, OfTheCallerChangesNoAnswer) {
  const std::vector<Environment> environments = foreign_environments();
  Rng rng(601);
  for (int i = 0; i < 100; ++i) {
    const RandomScene s = arbitrary_scene(rng);
    const std::vector<std::uint64_t> expected = answers(s, rng);
    for (const Environment& environment : environments) {
      environment.enter();
      const std::vector<std::uint64_t> found = answers(s, rng);
      environment.leave();
      ASSERT_EQ(found, expected) << environment.name << ", scene " << i;
    }
  }
}

/// Triangles that are points, so many that threads share the work, on a line so short that its coordinates in the unit
/// of the tree are subnormal float32 numbers; and two that make the model large.
Mesh speck_between_far_ends() {
  std::vector<Triangle> triangles;
  constexpr std::uint32_t count = 40'000;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 at{0x1p-149 * static_cast<double>(i * std::uint64_t{7919} % count), 0, 0};
    triangles.push_back({at, at, at});
  }
  triangles.push_back({{-1, -1, -1}, {-1, 0, -1}, {-1, -1, 0}});
  triangles.push_back({{1, 1, 1}, {1, 0, 1}, {1, 1, 0}});
  return soup(triangles);
}

TEST(FloatEnvironment, OfAPoolOfThreadsChangesNoTree) {
  // A pool of threads keeps the environment of the thread that used it first.
  const Mesh speck = speck_between_far_ends(), sheet = scenes::wave_sheet(200, 200, 0);
  const bvh::Tree speck_tree = bvh::build(speck), sheet_tree = bvh::build(sheet);
  const std::vector<Vec3> moved = scenes::wave_sheet(200, 200, 3).positions();
  Model refitted(sheet);
  refitted.move_all(moved).value(), refitted.commit();
  const auto equal = [](const bvh::Tree& a, const bvh::Tree& b) {
    if (a.leaves.size() != b.leaves.size()) return false;
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
      if (std::memcmp(&a.nodes[i].bounds, &b.nodes[i].bounds, sizeof(bvh::ChildBounds)) != 0) return false;
    }
    return std::memcmp(a.leaves.data(), b.leaves.data(), a.leaves.size() * sizeof(bvh::Leaf)) == 0;
  };
  for (const Environment& environment : foreign_environments()) {
    std::thread([&] {
      environment.enter();
      oneapi::tbb::parallel_for(0, 1000, [](int) {});
      const Model model(speck);
      Model other(sheet);
      EXPECT_TRUE(equal(tree_of(model), speck_tree)) << environment.name;
      EXPECT_TRUE(equal(tree_of(other), sheet_tree)) << environment.name;
      other.move_all(moved).value(), other.commit();
      EXPECT_TRUE(equal(tree_of(other), tree_of(refitted))) << environment.name;
    }).join();
  }
}

/// The floating-point environment of the calling thread, without the flags that note past exceptions.
auto present_environment() {
#if defined(__x86_64__)
  return _mm_getcsr() & ~0x3fU;
#else
  return std::fegetround();
#endif
}

TEST(FloatEnvironment, OfEveryParallelBodyIsTheDefault) {
  const auto wanted = present_environment();
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 2);
  for (const Environment& environment : foreign_environments()) {
    std::thread([&] {
      environment.enter();
      oneapi::tbb::task_arena(2).execute([&] {
        const base::DefaultFloatEnvironment of_caller;
        std::atomic<int> good{0};
        const auto note = [&](auto&&...) { good += present_environment() == wanted ? 1 : 0; };
        base::parallel_for(100, 1, note);
        EXPECT_EQ(good.exchange(0), 100) << environment.name;
        base::parallel_for_ranges(100, 10, note);
        EXPECT_EQ(good.exchange(0), 10) << environment.name;
        base::parallel_in_order<int>(100, note, [](int) {});
        EXPECT_EQ(good.exchange(0), 100) << environment.name;
        base::parallel_in_order<int>(
            100, [](std::size_t, int) {}, note);
        EXPECT_EQ(good.exchange(0), 100) << environment.name;
        base::parallel_invoke(true, note, note);
        EXPECT_EQ(good.exchange(0), 2) << environment.name;
      });
    }).join();
  }
}

TEST(FloatEnvironment, OfTheCallerIsAsItWasAfterACall) {
  const Model ball(scenes::thesis_ball());
  for (const Environment& environment : foreign_environments()) {
    environment.enter();
    const auto before = present_environment();
    static_cast<void>(collide({ball}, {ball}));
    EXPECT_EQ(present_environment(), before) << environment.name;
    environment.leave();
  }
}

#if defined(__x86_64__)
TEST(FloatEnvironment, WithTrapsSetIsNotTrapped) {
  // Intermediate results of the kernels are infinite or NaN even where the answers are right.
  const Model ball(scenes::thesis_ball()), square(scenes::thesis_square());
  const unsigned before = _mm_getcsr();
  constexpr unsigned masks_of_traps = 0x1f80, inexact = 0x1000, subnormal = 0x100;
  _mm_setcsr((before & ~masks_of_traps & ~0x3fU) | inexact | subnormal);
  const bool meets = collide({ball}, {square}).is_yes();
  _mm_setcsr(before);
  EXPECT_TRUE(meets);
}
#endif

}  // namespace
}  // namespace limber::testing
