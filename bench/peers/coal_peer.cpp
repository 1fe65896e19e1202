// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Coal with BVHModel<OBBRSS>, from the C++ headers and library in its PyPI wheel. As in FCL, the relative error of a
// distance request is not used for two meshes.
#include <coal/BVH/BVH_model.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree.h>
#include <coal/collision.h>
#include <coal/distance.h>

#include "bench/peers/fcl_family.h"

namespace limber::bench {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"  // of Coal's base
template <typename Visit>
struct Collector : coal::CollisionCallBackBase {
  const Visit* visit = nullptr;
  bool collide(coal::CollisionObject* a, coal::CollisionObject* b) override {
    (*visit)(a, b);
    return false;
  }
};
#pragma GCC diagnostic pop

struct Coal {
  static constexpr const char* name = "Coal";
  static constexpr auto ok = coal::BVH_OK;
  using Vector = coal::Vec3s;
  using Matrix = coal::Matrix3s;
  using Triangle = coal::Triangle;
  using Volume = coal::OBBRSS;
  template <typename AnyVolume>
  using Tree = coal::BVHModel<AnyVolume>;

  using Object = coal::CollisionObject;
  using Body = Object;
  using Manager = coal::DynamicAABBTreeCollisionManager;
  static coal::AABB& box_of(Body& body) { return body.getAABB(); }

  template <typename Visit>
  static void for_each_pair(Manager& manager, const Visit& visit) {
    Collector<Visit> collector;
    collector.visit = &visit;
    manager.collide(&collector);
  }
};

class CoalPeer : public FamilyPeer<Coal, Coal::Volume> {
 public:
  using FamilyPeer::FamilyPeer;
  bool answers(Question) const override { return true; }
  double ask(Question question, const Transform& pose_b) override {
    const coal::Transform3s origin = coal::Transform3s::Identity();
    const coal::Transform3s pose(matrix<Coal>(pose_b.rotation), vector<Coal>(pose_b.translation));
    const coal::CollisionGeometry *a = a_.get(), *b = b_.get();
    if (question == Question::collide) {
      const coal::CollisionRequest request;
      coal::CollisionResult result;
      return coal::collide(a, origin, b, pose, request, result) > 0 ? 0 : 1;
    }
    coal::DistanceRequest request;
    request.enable_signed_distance = false;
    if (question == Question::rough) request.rel_err = rough_error;
    coal::DistanceResult result;
    return std::max(0.0, coal::distance(a, origin, b, pose, request, result));
  }
};

}  // namespace

std::unique_ptr<Peer> make_coal(const Mesh& a, const Mesh& b) { return std::make_unique<CoalPeer>(a, b); }
std::unique_ptr<Manager> make_coal_manager(const Mesh& shape, std::size_t bodies, bool builds_anew) {
  return std::make_unique<FamilyManager<Coal>>(shape, bodies, builds_anew);
}

}  // namespace limber::bench
