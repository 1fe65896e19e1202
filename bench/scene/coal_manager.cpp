// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Coal's DynamicAABBTreeCollisionManager, as it is by default, from the C++ headers and library in its PyPI wheel.
#include <coal/BVH/BVH_model.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree.h>

#include <algorithm>

#include "bench/scene/manager.h"

namespace limber::bench {
namespace {

coal::Vec3s to_coal(const Vec3& v) { return {v.x, v.y, v.z}; }

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"  // of Coal's base
struct Collector : coal::CollisionCallBackBase {
  std::vector<ObjectPair>* pairs = nullptr;
  const coal::CollisionObject* first = nullptr;

  bool collide(coal::CollisionObject* a, coal::CollisionObject* b) override {
    const auto i = static_cast<ObjectId>(a - first), j = static_cast<ObjectId>(b - first);
    pairs->push_back({std::min(i, j), std::max(i, j)});
    return false;
  }
};
#pragma GCC diagnostic pop

class CoalManager : public Manager {
 public:
  CoalManager(const Mesh& shape, std::size_t bodies, bool builds_anew) : builds_anew_(builds_anew) {
    std::vector<coal::Vec3s> points;
    for (const Vec3& p : shape.positions()) points.push_back(to_coal(p));
    std::vector<coal::Triangle> triangles;
    for (const Corners& c : shape.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
    const auto model = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
    model->beginModel();
    model->addSubModel(points, triangles);
    model->endModel();
    objects_.reserve(bodies);
    for (std::size_t i = 0; i < bodies; ++i) objects_.emplace_back(model);
    for (coal::CollisionObject& object : objects_) all_.push_back(&object);
  }

  std::string name() const override { return builds_anew_ ? "Coal, built anew" : "Coal"; }
  void set_pose(std::size_t body, const Transform& pose) override {
    coal::Matrix3s r;
    const Vec3 rows[3] = {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2};
    for (int i = 0; i < 3; ++i) r.row(i) = to_coal(rows[i]).transpose();
    objects_[body].setTransform(r, to_coal(pose.translation));
    objects_[body].computeAABB();
  }
  void set_box(std::size_t body, const Box& box) override {
    objects_[body].getAABB() = coal::AABB(to_coal(box.low), to_coal(box.high));
  }
  void update() override {
    if (!manager_.empty() && !builds_anew_) return manager_.update();
    manager_.clear();
    manager_.registerObjects(all_);
    manager_.setup();
  }
  void find_pairs(std::vector<ObjectPair>& pairs) override {
    Collector collector;
    collector.pairs = &pairs, collector.first = objects_.data();
    manager_.collide(&collector);
  }

 private:
  bool builds_anew_;
  std::vector<coal::CollisionObject*> all_;
  std::vector<coal::CollisionObject> objects_;
  coal::DynamicAABBTreeCollisionManager manager_;
};

}  // namespace

std::unique_ptr<Manager> make_coal_manager(const Mesh& shape, std::size_t bodies, bool builds_anew) {
  return std::make_unique<CoalManager>(shape, bodies, builds_anew);
}

}  // namespace limber::bench
