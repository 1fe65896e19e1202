// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bullet's GImpact shapes, its only way from mesh to mesh: the collision algorithm of a pair of objects. No early out,
// no distance.
#include <btBulletCollisionCommon.h>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include "bench/peers/peer.h"

namespace limber::bench {
namespace {

btVector3 vector(const Vec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

class BulletModel {
 public:
  explicit BulletModel(const Mesh& mesh) {
    for (const Vec3& p : mesh.positions()) {
      for (std::size_t k = 0; k < 3; ++k) vertices_.push_back(static_cast<btScalar>(p[k]));
    }
    for (const Corners& c : mesh.triangles()) {
      for (const VertexId v : c) indices_.push_back(static_cast<int>(v));
    }
    btIndexedMesh part;
    part.m_numTriangles = static_cast<int>(mesh.triangles().size());
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices_.data());
    part.m_triangleIndexStride = 3 * sizeof(int);
    part.m_numVertices = static_cast<int>(mesh.positions().size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices_.data());
    part.m_vertexStride = 3 * sizeof(btScalar);
    part.m_vertexType = sizeof(btScalar) == sizeof(double) ? PHY_DOUBLE : PHY_FLOAT;
    meshes_.addIndexedMesh(part, PHY_INTEGER);
    shape_ = std::make_unique<btGImpactMeshShape>(&meshes_);
    shape_->setMargin(static_cast<btScalar>(1e-7));
    shape_->updateBound();
    object.setCollisionShape(shape_.get());
  }
  void deform(const std::vector<Vec3>& positions) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      for (std::size_t k = 0; k < 3; ++k) vertices_[3 * v + k] = static_cast<btScalar>(positions[v][k]);
    }
    shape_->postUpdate();
    shape_->updateBound();
  }
  btCollisionObject object;

 private:
  std::vector<btScalar> vertices_;
  std::vector<int> indices_;
  btTriangleIndexVertexArray meshes_;
  std::unique_ptr<btGImpactMeshShape> shape_;
};

class BulletPeer : public Peer {
 public:
  BulletPeer(const Mesh& a, const Mesh& b) : dispatcher_(&configuration_), a_(a), b_(b) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
  }
  bool answers(Question question) const override { return question == Question::collide; }
  bool deform(const std::vector<Vec3>& positions) override {
    a_.deform(positions);
    return true;
  }
  double ask(Question, const Transform& pose) override {
    const Mat3& r = pose.rotation;
    const btMatrix3x3 basis(vector(r.row0).x(), vector(r.row0).y(), vector(r.row0).z(), vector(r.row1).x(),
                            vector(r.row1).y(), vector(r.row1).z(), vector(r.row2).x(), vector(r.row2).y(),
                            vector(r.row2).z());
    b_.object.setWorldTransform(btTransform(basis, vector(pose.translation)));
    // Not contactPairTest(): it asks for closest-point algorithms, of which GImpact has none, and so says no to
    // everything.
    const btCollisionObjectWrapper a(nullptr, a_.object.getCollisionShape(), &a_.object, a_.object.getWorldTransform(),
                                     -1, -1);
    const btCollisionObjectWrapper b(nullptr, b_.object.getCollisionShape(), &b_.object, b_.object.getWorldTransform(),
                                     -1, -1);
    btCollisionAlgorithm* const algorithm = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    btManifoldResult result(&a, &b);
    algorithm->processCollision(&a, &b, info_, &result);
    btManifoldArray manifolds;
    algorithm->getAllContactManifolds(manifolds);
    bool hit = false;
    for (int i = 0; i < manifolds.size(); ++i) hit = hit || manifolds[i]->getNumContacts() > 0;
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return hit ? 0 : 1;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDispatcherInfo info_;
  BulletModel a_, b_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const Mesh& a, const Mesh& b) { return std::make_unique<BulletPeer>(a, b); }

}  // namespace limber::bench
