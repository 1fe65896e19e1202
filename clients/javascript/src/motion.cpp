// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/motion.h"

#include <vector>

#include "bindings.h"
#include "limber/elements.h"
#include "limber/model.h"

namespace limber::web {
namespace {

std::vector<Impact> impacts_found;
std::vector<double> columns;

/// As give() of other results; then the normal, and the kind of the elements and their ids. Without elements the ids
/// are no_id.
void give_impact(const ImpactResult& result) {
  give(result.witness, result.stats, static_cast<std::uint32_t>(result.status), result.stopped_by);
  exchange.numbers[0] = result.lower, exchange.numbers[1] = result.upper;
  double* to = exchange.numbers + 10;
  put(to, result.normal);
  const ElementPair elements = result.elements.value_or(ElementPair{});
  exchange.words[4] = static_cast<std::uint32_t>(elements.kind);
  exchange.words[5] = elements.a, exchange.words[6] = elements.b;
}

/// One column after the other: lower, upper; then, in 32 bits, elements of a and of b; then, in 8 bits, kinds of the
/// pairs and statuses.
void give_impacts(const PairCount& count) {
  const std::size_t n = impacts_found.size();
  const std::size_t bytes = n * (2 * sizeof(double) + 2 * sizeof(std::uint32_t) + 2);
  columns.resize((bytes + sizeof(double) - 1) / sizeof(double));
  double* to = columns.data();
  for (const Impact& i : impacts_found) *to++ = i.time.lower;
  for (const Impact& i : impacts_found) *to++ = i.time.upper;
  auto* id = reinterpret_cast<std::uint32_t*>(to);
  for (const Impact& i : impacts_found) *id++ = i.elements.a;
  for (const Impact& i : impacts_found) *id++ = i.elements.b;
  auto* byte = reinterpret_cast<std::uint8_t*>(id);
  for (const Impact& i : impacts_found) *byte++ = static_cast<std::uint8_t>(i.elements.kind);
  for (const Impact& i : impacts_found) *byte++ = static_cast<std::uint8_t>(i.time.status);
  give_bytes(columns.data(), bytes);
  give_count(n, count.is_complete, count.stats);
}

}  // namespace

/// Finds when a vertex and a face touch first, or two edges. Reads four points at the start and four at the end from
/// input(). Writes bounds and status where give() of other results does.
LIMBER_EXPORT(elementImpact)
bool exported_element_impact(bool are_edges, double max_time, double time_error, double min_separation) {
  return guarded([&] {
    const std::vector<Vec3> p = points_from(8, false);
    const ElementImpactOptions options{max_time, time_error, min_separation};
    const ElementImpact impact =
        are_edges ? time_of_impact({{p[0], p[1]}, {p[4], p[5]}}, {{p[2], p[3]}, {p[6], p[7]}}, options)
                  : time_of_impact({p[0], p[4]}, {{p[1], p[2], p[3]}, {p[5], p[6], p[7]}}, options);
    exchange.numbers[0] = impact.lower, exchange.numbers[1] = impact.upper;
    exchange.words[2] = static_cast<std::uint32_t>(impact.status);
  });
}

LIMBER_EXPORT(newMovingModel) MovingModel* new_moving_model(const OwnedModel* model) {
  MovingModel* moving = nullptr;
  guarded([&] { moving = new MovingModel(*model); });
  return moving;
}
LIMBER_EXPORT(deleteMovingModel) void delete_moving_model(MovingModel* moving) { delete moving; }

/// To the positions in input().
LIMBER_EXPORT(setMotion)
bool set_motion(MovingModel* model, std::size_t count, bool is_float32, PoseForm start_pose, PoseForm end_pose) {
  return guarded([&] {
    const Transform start = pose_from(start_pose, 0, "startPose"), end = pose_from(end_pose, 1, "endPose");
    model->set_motion(points_from(count, is_float32), start, end).value();
  });
}

/// Finds when two models touch first. A null b asks about a with itself, here and in impacts.
LIMBER_EXPORT(timeOfImpact)
bool exported_time_of_impact(const MovingModel* a, const MovingModel* b, double max_time, double time_error,
                             double min_separation, double separation_fraction, bool ignore_crossings, bool any_contact,
                             double deadline_ms, double max_steps) {
  return guarded([&] {
    const ImpactOptions options{.max_time = max_time,
                                .time_error = time_error,
                                .min_separation = min_separation,
                                .separation_fraction = separation_fraction,
                                .ignore_crossings = ignore_crossings,
                                .any_contact = any_contact,
                                .budget = budget_from(deadline_ms, max_steps)};
    give_impact(b != nullptr ? time_of_impact(*a, *b, options) : self_time_of_impact(*a, options));
  });
}

LIMBER_EXPORT(impacts)
bool exported_impacts(const MovingModel* a, const MovingModel* b, double max_time, double time_error,
                      double min_separation, double separation_fraction, double most) {
  return guarded([&] {
    const ImpactOptions options{max_time, time_error, min_separation, separation_fraction};
    const auto collect = collector(impacts_found, most);
    give_impacts(b != nullptr ? visit_impacts(*a, *b, collect, options) : visit_self_impacts(*a, collect, options));
  });
}

}  // namespace limber::web
