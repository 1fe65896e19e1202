// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "answers/answers.h"
#include "limber/geometry.h"
#include "limber/motion.h"

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

Json to_json(const FrameImpact& impact);
}  // namespace limber::program
