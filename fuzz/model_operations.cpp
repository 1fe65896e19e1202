// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as two small meshes and a sequence of operations on their models, against brute force.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/inputs.h"
#include "fuzz/property.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "support/right_answers.h"

namespace limber::fuzz {
namespace {

using testing::Truth;
using testing::wrong_answer;

constexpr std::size_t most_brute_force_tests = 2'500;
constexpr std::size_t most_steps = 60;
constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
/// The error that distances may have, as a part of the largest placed coordinates of both models, and at least: the sum
/// of the bounds of docs/algorithms/numerics.md, with extents of twice that and distances of four times that.
constexpr double relative_tolerance = 0x1p-42, least_tolerance = 0x1p-1020;

ModelOptions some_options(ByteReader& bytes, double factor) {
  constexpr std::array<double, 5> margins{0, 0x1p-20, 0x1p-10, 0.25, 4};
  constexpr std::array<std::optional<double>, 4> budgets{ModelOptions::automatic, 0, 1, 1e9};
  const double motion_margin = margins[bytes.below(5)] * factor;
  const auto rebuild_policy = static_cast<RebuildPolicy>(bytes.below(3));
  const std::optional<double> budget_us = budgets[bytes.below(4)];
  return {.motion_margin = motion_margin,
          .rebuild_policy = rebuild_policy,
          .rebuild_budget_us = budget_us,
          .preallocate = budget_us == 1};
}

template <typename Function>
void require_refused(const Function& function, const char* what) {
  try {
    function();
  } catch (const std::logic_error&) {
    return;
  }
  require(false, "what makes no sense is refused", what);
}

double size_of(const Placed& placed) {
  double size = 0;
  for (const Vec3& p : placed.model().mesh().positions()) size = std::max(size, length(p));
  return size + max_abs(placed.pose.translation);
}

Truth truth_about(const Placed& a, const Placed& b) {
  const reference::Placed plain_a{a.model().mesh(), a.pose}, plain_b{b.model().mesh(), b.pose};
  const double size = size_of(a) + size_of(b), distance = reference::distance(plain_a, plain_b).upper;
  require(reference::collide(plain_a, plain_b).is_yes() == (distance == 0),
          "by brute force, models collide exactly when their distance is 0");
  return {distance, std::max(relative_tolerance * size, least_tolerance), size};
}

/// Two models, their poses, and a query cache. The bytes of the input choose calls of the whole public interface. Each
/// model has a copy of the mesh that it should have; each committed state and each answer is checked.
class ModelSession {
 public:
  explicit ModelSession(ByteReader bytes)
      : bytes_(bytes),
        environment_(bytes_.byte()),
        factor_(scale(bytes_)),
        bodies_{body(bytes_, factor_), body(bytes_, factor_)} {}

  /// Reads operations until the input or the time for brute force is used up, then commits and checks.
  void run() {
    using Operation = void (ModelSession::*)(Body&);
    constexpr std::array<Operation, 16> operations{
        &ModelSession::move_all,      &ModelSession::commit,    &ModelSession::rebuild,      &ModelSession::set_margin,
        &ModelSession::take_new_mesh, &ModelSession::reject,    &ModelSession::move_aliased, &ModelSession::move_away,
        &ModelSession::change_pose,   &ModelSession::misuse,    &ModelSession::clear_cache,  &ModelSession::move_some,
        &ModelSession::move_some,     &ModelSession::move_some, &ModelSession::query,        &ModelSession::query};
    try {
      for (std::size_t i = 0; i < most_steps && !bytes_.is_empty() && brute_force_tests_ < most_brute_force_tests;
           ++i) {
        const std::uint8_t choice = bytes_.byte();
        (this->*operations[choice % 16])(bodies_[choice / 128]);
      }
      query(bodies_[0]);
    } catch (const std::logic_error& violated) {
      std::string detail = violated.what();
      for (const Body& body : bodies_) {
        if (const Result<void> valid = body.model.validate(); !valid) detail += "\n" + valid.error().text;
      }
      require(false, "the library's own checks hold", detail);
    }
  }

 private:
  struct Body {
    Model model;
    std::vector<Vec3> positions;  // that the mesh should have
    std::vector<Corners> triangles;
    Transform pose;
  };

  static Body body(ByteReader& bytes, double factor) {
    Mesh mesh = small_mesh(bytes, factor);
    std::vector<Vec3> positions = mesh.positions();
    std::vector<Corners> triangles = mesh.triangles();
    const ModelOptions options = some_options(bytes, factor);
    return {Model(std::move(mesh), options), std::move(positions), std::move(triangles), pose(bytes, factor)};
  }

  Vec3 new_position(const Vec3& old) {
    const Vec3 step = scaled(point(bytes_), factor_);
    if (bytes_.flag()) return step;
    return made_valid(old + step * 0x1p-6);
  }
  double some_length() { return std::abs(coordinate(bytes_)) * factor_; }
  std::size_t vertex_in(const Body& target) { return bytes_.byte() % target.positions.size(); }

  template <typename Update>
  void check_update(const Body& moved, const Update& update) {
    require(in_environment(environment_, [&] { return static_cast<bool>(update()); }), "a sound update is accepted");
    require(moved.model.mesh().positions() == moved.positions, "an update moves what it was given");
  }

  void move_some(Body& moving) {
    std::vector<VertexId> ids;
    std::vector<Vec3> positions;
    for (std::uint32_t i = 0, count = bytes_.below(5); i < count; ++i) {
      const std::size_t v = vertex_in(moving);
      ids.push_back(static_cast<VertexId>(v));
      positions.push_back(new_position(moving.positions[v]));
      moving.positions[v] = positions.back();
    }
    check_update(moving, [&] { return moving.model.move_vertices(ids, positions); });
  }

  void move_all(Body& moving) {
    if (bytes_.flag()) {  // one motion for all
      const Vec3 step = new_position({});
      for (Vec3& p : moving.positions) p = made_valid(p + step);
    } else {
      for (std::uint32_t i = 0, count = bytes_.below(8); i < count; ++i) {
        Vec3& p = moving.positions[vertex_in(moving)];
        p = new_position(p);
      }
    }
    check_update(moving, [&] { return moving.model.move_all(moving.positions); });
  }

  /// An update that refers to the model's own positions.
  void move_aliased(Body& moving) {
    const std::size_t count = 1 + bytes_.byte() % moving.positions.size();
    std::vector<VertexId> ids;
    for (std::size_t i = 0; i < count; ++i) ids.push_back(static_cast<VertexId>(vertex_in(moving)));
    const std::vector<Vec3> copy = moving.positions;
    for (std::size_t i = 0; i < count; ++i) moving.positions[ids[i]] = copy[i];
    const std::span<const Vec3> own = std::span<const Vec3>(moving.model.mesh().positions()).first(count);
    check_update(moving, [&] { return moving.model.move_vertices(ids, own); });
  }

  void reject(Body& target) {
    const std::uint32_t kind = bytes_.below(8);
    std::vector<Vec3> positions = target.positions;
    std::vector<VertexId> ids(positions.size());
    std::iota(ids.begin(), ids.end(), VertexId{0});
    const std::size_t at = vertex_in(target), axis = bytes_.below(3);
    constexpr std::array codes{ErrorCode::non_finite,    ErrorCode::non_finite,         ErrorCode::non_finite,
                               ErrorCode::too_large,     ErrorCode::index_out_of_range, ErrorCode::index_out_of_range,
                               ErrorCode::size_mismatch, ErrorCode::size_mismatch};
    const std::array bad{nan, infinity, -infinity, nudged(max_coordinate, 1)};
    if (kind < 4) {
      positions[at][axis] = bad[kind];
    } else if (kind < 6) {
      ids[at] = kind == 4 ? static_cast<VertexId>(positions.size()) : no_id;
    } else {
      positions.resize(kind == 6 ? positions.size() - 1 : positions.size() + 1);
    }
    const bool of_all = kind < 4 && bytes_.flag(), was_committed = target.model.is_committed();
    const Result<void> outcome = of_all ? target.model.move_all(positions) : target.model.move_vertices(ids, positions);
    require(!outcome, "an unsound update is rejected");
    const Error& error = outcome.error();
    require(error.code == codes[kind] && is_one_line(error.text) && (kind >= 6 || error.where == at),
            "a rejected update has the right code, one line of text, and names the entry", error.text);
    require(target.model.is_committed() == was_committed && target.model.mesh().positions() == target.positions,
            "a rejected update leaves the model as it was");
  }

  void set_margin(Body& target) {
    const double motion_margin = bytes_.below(4) == 0 ? 0 : some_length();
    in_environment(environment_, [&] { target.model.set_motion_margin(motion_margin); });
    require(target.model.options().motion_margin == motion_margin, "set_motion_margin() changes the option");
  }

  void take_new_mesh(Body& target) {
    Mesh mesh = small_mesh(bytes_, factor_);
    target.positions = mesh.positions();
    target.triangles = mesh.triangles();
    in_environment(environment_, [&] { target.model.reset(std::move(mesh)); });
    check_committed(target);
  }

  /// Passes the model through another one.
  void move_away(Body& target) {
    Model other = std::move(target.model);
    require_refused([&] { target.model.commit(); }, "commit() of a moved-from model");
    require_refused([&] { static_cast<void>(target.model.move_all(target.positions)); }, "move_all() of such a model");
    require_refused([&] { static_cast<void>(target.model.tree_stats()); }, "tree_stats() of such a model");
    require_refused([&] { static_cast<void>(collide({target.model}, {other})); }, "a query of such a model");
    target.model = std::move(other);
    require(target.model.mesh().positions() == target.positions, "a model that was moved keeps its positions");
  }

  void change_pose(Body& target) {
    if (bytes_.flag()) {
      target.pose = pose(bytes_, factor_);
    } else {  // a small step
      target.pose.translation = made_valid(target.pose.translation + scaled(point(bytes_), factor_) * 0x1p-6);
    }
  }

  void misuse(Body& target) {
    const double bad = bytes_.flag() ? nan : -1;
    Transform not_rigid = target.pose;
    not_rigid.rotation.row1.y = bytes_.flag() ? nan : 3;
    const Placed placed{target.model};
    if (!target.model.is_committed()) {
      return require_refused([&] { static_cast<void>(collide(placed, placed)); }, "a query of an uncommitted model");
    }
    require_refused([&] { static_cast<void>(collide({target.model, not_rigid}, placed)); }, "a pose that is not rigid");
    require_refused([&] { static_cast<void>(distance(placed, placed, {.relative_error = bad})); }, "a bad error");
    require_refused([&] { static_cast<void>(within(placed, placed, bad)); }, "a bad distance");
    check_committed(target);
  }

  void commit(Body& target) {
    in_environment(environment_, [&] { target.model.commit(); });
    check_committed(target);
  }

  void rebuild(Body& target) {
    in_environment(environment_, [&] { target.model.rebuild(); });
    check_committed(target);
  }

  void clear_cache(Body& /*target*/) { cache_.clear(); }

  void check_committed(const Body& target) const {
    require(target.model.is_committed(), "a model is committed after a commit");
    require(target.model.mesh().positions() == target.positions, "a commit keeps positions");
    require(target.model.mesh().triangles() == target.triangles, "a commit keeps triangles");
    const Result<void> valid = target.model.validate();
    require(static_cast<bool>(valid), "a committed model is valid", valid ? "" : valid.error().text);
    const TreeStats stats = target.model.tree_stats();
    require(stats.leaves == (target.triangles.size() + 7) / 8, "leaves are full");
    require(target.model.maintenance_stats().motion_margin >= 0, "the motion margin is not negative");
  }

  void query(Body& /*target*/) {
    for (Body& body : bodies_) commit(body);
    const bool is_swapped = bytes_.below(8) == 7;  // a cache may have been filled by other models
    const Body &first = bodies_[is_swapped ? 1 : 0], &second = bodies_[is_swapped ? 0 : 1];
    const Placed a{first.model, first.pose}, b{second.model, second.pose};
    brute_force_tests_ += first.triangles.size() * second.triangles.size();
    const Truth truth = truth_about(a, b);

    constexpr std::array<double, 8> relative_errors{0, 0, 0, 1e-12, 0.01, 0.5, 10, 1e100};
    const double relative = relative_errors[bytes_.below(8)];
    const double absolute = bytes_.below(4) == 3 ? some_length() : 0;
    constexpr std::array<double, 6> near_truth{1, 1 - 0x1p-52, 1 + 0x1p-52, 0.999, 1.001, 2};
    const std::uint32_t kind = bytes_.below(3);
    const double limit = kind == 0   ? infinity
                         : kind == 1 ? truth.distance * near_truth[bytes_.below(6)]
                                     : some_length();
    const double within_limit = std::isfinite(limit) ? limit : truth.distance;
    const bool warm_first = bytes_.flag();
    for (QueryCache* cache : {warm_first ? &cache_ : nullptr, warm_first ? nullptr : &cache_}) {
      const auto require_right = [&](const std::string& wrong) { require(wrong.empty(), "an answer is right", wrong); };
      const auto check_distance = [&](const DistanceOptions& options) {
        const DistanceResult found = in_environment(environment_, [&] { return distance(a, b, options); });
        require_right(wrong_answer(found, options, a, b, truth));
      };
      const auto meet = in_environment(environment_, [&] { return collide(a, b, {.cache = cache}); });
      require_right(wrong_answer(meet, 0, a, b, truth));
      check_distance({.relative_error = relative, .absolute_error = absolute, .max_distance = limit, .cache = cache});
      const auto near = in_environment(environment_, [&] { return within(a, b, within_limit, {.cache = cache}); });
      require_right(wrong_answer(near, within_limit, a, b, truth));
      check_distance({.cache = cache});
    }
  }

  ByteReader bytes_;
  std::uint8_t environment_;
  double factor_;  // by which coordinates are multiplied
  std::array<Body, 2> bodies_;
  QueryCache cache_;
  std::size_t brute_force_tests_ = 0;
};

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limber::fuzz::ModelSession(limber::fuzz::ByteReader({data, size})).run();
  return 0;
}
