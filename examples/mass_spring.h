// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "limber/limber.h"

/// A sheet of point masses and springs, solved as constraints on positions: XPBD [Macklin2016].
namespace mass_spring {

/// Holds two vertices at a distance, `rest`: softly, but never closer than `shortest`. The compliance is the inverse of
/// stiffness for vertices of mass 1.
struct Spring {
  limber::VertexId a = 0, b = 0;
  double rest = 0, shortest = 0, compliance = 0;
};

/// Keeps two points apart: gap + normal . (the weighted sum of motions since look_around()) >= wanted.
struct Constraint {
  std::array<limber::VertexId, 6> vertices{};
  std::array<double, 6> weights{};  ///< 0 for places that are not used
  limber::Vec3 normal;
  double gap = 0, wanted = 0;
};

/// The weights of a triangle's corners at a point on it.
inline std::array<double, 3> barycentric(const limber::Triangle& t, const limber::Vec3& point) {
  const limber::Vec3 n = cross(t.v1 - t.v0, t.v2 - t.v0);
  const double w1 = dot(cross(point - t.v0, t.v2 - t.v0), n), w2 = dot(cross(t.v1 - t.v0, point - t.v0), n);
  const double area = length_sq(n);
  if (!(area > 0)) return {1, 0, 0};
  const double b1 = std::clamp(w1 / area, 0.0, 1.0), b2 = std::clamp(w2 / area, 0.0, 1.0 - b1);
  return {1 - b1 - b2, b1, b2};
}

/// What the material is like. Lengths are in meters, times in seconds; every vertex has mass 1.
struct Material {
  double stretch_compliance = 1e-6, shear_compliance = 1e-5, bend_compliance = 2e-3;
  double damping = 1.2;      ///< share of the velocity that air takes in a second
  double friction = 0.4;     ///< Coulomb's coefficient
  double least_fold = 0.35;  ///< bending springs are never shorter than that share of their length
};

class Sheet {
 public:
  /// Takes a grid of (squares + 1)^2 vertices, row by row, as shapes::sheet() makes it: at rest, and at the start.
  Sheet(const std::vector<limber::Vec3>& at_rest, std::vector<limber::Vec3> positions, std::uint32_t squares,
        const Material& material = {})
      : positions_(std::move(positions)),
        velocities_(positions_.size()),
        start_(positions_),
        seen_(positions_),
        reach_(positions_.size()),
        material_(material) {
    const auto add = [&](std::uint32_t i, std::uint32_t j, int di, int dj, double shortest, double compliance) {
      const int i2 = static_cast<int>(i) + di, j2 = static_cast<int>(j) + dj, last = static_cast<int>(squares);
      if (i2 < 0 || i2 > last || j2 > last) return;
      const std::uint32_t a = j * (squares + 1) + i;
      const std::uint32_t b = static_cast<std::uint32_t>(j2 * (last + 1) + i2);
      const double rest = length(at_rest[b] - at_rest[a]);
      springs_.push_back({a, b, rest, shortest * rest, compliance});
    };
    for (std::uint32_t j = 0; j <= squares; ++j) {
      for (std::uint32_t i = 0; i <= squares; ++i) {
        add(i, j, 1, 0, 0.8, material.stretch_compliance);
        add(i, j, 0, 1, 0.8, material.stretch_compliance);
        add(i, j, 1, 1, 0.6, material.shear_compliance);
        add(i, j, -1, 1, 0.6, material.shear_compliance);
        add(i, j, 2, 0, material.least_fold, material.bend_compliance);
        add(i, j, 0, 2, material.least_fold, material.bend_compliance);
      }
    }
    pulls_.resize(springs_.size());
  }

  const std::vector<limber::Vec3>& positions() const { return positions_; }
  /// The motion of a vertex since the last look_around(), or since the start.
  limber::Vec3 motion(limber::VertexId v) const { return positions_[v] - seen_[v]; }

  /// Takes what holds from where the sheet is now: constraints, and how far each vertex may move from here.
  void look_around(std::vector<Constraint> constraints, std::vector<double> reach) {
    seen_ = positions_;
    constraints_ = std::move(constraints);
    reach_ = std::move(reach);
  }

  /// Moves the sheet by a time step. Returns how many vertices another step would bring to the limit of their
  /// reach.
  std::size_t step(double dt, int iterations) {
    constexpr limber::Vec3 gravity{0, 0, -9.81};
    start_ = positions_;
    const double kept = std::exp(-material_.damping * dt);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      positions_[v] += dt * (kept * velocities_[v] + dt * gravity);
    }
    std::fill(pulls_.begin(), pulls_.end(), 0.0);
    for (int i = 0; i < iterations; ++i) {
      for (std::size_t s = 0; s < springs_.size(); ++s) satisfy(springs_[s], pulls_[s], dt);
      for (const Constraint& constraint : constraints_) satisfy(constraint);
    }
    std::size_t at_limit = 0;
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      const limber::Vec3 motion = positions_[v] - seen_[v];
      const double moved = length(motion);
      if (moved > reach_[v]) positions_[v] = seen_[v] + (reach_[v] / moved) * motion;
      velocities_[v] = (1 / dt) * (positions_[v] - start_[v]);
      if (length(positions_[v] - seen_[v] + dt * velocities_[v]) > reach_[v]) ++at_limit;
    }
    return at_limit;
  }

 private:
  void satisfy(const Spring& spring, double& pull, double dt) {
    limber::Vec3 &a = positions_[spring.a], &b = positions_[spring.b];
    const limber::Vec3 from_a = b - a;
    const double distance = length(from_a);
    if (!(distance > 0)) return;
    double move = 0;  // of each end
    if (distance < spring.shortest) {
      move = 0.5 * (distance - spring.shortest);
    } else {
      const double softness = spring.compliance / (dt * dt);
      move = (distance - spring.rest - softness * pull) / (2 + softness);
      pull += move;
    }
    a += (move / distance) * from_a;
    b -= (move / distance) * from_a;
  }

  void satisfy(const Constraint& c) {
    limber::Vec3 motion, step;  // of the second point relative to the first
    double inverse_mass = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      motion += c.weights[i] * (positions_[c.vertices[i]] - seen_[c.vertices[i]]);
      step += c.weights[i] * (positions_[c.vertices[i]] - start_[c.vertices[i]]);
      inverse_mass += c.weights[i] * c.weights[i];
    }
    const double push = c.wanted - c.gap - dot(c.normal, motion);
    if (push <= 0) return;
    const limber::Vec3 slide = step - dot(c.normal, step) * c.normal;
    const double slid = length(slide);
    const double stopped = slid > 0 ? std::min(1.0, material_.friction * push / slid) : 0;
    const limber::Vec3 correction = (1 / inverse_mass) * (push * c.normal - stopped * slide);
    for (std::size_t i = 0; i < 6; ++i) positions_[c.vertices[i]] += c.weights[i] * correction;
  }

  std::vector<limber::Vec3> positions_, velocities_;
  std::vector<limber::Vec3> start_, seen_;  // positions at the start of the step, and at the last look_around()
  std::vector<Constraint> constraints_;
  std::vector<double> reach_;
  std::vector<Spring> springs_;
  std::vector<double> pulls_;  // what each spring has pulled in this step, the multiplier of XPBD
  Material material_;
};

}  // namespace mass_spring
