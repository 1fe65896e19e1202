// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/support/report.h"
#include "limber/mesh.h"
#include "limber/points.h"

/// Points that peers.py has asked libraries about, and what sets their distances apart from ours.
namespace limber::bench {

/// The points in the order of the file: number and coordinates a line. None if the file is missing.
///
/// Throws   std::runtime_error if a line is not as expected.
std::optional<std::vector<Vec3>> read_points(const std::filesystem::path& file);

/// The distances of `count` points that a peer has written, number and distance a line; NaN where it has none. None if
/// the file is missing.
///
/// Throws   std::runtime_error if a line is not as expected.
std::optional<std::vector<double>> read_distances(const std::filesystem::path& file, std::size_t count);

/// How the distances of a library differ from ours. Lengths are parts of the mesh's size.
struct PointDifference {
  std::string question, mesh, library;
  double tolerance = 0;
  std::size_t points = 0, agree = 0;  ///< `agree`: up to the tolerance
  double largest_of_agreeing = 0, largest = 0;
  std::map<std::string, std::size_t> others;  ///< how many do not agree, by reason
};

/// The closest points of a mesh, as found by limber.
struct PointAnswers {
  MeshView mesh;
  double size = 0;  ///< of the mesh
  std::span<const Vec3> points;
  std::span<const PointResult> results;
};

/// Checks that each answer is a point of its triangle at the distance that it names, and by brute force that no
/// triangle is closer to every hundredth point.
void check_points(const std::string& mesh, const PointAnswers& ours, Checker& checker);

/// Compares distances up to `tolerance`, a part of the mesh's size. Where a library's distance is greater, ours proves
/// it wrong, once check_points() has passed. Where it is smaller, brute force decides; ours may be wrong then.
///
/// Pre      There is a distance for each point.
PointDifference compare_points(const std::string& question, const std::string& mesh, const std::string& library,
                               const PointAnswers& ours, std::span<const double> theirs, double tolerance,
                               Checker& checker);

}  // namespace limber::bench
