// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "files.h"

namespace limber {

/// A glTF file in parts, each of which a test may replace. As it stands it shows one triangle: positions 0 0 0, 1 0 0
/// and 0 1 0, then the 16-bit indices 0, 1, 2.
struct GltfParts {
  std::string asset = R"({"version":"2.0"})";
  std::string scenes = R"([{"nodes":[0]}])";
  std::string nodes = R"([{"mesh":0}])";
  std::string primitives = R"([{"attributes":{"POSITION":0},"indices":1}])";
  std::string accessors = R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
                          R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}])";
  std::string views = R"([{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}])";
  std::string more;  ///< further properties, each ended by a comma
  std::string uri;   ///< of the buffer; empty: its bytes stand in the file
  std::string buffer = gltf_buffer({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});

  /// The description alone, with the bytes of the buffer in it or with its uri.
  std::string gltf() const { return description(uri.empty() ? "data:;base64," + base64(buffer) : uri); }
  /// The same as a binary file.
  std::string glb() const { return limber::glb(description(""), buffer); }

 private:
  std::string description(const std::string& buffer_uri) const {
    return "{" + more + R"("asset":)" + asset + R"(,"scenes":)" + scenes + R"(,"nodes":)" + nodes +
           R"(,"meshes":[{"primitives":)" + primitives + R"(}],"accessors":)" + accessors + R"(,"bufferViews":)" +
           views + R"(,"buffers":[{)" + (buffer_uri.empty() ? "" : R"("uri":")" + buffer_uri + R"(",)") +
           R"("byteLength":)" + std::to_string(buffer.size()) + "}]}";
  }
};

/// One triangle for each accessor of positions: sparse positions, a view with a stride, a strip and a fan, below two
/// levels of nodes.
GltfParts varied_gltf();

}  // namespace limber
