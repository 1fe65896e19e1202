// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gltf_parts.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

class Gltf : public FilesTest {
 protected:
  Error refused_parts(const GltfParts& parts) const { return refused("a.gltf", parts.gltf()); }
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
}

TEST_F(Gltf, glb_and_gltf_of_the_same_parts_agree) {
  const Result<MeshFile> text = read("a.gltf", varied_gltf().gltf()), binary = read("a.glb", varied_gltf().glb());
  ASSERT_TRUE(text && binary);
  EXPECT_EQ(text->mesh.positions(), binary->mesh.positions());
  EXPECT_EQ(text->mesh.triangles(), binary->mesh.triangles());
}

TEST_F(Gltf, transforms_keep_float64) {
  GltfParts parts;
  parts.nodes = R"([{"translation":[0.1,0,0],"children":[1]},{"mesh":0,"translation":[1e9,0,0]}])";
  const Result<MeshFile> file = read("a.gltf", parts.gltf());
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions()[0].x, 1e9 + 0.1);
}

TEST_F(Gltf, rotation_of_any_length_turns_without_scaling) {
  GltfParts parts;
  parts.nodes = R"([{"mesh":0,"rotation":[0,0,3,3]}])";  // a quarter turn around z
  const Result<MeshFile> file = read("a.gltf", parts.gltf());
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_NEAR(file->mesh.positions()[1].x, 0, 1e-15);
  EXPECT_NEAR(file->mesh.positions()[1].y, 1, 1e-15);
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
  fs::create_symlink("below/b.bin", path("link.bin"));
  GltfParts parts;
  parts.uri = "link.bin";
  EXPECT_TRUE(read("a.gltf", parts.gltf()));
}

TEST_F(Gltf, buffer_files_elsewhere_are_refused) {
  fs::create_directories(path("folder/below"));
  GltfParts parts;
  write("folder/inside.bin", parts.buffer);
  const std::string outside = write("outside.bin", parts.buffer).string();
  fs::create_symlink(outside, path("folder/link.bin"));
  fs::create_directory_symlink(path(""), path("folder/up"));
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

TEST_F(Gltf, pipes_and_devices_are_no_buffer_files) {
  GltfParts parts;
  ASSERT_EQ(mkfifo(path("pipe.bin").c_str(), 0600), 0);
  parts.uri = "pipe.bin";
  EXPECT_NE(refused_parts(parts).text.find("is not a regular file"), std::string::npos);
}

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
  GltfParts parts;
  parts.buffer = gltf_buffer(tetrahedron_positions, {{0, 2, 1}, {0, 1, 4}});
  parts.views = R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
  parts.nodes = R"([{"mesh":0}])";
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

}  // namespace
}  // namespace limber
