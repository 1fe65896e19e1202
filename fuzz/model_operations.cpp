// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as two small meshes and a sequence of operations on their models, against brute force.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/environment.h"
#include "fuzz/inputs.h"
#include "fuzz/property.h"
#include "fuzz/query_checks.h"
#include "limber/distance.h"
#include "limber/model.h"

namespace limber::fuzz {
namespace {

constexpr std::size_t most_brute_force_tests = 2'500;
constexpr std::size_t most_steps = 60;
constexpr double infinity = std::numeric_limits<double>::infinity();

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
bool throws_logic_error(const Function& function) {
  try {
    function();
    return false;
  } catch (const std::logic_error&) {
    return true;
  }
}

/// Two models, their poses, and a query cache. The bytes of the input choose calls of the whole public interface. Each
/// model has a copy of the mesh that it should have; each committed state and each answer is checked.
class ModelSession {
 public:
  explicit ModelSession(ByteReader bytes);

  /// Reads operations until the input or the time for brute force is used up, then commits and checks.
  void run();

 private:
  struct Body {
    Model model;
    std::vector<Vec3> positions;  // that the mesh should have
    std::vector<Corners> triangles;
    Transform pose;
  };

  static Body body(ByteReader& bytes, double factor);

  void step();
  void move_some(Body& moving);
  void move_all(Body& moving);
  void move_aliased(Body& moving);
  void reject(Body& target);
  void set_motion_margin(Body& target);
  void take_new_mesh(Body& target);
  void pass_through_other_model(Body& target);
  void change_pose(Body& target);
  void misuse(Body& target);
  void commit(Body& target);
  void query();

  Vec3 new_position(const Vec3& old);
  double some_length();
  std::size_t vertex_in(const Body& target);
  void check_committed(const Body& target) const;

  ByteReader bytes_;
  std::uint8_t environment_;
  double factor_;  // by which coordinates are multiplied
  std::array<Body, 2> bodies_;
  QueryCache cache_;
  std::size_t brute_force_tests_ = 0;
};

ModelSession::Body ModelSession::body(ByteReader& bytes, double factor) {
  Mesh mesh = small_mesh(bytes, factor);
  std::vector<Vec3> positions = mesh.positions();
  std::vector<Corners> triangles = mesh.triangles();
  const ModelOptions options = some_options(bytes, factor);
  return {Model(std::move(mesh), options), std::move(positions), std::move(triangles), pose(bytes, factor)};
}

ModelSession::ModelSession(ByteReader bytes)
    : bytes_(bytes),
      environment_(bytes_.byte()),
      factor_(scale(bytes_)),
      bodies_{body(bytes_, factor_), body(bytes_, factor_)} {}

void ModelSession::run() {
  try {
    for (std::size_t i = 0; i < most_steps && !bytes_.is_empty() && brute_force_tests_ < most_brute_force_tests; ++i) {
      step();
    }
    query();
  } catch (const std::logic_error& violated) {
    std::string detail = violated.what();
    for (const Body& body : bodies_) {
      if (const Result<void> valid = body.model.validate(); !valid) detail += "\n" + valid.error().text;
    }
    require(false, "the library's own checks hold", detail);
  }
}

void ModelSession::step() {
  const std::uint8_t choice = bytes_.byte();
  Body& target = bodies_[choice / 128];
  switch (choice % 16) {
    case 0:
      return move_all(target);
    case 1:
      return commit(target);
    case 2:
      in_environment(environment_, [&] { target.model.rebuild(); });
      return check_committed(target);
    case 3:
      return set_motion_margin(target);
    case 4:
      return take_new_mesh(target);
    case 5:
      return reject(target);
    case 6:
      return move_aliased(target);
    case 7:
      return pass_through_other_model(target);
    case 8:
      return change_pose(target);
    case 9:
      return misuse(target);
    case 10:
      return cache_.clear();
    case 11:
    case 12:
    case 13:
      return move_some(target);
    default:
      return query();
  }
}

Vec3 ModelSession::new_position(const Vec3& old) {
  const Vec3 step = scaled(point(bytes_), factor_);
  if (bytes_.flag()) return step;
  return made_valid(old + step * 0x1p-6);
}

double ModelSession::some_length() { return std::abs(coordinate(bytes_)) * factor_; }

std::size_t ModelSession::vertex_in(const Body& target) { return bytes_.byte() % target.positions.size(); }

void ModelSession::move_some(Body& moving) {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0, count = bytes_.below(5); i < count; ++i) {
    const std::size_t v = vertex_in(moving);
    ids.push_back(static_cast<VertexId>(v));
    positions.push_back(new_position(moving.positions[v]));
    moving.positions[v] = positions.back();
  }
  require(in_environment(environment_, [&] { return static_cast<bool>(moving.model.move_vertices(ids, positions)); }),
          "a sound update is accepted");
  require(moving.model.mesh().positions() == moving.positions, "move_vertices() moves what it was given");
}

void ModelSession::move_all(Body& moving) {
  if (bytes_.flag()) {  // one motion for all
    const Vec3 step = new_position({});
    for (Vec3& p : moving.positions) p = made_valid(p + step);
  } else {
    for (std::uint32_t i = 0, count = bytes_.below(8); i < count; ++i) {
      Vec3& p = moving.positions[vertex_in(moving)];
      p = new_position(p);
    }
  }
  require(in_environment(environment_, [&] { return static_cast<bool>(moving.model.move_all(moving.positions)); }),
          "a sound update of all vertices is accepted");
  require(moving.model.mesh().positions() == moving.positions, "move_all() moves what it was given");
}

void ModelSession::move_aliased(Body& moving) {
  const std::size_t count = 1 + bytes_.byte() % moving.positions.size();
  std::vector<VertexId> ids;
  for (std::size_t i = 0; i < count; ++i) ids.push_back(static_cast<VertexId>(vertex_in(moving)));
  const std::vector<Vec3> copy = moving.positions;
  for (std::size_t i = 0; i < count; ++i) moving.positions[ids[i]] = copy[i];
  const std::span<const Vec3> own = std::span<const Vec3>(moving.model.mesh().positions()).first(count);
  require(in_environment(environment_, [&] { return static_cast<bool>(moving.model.move_vertices(ids, own)); }),
          "an update from the model's own positions is accepted");
  require(moving.model.mesh().positions() == moving.positions, "an update may refer to the model's own positions");
}

void ModelSession::reject(Body& target) {
  const std::uint32_t kind = bytes_.below(8);
  std::vector<Vec3> positions = target.positions;
  std::vector<VertexId> ids(positions.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<VertexId>(i);
  const std::size_t at = vertex_in(target), axis = bytes_.below(3);
  ErrorCode expected = ErrorCode::non_finite;
  constexpr std::array<double, 3> not_finite{std::numeric_limits<double>::quiet_NaN(), infinity, -infinity};
  if (kind < 3) {
    positions[at][axis] = not_finite[kind];
  } else if (kind == 3) {
    positions[at][axis] = nudged(max_coordinate, 1);
    expected = ErrorCode::too_large;
  } else if (kind < 6) {
    ids[at] = kind == 4 ? static_cast<VertexId>(positions.size()) : no_id;
    expected = ErrorCode::index_out_of_range;
  } else {
    positions.resize(kind == 6 ? positions.size() - 1 : positions.size() + 1);
    expected = ErrorCode::size_mismatch;
  }
  const bool of_all = kind < 4 && bytes_.flag(), was_committed = target.model.is_committed();
  const Result<void> outcome = of_all ? target.model.move_all(positions) : target.model.move_vertices(ids, positions);
  require(!outcome, "an unsound update is rejected");
  require(outcome.error().code == expected, "a rejected update has the right code", outcome.error().text);
  require(is_one_line(outcome.error().text), "a rejected update has one line of text", outcome.error().text);
  require(kind >= 6 || outcome.error().where == at, "a rejected update names the entry", outcome.error().text);
  require(target.model.is_committed() == was_committed, "a rejected update leaves the model as it was");
  require(target.model.mesh().positions() == target.positions, "a rejected update leaves positions as they were");
}

void ModelSession::set_motion_margin(Body& target) {
  const std::uint32_t kind = bytes_.below(4);
  const double motion_margin = kind == 0 ? 0 : some_length();
  in_environment(environment_, [&] { target.model.set_motion_margin(motion_margin); });
  require(target.model.options().motion_margin == motion_margin, "set_motion_margin() changes the option");
}

void ModelSession::take_new_mesh(Body& target) {
  Mesh mesh = small_mesh(bytes_, factor_);
  target.positions = mesh.positions();
  target.triangles = mesh.triangles();
  in_environment(environment_, [&] { target.model.reset(std::move(mesh)); });
  check_committed(target);
}

void ModelSession::pass_through_other_model(Body& target) {
  Model other = std::move(target.model);
  require(throws_logic_error([&] { target.model.commit(); }), "commit() of a moved-from model is refused");
  require(throws_logic_error([&] { static_cast<void>(target.model.move_all(target.positions)); }),
          "move_all() of a moved-from model is refused");
  require(throws_logic_error([&] { static_cast<void>(target.model.tree_stats()); }),
          "tree_stats() of a moved-from model is refused");
  require(throws_logic_error([&] { static_cast<void>(collide({target.model}, {other})); }),
          "a query of a moved-from model is refused");
  target.model = std::move(other);
  require(target.model.mesh().positions() == target.positions, "a model that was moved keeps its positions");
}

void ModelSession::change_pose(Body& target) {
  if (bytes_.flag()) {
    target.pose = pose(bytes_, factor_);
  } else {  // a small step
    target.pose.translation = made_valid(target.pose.translation + scaled(point(bytes_), factor_) * 0x1p-6);
  }
}

void ModelSession::misuse(Body& target) {
  const double bad = bytes_.flag() ? std::numeric_limits<double>::quiet_NaN() : -1;
  Transform not_rigid = target.pose;
  not_rigid.rotation.row1.y = bytes_.flag() ? std::numeric_limits<double>::quiet_NaN() : 3;
  if (!target.model.is_committed()) {
    require(throws_logic_error([&] { static_cast<void>(collide({target.model}, {target.model})); }),
            "a query of an uncommitted model is refused");
    return;
  }
  require(throws_logic_error([&] {
            static_cast<void>(collide({target.model, not_rigid}, {target.model}));
          }),
          "a pose that is not rigid is refused");
  const DistanceOptions options{.relative_error = bad};
  require(throws_logic_error([&] { static_cast<void>(distance({target.model}, {target.model}, options)); }),
          "a bad relative error is refused");
  require(throws_logic_error([&] { static_cast<void>(within({target.model}, {target.model}, bad)); }),
          "a bad distance is refused");
  check_committed(target);
}

void ModelSession::commit(Body& target) {
  in_environment(environment_, [&] { target.model.commit(); });
  check_committed(target);
}

void ModelSession::check_committed(const Body& target) const {
  require(target.model.is_committed(), "a model is committed after a commit");
  require(target.model.mesh().positions() == target.positions, "a commit keeps positions");
  require(target.model.mesh().triangles() == target.triangles, "a commit keeps triangles");
  const Result<void> valid = target.model.validate();
  require(static_cast<bool>(valid), "a committed model is valid", valid ? "" : valid.error().text);
  const TreeStats stats = target.model.tree_stats();
  require(stats.leaves == (target.triangles.size() + 7) / 8, "leaves are full");
  require(target.model.maintenance_stats().motion_margin >= 0, "the motion margin is not negative");
}

void ModelSession::query() {
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
  const double limit = kind == 0 ? infinity : kind == 1 ? truth.distance * near_truth[bytes_.below(6)] : some_length();
  const DistanceOptions options{.relative_error = relative, .absolute_error = absolute, .max_distance = limit};
  const double within_limit = std::isfinite(limit) ? limit : truth.distance;
  const bool warm_first = bytes_.flag();
  for (QueryCache* cache : {warm_first ? &cache_ : nullptr, warm_first ? nullptr : &cache_}) {
    check_collide(a, b, truth, environment_, cache);
    check_distance(a, b, truth, environment_, cache, options);
    check_within(a, b, truth, environment_, cache, within_limit);
    check_distance(a, b, truth, environment_, cache, {});
  }
}

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limber::fuzz::ModelSession(limber::fuzz::ByteReader({data, size})).run();
  return 0;
}
