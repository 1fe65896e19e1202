// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gltf_parts.h"

namespace limber {

GltfParts varied_gltf() {
  GltfParts parts;
  parts.buffer.clear();
  // Positions with a fourth number behind each, which the stride passes over.
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}}) {
    for (const double c : {p.x, p.y, p.z, 99.0}) append(parts.buffer, static_cast<float>(c));
  }
  parts.buffer += std::string(
      "\0\1\2\3"
      "\1\0\3\0",
      8);  // from byte 64: four bytes, two 16-bit numbers
  for (const float c : {5.0F, 6.0F, 7.0F, 8.0F, 9.0F, 10.0F}) append(parts.buffer, c);  // from byte 72
  parts.views = R"([{"buffer":0,"byteLength":64,"byteStride":16},{"buffer":0,"byteOffset":64,"byteLength":4},)"
                R"({"buffer":0,"byteOffset":68,"byteLength":4},{"buffer":0,"byteOffset":72,"byteLength":24}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5121,"count":4,"type":"SCALAR"},)"
                    R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":2,)"
                    R"("indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}},)"
                    R"({"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,)"
                    R"("indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3,"byteOffset":12}}}])";
  parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":5},)"
                     R"({"attributes":{"POSITION":2},"indices":1,"mode":6},)"
                     R"({"attributes":{"POSITION":3}},{"attributes":{"POSITION":0},"indices":1,"mode":0}])";
  parts.nodes = R"([{"children":[1],"translation":[0,0,10]},{"mesh":0,)"
                R"("matrix":[2,0,0,0, 0,2,0,0, 0,0,2,0, 1,0,0,1]}])";
  return parts;
}

}  // namespace limber
