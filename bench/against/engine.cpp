// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// This revision behind the interface. The comparison compiles two such files: this one, with
// LIMBER_MAKE_ENGINE = make_engine_now, and that of the other revision, whose namespace a macro renames, with
// make_engine_before.
#include "bench/against/engine.h"

#include <bit>
#include <utility>

#include "limber/distance.h"
#include "limber/model.h"

namespace {

std::vector<limber::Vec3> vectors(const std::vector<std::array<double, 3>>& points) {
  std::vector<limber::Vec3> result;
  result.reserve(points.size());
  for (const auto& p : points) result.push_back({p[0], p[1], p[2]});
  return result;
}

limber::Mesh mesh(const against::RawMesh& raw) {
  return limber::Mesh::create(vectors(raw.positions), raw.triangles).value();
}

limber::Transform transform(const against::RawPose& pose) {
  const auto& r = pose.rotation;
  return {{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}},
          {pose.translation[0], pose.translation[1], pose.translation[2]}};
}

class ThisEngine : public against::Engine {
 public:
  ThisEngine(const against::RawMesh& a, const against::RawMesh& b) : a_(mesh(a)), b_(mesh(b)) {}

  double ask(against::Question question, const against::RawPose& pose) override {
    const limber::Placed a{a_}, b{b_, transform(pose)};
    switch (question) {
      case against::Question::collide:
        return collide(a, b).is_yes() ? 1 : 0;
      case against::Question::exact:
        return distance(a, b).upper;
      case against::Question::within_10_percent:
        return distance(a, b, {.relative_error = 0.1}).upper;
      case against::Question::within_limit:
        return within(a, b, 0.01).is_yes() ? 1 : 0;
      case against::Question::warm_exact:
        return distance(a, b, {.cache = &cache_}).upper;
    }
    return 0;
  }

  void move_all(const std::vector<std::array<double, 3>>& positions) override {
    a_.move_all(std::span(std::bit_cast<const limber::Vec3*>(positions.data()), positions.size())).value();
    a_.commit();
  }
  void move(const std::vector<std::uint32_t>& ids, const std::vector<std::array<double, 3>>& positions) override {
    a_.move_vertices(ids, std::span(std::bit_cast<const limber::Vec3*>(positions.data()), positions.size())).value();
    a_.commit();
  }

  void build() override { a_ = limber::Model(limber::Mesh(a_.mesh())); }

 private:
  limber::Model a_, b_;
  limber::QueryCache cache_;
};

}  // namespace

std::unique_ptr<against::Engine> LIMBER_MAKE_ENGINE(const against::RawMesh& a, const against::RawMesh& b) {
  return std::make_unique<ThisEngine>(a, b);
}
