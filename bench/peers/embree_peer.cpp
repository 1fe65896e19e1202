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
#include "limber/geometry.h"

namespace limber::bench {
namespace {

/// One mesh as it stands in the world.
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

float outward(double x, float way) { return std::nextafter(static_cast<float>(x), way); }

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
  double ask(Question, const Transform&) override {
    Candidates candidates{&a_.standing, &b_.standing};
    rtcCollide(a_.scene, b_.scene, check, &candidates);
    return candidates.hit ? 0 : 1;
  }

 private:
  EmbreeDevice device_;
  EmbreeScene a_, b_;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const Mesh& a, const Mesh& b) { return std::make_unique<EmbreePeer>(a, b); }

}  // namespace limber::bench
