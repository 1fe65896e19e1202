// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "limber/mesh.h"
#include "run_program.h"

/// Reads what pages of `--report` hold. Written apart from the program, and from the scripts of the pages.
namespace limber::program_tests {

/// A run that must succeed, and the page that it has written.
struct Report {
  Folder folder;
  Outcome outcome;
  std::string page;
  nlohmann::json data;

  /// Completes the line by `--report` and the path.
  explicit Report(const std::string& line);
};

/// The data of a page; fails the test where there is none.
nlohmann::json page_data(const std::string& page);

std::vector<std::uint8_t> bytes_of(const std::string& base64);

/// Counts in groups of 7 bits.
std::vector<std::uint64_t> counts_of(const std::string& base64);

/// low + step * k for k of 3 bytes.
std::vector<double> numbers_of(double low, double step, const std::string& base64);

/// Points whose coordinates are three such lists.
std::vector<Vec3> points_of(const nlohmann::json& quantized);

/// Triangles over vertices that are numbered in the order in which they are first named.
std::vector<Corners> corners_of(const std::string& base64);

/// The vertices of a mesh in that order.
std::vector<VertexId> page_order(MeshView mesh);

/// All frames of a deforming mesh.
std::vector<std::vector<Vec3>> frames_of(const nlohmann::json& frames, std::size_t vertex_count);

/// The float64 numbers of poses, twelve each.
std::vector<Transform> poses_of(const std::string& base64);

}  // namespace limber::program_tests
