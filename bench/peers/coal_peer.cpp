// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Coal with BVHModel<OBBRSS>, from the C++ headers and library in its PyPI wheel. As in FCL, the relative error of a
// distance request is not used for two meshes.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>

#include <algorithm>
#include <type_traits>

#include "bench/peers/peer.h"
#include "limber/distance.h"

namespace limber::bench {
namespace {

template <typename Volume>
std::shared_ptr<coal::BVHModel<Volume>> built(const Mesh& mesh) {
  std::vector<coal::Vec3s> points;
  for (const Vec3& p : mesh.positions()) points.emplace_back(p.x, p.y, p.z);
  std::vector<coal::Triangle> triangles;
  for (const Corners& c : mesh.triangles()) triangles.emplace_back(c[0], c[1], c[2]);
  auto model = std::make_shared<coal::BVHModel<Volume>>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

coal::Transform3s transform(const Transform& pose) {
  coal::Matrix3s r;
  const Vec3 rows[3] = {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = rows[i][static_cast<std::size_t>(j)];
  }
  return {r, coal::Vec3s(pose.translation.x, pose.translation.y, pose.translation.z)};
}

template <typename Volume>
class CoalPeer : public Peer {
 public:
  CoalPeer(const Mesh& a, const Mesh& b) : a_(built<Volume>(a)), b_(built<Volume>(b)) {}
  bool answers(Question question) const override {
    return question != Question::collide || std::is_same_v<Volume, coal::OBBRSS>;
  }
  bool deform(const std::vector<Vec3>& positions) override {
    std::vector<coal::Vec3s> points;
    points.reserve(positions.size());
    for (const Vec3& p : positions) points.emplace_back(p.x, p.y, p.z);
    return a_->beginReplaceModel() == coal::BVH_OK && a_->replaceSubModel(points) == coal::BVH_OK &&
           a_->endReplaceModel(true, true) == coal::BVH_OK;
  }
  double ask(Question question, const Transform& pose_b) override {
    const coal::Transform3s origin = coal::Transform3s::Identity(), pose = transform(pose_b);
    if (question == Question::collide) {
      const coal::CollisionRequest request;
      coal::CollisionResult result;
      return coal::collide(a_.get(), origin, b_.get(), pose, request, result) > 0 ? 0 : 1;
    }
    coal::DistanceRequest request;
    request.enable_signed_distance = false;
    if (question == Question::rough) request.rel_err = rough_error;
    coal::DistanceResult result;
    return std::max(0.0, coal::distance(a_.get(), origin, b_.get(), pose, request, result));
  }

 private:
  std::shared_ptr<coal::BVHModel<Volume>> a_, b_;
};

}  // namespace

std::unique_ptr<Peer> make_coal(const Mesh& a, const Mesh& b) { return std::make_unique<CoalPeer<coal::OBBRSS>>(a, b); }
std::unique_ptr<Peer> make_coal_rss(const Mesh& a, const Mesh& b) {
  return std::make_unique<CoalPeer<coal::RSS>>(a, b);
}

}  // namespace limber::bench
