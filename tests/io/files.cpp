// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <sstream>

namespace limber {

std::string tetrahedron_obj() {
  return "# four corners\no tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

std::string tetrahedron_off() {
  return "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 0.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
}

std::string tetrahedron_ply_ascii() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 0.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
}

std::string tetrahedron_ply_binary(bool big_endian) {
  std::string bytes = std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 4\nproperty list uchar int vertex_index\nend_header\n";
  for (const Vec3& p : tetrahedron_positions) {
    for (const double c : {p.x, p.y, p.z}) append(bytes, static_cast<float>(c), big_endian);
  }
  for (const Corners& corners : tetrahedron_triangles) {
    append(bytes, std::uint8_t{3});
    for (const VertexId v : corners) append(bytes, v, big_endian);
  }
  return bytes;
}

std::string tetrahedron_stl_text() {
  std::ostringstream out;
  out << "solid four corners\n";
  for (const Corners& corners : tetrahedron_triangles) {
    out << " facet normal 0 0 1\n  outer loop\n";
    for (const VertexId v : corners) {
      const Vec3& p = tetrahedron_positions[v];
      out << "   vertex " << p.x << " " << p.y << " " << p.z << "\n";
    }
    out << "  endloop\n endfacet\n";
  }
  out << "endsolid four corners\n";
  return out.str();
}

std::string tetrahedron_stl_binary() {
  std::string bytes = "solid, and yet binary";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(tetrahedron_triangles.size()));
  for (const Corners& corners : tetrahedron_triangles) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, 0.0F);
    for (const VertexId v : corners) {
      for (std::size_t axis = 0; axis < 3; ++axis) append(bytes, static_cast<float>(tetrahedron_positions[v][axis]));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
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

std::string gltf_json(std::size_t vertex_count, std::size_t index_count, const std::string& nodes,
                      const std::string& uri) {
  const std::size_t position_bytes = 12 * vertex_count, index_bytes = 2 * index_count;
  std::ostringstream out;
  out << R"({"asset":{"version":"2.0"},"scene":0,)";
  out << (nodes.empty() ? R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)" : nodes);
  out << R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      << R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","min":[0,0,0],"max":[1,1,1],"count":)"
      << vertex_count << R"(},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":)" << index_count
      << R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" << position_bytes
      << R"(},{"buffer":0,"byteOffset":)" << position_bytes << R"(,"byteLength":)" << index_bytes
      << R"(}],"buffers":[{)" << (uri.empty() ? "" : R"("uri":")") << uri << (uri.empty() ? "" : R"(",)")
      << R"("byteLength":)" << position_bytes + index_bytes << "}]}";
  return out.str();
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

std::string tetrahedron_glb() {
  return glb(gltf_json(4, 12), gltf_buffer(tetrahedron_positions, tetrahedron_triangles));
}

std::string tetrahedron_gltf() {
  const std::string buffer = gltf_buffer(tetrahedron_positions, tetrahedron_triangles);
  return gltf_json(4, 12, {}, std::string("data:application/octet-stream;base64,").append(base64(buffer)));
}

std::vector<std::pair<std::string, std::string>> tetrahedron_files() {
  return {{"text.obj", tetrahedron_obj()},           {"text.off", tetrahedron_off()},
          {"text.ply", tetrahedron_ply_ascii()},     {"little.ply", tetrahedron_ply_binary(false)},
          {"big.ply", tetrahedron_ply_binary(true)}, {"text.stl", tetrahedron_stl_text()},
          {"binary.stl", tetrahedron_stl_binary()},  {"binary.glb", tetrahedron_glb()},
          {"text.gltf", tetrahedron_gltf()}};
}

}  // namespace limber
