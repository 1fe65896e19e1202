// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "bench/peers/peer.h"

/// What FCL and Coal, which began as a copy of it, have in common. `Library` names their types and what differs.
namespace limber::bench {

template <typename Library>
typename Library::Vector vector(const Vec3& v) {
  return {v.x, v.y, v.z};
}

template <typename Library>
std::vector<typename Library::Vector> vectors(const std::vector<Vec3>& points) {
  std::vector<typename Library::Vector> all;
  all.reserve(points.size());
  for (const Vec3& p : points) all.push_back(vector<Library>(p));
  return all;
}

template <typename Library>
typename Library::Matrix matrix(const Mat3& rotation) {
  typename Library::Matrix r;
  const Vec3 rows[3] = {rotation.row0, rotation.row1, rotation.row2};
  for (int i = 0; i < 3; ++i) r.row(i) = vector<Library>(rows[i]).transpose();
  return r;
}

template <typename Library, typename Volume>
auto built(const Mesh& mesh) {
  std::vector<typename Library::Triangle> triangles;
  for (const Corners& c : mesh.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
  auto tree = std::make_shared<typename Library::template Tree<Volume>>();
  tree->beginModel();
  tree->addSubModel(vectors<Library>(mesh.positions()), triangles);
  tree->endModel();
  return tree;
}

/// Two trees. Updates refit from the leaves up, which is the fastest way that both libraries have.
template <typename Library, typename Volume>
class FamilyPeer : public Peer {
 public:
  FamilyPeer(const Mesh& a, const Mesh& b) : a_(built<Library, Volume>(a)), b_(built<Library, Volume>(b)) {}
  bool deform(const std::vector<Vec3>& positions) override {
    return a_->beginReplaceModel() == Library::ok && a_->replaceSubModel(vectors<Library>(positions)) == Library::ok &&
           a_->endReplaceModel(true, true) == Library::ok;
  }

 protected:
  std::shared_ptr<typename Library::template Tree<Volume>> a_, b_;
};

/// DynamicAABBTreeCollisionManager, as it is by default.
template <typename Library>
class FamilyManager : public Manager {
 public:
  FamilyManager(const Mesh& shape, std::size_t bodies, bool builds_anew) : builds_anew_(builds_anew) {
    const auto tree = built<Library, typename Library::Volume>(shape);
    bodies_.reserve(bodies);
    for (std::size_t i = 0; i < bodies; ++i) bodies_.emplace_back(tree);
    for (typename Library::Body& body : bodies_) all_.push_back(&body);
  }

  std::string name() const override { return std::string(Library::name) + (builds_anew_ ? ", built anew" : ""); }
  void set_pose(std::size_t body, const Transform& pose) override {
    bodies_[body].setTransform(matrix<Library>(pose.rotation), vector<Library>(pose.translation));
    bodies_[body].computeAABB();
  }
  void set_box(std::size_t body, const Box& box) override {
    Library::box_of(bodies_[body]) = {vector<Library>(box.low), vector<Library>(box.high)};
  }
  void update() override {
    if (!manager_.empty() && !builds_anew_) return manager_.update();
    manager_.clear();
    manager_.registerObjects(all_);
    manager_.setup();
  }
  void find_pairs(std::vector<ObjectPair>& pairs) override {
    Library::for_each_pair(manager_, [&](const auto* a, const auto* b) {
      const auto id = [&](const auto* object) {
        return static_cast<ObjectId>(static_cast<const typename Library::Body*>(object) - bodies_.data());
      };
      pairs.push_back({std::min(id(a), id(b)), std::max(id(a), id(b))});
    });
  }

 private:
  bool builds_anew_;
  std::vector<typename Library::Object*> all_;
  std::vector<typename Library::Body> bodies_;
  typename Library::Manager manager_;
};

}  // namespace limber::bench
