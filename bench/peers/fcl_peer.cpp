// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// FCL with BVHModel<OBBRSSd>, the volume its documentation recommends for both queries. Its DistanceRequest's rel_err
// is not used for two meshes (the traversal node copies it before the request is there). The forced peer sets it in the
// node, with an abs_err so large that it has no effect, since pruning requires both.
#include <fcl/fcl.h>

#include <algorithm>

#include "bench/peers/peer.h"
#include "bench/support/sampling.h"

namespace limber::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

template <typename Volume = fcl::OBBRSSd>
std::shared_ptr<fcl::BVHModel<Volume>> built(const Mesh& mesh) {
  std::vector<fcl::Vector3d> points;
  for (const Vec3& p : mesh.positions()) points.emplace_back(p.x, p.y, p.z);
  std::vector<fcl::Triangle> triangles;
  for (const Corners& c : mesh.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
  auto model = std::make_shared<fcl::BVHModel<Volume>>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

/// Replaces all vertices and refits from the leaves up, which is the fastest way that FCL has.
template <typename Volume>
bool replaced(fcl::BVHModel<Volume>& model, const std::vector<Vec3>& positions) {
  std::vector<fcl::Vector3d> points;
  points.reserve(positions.size());
  for (const Vec3& p : positions) points.emplace_back(p.x, p.y, p.z);
  return model.beginReplaceModel() == fcl::BVH_OK && model.replaceSubModel(points) == fcl::BVH_OK &&
         model.endReplaceModel(true, true) == fcl::BVH_OK;
}

fcl::Transform3d transform(const Transform& pose) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  const Vec3 rows[3] = {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) t.linear()(i, j) = rows[i][static_cast<std::size_t>(j)];
  }
  t.translation() = fcl::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z);
  return t;
}

class FclPeer : public Peer {
 public:
  FclPeer(const Mesh& a, const Mesh& b, bool forced) : a_(built<>(a)), b_(built<>(b)), forced_(forced) {}

  bool answers(Question question) const override { return forced_ == (question == Question::rough) || !forced_; }

  bool deform(const std::vector<Vec3>& positions) override { return replaced(*a_, positions); }

  double ask(Question question, const Transform& pose_b) override {
    const fcl::Transform3d pose = transform(pose_b);
    if (question == Question::collide) {
      const fcl::CollisionRequestd request;
      fcl::CollisionResultd result;
      return fcl::collide<double>(a_.get(), fcl::Transform3d::Identity(), b_.get(), pose, request, result) > 0 ? 0 : 1;
    }
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    if (question == Question::rough) request.rel_err = rough_error;
    if (!forced_) {
      return std::max(0.0,
                      fcl::distance<double>(a_.get(), fcl::Transform3d::Identity(), b_.get(), pose, request, result));
    }
    fcl::detail::MeshDistanceTraversalNodeOBBRSSd node;
    fcl::detail::initialize(node, *a_, fcl::Transform3d::Identity(), *b_, pose, request, result);
    node.rel_err = rough_error;
    node.abs_err = 1e300;
    fcl::detail::distance<double>(&node);
    return std::max(0.0, result.min_distance);
  }

 private:
  std::shared_ptr<Model> a_, b_;
  bool forced_;
};

/// Axis-aligned boxes. Only their updates are measured, because their queries copy one of the models.
class FclBoxesPeer : public Peer {
 public:
  explicit FclBoxesPeer(const Mesh& a) : a_(built<fcl::AABBd>(a)) {}
  bool answers(Question) const override { return false; }
  double ask(Question, const Transform&) override { return 0; }
  bool deform(const std::vector<Vec3>& positions) override { return replaced(*a_, positions); }

 private:
  std::shared_ptr<fcl::BVHModel<fcl::AABBd>> a_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl_aabb(const Mesh& a, const Mesh&) { return std::make_unique<FclBoxesPeer>(a); }
std::unique_ptr<Peer> make_fcl(const Mesh& a, const Mesh& b) { return std::make_unique<FclPeer>(a, b, false); }
std::unique_ptr<Peer> make_fcl_forced(const Mesh& a, const Mesh& b) { return std::make_unique<FclPeer>(a, b, true); }

double fcl_build_ns(const Mesh& mesh) {
  const Stopwatch watch;
  built<>(mesh);
  return watch.us() * 1e3 / static_cast<double>(mesh.triangles().size());
}

}  // namespace limber::bench
