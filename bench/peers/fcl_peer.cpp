// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// FCL with BVHModel<OBBRSSd>, the volume its documentation recommends for both queries. Its DistanceRequest's rel_err
// is not used for two meshes (the traversal node copies it before the request is there). The forced peer sets it in the
// node, with an abs_err so large that it has no effect, since pruning requires both.
#include <fcl/fcl.h>

#include "bench/peers/fcl_family.h"

namespace limber::bench {
namespace {

struct Fcl {
  static constexpr const char* name = "FCL";
  static constexpr auto ok = fcl::BVH_OK;
  using Vector = fcl::Vector3d;
  using Matrix = fcl::Matrix3d;
  using Triangle = fcl::Triangle;
  using Volume = fcl::OBBRSSd;
  template <typename AnyVolume>
  using Tree = fcl::BVHModel<AnyVolume>;

  using Object = fcl::CollisionObjectd;
  using Manager = fcl::DynamicAABBTreeCollisionManagerd;
  /// An object whose box may be replaced.
  struct Body : Object {
    using Object::Object;
    fcl::AABBd& box() { return aabb; }
  };
  static fcl::AABBd& box_of(Body& body) { return body.box(); }

  template <typename Visit>
  static void for_each_pair(Manager& manager, Visit visit) {
    manager.collide(&visit, [](Object* a, Object* b, void* data) {
      (*static_cast<Visit*>(data))(a, b);
      return false;
    });
  }
};

class FclPeer : public FamilyPeer<Fcl, Fcl::Volume> {
 public:
  FclPeer(const Mesh& a, const Mesh& b, bool forced) : FamilyPeer(a, b), forced_(forced) {}

  bool answers(Question question) const override { return forced_ == (question == Question::rough) || !forced_; }

  double ask(Question question, const Transform& pose_b) override {
    const fcl::Transform3d origin = fcl::Transform3d::Identity();
    fcl::Transform3d pose = origin;
    pose.linear() = matrix<Fcl>(pose_b.rotation);
    pose.translation() = vector<Fcl>(pose_b.translation);
    if (question == Question::collide) {
      const fcl::CollisionRequestd request;
      fcl::CollisionResultd result;
      return fcl::collide<double>(a_.get(), origin, b_.get(), pose, request, result) > 0 ? 0 : 1;
    }
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    if (question == Question::rough) request.rel_err = rough_error;
    if (!forced_) return std::max(0.0, fcl::distance<double>(a_.get(), origin, b_.get(), pose, request, result));
    fcl::detail::MeshDistanceTraversalNodeOBBRSSd node;
    fcl::detail::initialize(node, *a_, origin, *b_, pose, request, result);
    node.rel_err = rough_error;
    node.abs_err = 1e300;
    fcl::detail::distance<double>(&node);
    return std::max(0.0, result.min_distance);
  }

 private:
  bool forced_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const Mesh& a, const Mesh& b) { return std::make_unique<FclPeer>(a, b, false); }
std::unique_ptr<Peer> make_fcl_forced(const Mesh& a, const Mesh& b) { return std::make_unique<FclPeer>(a, b, true); }

// Axis-aligned boxes. Only their updates are measured, because their queries copy one of the models.
std::unique_ptr<Peer> make_fcl_aabb(const Mesh& a, const Mesh& b) {
  return std::make_unique<FamilyPeer<Fcl, fcl::AABBd>>(a, b);
}

std::unique_ptr<Manager> make_fcl_manager(const Mesh& shape, std::size_t bodies, bool builds_anew) {
  return std::make_unique<FamilyManager<Fcl>>(shape, bodies, builds_anew);
}

}  // namespace limber::bench
