// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

class Gltf : public FilesTest {
 protected:
  Error refused_parts(const GltfParts& parts) const { return refused("a.gltf", parts.gltf()); }

  /// A text with the first `part` replaced.
  static std::string with(std::string text, const std::string& part, const std::string& instead) {
    EXPECT_NE(text.find(part), text.npos) << part;
    return text.replace(text.find(part), part.size(), instead);
  }
  using Changes = std::vector<std::pair<std::string, std::string>>;
  /// Each change alone, of one part of a sound file, makes it malformed or too large.
  void expect_refused_changes(const GltfParts& sound, std::string GltfParts::*part, const Changes& changes) const {
    ASSERT_TRUE(read("a.gltf", sound.gltf()));
    for (const auto& [from, to] : changes) {
      GltfParts parts = sound;
      parts.*part = with(parts.*part, from, to);
      const ErrorCode code = refused_parts(parts).code;
      EXPECT_TRUE(code == ErrorCode::malformed_file || code == ErrorCode::too_large) << to;
    }
  }
};

std::vector<Triangle> triangles_of(const Result<MeshFile>& file) {
  std::vector<Triangle> triangles;
  for (TriangleId t = 0; file && t < file->mesh.triangles().size(); ++t) triangles.push_back(file->mesh.triangle(t));
  return triangles;
}

bool are_corners(const Triangle& triangle, const Vec3& v0, const Vec3& v1, const Vec3& v2) {
  return triangle.v0 == v0 && triangle.v1 == v1 && triangle.v2 == v2;
}

TEST_F(Gltf, strips_fans_strides_and_sparse_accessors_are_read) {
  const Result<MeshFile> file = read("a.gltf", varied_gltf().gltf());
  ASSERT_TRUE(file) << file.error().text;
  const std::vector<Triangle> triangles = triangles_of(file);
  ASSERT_EQ(triangles.size(), 5U);
  const auto placed = [](const Vec3& p) { return 2 * p + Vec3{1, 0, 10}; };
  const Vec3 a = placed({0, 0, 0}), b = placed({1, 0, 0}), c = placed({0, 1, 0}), d = placed({1, 1, 0});
  EXPECT_TRUE(are_corners(triangles[0], a, b, c));  // the strip
  EXPECT_TRUE(are_corners(triangles[1], b, d, c));
  const Vec3 e = placed({5, 6, 7}), f = placed({8, 9, 10});  // stand in for b and d
  EXPECT_TRUE(are_corners(triangles[2], e, c, a));           // the fan
  EXPECT_TRUE(are_corners(triangles[3], c, f, a));
  EXPECT_TRUE(are_corners(triangles[4], a, f, a));  // zeros but for the one sparse element
  EXPECT_EQ(file->face_count, 5U);                  // points are not counted
  const Result<MeshFile> binary = read("a.glb", varied_gltf().glb());
  ASSERT_TRUE(binary);
  EXPECT_EQ(binary->mesh.positions(), file->mesh.positions());
  EXPECT_EQ(binary->mesh.triangles(), file->mesh.triangles());
}

TEST_F(Gltf, transforms_keep_float64) {
  GltfParts parts;
  parts.nodes = R"([{"translation":[0.1,0,0],"children":[1]},{"mesh":0,"translation":[1e9,0,0]}])";
  const Result<MeshFile> file = read("a.gltf", parts.gltf());
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions()[0].x, 1e9 + 0.1);
}

TEST_F(Gltf, rotation_about_a_slanted_axis_is_that_of_the_quaternion) {
  GltfParts parts;
  parts.nodes = R"([{"rotation":[1,2,3,4],"children":[1]},{"mesh":0,"translation":[0,0,1]}])";
  const Result<MeshFile> file = read("a.gltf", parts.gltf());
  ASSERT_TRUE(file) << file.error().text;
  const Vec3 of_x{4, 28, -10}, of_y{-20, 10, 20}, of_z{22, 4, 20};  // thirtieths
  const std::vector<Vec3>& positions = file->mesh.positions();
  EXPECT_LT(max_abs(30 * positions[0] - of_z), 1e-13);
  EXPECT_LT(max_abs(30 * positions[1] - (of_x + of_z)), 1e-13);
  EXPECT_LT(max_abs(30 * positions[2] - (of_y + of_z)), 1e-13);
}

TEST_F(Gltf, points_and_lines_are_passed_over) {
  for (const char* mode : {"0", "1", "2", "3"}) {
    GltfParts parts;
    parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":)" + std::string(mode) + "}]";
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::empty_mesh);
    parts.primitives.insert(1, R"({"attributes":{"POSITION":0}},)");
    const Result<MeshFile> file = read("a.gltf", parts.gltf());
    ASSERT_TRUE(file) << file.error().text;
    EXPECT_EQ(file->face_count, 1U);
  }
}

TEST_F(Gltf, chain_of_twenty_thousand_nodes_is_read) {
  constexpr std::size_t node_count = 20'000;
  GltfParts parts;
  parts.nodes = "[";
  for (std::size_t n = 1; n < node_count; ++n) {
    parts.nodes += R"({"translation":[1,0,0],"children":[)" + std::to_string(n) + "]},";
  }
  parts.nodes += R"({"mesh":0}])";
  const Result<MeshFile> file = read("a.gltf", parts.gltf());
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions()[0].x, static_cast<double>(node_count - 1));
}

TEST_F(Gltf, scene_is_the_named_one_or_the_first) {
  GltfParts parts;
  parts.scenes = R"([{"nodes":[0]},{"nodes":[1]}])";
  parts.nodes = R"([{"mesh":0},{"mesh":0,"translation":[7,0,0]}])";
  EXPECT_EQ(read("a.gltf", parts.gltf())->mesh.positions()[0].x, 0);
  parts.more = R"("scene":1,)";
  EXPECT_EQ(read("a.gltf", parts.gltf())->mesh.positions()[0].x, 7);
  parts.more = R"("scene":2,)";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file);
  parts.more.clear();
  parts.scenes = "[]";
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::empty_mesh);
}

TEST_F(Gltf, extensions_that_change_no_geometry_may_be_required) {
  GltfParts parts;
  parts.more = R"("extensionsRequired":["KHR_materials_unlit","KHR_texture_transform","EXT_texture_webp"],)";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
}

TEST_F(Gltf, buffer_files_lie_in_the_folder_or_below) {
  fs::create_directories(path("below"));
  for (const auto& [name, uri] : std::vector<std::pair<std::string, std::string>>{{"a.bin", "a.bin"},
                                                                                  {"a.bin", "./a.bin"},
                                                                                  {"below/b.bin", "below/b.bin"},
                                                                                  {"a b.bin", "a%20b.bin"},
                                                                                  {"..c.bin", "..c.bin"},
                                                                                  {"\xC3\xA4.bin", "%C3%a4.bin"}}) {
    GltfParts parts;
    write(name, parts.buffer);
    parts.uri = uri;
    const Result<MeshFile> file = read("a.gltf", parts.gltf());
    EXPECT_TRUE(file) << uri << file.error().text;
  }
#if !defined(_WIN32)  // where few may make links, and the standard library of MinGW cannot
  fs::create_symlink("below/b.bin", path("link.bin"));
  GltfParts parts;
  parts.uri = "link.bin";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
#endif
}

TEST_F(Gltf, buffer_files_elsewhere_are_refused) {
  fs::create_directories(path("folder/below"));
  GltfParts parts;
  write("folder/inside.bin", parts.buffer);
  const std::string outside = write("outside.bin", parts.buffer).generic_string();
#if !defined(_WIN32)
  fs::create_symlink(outside, path("folder/link.bin"));
  fs::create_directory_symlink(path(""), path("folder/up"));
#endif
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("%2e%2E/outside.bin"), std::string("..%2Foutside.bin"),
        std::string("./../outside.bin"), outside, "file://" + outside, std::string("http://localhost/outside.bin"),
        std::string("below/../inside.bin"), std::string("link.bin"), std::string("up/outside.bin"),
        std::string("..\\\\outside.bin"), std::string("a%00.bin"), std::string("%4"), std::string("%zz"),
        std::string("missing.bin"), std::string("."), std::string("up")}) {
    parts.uri = uri;
    const Error error = refused("folder/a.gltf", parts.gltf());
    EXPECT_EQ(error.code, ErrorCode::malformed_file) << uri;
    EXPECT_NE(error.text.find("buffer 0"), std::string::npos) << error.text;
  }
}

#if !defined(_WIN32)
TEST_F(Gltf, pipes_and_devices_are_no_buffer_files) {
  GltfParts parts;
  ASSERT_EQ(mkfifo(path("pipe.bin").c_str(), 0600), 0);
  parts.uri = "pipe.bin";
  EXPECT_NE(refused_parts(parts).text.find("is not a regular file"), std::string::npos);
}
#endif

TEST_F(Gltf, bytes_in_a_buffer_file_beyond_the_promised_length_do_not_count) {
  GltfParts parts;
  write("long.bin", parts.buffer + "more");
  parts.uri = "long.bin";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
  write("short.bin", parts.buffer.substr(1));
  parts.uri = "short.bin";
  EXPECT_NE(refused_parts(parts).text.find("buffer 0: promises 42 bytes but has 41"), std::string::npos);
}

TEST_F(Gltf, index_of_a_missing_vertex_is_named) {
  const GltfParts parts = gltf_of(tetrahedron_positions, {{0, 2, 1}, {0, 1, 4}});
  const Error error = refused_parts(parts);
  EXPECT_EQ(error.code, ErrorCode::index_out_of_range);
  EXPECT_EQ(error.where, 1U);
  EXPECT_NE(error.text.find("mesh 0 primitive 0: triangle 1 names vertex 4, but there are only 4 vertices"),
            std::string::npos)
      << error.text;
}

TEST_F(Gltf, largest_index_of_a_type_is_refused) {
  GltfParts parts;
  parts.accessors = R"([{"componentType":5126,"count":256,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}])";
  parts.buffer[38] = '\xff';
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::index_out_of_range);
  parts.buffer[38] = '\xfe';
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
}

TEST_F(Gltf, positions_of_other_types_than_float_are_refused) {
  for (const char* type : {"5120", "5121", "5122", "5123", "5125", "0", "5130"}) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, "5126", type);
    const Error error = refused_parts(parts);
    EXPECT_EQ(error.code, ErrorCode::unsupported_format);
    EXPECT_NE(error.text.find("accessor 0: positions of component type " + std::string(type)), std::string::npos);
  }
}

TEST_F(Gltf, required_extensions_are_known_by_their_decoded_names) {
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

TEST_F(Gltf, broken_accessors_are_malformed) {
  expect_refused_changes({}, &GltfParts::accessors,
                         {{R"("count":3)", R"("count":4)"},
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
                          {"}", R"(,"sparse":7})"}});
}

TEST_F(Gltf, broken_buffer_views_are_malformed) {
  expect_refused_changes({}, &GltfParts::views,
                         {{R"("byteLength":36)", R"("byteLength":43)"},
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
                          {R"("buffer":0)", R"("buffer":1)"}});
}

TEST_F(Gltf, broken_sparse_accessors_are_malformed) {
  expect_refused_changes(
      varied_gltf(), &GltfParts::accessors,
      {{R"("count":2)", R"("count":3)"},
       {R"("count":2)", R"("count":5)"},
       {R"("count":2)", R"("count":0)"},
       {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":2,"byteOffset":1099511627776)"},
       {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":2,"byteOffset":1)"},
       {R"("indices":{"bufferView":2)", R"("indices":{"bufferView":0)"},
       {R"("indices":{"bufferView":2)", R"("indices":{"nothing":2)"},
       {R"("values":{"bufferView":3})", R"("values":{"bufferView":2})"},
       {R"("values":{"bufferView":3})", R"("values":{"bufferView":3,"byteOffset":4})"},
       {R"("values":{"bufferView":3})", R"("values":{"bufferView":3,"byteOffset":18446744073709551608})"},
       {R"("componentType":5123})", R"("componentType":5126})"}});
  GltfParts falling = varied_gltf();
  std::swap(falling.buffer[68], falling.buffer[70]);  // 3, 1
  EXPECT_NE(refused_parts(falling).text.find("sparse index 1 does not follow"), std::string::npos);
  GltfParts beyond = varied_gltf();
  beyond.buffer[70] = 4;
  EXPECT_NE(refused_parts(beyond).text.find("sparse index 4 names no element"), std::string::npos);
}

TEST_F(Gltf, corners_that_make_no_whole_triangles_are_malformed) {
  for (const auto& [count, mode] : std::vector<std::pair<std::string, std::string>>{
           {"1", "4"}, {"2", "4"}, {"2", "5"}, {"1", "6"}, {"2", "6"}, {"3", "7"}, {"3", "-1"}, {"3", "\"4\""}}) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, R"(5123,"count":3)", R"(5123,"count":)" + count);
    parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":)" + mode + "}]";
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << count << " corners, mode " << mode;
  }
}

TEST_F(Gltf, nodes_that_form_no_tree_are_malformed) {
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

TEST_F(Gltf, broken_transforms_are_malformed) {
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

TEST_F(Gltf, other_versions_are_unsupported) {
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

TEST_F(Gltf, names_that_an_object_has_twice_are_malformed) {
  GltfParts parts;
  parts.accessors = with(parts.accessors, R"("count":3)", R"("count":3,"co\u0075nt":1)");
  EXPECT_NE(refused_parts(parts).text.find("two properties 'count'"), std::string::npos);
}

TEST_F(Gltf, data_that_is_not_base64_is_malformed) {
  for (const char* uri : {"data:,abc", "data:;base64", "data:;base64,A", "data:;base64,AA*A", "data:;base64,AA A",
                          "data:;base64,====", "data:application/octet-stream;base64,AAAA\\n"}) {
    GltfParts parts;
    parts.uri = uri;
    EXPECT_EQ(refused_parts(parts).code, ErrorCode::malformed_file) << uri;
  }
}

TEST_F(Gltf, compressed_primitives_are_read_only_if_plain_data_is_there_too) {
  GltfParts parts;
  parts.primitives = R"([{"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}}])";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
  parts.accessors = with(parts.accessors, R"("bufferView":0,)", "");
  EXPECT_EQ(refused_parts(parts).code, ErrorCode::unsupported_format);
}

TEST_F(Gltf, broken_binary_containers_are_malformed) {
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
