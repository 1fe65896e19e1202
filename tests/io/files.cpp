// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

namespace limber {

std::string ply_header(std::size_t vertex_count, std::size_t face_count) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(face_count) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::vector<std::pair<std::string, std::string>> triangle_files(const std::array<std::string, 3>& vertices) {
  const auto& [a, b, c] = vertices;
  const std::string lines = a + "\n" + b + "\n" + c + "\n3 0 1 2\n";
  return {{"a.obj", "v " + a + "\nv " + b + "\nv " + c + "\nf 1 2 3\n"},
          {"a.off", "OFF\n3 1 0\n" + lines},
          {"a.ply", ply_header(3, 1) + lines},
          {"a.stl", "solid\nfacet normal 0 0 1 outer loop vertex " + a + " vertex " + b + " vertex " + c +
                        "\nendloop endfacet\nendsolid\n"}};
}

std::string glb(std::string json, std::string buffer) {
  json.append((4 - json.size() % 4) % 4, ' ');
  buffer.append((4 - buffer.size() % 4) % 4, '\0');
  std::string bytes("glTF");
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes.append("JSON").append(json);
  append(bytes, static_cast<std::uint32_t>(buffer.size()));
  bytes.append("BIN\0", 4);
  return bytes + buffer;
}

std::string gltf_buffer(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles) {
  std::string bytes;
  for (const Vec3& p : positions) {
    for (const double c : {p.x, p.y, p.z}) append(bytes, static_cast<float>(c));
  }
  for (const Corners& corners : triangles) {
    for (const VertexId v : corners) append(bytes, static_cast<std::uint16_t>(v));
  }
  return bytes;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

GltfParts gltf_of(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles) {
  GltfParts parts;
  const std::string position_bytes = std::to_string(12 * positions.size());
  parts.buffer = gltf_buffer(positions, triangles);
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"type":"VEC3","min":[0,0,0],"max":[1,1,1],"count":)" +
                    std::to_string(positions.size()) +
                    R"(},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":)" +
                    std::to_string(3 * triangles.size()) + "}]";
  parts.views = R"([{"buffer":0,"byteOffset":0,"byteLength":)" + position_bytes + R"(},{"buffer":0,"byteOffset":)" +
                position_bytes + R"(,"byteLength":)" + std::to_string(6 * triangles.size()) + "}]";
  return parts;
}

std::vector<std::pair<std::string, std::string>> tetrahedron_files() {
  const GltfParts parts = gltf_of(tetrahedron_positions, tetrahedron_triangles);
  std::vector<std::pair<std::string, std::string>> files{{"text.gltf", parts.gltf()}, {"binary.glb", parts.glb()}};
  for (const std::string name : {"obj/plain.obj", "off/plain.off", "ply/text.ply", "ply/little.ply", "ply/big.ply",
                                 "stl/text.stl", "stl/binary.stl", "stl/binary_called_solid.stl"}) {
    files.emplace_back(name.substr(4), tetrahedron(name));
  }
  return files;
}

}  // namespace limber
