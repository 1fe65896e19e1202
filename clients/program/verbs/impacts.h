// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "limber/geometry.h"
#include "limber/motion.h"
#include "verbs/answers.h"

/// Impacts between frames: when two models touch first on the way from one frame to the next, or one touches itself.
namespace limber::program {

/// The way of a model from one frame to the next.
struct FrameMotion {
  const Model& model;
  MovingModel moving;

  explicit FrameMotion(const Model& of) : model(of), moving(of) {}
  FrameMotion(const FrameMotion&) = delete;
  FrameMotion& operator=(const FrameMotion&) = delete;
};

/// Two elements that touch, as parts of triangles. Models that cross at the start have no such parts.
struct FoundTouch {
  FoundWitness at;
  Vec3 normal;
  std::optional<Feature> feature_a = {}, feature_b = {};
};

/// The first impact on the way to a frame, and the word that its columns start with.
struct FrameImpact {
  std::string name;
  std::optional<ImpactStatus> status = {};       ///< none where no frame comes before
  std::optional<double> lower = {}, upper = {};  ///< in frames; none where nothing touches
  std::optional<FoundTouch> touch = {};
  double elapsed_us = 0;
};

/// The first impact of two models, or of one with itself, on their way to a frame from the one before. Faces are not
/// set.
///
/// Pre      `frame` is at least 1, and the motions are set.
FrameImpact find_impact(const std::string& name, std::size_t frame, const FrameMotion& a, const FrameMotion& b,
                        const ImpactOptions& options);

/// One object, whose values are the cells under these columns; each column starts with the name and an underscore.
Json to_json(const FrameImpact& impact);
inline constexpr const char* impact_columns =
    "query_us,status,lower,upper,triangle_a,triangle_b,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
    "normal_x,normal_y,normal_z,feature_a,feature_b,face_a,face_b";

}  // namespace limber::program
