// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/impacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "answers/contact_answers.h"

namespace limber::program {
namespace {

/// As ImpactStatus, whose first value is clear.
constexpr std::array impact_words = {"clear", "contact", "initial_contact", "undecided"};

/// A time of the step that ends at a frame, in frames, rounded to the side of `bound`.
double in_frames(std::size_t frame, double time, double bound) {
  const double start = static_cast<double>(frame - 1), sum = start + time;
  const double error = time - (sum - start);  // exact: `start` is 0, or at least as large as `time`
  return error == 0 || (error < 0) == (bound > 0) ? sum : std::nextafter(sum, bound);
}

std::uint8_t index_of(std::uint32_t id, const std::array<std::uint32_t, 3>& ids) {
  return static_cast<std::uint8_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
}

Feature feature_of(const FrameMotion& motion, TriangleId triangle, std::uint32_t id, FeatureKind kind) {
  if (kind == FeatureKind::edge) return {kind, index_of(id, motion.model.edges().of_triangles()[triangle])};
  if (kind == FeatureKind::vertex) return {kind, index_of(id, motion.model.mesh().triangles()[triangle])};
  return {};
}

FoundTouch touch_of(const ImpactResult& found, const FrameMotion& a, const FrameMotion& b) {
  FoundTouch touch{{*found.witness}, found.normal};
  if (!found.elements) return touch;
  using enum ElementPair::Kind;
  const auto& [kind, id_a, id_b] = *found.elements;
  const auto kind_of = [of_pair = kind](ElementPair::Kind of_vertex) {
    return of_pair == edge_edge ? FeatureKind::edge : of_pair == of_vertex ? FeatureKind::vertex : FeatureKind::face;
  };
  touch.feature_a = feature_of(a, found.witness->triangle_a, id_a, kind_of(vertex_face));
  touch.feature_b = feature_of(b, found.witness->triangle_b, id_b, kind_of(face_vertex));
  return touch;
}

Json touch_json(const FoundTouch& touch) {
  const Witness& witness = touch.at.witness;
  const auto words = [](const std::optional<Feature>& feature) { return feature ? Json(to_text(*feature)) : nullptr; };
  return {
      {"triangle_a", witness.triangle_a},    {"triangle_b", witness.triangle_b}, {"point_a", to_json(witness.point_a)},
      {"point_b", to_json(witness.point_b)}, {"normal", to_json(touch.normal)},  {"feature_a", words(touch.feature_a)},
      {"feature_b", words(touch.feature_b)}, {"face_a", touch.at.face_a},        {"face_b", touch.at.face_b}};
}

}  // namespace

FrameImpact find_impact(const std::string& name, std::size_t frame, const FrameMotion& a, const FrameMotion& b,
                        const ImpactOptions& options) {
  const Stopwatch asking;
  const ImpactResult found =
      &a == &b ? self_time_of_impact(a.moving, options) : time_of_impact(a.moving, b.moving, options);
  FrameImpact impact{name, found.status};
  impact.elapsed_us = asking.microseconds();
  if (!found.witness) return impact;
  constexpr double endless = std::numeric_limits<double>::infinity();
  impact.lower = in_frames(frame, found.lower, -endless);
  impact.upper = in_frames(frame, found.upper, endless);
  impact.touch = touch_of(found, a, b);
  return impact;
}

Json to_json(const FrameImpact& impact) {
  return {{"query_us", impact.status ? Json(impact.elapsed_us) : nullptr},
          {"status", impact.status ? Json(impact_words.at(static_cast<std::size_t>(*impact.status))) : nullptr},
          {"lower", to_json(impact.lower)},
          {"upper", to_json(impact.upper)},
          {"touch", impact.touch ? touch_json(*impact.touch) : nullptr}};
}

}  // namespace limber::program
