// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as two small meshes that move: times of impact of the models, and of one with itself, against all pairs of
// elements.
#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "fuzz/inputs.h"
#include "fuzz/property.h"
#include "limber/motion.h"
#include "reference/reference.h"

namespace limber::fuzz {
namespace {

/// Small numbers, some of them moved by a few last digits. Numbers of very different sizes take exact arithmetic long.
double short_coordinate(ByteReader& bytes) {
  const std::uint8_t kind = bytes.byte();
  const double integer = static_cast<double>(kind % 8) - 3;
  if (kind < 160) return integer;
  if (kind < 208) return integer / 4;
  return integer == 0 ? 0 : nudged(integer, static_cast<int>(bytes.below(9)) - 4);
}

Vec3 short_point(ByteReader& bytes, double factor) {
  const double x = short_coordinate(bytes), y = short_coordinate(bytes), z = short_coordinate(bytes);
  return scaled({x, y, z}, factor);
}

struct MovingMesh {
  Mesh mesh;
  std::vector<Vec3> end;
  Transform start_pose, end_pose;
};

MovingMesh moving_mesh(ByteReader& bytes, double factor) {
  std::vector<Vec3> start, end;
  for (std::uint32_t v = 0, count = 1 + bytes.below(6); v < count; ++v) {
    start.push_back(short_point(bytes, factor));
    end.push_back(bytes.flag() ? start.back() : short_point(bytes, factor));
  }
  std::vector<Corners> triangles;
  const auto some_vertex = [&] { return bytes.below(static_cast<std::uint32_t>(start.size())); };
  for (std::uint32_t t = 0, count = 1 + bytes.below(4); t < count; ++t) {
    const VertexId v0 = some_vertex(), v1 = some_vertex(), v2 = some_vertex();
    triangles.push_back({v0, v1, v2});
  }
  const Transform start_pose{rotation(bytes), short_point(bytes, factor)};
  const Transform end_pose{rotation(bytes), short_point(bytes, factor)};
  return {Mesh::create(std::move(start), std::move(triangles)).value(), std::move(end), start_pose, end_pose};
}

auto ids_of(const Impact& i) { return std::tuple(i.elements.kind, i.elements.a, i.elements.b); }

/// All impacts have to be those of brute force, numbers included, and the first one the earliest of them.
template <typename First, typename All>
void check(std::uint8_t environment, const First& first_of, const All& all_of, std::vector<Impact> truth) {
  std::vector<Impact> all = in_environment(environment, all_of);
  const auto by_ids = [](const Impact& p, const Impact& q) { return ids_of(p) < ids_of(q); };
  std::sort(all.begin(), all.end(), by_ids), std::sort(truth.begin(), truth.end(), by_ids);
  require(std::equal(all.begin(), all.end(), truth.begin(), truth.end(),
                     [](const Impact& p, const Impact& q) {
                       return ids_of(p) == ids_of(q) && p.time.lower == q.time.lower && p.time.upper == q.time.upper;
                     }),
          "all impacts are those of brute force");
  double lower = std::numeric_limits<double>::infinity(), upper = lower;
  for (const Impact& i : truth) lower = std::min(lower, i.time.lower), upper = std::min(upper, i.time.upper);
  for (const std::uint64_t steps : {std::numeric_limits<std::uint64_t>::max(), std::uint64_t{3}}) {
    const ImpactResult first = in_environment(environment, [&] { return first_of(steps); });
    require(first.lower <= upper && lower <= first.upper, "the first impact is in the interval");
    require(first.status == ImpactStatus::undecided || (first.status == ImpactStatus::clear) == truth.empty(),
            "models touch exactly where elements do");
    require(first.status == ImpactStatus::undecided || truth.empty() || first.upper - first.lower <= 0x1p-53,
            "the interval is as short as promised");
  }
}

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber;
  fuzz::ByteReader bytes({data, size});
  const std::uint8_t environment = bytes.byte();
  const double factor = fuzz::scale(bytes);
  const fuzz::MovingMesh a = fuzz::moving_mesh(bytes, factor), b = fuzz::moving_mesh(bytes, factor);
  const Model model_a(a.mesh), model_b(b.mesh);
  MovingModel moving_a(model_a), moving_b(model_b);
  moving_a.set_motion(a.end, a.start_pose, a.end_pose).value();
  moving_b.set_motion(b.end, b.start_pose, b.end_pose).value();
  const auto options = [](std::uint64_t steps) {
    return ImpactOptions{.ignore_crossings = true, .budget = {.max_steps = steps}};
  };
  const auto list = [](const auto& visit) {
    std::vector<Impact> found;
    visit([&](const Impact& i) { return found.push_back(i), true; });
    return found;
  };
  const reference::MovingMesh twin_a{a.mesh, a.end, a.start_pose, a.end_pose},
      twin_b{b.mesh, b.end, b.start_pose, b.end_pose};
  fuzz::check(
      environment, [&](std::uint64_t steps) { return time_of_impact(moving_a, moving_b, options(steps)); },
      [&] { return list([&](ImpactVisitor visit) { visit_impacts(moving_a, moving_b, visit); }); },
      reference::impacts(twin_a, twin_b, {}));
  fuzz::check(
      environment, [&](std::uint64_t steps) { return self_time_of_impact(moving_a, options(steps)); },
      [&] { return list([&](ImpactVisitor visit) { visit_self_impacts(moving_a, visit); }); },
      reference::self_impacts(twin_a, {}));
  return 0;
}
