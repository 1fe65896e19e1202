// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Embree's rtcCollide over user geometries, float32 boxes in the world frame; candidates are decided by our exact test.
// It cannot move a scene: a new pose of b is transformed vertices and a refit, which move() does, untimed by the tables
// of queries. No early out, no distance. For closest points Embree finds the triangles that a sphere meets and leaves
// their distances to a callback, which is ours: float32, as Embree's vertices are.
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "bench/peers/peer.h"
#include "bench/support/sampling.h"
#include "limber/geometry.h"

namespace limber::bench {
namespace {

/// One mesh and its placed triangles.
struct Standing {
  Mesh mesh;
  std::vector<Triangle> world;

  explicit Standing(const Mesh& source) : mesh(source), world(source.triangles().size()) { place({}); }
  void place(const Transform& pose) {
    for (TriangleId t = 0; t < world.size(); ++t) {
      const Triangle m = mesh.triangle(t);
      world[t] = {pose(m.v0), pose(m.v1), pose(m.v2)};
    }
  }
};

float outward(double x, float limit) { return std::nextafter(static_cast<float>(x), limit); }

void bounds_of(const RTCBoundsFunctionArguments* arguments) {
  const Triangle& t = static_cast<const Standing*>(arguments->geometryUserPtr)->world[arguments->primID];
  const Vec3 low = min(min(t.v0, t.v1), t.v2), high = max(max(t.v0, t.v1), t.v2);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  RTCBounds& b = *arguments->bounds_o;
  b.lower_x = outward(low.x, -infinity), b.lower_y = outward(low.y, -infinity), b.lower_z = outward(low.z, -infinity);
  b.upper_x = outward(high.x, infinity), b.upper_y = outward(high.y, infinity), b.upper_z = outward(high.z, infinity);
}

struct Candidates {
  const Standing *a, *b;
  std::atomic<bool> hit{false};
};

void check(void* user, RTCCollision* pairs, unsigned count) {
  auto& candidates = *static_cast<Candidates*>(user);
  for (unsigned i = 0; i < count && !candidates.hit; ++i) {
    if (intersects(candidates.a->world[pairs[i].primID0], candidates.b->world[pairs[i].primID1])) candidates.hit = true;
  }
}

class EmbreeScene {
 public:
  EmbreeScene(RTCDevice device, const Mesh& mesh)
      : standing(mesh), scene(rtcNewScene(device)), geometry_(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER)) {
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(mesh.triangles().size()));
    rtcSetGeometryUserData(geometry_, &standing);
    rtcSetGeometryBoundsFunction(geometry_, bounds_of, nullptr);
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene, geometry_);
    rtcCommitScene(scene);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene);
  }
  void deform(const std::vector<Vec3>& positions) {
    standing.mesh.set_positions(positions).value();
    place({});
  }
  void place(const Transform& pose) {
    standing.place(pose);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene);
  }

  Standing standing;
  RTCScene scene;

 private:
  RTCGeometry geometry_;
};

struct EmbreeDevice {
  /// A number of threads holds all of oneTBB in this process to it while the device lives.
  explicit EmbreeDevice(const char* settings) : device(rtcNewDevice(settings)) {}
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;
  ~EmbreeDevice() { rtcReleaseDevice(device); }
  RTCDevice device;
};

class EmbreePeer : public Peer {
 public:
  EmbreePeer(const Mesh& a, const Mesh& b) : a_(device_.device, a), b_(device_.device, b) {}
  bool answers(Question question) const override { return question == Question::collide; }
  void move(const Transform& pose) override { b_.place(pose); }
  bool deform(const std::vector<Vec3>& positions) override {
    a_.deform(positions);
    return true;
  }
  double ask(Question, const Transform&) override {
    Candidates candidates{&a_.standing, &b_.standing};
    rtcCollide(a_.scene, b_.scene, check, &candidates);
    return candidates.hit ? 0 : 1;
  }

 private:
  EmbreeDevice device_{"threads=1"};
  EmbreeScene a_, b_;
};

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
class EmbreeTriangles {
 public:
  EmbreeTriangles(const Mesh& mesh, RTCBuildQuality quality, const char* settings)
      : device_(settings), scene_(rtcNewScene(device_.device)) {
    geometry_ = rtcNewGeometry(device_.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneBuildQuality(scene_, quality);
    // Embree builds by Morton codes only where a scene may change.
    if (quality == RTC_BUILD_QUALITY_LOW) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetGeometryBuildQuality(geometry_, quality);
    const std::size_t vertex_count = mesh.positions().size(), count = mesh.triangles().size();
    vertices_ = static_cast<Vector*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector), vertex_count));
    corners_ = static_cast<Corners*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Corners), count));
    std::copy(mesh.triangles().begin(), mesh.triangles().end(), corners_);
    write(mesh.positions());
    build_us_ = mean_us(1, [&] {
      rtcCommitGeometry(geometry_);
      rtcAttachGeometry(scene_, geometry_);
      rtcCommitScene(scene_);
    });
  }
  EmbreeTriangles(const EmbreeTriangles&) = delete;
  EmbreeTriangles& operator=(const EmbreeTriangles&) = delete;
  ~EmbreeTriangles() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }
  /// What the build took, without the copy of the mesh and the device.
  double build_us() const { return build_us_; }

  void refit(const std::vector<Vec3>& positions) {
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    write(positions);
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  double distance(const Vec3& point) const {
    const Vector p = rounded(point);
    RTCPointQuery query{p.x, p.y, p.z, 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, shrink, const_cast<EmbreeTriangles*>(this));
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

  EmbreeDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
  Vector* vertices_;
  Corners* corners_;
  double build_us_ = 0;
};

/// Only the updates of triangles are measured.
class EmbreeTrianglesPeer : public Peer {
 public:
  explicit EmbreeTrianglesPeer(const Mesh& a) : triangles_(a, RTC_BUILD_QUALITY_LOW, "threads=1") {}
  bool deform(const std::vector<Vec3>& positions) override {
    triangles_.refit(positions);
    return true;
  }

 private:
  EmbreeTriangles triangles_;
};

}  // namespace

double embree_morton_build_us(const Mesh& mesh) {
  return EmbreeTriangles(mesh, RTC_BUILD_QUALITY_LOW, "threads=1").build_us();
}
double embree_sah_build_us(const Mesh& mesh) {
  return EmbreeTriangles(mesh, RTC_BUILD_QUALITY_MEDIUM, "threads=1").build_us();
}
std::unique_ptr<Peer> make_embree_triangles(const Mesh& a, const Mesh&) {
  return std::make_unique<EmbreeTrianglesPeer>(a);
}
std::unique_ptr<Peer> make_embree(const Mesh& a, const Mesh& b) { return std::make_unique<EmbreePeer>(a, b); }

Projector embree_projector(const Mesh& mesh) {
  return {"Embree, float32", "rtcPointQuery, medium quality", true,
          [built = std::make_shared<const EmbreeTriangles>(mesh, RTC_BUILD_QUALITY_MEDIUM, nullptr)](const Vec3& p) {
            return built->distance(p);
          }};
}

}  // namespace limber::bench
