// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/peer.h"
#include "limber/distance.h"
#include "limber/model.h"

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
    switch (question) {
      case Question::exact:
        return distance({a_}, {b_, pose_b}).upper;
      case Question::rough:
        return distance({a_}, {b_, pose_b}, {.relative_error = rough_error}).upper;
      case Question::collide:
        break;
    }
    return collide({a_}, {b_, pose_b}).is_yes() ? 0 : 1;
  }

 private:
  Model a_, b_;
};

}  // namespace

std::unique_ptr<Peer> make_limber(const Mesh& a, const Mesh& b) { return std::make_unique<LimberPeer>(a, b); }

std::vector<std::pair<std::string, PeerFactory>> all_peers() {
  return {
      {"limber", make_limber},
#ifdef LIMBER_PEER_FCL
      {"fcl", make_fcl},       {"fcl-forced", make_fcl_forced},
#endif
#ifdef LIMBER_PEER_COAL
      {"coal", make_coal},
#endif
#ifdef LIMBER_PEER_CGAL
      {"cgal", make_cgal},
#endif
#ifdef LIMBER_PEER_BULLET
      {"bullet", make_bullet},
#endif
#ifdef LIMBER_PEER_EMBREE
      {"embree", make_embree},
#endif
  };
}

std::vector<std::pair<std::string, PeerFactory>> all_peers_and_classic() {
  auto peers = all_peers();
  peers.emplace_back("classic", make_classic);
  return peers;
}

std::vector<std::pair<std::string, PeerFactory>> deforming_peers() {
  return {
      {"limber", make_limber},
#ifdef LIMBER_PEER_EMBREE
      {"embree, triangles", make_embree_triangles},
      {"embree, boxes", make_embree},
#endif
#ifdef LIMBER_PEER_BULLET
      {"bullet, GImpact", make_bullet},
#endif
#ifdef LIMBER_PEER_FCL
      {"fcl, AABB", make_fcl_aabb},
      {"fcl, OBBRSS", make_fcl},
#endif
#ifdef LIMBER_PEER_COAL
      {"coal, RSS", make_coal_rss},
      {"coal, OBBRSS", make_coal},
#endif
  };
}

std::vector<std::pair<std::string, BuildTime>> builders() {
  return {
#ifdef LIMBER_PEER_EMBREE
      {"Embree Morton", embree_morton_build_ns},
      {"Embree SAH", embree_sah_build_ns},
#endif
#ifdef LIMBER_PEER_FCL
      {"FCL OBBRSS", fcl_build_ns},
#endif
  };
}

}  // namespace limber::bench
