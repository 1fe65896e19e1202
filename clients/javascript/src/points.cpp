// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/points.h"

#include <limits>
#include <type_traits>
#include <vector>

#include "bindings.h"
#include "limber/mesh.h"

namespace limber::web {
namespace {

Columns columns;

constexpr double nowhere = std::numeric_limits<double>::infinity();
double distance_of(const PointResult& result) { return result.closest ? result.closest->distance : nowhere; }
double distance_of(const SignedDistance& result) { return result.closest ? result.distance() : nowhere; }

/// One column after the other: distances, positions, weights, both statistics; then, in 32 bits, triangles; then, in 8
/// bits, kind and index of the feature, point by point, and of signed distances whether the point is inside. Where
/// nothing was found, the distance is infinite, other numbers are 0 and the triangle is no_id.
template <typename T>
void give_points(const std::vector<T>& results) {
  const std::size_t n = results.size();
  columns.begin(9 * n, n, 3 * n);
  const auto closest = [](const T& result) { return result.closest.value_or(SurfacePoint{}); };
  for (const T& r : results) *columns.number++ = distance_of(r);
  for (const T& r : results) put(columns.number, closest(r).position);
  for (const T& r : results) put(columns.number, closest(r).weights);
  for (const T& r : results) *columns.number++ = static_cast<double>(r.stats.node_tests);
  for (const T& r : results) *columns.number++ = static_cast<double>(r.stats.primitive_tests);
  for (const T& r : results) *columns.id++ = closest(r).triangle;
  for (const T& r : results) {
    const Feature feature = closest(r).feature;
    *columns.byte++ = static_cast<std::uint8_t>(feature.kind), *columns.byte++ = feature.index;
  }
  if constexpr (std::is_same_v<T, SignedDistance>) {
    for (const T& r : results) *columns.byte++ = r.is_inside ? 1 : 0;
  }
}

}  // namespace

/// The closest points of a model to the points in input().
LIMBER_EXPORT(closestPointMany)
bool exported_closest_point_many(const OwnedModel* model, PoseForm pose, std::size_t count, bool is_float32,
                                 double max_distance) {
  return guarded([&] {
    const std::vector<Vec3> points = points_from(count, is_float32);
    std::vector<PointResult> results(count);
    closest_point_many(Placed(*model, pose_from(pose, 0, "pose")), points, results, {max_distance});
    give_points(results);
  });
}

LIMBER_EXPORT(newClosedSurface) ClosedSurface* new_closed_surface(const OwnedModel* model) {
  ClosedSurface* surface = nullptr;
  guarded([&] { surface = new ClosedSurface(ClosedSurface::create(*model).value()); });
  return surface;
}
LIMBER_EXPORT(deleteClosedSurface) void delete_closed_surface(ClosedSurface* surface) { delete surface; }

/// The signed distances of the points in input(), negative inside.
LIMBER_EXPORT(signedDistanceMany)
bool exported_signed_distance_many(const ClosedSurface* surface, PoseForm pose, std::size_t count, bool is_float32,
                                   double max_distance) {
  return guarded([&] {
    const std::vector<Vec3> points = points_from(count, is_float32);
    std::vector<SignedDistance> results(count);
    surface->signed_distance_many(points, results, pose_from(pose, 0, "pose"), {max_distance});
    give_points(results);
  });
}

LIMBER_EXPORT(contains)
bool exported_contains(const ClosedSurface* surface, PoseForm pose, double x, double y, double z) {
  return guarded([&] { exchange.words[0] = surface->contains({x, y, z}, pose_from(pose, 0, "pose")) ? 1 : 0; });
}

/// The rotation nearest to the 3 x 3 matrix, by columns, in Exchange::poses[0]: to Exchange::numbers, the same way.
LIMBER_EXPORT(orthonormalized) bool exported_orthonormalized() {
  return guarded([] {
    const double(&m)[16] = exchange.poses[0];
    const Mat3 columns_as_rows{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
    const Mat3 nearest = transpose(orthonormalized(transpose(columns_as_rows)).value());
    double* to = exchange.numbers;
    put(to, nearest.row0), put(to, nearest.row1), put(to, nearest.row2);
  });
}

}  // namespace limber::web
