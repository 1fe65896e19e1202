// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The first impact of a body that moves through a scene. The way is walked in pieces of time, in which the body moves
// by about its own size. Objects near a piece, which no earlier piece was near, are asked for all of the way that is
// left; a hit ends that way.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"
#include "limber/path.h"
#include "motion/rigid/moving_distance.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

constexpr const char* time_of_impact_name = "limber::Scene::time_of_impact";

class ImpactSearch {
 public:
  /// The motion is null, or that of the path.
  ImpactSearch(const Scene::Impl& scene, const Body& body, const RigidPath& path, const RigidMotion* motion,
               const ObjectImpactOptions& options)
      : scene_(scene),
        body_(body),
        path_(path),
        motion_(motion),
        filter_(options.filter),
        of_pair_(options.path),
        asked_(scene.objects.size()) {
    found_.result.status = ImpactStatus::clear;
    found_.result.time = std::numeric_limits<double>::infinity();
  }

  ObjectImpactResult run() {
    const scene::LocalBounds local = scene::local_bounds(body_);
    const double size = std::max(2 * local.radius, std::numeric_limits<double>::min());
    const int pieces = static_cast<int>(std::min(path_.speed * of_pair_.max_time / size, most_pieces - 1)) + 1;
    const double duration = of_pair_.max_time / pieces;
    // Times are rounded.
    const double reach = of_pair_.min_separation + path_.speed * (0.5 * duration + 0x1p-50);
    for (int piece = 0; piece < pieces; ++piece) {
      begin_ = piece * duration;
      if (begin_ > of_pair_.max_time) break;
      const Placed there(body_, path_.pose(std::min(begin_ + 0.5 * duration, 1.0)));
      require_ready(there, time_of_impact_name, "the model");
      find_near(scene::world_bounds(local, there.pose), reach);
      for (const Near& object : near_) {
        ask(object.id);
        if (!scene::ends_all(found_.result.stopped_by)) continue;
        found_.result.time = begin_;  // nothing is known of other objects near this piece
        return found_;
      }
    }
    return found_;
  }

 private:
  struct Near {
    double bound;
    ObjectId id;
    friend bool operator<(const Near& s, const Near& t) { return s.bound != t.bound ? s.bound < t.bound : s.id < t.id; }
  };
  static constexpr double most_pieces = 64;

  /// Finds the objects that count, have not been asked, and may be within a distance.
  void find_near(const scene::WorldBounds& bounds, double reach) {
    near_.clear();
    scene_.tree.visit_near(bounds, scene::margin_with_error(reach), [&](std::uint32_t rank) {
      const ObjectId id = scene_.tree.id_of(rank);
      if (asked_[id]) return true;
      asked_[id] = true;
      if (!filter_ || (*filter_)(id)) near_.push_back({scene_.tree.lower_bound(bounds, rank), id});
      return true;
    });
    std::sort(near_.begin(), near_.end());
  }
  void ask(ObjectId id) {
    const PathImpact impact = motion::first_impact(body_, path_, motion_, scene_.placed(id), begin_, of_pair_);
    PathImpact& first = found_.result;
    const std::uint64_t distances = first.distance_count + impact.distance_count;
    QueryStats stats = first.stats;
    stats += impact.stats;
    // A contact and an object that could not be decided may share a time: the contact counts.
    const bool is_first = impact.time < first.time || (impact.witness && !first.witness && impact.time == first.time);
    if (is_first) {
      first = impact;
      found_.object = impact.witness ? id : no_id;
      of_pair_.max_time = impact.time;
    }
    first.distance_count = distances, first.stats = stats;
  }

  const Scene::Impl& scene_;
  const Body body_;
  const RigidPath path_;
  const RigidMotion* const motion_;
  const std::optional<ObjectFilter> filter_;
  PathOptions of_pair_;  // its max_time is that of the first impact so far
  double begin_ = 0;     // of the piece
  std::vector<bool> asked_;
  std::vector<Near> near_;
  ObjectImpactResult found_;
};

void check(const Scene::Impl& scene, const Body& body, const ObjectImpactOptions& options) {
  scene::require_committed(scene, "limber::Scene::time_of_impact");
  require_ready(Placed(body), time_of_impact_name, "the model");
  motion::check_path_options(options.path, time_of_impact_name);
  LIMBER_REQUIRE(options.path.cache == nullptr, "limber::Scene::time_of_impact: path takes no cache");
}

}  // namespace

ObjectImpactResult Scene::time_of_impact(const Body& body, const RigidMotion& motion,
                                         const ObjectImpactOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("time_of_impact");
  check(scene, body, options);
  const auto pose = [&](double time) { return motion.at(time); };
  return ImpactSearch(scene, body, {pose, motion::speed_of(body, motion)}, &motion, options).run();
}

ObjectImpactResult Scene::time_of_impact(const Body& body, const RigidPath& path,
                                         const ObjectImpactOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("time_of_impact");
  check(scene, body, options);
  motion::check_speed(path.speed, time_of_impact_name);
  return ImpactSearch(scene, body, path, nullptr, options).run();
}

}  // namespace limber
