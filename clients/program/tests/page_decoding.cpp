// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "page_decoding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace limber::program_tests {

Report::Report(const std::string& line) {
  const std::string path = folder.path("page.html");
  outcome = run(line + " --report " + path);
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << line << '\n' << outcome.err;
  page = text_of(path);
  data = page_data(page);
}

nlohmann::json page_data(const std::string& page) {
  const std::string start = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = page.find(start);
  EXPECT_NE(at, std::string::npos);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + start.size();
  nlohmann::json data =
      nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin), nullptr, false);
  EXPECT_FALSE(data.is_discarded());
  return data;
}

std::vector<std::uint8_t> bytes_of(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  EXPECT_EQ(base64.size() % 4, 0U);
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : base64) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("not base64");
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(bit_count)));
  }
  return bytes;
}

std::vector<std::uint64_t> counts_of(const std::string& base64) {
  std::vector<std::uint64_t> counts;
  std::uint64_t count = 0, factor = 1;
  for (const std::uint8_t byte : bytes_of(base64)) {
    count += factor * (byte % 128);
    factor *= 128;
    if (byte >= 128) continue;
    counts.push_back(count);
    count = 0;
    factor = 1;
  }
  return counts;
}

std::vector<double> numbers_of(double low, double step, const std::string& base64) {
  const std::vector<std::uint8_t> bytes = bytes_of(base64);
  std::vector<double> numbers;
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {
    numbers.push_back(low + step * (bytes[i] + 256.0 * bytes[i + 1] + 65536.0 * bytes[i + 2]));
  }
  return numbers;
}

std::vector<Vec3> points_of(const nlohmann::json& quantized) {
  std::vector<Vec3> points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double> coordinates =
        numbers_of(quantized["low"][axis], quantized["step"][axis], quantized["data"][axis]);
    points.resize(coordinates.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i][axis] = coordinates[i];
  }
  return points;
}

std::vector<Corners> corners_of(const std::string& base64) {
  std::vector<Corners> triangles;
  VertexId named = 0;
  std::size_t corner = 0;
  for (const std::uint64_t back : counts_of(base64)) {
    if (corner == 0) triangles.emplace_back();
    triangles.back()[corner] = back == 0 ? named++ : named - static_cast<VertexId>(back);
    corner = (corner + 1) % 3;
  }
  return triangles;
}

std::vector<VertexId> page_order(MeshView mesh) {
  std::vector<VertexId> order;
  std::vector<bool> is_named(mesh.positions.size());
  for (const Corners& triangle : mesh.triangles) {
    for (const VertexId v : triangle) {
      if (!is_named[v]) order.push_back(v);
      is_named[v] = true;
    }
  }
  return order;
}

std::vector<std::vector<Vec3>> frames_of(const nlohmann::json& frames, std::size_t vertex_count) {
  const double step = frames["step"];
  const std::size_t run = frames["run"];
  std::vector<double> steps(3 * vertex_count);
  std::vector<std::vector<Vec3>> decoded;
  for (const nlohmann::json& data : frames["data"]) {
    const std::vector<std::uint64_t> counts = counts_of(data);
    std::vector<double> differences;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto code = static_cast<double>(counts[i]);
      if (counts[i] == 0) {
        differences.resize(differences.size() + counts.at(++i));
      } else {
        differences.push_back(counts[i] % 2 == 0 ? code / 2 : -(code + 1) / 2);
      }
    }
    EXPECT_EQ(differences.size(), steps.size());
    std::vector<Vec3>& points = decoded.emplace_back(vertex_count);
    for (std::size_t i = 0; i < std::min(steps.size(), differences.size()); ++i) {
      const bool is_whole = (decoded.size() - 1) % run == 0;
      steps[i] = (!is_whole ? steps[i] : i < 3 ? 0 : steps[i - 3]) + differences[i];
      points[i / 3][i % 3] = frames["low"][i % 3].get<double>() + step * steps[i];
    }
  }
  return decoded;
}

std::vector<Transform> poses_of(const std::string& base64) {
  const std::vector<std::uint8_t> bytes = bytes_of(base64);
  std::vector<Transform> poses(bytes.size() / 96);
  for (std::size_t p = 0; p < poses.size(); ++p) {
    double n[12];
    std::memcpy(n, bytes.data() + 96 * p, sizeof n);
    poses[p] = {{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}}, {n[9], n[10], n[11]}};
  }
  return poses;
}

}  // namespace limber::program_tests
