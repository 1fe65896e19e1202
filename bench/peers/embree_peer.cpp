// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Embree's triangles, in float32 and for rays: their refit, and closest points. For these Embree finds the triangles
// that a sphere meets and leaves their distances to a callback, which is ours: float32, as Embree's vertices are.
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/peers/peer.h"

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

/// Embree's own triangles, in float32 and for rays.
class EmbreeTriangles : public Peer {
 public:
  /// With `settings` of a number of threads, all of oneTBB in this process is held to it while the device lives.
  EmbreeTriangles(const Mesh& mesh, RTCBuildQuality quality, const char* settings)
      : device_(rtcNewDevice(settings), rtcReleaseDevice),
        scene_(rtcNewScene(device_.get()), rtcReleaseScene),
        geometry_(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry) {
    rtcSetSceneBuildQuality(scene_.get(), quality);
    // Embree builds by Morton codes only where a scene may change.
    if (quality == RTC_BUILD_QUALITY_LOW) rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_DYNAMIC);
    rtcSetGeometryBuildQuality(geometry_.get(), quality);
    const std::size_t vertex_count = mesh.positions().size(), count = mesh.triangles().size();
    vertices_ = static_cast<Vector*>(rtcSetNewGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, sizeof(Vector), vertex_count));
    corners_ = static_cast<Corners*>(
        rtcSetNewGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Corners), count));
    std::copy(mesh.triangles().begin(), mesh.triangles().end(), corners_);
    write(mesh.positions());
    rtcCommitGeometry(geometry_.get());
    rtcAttachGeometry(scene_.get(), geometry_.get());
    rtcCommitScene(scene_.get());
  }

  bool deform(const std::vector<Vec3>& positions) override {
    rtcSetGeometryBuildQuality(geometry_.get(), RTC_BUILD_QUALITY_REFIT);
    write(positions);
    rtcUpdateGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_.get());
    rtcCommitScene(scene_.get());
    return true;
  }

  double distance(const Vec3& point) const {
    const Vector p = rounded(point);
    RTCPointQuery query{p.x, p.y, p.z, 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, shrink, const_cast<EmbreeTriangles*>(this));
    return query.radius;
  }

 private:
  static Vector rounded(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  /// Whether a triangle makes the sphere smaller.
  static bool shrink(RTCPointQueryFunctionArguments* arguments) {
    const EmbreeTriangles& mesh = *static_cast<const EmbreeTriangles*>(arguments->userPtr);
    const Corners& at = mesh.corners_[arguments->primID];
    RTCPointQuery& query = *arguments->query;
    const float found = triangle_distance({query.x, query.y, query.z}, mesh.vertices_[at[0]], mesh.vertices_[at[1]],
                                          mesh.vertices_[at[2]]);
    if (!(found < query.radius)) return false;
    query.radius = found;
    return true;
  }

  void write(const std::vector<Vec3>& positions) {
    for (std::size_t v = 0; v < positions.size(); ++v) vertices_[v] = rounded(positions[v]);
  }

  std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> device_;
  std::unique_ptr<RTCSceneTy, void (*)(RTCScene)> scene_;
  std::unique_ptr<RTCGeometryTy, void (*)(RTCGeometry)> geometry_;
  Vector* vertices_;
  Corners* corners_;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const Mesh& a) {
  return std::make_unique<EmbreeTriangles>(a, RTC_BUILD_QUALITY_LOW, "threads=1");
}

Projector embree_projector(const Mesh& mesh) {
  return {"Embree, float32", "rtcPointQuery, medium quality", true,
          [built = std::make_shared<const EmbreeTriangles>(mesh, RTC_BUILD_QUALITY_MEDIUM, nullptr)](const Vec3& p) {
            return built->distance(p);
          }};
}

}  // namespace limber::bench
