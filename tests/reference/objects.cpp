// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "reference/reference.h"

namespace limber::reference {

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
