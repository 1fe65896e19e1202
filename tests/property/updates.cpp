// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "updates.h"
#include "limber/distance.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>
#include <thread>

#include "support/brute_force.h"

namespace limber::testing {
namespace {

constexpr const char* shape_names[] = {"ball", "sheet", "uniform soup", "lattice soup", "small soup", "needles"};
constexpr const char* update_names[] = {"move",  "move_to_own", "move_all",          "stay",    "collapse", "regrow",
                                        "scale", "reject",      "set_motion_margin", "rebuild", "reset",    "commit",
                                        "check"};
constexpr const char* policy_names[] = {"off", "in_commit", "on_worker"};

double power_of_ten(int exponent) { return std::pow(10.0, exponent); }

double largest_coordinate(const Mesh& mesh) {
  double largest = 0;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, max_abs(mesh.triangle(t)[k]));
  }
  return largest;
}

template <typename... Parts>
std::string text_of(const Parts&... parts) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << parts);
  return out.str();
}

std::string failed(const char* call, const Result<void>& result) {
  return result ? "" : text_of(call, " failed: ", result.error().text);
}

}  // namespace

Mesh Shape::mesh() const {
  Rng rng(seed + 1);
  if (kind == Kind::ball) return scenes::ball(3 + size % 6, 2 + size % 4);
  if (kind == Kind::sheet) return dented_sheet(rng);
  std::vector<Triangle> triangles;
  const std::uint64_t of_kind = kind == Kind::lattice_soup   ? 0
                                : kind == Kind::uniform_soup ? 1
                                : kind == Kind::small_soup   ? 2
                                                             : 5;
  for (std::uint32_t i = 0; i < size; ++i) triangles.push_back(arbitrary_triangle(rng, of_kind));
  return soup(triangles);
}

std::ostream& operator<<(std::ostream& out, const Shape& shape) {
  return out << shape_names[static_cast<std::size_t>(shape.kind)] << " of size " << shape.size << ", seed "
             << shape.seed;
}

std::ostream& operator<<(std::ostream& out, const Start& start) {
  out << start.shape << "; beside it a " << start.still << "; ";
  out << "motion margin " << start.motion_margin << "; ";
  out << policy_names[static_cast<std::size_t>(start.rebuild_policy)];
  if (start.rebuild_budget_us) out << " within " << *start.rebuild_budget_us << " us";
  return out;
}

std::ostream& operator<<(std::ostream& out, const Update& update) {
  return out << update_names[static_cast<std::size_t>(update.kind)] << "(count " << update.count << ", exponent "
             << update.exponent << ", draw " << update.draw << ")";
}

Subject::Subject(const Start& start)
    : mesh_(start.shape.mesh()),
      first_(mesh_.positions()),
      model_(mesh_, {.motion_margin = start.motion_margin,
                     .rebuild_policy = start.rebuild_policy,
                     .rebuild_budget_us = start.rebuild_budget_us,
                     .preallocate = start.rebuild_budget_us.has_value()}),
      still_(start.still.mesh()) {}

std::string Subject::apply(const Update& update) {
  Rng rng(update.draw + 1);
  std::vector<Vec3> positions = mesh_.positions();
  const double step = power_of_ten(update.exponent);
  switch (update.kind) {
    case Update::Kind::move:
      return move(update, rng);
    case Update::Kind::move_to_own:
      return move_to_own(update, rng);
    case Update::Kind::move_all:
      for (Vec3& p : positions) p += step * uniform_point(rng);
      return move_all_to(positions);
    case Update::Kind::stay:
      return failed("move_all to the model's own positions", model_.move_all(model_.mesh().positions()));
    case Update::Kind::collapse: {
      const Vec3 at = (rng.below(2) == 0 ? step : power_of_ten(4 * update.exponent)) * uniform_point(rng);
      return move_all_to(std::vector<Vec3>(positions.size(), at));
    }
    case Update::Kind::regrow:
      return move_all_to(first_);
    case Update::Kind::scale:
      for (std::size_t v = 0; v < positions.size(); ++v) {
        positions[v] = first_[v] * std::ldexp(1.0, static_cast<int>(update.draw % 121) - 60);
      }
      return move_all_to(positions);
    case Update::Kind::reject:
      return reject(rng);
    case Update::Kind::set_motion_margin:
      model_.set_motion_margin(update.count == 1 ? 0 : step);
      return "";
    case Update::Kind::rebuild:
      model_.rebuild();
      return model_.is_committed() ? "" : "rebuild left the model uncommitted";
    case Update::Kind::reset:
      for (Vec3& p : positions) p += step * uniform_point(rng);
      mesh_.set_positions(positions).value();
      model_.reset(mesh_);
      return model_.is_committed() ? "" : "reset left the model uncommitted";
    case Update::Kind::commit:
      model_.commit();
      std::this_thread::sleep_for(std::chrono::microseconds(update.draw % 8 == 0 ? 50 : 0));
      return "";
    default:
      return check(update.draw);
  }
}

std::string Subject::move(const Update& update, Rng& rng) {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0; i < update.count; ++i) {
    const bool again = i > 0 && rng.below(4) == 0;
    ids.push_back(again ? ids.back() : static_cast<VertexId>(rng.below(mesh_.positions().size())));
    positions.push_back(mesh_.positions()[ids.back()] + power_of_ten(update.exponent) * uniform_point(rng));
    mesh_.set_position(ids.back(), positions.back()).value();
  }
  return failed("move_vertices", model_.move_vertices(ids, positions));
}

std::string Subject::move_to_own(const Update& update, Rng& rng) {
  const std::size_t vertex_count = mesh_.positions().size();
  const std::size_t count = std::min<std::size_t>(update.count + rng.below(vertex_count), vertex_count);
  const std::size_t from = rng.below(vertex_count - count + 1);
  std::vector<VertexId> ids;
  for (std::size_t i = 0; i < count; ++i) ids.push_back(static_cast<VertexId>(rng.below(vertex_count)));
  const std::vector<Vec3> before = mesh_.positions();
  for (std::size_t i = 0; i < count; ++i) mesh_.set_position(ids[i], before[from + i]).value();
  return failed("move_vertices to the model's own positions",
                model_.move_vertices(ids, std::span(model_.mesh().positions()).subspan(from, count)));
}

std::string Subject::move_all_to(const std::vector<Vec3>& positions) {
  mesh_.set_positions(positions).value();
  return failed("move_all", model_.move_all(positions));
}

std::string Subject::reject(Rng& rng) {
  const bool was_committed = model_.is_committed();
  std::vector<Vec3> positions = mesh_.positions();
  const std::size_t bad = rng.below(positions.size());
  positions[bad].z = rng.below(2) == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e70;
  const Result<void> all = model_.move_all(positions);
  if (all || all.error().where != bad) return "move_all did not name the bad position";
  const std::vector<VertexId> ids{0, static_cast<VertexId>(positions.size())};
  const Result<void> some = model_.move_vertices(ids, std::vector<Vec3>(2));
  if (some || some.error().where != 1U) return "move_vertices did not name the bad id";
  return model_.is_committed() == was_committed ? "" : "a rejected update moved something";
}

std::string Subject::check(std::uint32_t draw) {
  model_.commit();
  if (!model_.is_committed()) return "the model is not committed";
  if (model_.mesh().positions() != mesh_.positions()) return "vertices are not where they were moved to";
  if (const Result<void> valid = model_.validate(); !valid) return valid.error().text;
  // The number of levels: docs/algorithms/bounds.md.
  const std::size_t leaves = (mesh_.triangles().size() + 7) / 8;
  std::uint32_t levels = 1;
  for (std::size_t most = 1; most < leaves; most *= 8) ++levels;
  if (model_.tree_stats().levels != levels) return text_of("the tree has ", model_.tree_stats().levels, " levels");
  Rng rng(draw + 1);
  return compare(rng.below(3) == 0 ? random_pose(rng, 4) : Transform{});
}

std::string Subject::compare(const Transform& pose) {
  // The size of the coordinates that are rounded when triangles are placed and compared.
  const double extent = largest_coordinate(mesh_) + largest_coordinate(still_.mesh()) + max_abs(pose.translation);
  const double tolerance = 0x1p-45 * extent;  // docs/algorithms/numerics.md
  const Placed a{model_}, b{still_, pose};
  const double truth = brute_force_distance({mesh_}, {still_.mesh(), pose});
  const DistanceResult cold = distance(a, b), warm = distance(a, b, {.cache = &cache_});
  for (const auto& [name, found] : {std::pair("cold", &cold), std::pair("warm", &warm)}) {
    const bool is_right = std::abs(found->upper - truth) <= tolerance && found->lower <= truth + tolerance &&
                          (found->upper == 0) == (truth == 0);
    if (!is_right) return text_of(name, " distance ", found->lower, " to ", found->upper, " but it is ", truth);
  }
  if (collide(a, b).is_yes() != (truth == 0)) return text_of("cold collide is wrong at distance ", truth);
  if (collide(a, b, {.cache = &cache_}).is_yes() != (truth == 0))
    return text_of("warm collide is wrong at distance ", truth);
  if (!within(a, b, truth + tolerance, {.cache = &cache_}).is_yes()) return text_of("within denies ", truth);
  if (truth > 4 * tolerance && within(a, b, 0.5 * truth).is_yes()) return text_of("within half of ", truth);
  return "";
}

}  // namespace limber::testing
