// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Embree's point query finds the triangles that a sphere meets and leaves their distances to a callback, which is ours:
// float32, as Embree's vertices are.
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "bench/contacts/linked_projectors.h"

namespace limber::bench {
namespace {

struct Vector {
  float x, y, z;
};
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float inner(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector outer(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// From a segment that starts at 0 and ends at `edge`.
float segment_distance_sq(const Vector& point, const Vector& edge) {
  const float length_sq = inner(edge, edge);
  const float along = length_sq > 0 ? std::clamp(inner(point, edge) / length_sq, 0.0F, 1.0F) : 0.0F;
  const Vector rest = point - Vector{along * edge.x, along * edge.y, along * edge.z};
  return inner(rest, rest);
}

float triangle_distance(const Vector& point, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, bc = c - b, ca = a - c, pa = point - a, pb = point - b, pc = point - c;
  const Vector normal = outer(ab, bc);
  const float normal_sq = inner(normal, normal);
  const bool is_above_face = inner(outer(normal, ab), pa) >= 0 && inner(outer(normal, bc), pb) >= 0 &&
                             inner(outer(normal, ca), pc) >= 0 && normal_sq > 0;
  if (is_above_face) return std::abs(inner(normal, pa)) / std::sqrt(normal_sq);
  return std::sqrt(std::min({segment_distance_sq(pa, ab), segment_distance_sq(pb, bc), segment_distance_sq(pc, ca)}));
}

class EmbreeMesh {
 public:
  explicit EmbreeMesh(const Mesh& mesh) : scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t vertex_count = mesh.positions().size(), count = mesh.triangles().size();
    auto* const vertices = static_cast<Vector*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector), vertex_count));
    for (std::size_t v = 0; v < vertex_count; ++v) vertices[v] = rounded(mesh.positions()[v]);
    auto* const corners = static_cast<Corners*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Corners), count));
    std::copy(mesh.triangles().begin(), mesh.triangles().end(), corners);
    vertices_ = vertices, corners_ = corners;
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);  // the scene keeps it
    rtcCommitScene(scene_);
  }
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;
  ~EmbreeMesh() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  double distance(const Vec3& point) const {
    const Vector p = rounded(point);
    RTCPointQuery query{p.x, p.y, p.z, 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, shrink, const_cast<EmbreeMesh*>(this));
    return query.radius;
  }

 private:
  static Vector rounded(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  /// Whether a triangle makes the sphere smaller.
  static bool shrink(RTCPointQueryFunctionArguments* arguments) {
    const EmbreeMesh& mesh = *static_cast<const EmbreeMesh*>(arguments->userPtr);
    const Corners& at = mesh.corners_[arguments->primID];
    RTCPointQuery& query = *arguments->query;
    const float found = triangle_distance({query.x, query.y, query.z}, mesh.vertices_[at[0]], mesh.vertices_[at[1]],
                                          mesh.vertices_[at[2]]);
    if (!(found < query.radius)) return false;
    query.radius = found;
    return true;
  }

  RTCDevice device_ = rtcNewDevice(nullptr);  // a number of threads would hold all of oneTBB in this process to it
  RTCScene scene_;
  const Vector* vertices_ = nullptr;
  const Corners* corners_ = nullptr;
};

}  // namespace

LinkedProjector embree_projector(const Mesh& mesh) {
  return {
      "Embree, float32", "rtcPointQuery, medium quality", true,
      [built = std::make_shared<const EmbreeMesh>(mesh)](std::span<const Vec3> points, std::span<double> distances) {
        for (std::size_t i = 0; i < points.size(); ++i) distances[i] = built->distance(points[i]);
      }};
}

}  // namespace limber::bench
