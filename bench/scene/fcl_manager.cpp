// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// FCL's DynamicAABBTreeCollisionManager, as it is by default.
#include <fcl/fcl.h>

#include <algorithm>

#include "bench/scene/manager.h"

namespace limber::bench {
namespace {

fcl::Vector3d to_fcl(const Vec3& v) { return {v.x, v.y, v.z}; }

/// An object whose box may be replaced.
class Body : public fcl::CollisionObjectd {
 public:
  using fcl::CollisionObjectd::CollisionObjectd;
  void set_box(const fcl::AABBd& box) { aabb = box; }
};

struct Found {
  std::vector<ObjectPair>* pairs;
  const Body* first;
};

bool add(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
  const Found& found = *static_cast<const Found*>(data);
  const auto i = static_cast<ObjectId>(static_cast<const Body*>(a) - found.first);
  const auto j = static_cast<ObjectId>(static_cast<const Body*>(b) - found.first);
  found.pairs->push_back({std::min(i, j), std::max(i, j)});
  return false;
}

class FclManager : public Manager {
 public:
  FclManager(const Mesh& shape, std::size_t bodies, bool builds_anew) : builds_anew_(builds_anew) {
    std::vector<fcl::Vector3d> points;
    for (const Vec3& p : shape.positions()) points.push_back(to_fcl(p));
    std::vector<fcl::Triangle> triangles;
    for (const Corners& c : shape.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
    const auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    model->beginModel();
    model->addSubModel(points, triangles);
    model->endModel();
    bodies_.reserve(bodies);
    for (std::size_t i = 0; i < bodies; ++i) bodies_.emplace_back(model);
    for (Body& body : bodies_) all_.push_back(&body);
  }

  std::string name() const override { return builds_anew_ ? "FCL, built anew" : "FCL"; }
  void set_pose(std::size_t body, const Transform& pose) override {
    fcl::Matrix3d r;
    const Vec3 rows[3] = {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2};
    for (int i = 0; i < 3; ++i) r.row(i) = to_fcl(rows[i]).transpose();
    bodies_[body].setTransform(r, to_fcl(pose.translation));
    bodies_[body].computeAABB();
  }
  void set_box(std::size_t body, const Box& box) override {
    bodies_[body].set_box(fcl::AABBd(to_fcl(box.low), to_fcl(box.high)));
  }
  void update() override {
    if (!manager_.empty() && !builds_anew_) return manager_.update();
    manager_.clear();
    manager_.registerObjects(all_);
    manager_.setup();
  }
  void find_pairs(std::vector<ObjectPair>& pairs) override {
    Found found{&pairs, bodies_.data()};
    manager_.collide(&found, add);
  }

 private:
  bool builds_anew_;
  std::vector<fcl::CollisionObjectd*> all_;
  std::vector<Body> bodies_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<Manager> make_fcl_manager(const Mesh& shape, std::size_t bodies, bool builds_anew) {
  return std::make_unique<FclManager>(shape, bodies, builds_anew);
}

}  // namespace limber::bench
