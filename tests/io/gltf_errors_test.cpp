// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gltf_parts.h"

namespace limber {
namespace {

class GltfErrors : public FilesTest {
 protected:
  Error refused_parts(const GltfParts& parts) const { return refused("a.gltf", parts.gltf()); }

  /// Replaces the first `part` of an accessor list or another text that has it.
  static std::string with(std::string text, const std::string& part, const std::string& instead) {
    EXPECT_NE(text.find(part), text.npos) << part;
    return text.replace(text.find(part), part.size(), instead);
  }
};

TEST_F(GltfErrors, positions_of_other_types_than_float_are_refused) {
  for (const char* type : {"5120", "5121", "5122", "5123", "5125", "0", "5130"}) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, "5126", type);
    const Error error = refused_parts(parts);
    EXPECT_EQ(error.code, ErrorCode::unsupported_format);
    EXPECT_NE(error.text.find("accessor 0: positions of component type " + std::string(type)), std::string::npos);
  }
}

TEST_F(GltfErrors, required_extensions_are_known_by_their_decoded_names) {
  for (const std::string name :
       {"KHR_mesh_quantization", "KHR\\u005fmesh_quantization", "\\u004bHR_mesh_quantization"}) {
    GltfParts parts;
    parts.more = R"("extensionsUsed":[")" + name + R"("],"extensionsRequired":[")" + name + R"("],)";
    for (const std::string& bytes : {parts.gltf(), parts.glb()}) {
      const Error error = refused("a.glb", bytes);
      EXPECT_EQ(error.code, ErrorCode::unsupported_format);
      EXPECT_NE(error.text.find("KHR_mesh_quantization"), std::string::npos) << error.text;
    }
    parts.more = with(parts.more, "extensionsRequired", "extensions\\u0052equired");
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::unsupported_format);
  }
  GltfParts parts;
  parts.more = R"("extensionsRequired":["VENDOR_unheard_of"],)";
  EXPECT_NE(refused_parts(parts).text.find("VENDOR_unheard_of"), std::string::npos);
  parts.more = R"("extensionsRequired":[7],)";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file);
}

TEST_F(GltfErrors, broken_accessors_are_malformed) {
  const GltfParts sound;
  ASSERT_TRUE(read("a.gltf", sound.gltf()));
  for (const auto& [part, instead] : std::vector<std::pair<std::string, std::string>>{
           {R"("count":3)", R"("count":4)"},
           {R"("count":3)", R"("count":0)"},
           {R"("count":3)", R"("count":-3)"},
           {R"("count":3)", R"("count":3.0)"},
           {R"("count":3)", R"("count":18446744073709551615)"},
           {R"("count":3)", R"("count":99999999999999999999999)"},
           {R"("count":3)", R"("counts":3)"},
           {R"("bufferView":0)", R"("bufferView":2)"},
           {R"("bufferView":0)", R"("bufferView":18446744073709551615)"},
           {R"("bufferView":0)", R"("bufferView":0,"byteOffset":4)"},
           {R"("bufferView":0)", R"("bufferView":0,"byteOffset":18446744073709551612)"},
           {R"("bufferView":0)", R"("byteOffset":4)"},
           {R"("VEC3")", R"("VEC4")"},
           {R"("VEC3")", "3"},
           {R"("VEC3")", R"("VEC3","normalized":true)"},
           {"5123", "5122"},
           {"5123", "5126"},
           {"5123", "5125"},
           {R"("SCALAR")", R"("VEC2")"},
           {"}", R"(,"sparse":7})"}}) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, part, instead);
    const ErrorCode code = refused_parts(parts).code;
    EXPECT_TRUE(code == ErrorCode::malformed_file || code == ErrorCode::too_large) << instead;
  }
}

TEST_F(GltfErrors, broken_buffer_views_are_malformed) {
  for (const auto& [part, instead] : std::vector<std::pair<std::string, std::string>>{
           {R"("byteLength":36)", R"("byteLength":43)"},
           {R"("byteLength":36)", R"("byteLength":35)"},
           {R"("byteLength":36)", R"("byteLength":0)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteOffset":18446744073709551615)"},
           {R"("byteLength":36)", R"("byteLength":18446744073709551615,"byteOffset":1)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteOffset":2)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteStride":8)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteStride":14)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteStride":16)"},
           {R"("byteLength":36)", R"("byteLength":36,"byteStride":256)"},
           {R"("byteLength":6)", R"("byteLength":6,"byteStride":4)"},
           {R"("byteLength":6)", R"("byteLength":12)"},
           {R"("byteOffset":36)", R"("byteOffset":35)"},
           {R"("buffer":0)", R"("buffer":1)"}}) {
    GltfParts parts;
    parts.views = with(parts.views, part, instead);
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << instead;
  }
}

TEST_F(GltfErrors, broken_sparse_accessors_are_malformed) {
  const GltfParts sound = varied_gltf();
  ASSERT_TRUE(read("a.gltf", sound.gltf()));
  for (const auto& [part, instead] : std::vector<std::pair<std::string, std::string>>{
           {R"("count":2)", R"("count":3)"},
           {R"("count":2)", R"("count":5)"},
           {R"("count":2)", R"("count":0)"},
           {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":2,"byteOffset":1099511627776)"},
           {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":2,"byteOffset":1)"},
           {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":0)"},
           {R"("indices":{"bufferView":2)", R"("indices":{"nothing":2)"},
           {R"("values":{"bufferView":3})", R"("values":{"bufferView":2})"},
           {R"("values":{"bufferView":3})", R"("values":{"bufferView":3,"byteOffset":4})"},
           {R"("values":{"bufferView":3})", R"("values":{"bufferView":3,"byteOffset":18446744073709551608})"},
           {R"("componentType":5123})", R"("componentType":5126})"}}) {
    GltfParts parts = sound;
    parts.accessors = with(parts.accessors, part, instead);
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << instead;
  }
  GltfParts falling = sound;
  std::swap(falling.buffer[68], falling.buffer[70]);  // 3, 1
  EXPECT_NE(refused_parts(falling).text.find("sparse index 1 does not follow"), std::string::npos);
  GltfParts beyond = sound;
  beyond.buffer[70] = 4;
  EXPECT_NE(refused_parts(beyond).text.find("sparse index 4 names no element"), std::string::npos);
}

TEST_F(GltfErrors, corners_that_make_no_whole_triangles_are_malformed) {
  for (const auto& [count, mode] : std::vector<std::pair<std::string, std::string>>{
           {"1", "4"}, {"2", "4"}, {"2", "5"}, {"1", "6"}, {"2", "6"}, {"3", "7"}, {"3", "-1"}, {"3", "\"4\""}}) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, R"(5123,"count":3)", R"(5123,"count":)" + count);
    parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":)" + mode + "}]";
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << count << " corners, mode " << mode;
  }
}

TEST_F(GltfErrors, nodes_that_form_no_tree_are_malformed) {
  for (const auto& [nodes, scenes] : std::vector<std::pair<std::string, std::string>>{
           {R"([{"children":[0],"mesh":0}])", "[0]"},
           {R"([{"children":[1]},{"children":[0],"mesh":0}])", "[0]"},
           {R"([{"children":[1]},{"children":[2]},{"children":[1],"mesh":0}])", "[0]"},
           {R"([{"children":[1,1]},{"mesh":0}])", "[0]"},
           {R"([{"children":[2]},{"children":[2]},{"mesh":0}])", "[0,1]"},
           {R"([{"children":[1]},{"mesh":0}])", "[1]"},
           {R"([{"mesh":0}])", "[0,0]"},
           {R"([{"mesh":0}])", "[1]"},
           {R"([{"mesh":1}])", "[0]"},
           {R"([{"children":[7],"mesh":0}])", "[0]"},
           {R"([7])", "[0]"}}) {
    GltfParts parts;
    parts.nodes = nodes;
    parts.scenes = R"([{"nodes":)" + scenes + "}]";
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << nodes << scenes;
  }
}

TEST_F(GltfErrors, broken_transforms_are_malformed) {
  const std::string matrix = R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])";
  for (const std::string& transform :
       {with(matrix, "1]", "2]"), with(matrix, "[1,0,0,0", "[1,0,0,1"), with(matrix, ",1]", "]"),
        matrix + R"(,"scale":[1,1,1])", std::string(R"("rotation":[0,0,0,0])"), std::string(R"("rotation":[0,0,1])"),
        std::string(R"("translation":[0,0,"x"])"), std::string(R"("scale":1)"),
        std::string(R"("scale":[1e999,1,1])")}) {
    GltfParts parts;
    parts.nodes = R"([{"mesh":0,)" + transform + "}]";
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << transform;
  }
  GltfParts parts;
  parts.nodes = R"([{"mesh":0,"scale":[1e300,1,1]}])";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::too_large);
}

TEST_F(GltfErrors, other_versions_are_unsupported) {
  GltfParts parts;
  parts.asset = R"({"version":"1.0"})";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::unsupported_format);
  parts.asset = R"({"version":"2.1","minVersion":"2.1"})";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::unsupported_format);
  parts.asset = R"({"version":"2.1"})";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
  parts.asset = "{}";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file);
  std::string bytes = GltfParts().glb();
  bytes[4] = 1;
  EXPECT_EQ(refused("a.glb", bytes).code, ErrorCode::unsupported_format);
}

TEST_F(GltfErrors, names_that_an_object_has_twice_are_malformed) {
  GltfParts parts;
  parts.accessors = with(parts.accessors, R"("count":3)", R"("count":3,"co\u0075nt":1)");
  EXPECT_NE(refused_parts(parts).text.find("two properties 'count'"), std::string::npos);
}

TEST_F(GltfErrors, data_that_is_not_base64_is_malformed) {
  for (const char* uri : {"data:,abc", "data:;base64", "data:;base64,A", "data:;base64,AA*A", "data:;base64,AA A",
                          "data:;base64,====", "data:application/octet-stream;base64,AAAA\\n"}) {
    GltfParts parts;
    parts.uri = uri;
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << uri;
  }
}

TEST_F(GltfErrors, compressed_primitives_are_read_only_if_plain_data_is_there_too) {
  GltfParts parts;
  parts.primitives = R"([{"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}}])";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
  parts.accessors = with(parts.accessors, R"("bufferView":0,)", "");
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::unsupported_format);
}

TEST_F(GltfErrors, broken_binary_containers_are_malformed) {
  const std::string sound = GltfParts().glb();
  ASSERT_TRUE(read("a.glb", sound));
  std::string no_json_first = sound;
  no_json_first.replace(16, 4, "JSOM");
  EXPECT_EQ(refused("a.glb", no_json_first).code, ErrorCode::malformed_file);
  std::string no_binary_chunk = sound;
  no_binary_chunk.replace(sound.find(std::string_view("BIN\0", 4)), 3, "BIM");
  EXPECT_NE(refused("a.glb", no_binary_chunk).text.find("no binary chunk"), std::string::npos);
  EXPECT_EQ(refused("a.glb", sound.substr(0, 12)).code, ErrorCode::malformed_file);
  std::string chunk_beyond_the_end = sound;
  chunk_beyond_the_end[sound.find(std::string_view("BIN\0", 4)) - 4] += 4;
  EXPECT_NE(refused("a.glb", chunk_beyond_the_end).text.find("promises"), std::string::npos);
}

}  // namespace
}  // namespace limber
