// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/peer.h"

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/classic/classic.h"

namespace limber::bench {
namespace {

class LimberPeer : public Peer {
 public:
  LimberPeer(const Mesh& a, const Mesh& b) : a_(a), b_(b) {}
  bool answers(Question) const override { return true; }
  bool deform(const std::vector<Vec3>& positions) override {
    const bool done = static_cast<bool>(a_.move_all(positions));
    a_.commit();
    return done;
  }
  double ask(Question question, const Transform& pose_b) override {
    if (question == Question::collide) return collide({a_}, {b_, pose_b}).is_yes() ? 0 : 1;
    return distance({a_}, {b_, pose_b}, {.relative_error = question == Question::rough ? rough_error : 0}).upper;
  }

 private:
  Model a_, b_;
};

class ClassicPeer : public Peer {
 public:
  ClassicPeer(const Mesh& a, const Mesh& b) : a_(a), b_(b) {}
  bool answers(Question) const override { return true; }
  double ask(Question question, const Transform& pose_b) override {
    const classic::Placed a{a_}, b{b_, pose_b};
    if (question == Question::collide) return classic::collide(a, b).is_yes() ? 0 : 1;
    return classic::distance(a, b, {.relative_error = question == Question::rough ? rough_error : 0}).upper;
  }

 private:
  classic::Model a_, b_;
};

std::unique_ptr<Peer> make_limber(const Mesh& a, const Mesh& b) { return std::make_unique<LimberPeer>(a, b); }

}  // namespace

const char* to_text(Question question) {
  return question == Question::exact ? "distance" : question == Question::rough ? "within 10 %" : "collide";
}

bool agree(Question question, double a, double b, double tolerance) {
  if (question == Question::collide) return a == b;
  const double error = question == Question::rough ? rough_error : 0;  // both are within it of the true distance
  return a <= b * (1 + error) + tolerance && b <= a * (1 + error) + tolerance;
}

std::unique_ptr<Peer> make_classic(const Mesh& a, const Mesh& b) { return std::make_unique<ClassicPeer>(a, b); }

std::vector<Contestant> deforming_peers(const Mesh& a, const Mesh& b) {
  std::vector<Contestant> peers;
  peers.emplace_back("limber", make_limber(a, b));
#ifdef LIMBER_PEER_EMBREE
  peers.emplace_back("embree, triangles", make_embree(a));
#endif
#ifdef LIMBER_PEER_FCL
  peers.emplace_back("fcl, AABB", make_fcl_aabb(a, b));
  peers.emplace_back("fcl, OBBRSS", make_fcl(a, b));
#endif
#ifdef LIMBER_PEER_COAL
  peers.emplace_back("coal, OBBRSS", make_coal(a, b));
#endif
  return peers;
}

}  // namespace limber::bench
