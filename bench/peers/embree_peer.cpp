// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Embree's rtcCollide over user geometries, float32 boxes in the world frame; candidates are decided by our exact test.
// It cannot move a scene: a new pose of b is transformed vertices and a refit, which move() does, untimed by the tables
// of queries. No early out, no distance.
#include <embree3/rtcore.h>

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

/// Holds all of oneTBB in this process to one thread while it lives.
struct EmbreeDevice {
  RTCDevice device = rtcNewDevice("threads=1");
  EmbreeDevice() = default;
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;
  ~EmbreeDevice() { rtcReleaseDevice(device); }
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
  EmbreeDevice device_;
  EmbreeScene a_, b_;
};

/// Embree's own triangles, in float32 and for rays. Only their updates are measured.
class EmbreeTrianglesPeer : public Peer {
 public:
  explicit EmbreeTrianglesPeer(const Mesh& a)
      : scene_(rtcNewScene(device_.device)),
        geometry_(rtcNewGeometry(device_.device, RTC_GEOMETRY_TYPE_TRIANGLE)),
        vertex_count_(a.positions().size()) {
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    auto* const corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), a.triangles().size()));
    for (std::size_t t = 0; t < a.triangles().size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) corners[3 * t + k] = a.triangles()[t][k];
    }
    vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                            3 * sizeof(float), vertex_count_));
    write(a.positions());
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
  }
  EmbreeTrianglesPeer(const EmbreeTrianglesPeer&) = delete;
  EmbreeTrianglesPeer& operator=(const EmbreeTrianglesPeer&) = delete;
  ~EmbreeTrianglesPeer() override {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
  }
  bool answers(Question) const override { return false; }
  double ask(Question, const Transform&) override { return 0; }
  bool deform(const std::vector<Vec3>& positions) override {
    write(positions);
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
    return true;
  }

 private:
  void write(const std::vector<Vec3>& positions) {
    for (std::size_t v = 0; v < vertex_count_; ++v) {
      for (std::size_t k = 0; k < 3; ++k) vertices_[3 * v + k] = static_cast<float>(positions[v][k]);
    }
  }

  EmbreeDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
  std::size_t vertex_count_;
  float* vertices_ = nullptr;
};

/// What a build of Embree's own triangles takes, without the copy of the mesh and the device.
double build_ns(const Mesh& mesh, RTCBuildQuality quality) {
  const EmbreeDevice device;
  const RTCScene scene = rtcNewScene(device.device);
  const RTCGeometry geometry = rtcNewGeometry(device.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSceneBuildQuality(scene, quality);
  // Embree builds by Morton codes only where a scene may change.
  if (quality == RTC_BUILD_QUALITY_LOW) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetGeometryBuildQuality(geometry, quality);
  auto* const corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles().size()));
  auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions().size()));
  for (std::size_t i = 0; i < 3 * mesh.triangles().size(); ++i) corners[i] = mesh.triangles()[i / 3][i % 3];
  for (std::size_t i = 0; i < 3 * mesh.positions().size(); ++i) {
    vertices[i] = static_cast<float>(mesh.positions()[i / 3][i % 3]);
  }
  const Stopwatch watch;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
  const double us = watch.us();
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene);
  return us * 1e3 / static_cast<double>(mesh.triangles().size());
}

}  // namespace

double embree_morton_build_ns(const Mesh& mesh) { return build_ns(mesh, RTC_BUILD_QUALITY_LOW); }
double embree_sah_build_ns(const Mesh& mesh) { return build_ns(mesh, RTC_BUILD_QUALITY_MEDIUM); }

std::unique_ptr<Peer> make_embree_triangles(const Mesh& a, const Mesh&) {
  return std::make_unique<EmbreeTrianglesPeer>(a);
}
std::unique_ptr<Peer> make_embree(const Mesh& a, const Mesh& b) { return std::make_unique<EmbreePeer>(a, b); }

}  // namespace limber::bench
