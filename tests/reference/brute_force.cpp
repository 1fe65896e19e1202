// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <vector>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "reference/place.h"
#include "reference/reference.h"

namespace limber::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) {
  const base::DefaultFloatEnvironment environment;
  CollideResult result;
  const std::vector<Triangle> triangles_a = place(a), triangles_b = place(b);
  for (TriangleId i = 0; i < triangles_a.size(); ++i) {
    for (TriangleId j = 0; j < triangles_b.size(); ++j) {
      ++result.stats.primitive_tests;
      if (!geometry::intersects(triangles_a[i], triangles_b[j])) continue;
      const Vec3 shared = geometry::shared_point(triangles_a[i], triangles_b[j]);
      result.answer = Answer::yes;
      result.witness = Witness{shared, shared, i, j};
      return result;
    }
  }
  result.answer = Answer::no;
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  DistanceResult result;
  result.upper = infinity;
  const std::vector<Triangle> triangles_a = place(a), triangles_b = place(b);
  for (TriangleId i = 0; i < triangles_a.size(); ++i) {
    for (TriangleId j = 0; j < triangles_b.size(); ++j) {
      ++result.stats.primitive_tests;
      const ClosestPoints closest = geometry::closest_points(triangles_a[i], triangles_b[j]);
      if (closest.distance >= result.upper) continue;
      result.upper = closest.distance;
      result.witness = Witness{closest.point_a, closest.point_b, i, j};
    }
  }
  result.lower = result.upper;
  result.status = result.upper == 0 ? DistanceStatus::collision : DistanceStatus::exact;
  if (result.upper > options.max_distance) {
    result.lower = options.max_distance;
    result.upper = infinity;
    result.witness.reset();
    result.status = DistanceStatus::beyond_limit;
  }
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance) {
  const base::DefaultFloatEnvironment environment;
  CollideResult result;
  const DistanceResult closest = distance(a, b, {.max_distance = max_distance});
  result.stats = closest.stats;
  result.answer = closest.status != DistanceStatus::beyond_limit ? Answer::yes : Answer::no;
  result.witness = closest.witness;
  return result;
}

std::vector<ObjectPair> pairs_within(std::span<const Placed> objects, double max_distance) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  std::vector<ObjectPair> pairs;
  for (ObjectId a = 0; a < objects.size(); ++a) {
    for (ObjectId b = a + 1; b < objects.size(); ++b) {
      if (within(objects[a], objects[b], max_distance).is_yes()) pairs.push_back({a, b});
    }
  }
  return pairs;
}

ClosestObjectsResult closest_objects(std::span<const Placed> objects, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::reference::closest_objects");
  ClosestObjectsResult closest;
  closest.result.status = DistanceStatus::beyond_limit;
  closest.result.lower = options.max_distance;
  closest.result.upper = std::numeric_limits<double>::infinity();
  for (ObjectId a = 0; a < objects.size(); ++a) {
    for (ObjectId b = a + 1; b < objects.size(); ++b) {
      const DistanceResult result = distance(objects[a], objects[b], options);
      if (result.upper < closest.result.upper) closest = {{a, b}, result};
    }
  }
  return closest;
}

}  // namespace limber::reference
