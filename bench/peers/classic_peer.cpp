// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/peer.h"
#include "limber/classic.h"

namespace limber::bench {
namespace {

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

}  // namespace

std::unique_ptr<Peer> make_classic(const Mesh& a, const Mesh& b) { return std::make_unique<ClassicPeer>(a, b); }

}  // namespace limber::bench
