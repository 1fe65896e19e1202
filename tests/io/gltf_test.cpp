// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <sstream>

namespace limber {
namespace {

namespace fs = std::filesystem;

class Gltf : public FilesTest {
 protected:
  void refuse(const GltfParts& parts, ErrorCode code = ErrorCode::malformed_file, const std::string& text = "") const {
    refused("a.gltf", parts.gltf(), code, text);
  }
  MeshFile read_parts(const GltfParts& parts) const { return read("a.gltf", parts.gltf()).value(); }
  /// Each change alone makes a sound file malformed or too large: a part of the text, and what stands instead.
  void expect_refused_changes(const GltfParts& sound, std::string GltfParts::*part, const std::string& changes) const {
    read_parts(sound);
    std::istringstream words(changes);
    for (std::string from, to; words >> from >> to;) {
      GltfParts parts = sound;
      parts.*part = with(parts.*part, from, to);
      const Result<MeshFile> file = read("a.gltf", parts.gltf());
      ASSERT_FALSE(file) << to;
      EXPECT_TRUE(is_one_line_about(path("a.gltf"), file.error().text)) << file.error().text;
      const ErrorCode code = file.error().code;
      EXPECT_TRUE(code == ErrorCode::malformed_file || code == ErrorCode::too_large) << to;
    }
  }
};

/// A strip of four positions: every fourth number of their view is passed over, and two positions are replaced.
GltfParts sparse_gltf() {
  GltfParts parts;
  parts.buffer.clear();
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}}) {
    for (const double c : {p.x, p.y, p.z, 99.0}) append(parts.buffer, static_cast<float>(c));
  }
  for (const std::uint16_t index : {std::uint16_t{1}, std::uint16_t{3}}) append(parts.buffer, index);  // from byte 64
  for (const float c : {5.0F, 6.0F, 7.0F, 8.0F, 9.0F, 10.0F}) append(parts.buffer, c);
  parts.views = R"([{"buffer":0,"byteLength":64,"byteStride":16},{"buffer":0,"byteOffset":64,"byteLength":4},)"
                R"({"buffer":0,"byteOffset":68,"byteLength":24}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":2,)"
                    R"("indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}}}])";
  parts.primitives = R"([{"attributes":{"POSITION":0},"mode":5}])";
  return parts;
}

TEST_F(Gltf, strides_and_sparse_accessors_are_read) {
  for (const MeshFile& file : {read_parts(sparse_gltf()), read("a.glb", sparse_gltf().glb()).value()}) {
    EXPECT_EQ(file.mesh.positions(), (std::vector<Vec3>{{0, 0, 0}, {5, 6, 7}, {0, 1, 0}, {8, 9, 10}}));
    EXPECT_EQ(file.mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {1, 3, 2}}));
  }
}

/// Appends an accessor with a buffer view of its own and returns its index.
template <typename Component>
std::string add(GltfParts& parts, int component_type, const std::string& type, const std::vector<double>& numbers) {
  const auto object_count = [](const std::string& list) {
    return std::to_string(std::count(list.begin(), list.end(), '{'));
  };
  const std::string index = object_count(parts.accessors), view = object_count(parts.views);
  const std::size_t size = type == "MAT4" ? 16 : type == "VEC4" ? 4 : type == "VEC3" ? 3 : 1;
  parts.buffer.resize((parts.buffer.size() + 3) / 4 * 4);
  parts.accessors.back() = parts.views.back() = ',';
  parts.accessors += R"({"bufferView":)" + view + R"(,"componentType":)" + std::to_string(component_type) +
                     R"(,"type":")" + type + R"(","count":)" + std::to_string(numbers.size() / size) + "}]";
  parts.views += R"({"buffer":0,"byteOffset":)" + std::to_string(parts.buffer.size()) + R"(,"byteLength":)" +
                 std::to_string(numbers.size() * sizeof(Component)) + "}]";
  for (const double number : numbers) append(parts.buffer, static_cast<Component>(number));
  return index;
}
std::string add_bytes(GltfParts& parts, const std::string& type, const std::vector<double>& numbers) {
  return add<std::uint8_t>(parts, 5121, type, numbers);
}
std::string add_floats(GltfParts& parts, const std::string& type, const std::vector<double>& numbers) {
  return add<float>(parts, 5126, type, numbers);
}

std::string json(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "[" : ",") + std::to_string(number);
  return text + "]";
}

using Map = std::function<Vec3(const Vec3&)>;
Map operator*(const Map& a_from_b, const Map& b_from_c) {
  return [=](const Vec3& p) { return a_from_b(b_from_c(p)); };
}
Map map_of_parts(const double* t, const double* q, const double* s) {
  const Transform turn = transform_from_quaternion({t[0], t[1], t[2]}, q[3], q[0], q[1], q[2]).value();
  return [turn, x = s[0], y = s[1], z = s[2]](const Vec3& p) { return turn({x * p.x, y * p.y, z * p.z}); };
}
Map map_of_matrix(const std::vector<double>& m) {
  const auto column = [m](std::size_t i) { return Vec3{m[4 * i], m[4 * i + 1], m[4 * i + 2]}; };
  return [=](const Vec3& p) { return p.x * column(0) + p.y * column(1) + p.z * column(2) + column(3); };
}

TEST_F(Gltf, closed_meshes_are_placed_and_stay_outward_whatever_the_tree) {
  std::mt19937 random(20);
  const auto numbers = [&](std::size_t count) {  // exact in float32 and in text, none is zero
    std::vector<double> drawn(count);
    for (double& number : drawn) number = (2.0 * static_cast<double>(random() % 16) - 15) / 8;
    return drawn;
  };
  const auto matrix = [&] {
    std::vector<double> m = numbers(16);
    m[3] = m[7] = m[11] = 0, m[15] = 1;
    return m;
  };
  for (int round = 0; round < 40; ++round) {
    // A tetrahedron three times, bound to the second of two joints: as a list, a strip, and a fan with a triangle.
    GltfParts parts = gltf_of(tetrahedron_positions, tetrahedron_triangles);
    add_bytes(parts, "SCALAR", {0, 2, 1, 3, 0, 2});
    add_bytes(parts, "SCALAR", {0, 2, 1, 3, 2});
    add_bytes(parts, "SCALAR", {1, 2, 3});
    add_bytes(parts, "VEC4", {1, 0, 0, 0, 0, 1, 0, 0, 1, 9, 0, 0, 1, 1, 0, 0});
    add_floats(parts, "VEC4", {1, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0});
    const std::string primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":5,"WEIGHTS_0":6},"indices":)";
    parts.primitives =
        "[" + primitive + "1}," + primitive + R"(2,"mode":5},)" + primitive + R"(3,"mode":6},)" + primitive + "4}]";
    const std::vector<double> t = numbers(6), q = numbers(8), s = numbers(6), unused = matrix(), bind = matrix();
    std::vector<double> binds = unused;
    binds.insert(binds.end(), bind.begin(), bind.end());
    parts.more = R"("skins":[{"joints":[1,2],"inverseBindMatrices":)" + add_floats(parts, "MAT4", binds) + "}],";
    const std::string instances = R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
                                  add_floats(parts, "VEC3", t) + R"(,"ROTATION":)" + add_floats(parts, "VEC4", q) +
                                  R"(,"SCALE":)" + add_floats(parts, "VEC3", s) + "}}}";

    std::vector<Map> world;
    std::map<std::string, Map> expected;  // of each part
    std::vector<std::string> nodes, children(7);
    for (std::size_t n = 0; n < children.size(); ++n) {
      const std::vector<double> m = matrix(), move = numbers(3), turn = numbers(4), scale = numbers(3);
      const bool has_matrix = random() % 2 == 0;
      const std::string name = "n" + std::to_string(n), id = std::to_string(n);
      nodes.push_back(R"({"mesh":0,"name":")" + name + "\"" +
                      (n == 5   ? instances
                       : n == 6 ? R"(,"skin":0)"
                                : "") +
                      (has_matrix ? R"(,"matrix":)" + json(m)
                                  : R"(,"translation":)" + json(move) + R"(,"rotation":)" + json(turn) +
                                        R"(,"scale":)" + json(scale)));
      world.push_back(has_matrix ? map_of_matrix(m) : map_of_parts(move.data(), turn.data(), scale.data()));
      const std::size_t parent = n == 0 || random() % 4 == 0 ? 0 : random() % n;
      if (n > 0) children[parent] += (children[parent].empty() ? "" : ",") + id;
      if (n > 0) world[n] = world[parent] * world[n];
      if (n == 5) {
        expected[name + "[0]"] = world[n] * map_of_parts(&t[0], &q[0], &s[0]);
        expected[name + "[1]"] = world[n] * map_of_parts(&t[3], &q[4], &s[3]);
      } else {
        expected[name] = n == 6 ? world[2] * map_of_matrix(bind) : world[n];
      }
    }
    parts.nodes.clear();
    for (std::size_t n = 0; n < nodes.size(); ++n)
      parts.nodes += (n == 0 ? "[" : ",") + nodes[n] + R"(,"children":[)" + children[n] + "]}";
    parts.nodes += "]";

    const MeshFile file = read_parts(parts);
    ASSERT_EQ(file.parts.size(), expected.size());
    std::vector<double> volumes(expected.size());
    for (TriangleId i = 0; i < file.mesh.triangles().size(); ++i) {
      const std::uint32_t part = file.part_of_triangle[i];
      const Triangle triangle = file.mesh.triangle(i);
      volumes[part] += dot(triangle.v0, cross(triangle.v1, triangle.v2)) / 6;
      if (i % 12 >= tetrahedron_triangles.size()) continue;
      Vec3 sum = -(triangle.v0 + triangle.v1 + triangle.v2);
      for (const VertexId v : tetrahedron_triangles[i % 12])
        sum += expected[file.parts[part]](tetrahedron_positions[v]);
      EXPECT_LT(max_abs(sum), 1e-10) << file.parts[part];
    }
    for (std::size_t part = 0; part < volumes.size(); ++part) {
      const auto edge = [&, map = expected[file.parts[part]]](std::size_t v) {
        return map(tetrahedron_positions[v]) - map({});
      };
      EXPECT_NEAR(volumes[part], std::abs(dot(edge(1), cross(edge(2), edge(3)))) / 2, 1e-8) << file.parts[part];
    }
  }
}

TEST_F(Gltf, skins_blend_the_maps_of_joints) {
  GltfParts parts;
  add_bytes(parts, "VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  add_bytes(parts, "VEC4", {51, 51, 0, 0, 51, 51, 0, 0, 51, 51, 0, 0});
  parts.accessors = with(parts.accessors, R"(}])", R"(,"normalized":true}])");
  add_floats(parts, "VEC4", {0, 0.6, 0, 0, 0, 0.6, 0, 0, 0, 0.6, 0, 0});
  add_floats(parts, "VEC4", {2, -1, 0, 0, 2, -1, 0, 0, 2, -1, 0, 0});
  parts.primitives =
      R"([{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3,"JOINTS_1":2,"WEIGHTS_1":4},"indices":1}])";
  parts.nodes = R"([{"mesh":0,"skin":0,"translation":[9,9,9]},{"translation":[10,0,0]},{"translation":[0,5,0]}])";
  parts.scenes = R"([{"nodes":[0,1,2]}])";
  parts.more = R"("skins":[{"joints":[1,2]}],)";
  EXPECT_LT(max_abs(read_parts(parts).mesh.positions()[0] - Vec3{2, 4, 0}), 1e-6);
  expect_refused_changes(parts, &GltfParts::scenes, R"([0,1,2] [0,1])");
  expect_refused_changes(parts, &GltfParts::more, R"([1,2] [1,3]  [1,2] [1]  [1,2] [1,2],"inverseBindMatrices":5)");
  expect_refused_changes(parts, &GltfParts::primitives, R"(
    JOINTS_0 _J  WEIGHTS_0 _W  _0":3 _0":2  _1":4 _1":5  _0":2 _0":1)");
  expect_refused_changes(parts, &GltfParts::nodes, R"(
    "skin":0 "skin":1  "skin":0 "skin":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{}}})");
}

TEST_F(Gltf, quantized_positions_are_read) {
  const auto expect_lows_and_highs = [&](auto component, int component_type, double low, double high) {
    GltfParts parts;
    parts.primitives = R"([{"attributes":{"POSITION":)" +
                       add<decltype(component)>(parts, component_type, "VEC3", {low, 7, high, 1, 0, 0, 0, 1, 0}) +
                       "}}]";
    parts.more = R"("extensionsRequired":["KHR_mesh_quantization"],)";
    EXPECT_EQ(read_parts(parts).mesh.positions()[0], (Vec3{low, 7, high}));
    parts.accessors = with(parts.accessors, R"(":3}])", R"(":3,"normalized":true}])");
    EXPECT_EQ(read_parts(parts).mesh.positions()[0], (Vec3{low < 0 ? -1.0 : 0.0, 7 / high, 1}));
  };
  expect_lows_and_highs(std::int8_t{}, 5120, -128, 127);
  expect_lows_and_highs(std::uint8_t{}, 5121, 0, 255);
  expect_lows_and_highs(std::int16_t{}, 5122, -32768, 32767);
  expect_lows_and_highs(std::uint16_t{}, 5123, 0, 65535);
}

TEST_F(Gltf, hidden_nodes_show_nothing_and_parts_are_named_after_nodes_or_meshes) {
  GltfParts parts;
  parts.primitives += R"(,"weights":[0,0],"name":"m")";
  parts.nodes = R"([{"children":[1],"extensions":{"KHR_node_visibility":{"visible":false}}},{"mesh":0},{"mesh":0},)"
                R"({"mesh":0,"name":"n","extensions":{"KHR_node_visibility":{}}}])";
  parts.scenes = R"([{"nodes":[0,2,3]}])";
  EXPECT_EQ(read_parts(parts).parts, (std::vector<std::string>{"m", "n"}));
  parts.primitives = with(parts.primitives, "[0,0]", "[0,0.5]");  // morph targets that move vertices
  refuse(parts, ErrorCode::unsupported_format);
}

TEST_F(Gltf, points_and_lines_are_passed_over) {
  for (const char* mode : {"0", "1", "2", "3"}) {
    GltfParts parts;
    parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":)" + std::string(mode) + "}]";
    refuse(parts, ErrorCode::empty_mesh);
    parts.primitives.insert(1, R"({"attributes":{"POSITION":0}},)");
    EXPECT_EQ(read_parts(parts).face_count, 1U);
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
  EXPECT_EQ(read_parts(parts).mesh.positions()[0].x, static_cast<double>(node_count - 1));
}

TEST_F(Gltf, scene_is_the_named_one_or_the_first) {
  GltfParts parts;
  parts.scenes = R"([{"nodes":[0]},{"nodes":[1]}])";
  parts.nodes = R"([{"mesh":0},{"mesh":0,"translation":[7,0,0]}])";
  EXPECT_EQ(read_parts(parts).mesh.positions()[0].x, 0);
  parts.more = R"("scene":1,)";
  EXPECT_EQ(read_parts(parts).mesh.positions()[0].x, 7);
  parts.more = R"("scene":2,)";
  refuse(parts);
  parts.more.clear();
  parts.scenes = "[]";
  refuse(parts, ErrorCode::empty_mesh);
}

TEST_F(Gltf, buffer_files_lie_in_the_folder_or_below) {
  fs::create_directories(path("below"));
  for (const std::string file : {"a.bin>a.bin", "a.bin>./a.bin", "below/b.bin>below/b.bin", "a b.bin>a%20b.bin",
                                 "..c.bin>..c.bin", "\xC3\xA4.bin>%C3%a4.bin"}) {
    GltfParts parts;
    write(file.substr(0, file.find('>')), parts.buffer);
    parts.uri = file.substr(file.find('>') + 1);
    read_parts(parts);
  }
#if !defined(_WIN32)  // where few may make links, and the standard library of MinGW cannot
  fs::create_symlink("below/b.bin", path("link.bin"));
  GltfParts parts;
  parts.uri = "link.bin";
  read_parts(parts);
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
  for (const std::string& uri : std::vector<std::string>{
           "../outside.bin", "%2e%2E/outside.bin", "..%2Foutside.bin", "./../outside.bin", outside, "file://" + outside,
           "http://localhost/outside.bin", "below/../inside.bin", "link.bin", "up/outside.bin", "..\\\\outside.bin",
           "a%00.bin", "%4", "%zz", "missing.bin", ".", "up"}) {
    parts.uri = uri;
    refused("folder/a.gltf", parts.gltf(), ErrorCode::malformed_file, "buffer 0");
  }
#if !defined(_WIN32)
  ASSERT_EQ(mkfifo(path("pipe.bin").c_str(), 0600), 0);
  parts.uri = "pipe.bin";
  refuse(parts, ErrorCode::malformed_file, "is not a regular file");
#endif
}

TEST_F(Gltf, bytes_in_a_buffer_file_beyond_the_promised_length_do_not_count) {
  GltfParts parts;
  write("long.bin", parts.buffer + "more");
  parts.uri = "long.bin";
  read_parts(parts);
  write("short.bin", parts.buffer.substr(1));
  parts.uri = "short.bin";
  refuse(parts, ErrorCode::malformed_file, "buffer 0: promises 42 bytes but has 41");
}

TEST_F(Gltf, indices_of_missing_vertices_and_the_largest_of_a_type_are_refused) {
  GltfParts parts = gltf_of(tetrahedron_positions, {{0, 2, 1}, {0, 1, 4}});
  refuse(parts, ErrorCode::index_out_of_range,
         "mesh 0 primitive 0: triangle 1 names vertex 4, but there are only 4 vertices");
  EXPECT_EQ(read("a.gltf", parts.gltf()).error().where, 1U);
  parts = {};
  parts.accessors = R"([{"componentType":5126,"count":256,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}])";
  parts.buffer[38] = '\xff';
  refuse(parts, ErrorCode::index_out_of_range);
  parts.buffer[38] = '\xfe';
  read_parts(parts);
}

TEST_F(Gltf, required_extensions_are_known_by_their_decoded_names) {
  for (const std::string name :
       {"KHR_draco_mesh_compression", "KHR\\u005fdraco_mesh_compression", "\\u004bHR_draco_mesh_compression"}) {
    GltfParts parts;
    parts.more = R"("extensionsUsed":[")" + name + R"("],"extensionsRequired":[")" + name + R"("],)";
    for (const std::string& bytes : {parts.gltf(), parts.glb()}) {
      refused("a.glb", bytes, ErrorCode::unsupported_format, "KHR_draco_mesh_compression");
    }
    parts.more = with(parts.more, "extensionsRequired", "extensions\\u0052equired");
    refuse(parts, ErrorCode::unsupported_format);
  }
  GltfParts parts;
  parts.more = R"("extensionsRequired":["VENDOR_unheard_of"],)";
  refuse(parts, ErrorCode::unsupported_format, "VENDOR_unheard_of");
  parts.more = R"("extensionsRequired":[7],)";
  refuse(parts);
  // These change no geometry.
  parts.more = R"("extensionsRequired":["KHR_materials_unlit","KHR_texture_transform","EXT_texture_webp"],)";
  read_parts(parts);
}

TEST_F(Gltf, each_change_of_a_sound_part_is_refused) {
  expect_refused_changes({}, &GltfParts::accessors, R"(
    "count":3 "count":4  "count":3 "count":0  "count":3 "count":-3  "count":3 "count":3.0
    "count":3 "count":18446744073709551615  "count":3 "count":99999999999999999999999  "count":3 "counts":3
    "bufferView":0 "bufferView":2  "bufferView":0 "bufferView":18446744073709551615
    "bufferView":0 "bufferView":0,"byteOffset":4  "bufferView":0 "bufferView":0,"byteOffset":18446744073709551612
    "bufferView":0 "byteOffset":4  "VEC3" "VEC4"  "VEC3" 3  "VEC3" "VEC3","normalized":true  5126 5125  5126 5130
    5123 5122  5123 5126  5123 5125  "SCALAR" "VEC2"  } ,"sparse":7})");
  expect_refused_changes({}, &GltfParts::views, R"(
    "byteLength":36 "byteLength":43  "byteLength":36 "byteLength":35  "byteLength":36 "byteLength":0
    "byteLength":36 "byteLength":36,"byteOffset":18446744073709551615
    "byteLength":36 "byteLength":18446744073709551615,"byteOffset":1  "byteLength":36 "byteLength":36,"byteOffset":2
    "byteLength":36 "byteLength":36,"byteStride":8  "byteLength":36 "byteLength":36,"byteStride":14
    "byteLength":36 "byteLength":36,"byteStride":16  "byteLength":36 "byteLength":36,"byteStride":256
    "byteLength":6 "byteLength":6,"byteStride":4  "byteLength":6 "byteLength":12  "byteOffset":36 "byteOffset":35
    "buffer":0 "buffer":1)");
  expect_refused_changes(sparse_gltf(), &GltfParts::accessors, R"(
    "count":2 "count":3  "count":2 "count":5  "count":2 "count":0
    "indices":{"bufferView":1 "indices":{"bufferView":1,"byteOffset":1099511627776
    "indices":{"bufferView":1 "indices":{"bufferView":1,"byteOffset":1
    "indices":{"bufferView":1 "indices":{"bufferView":0  "indices":{"bufferView":1 "indices":{"nothing":1
    "values":{"bufferView":2} "values":{"bufferView":1}
    "values":{"bufferView":2} "values":{"bufferView":2,"byteOffset":4}
    "values":{"bufferView":2} "values":{"bufferView":2,"byteOffset":18446744073709551608}
    "componentType":5123} "componentType":5126})");
  GltfParts parts;
  parts.nodes = R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])";
  expect_refused_changes(parts, &GltfParts::nodes, R"(1]} 2]}  [1,0,0,0 [1,0,0,1  ,1]} ]}  } ,"scale":[1,1,1]})");
  parts.nodes = R"([{"mesh":0,"rotation":[0,0,0,1],"translation":[0,0,0],"scale":[1,1,1]}])";
  expect_refused_changes(parts, &GltfParts::nodes, R"(
    0,1] 0,0]  0,0,1] 0,1]  [0,0,0], [0,0,"x"],  [1,1,1] 1  [1,1,1] [1e999,1,1]  [1,1,1] [1e300,1,1])");
}

TEST_F(Gltf, sparse_indices_that_fall_or_name_no_element_are_malformed) {
  GltfParts falling = sparse_gltf();
  std::swap(falling.buffer[64], falling.buffer[66]);  // 3, 1
  refuse(falling, ErrorCode::malformed_file, "sparse index 1 does not follow");
  GltfParts beyond = sparse_gltf();
  beyond.buffer[66] = 4;
  refuse(beyond, ErrorCode::malformed_file, "sparse index 4 names no element");
}

TEST_F(Gltf, corners_that_make_no_whole_triangles_are_malformed) {
  std::istringstream words(R"(1 4  2 4  2 5  1 6  2 6  3 7  3 -1  3 "4")");
  for (std::string count, mode; words >> count >> mode;) {
    GltfParts parts;
    parts.accessors = with(parts.accessors, R"(5123,"count":3)", R"(5123,"count":)" + count);
    parts.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":)" + mode + "}]";
    refuse(parts);
  }
}

TEST_F(Gltf, nodes_that_form_no_tree_are_malformed) {
  std::istringstream words(R"([{"children":[0],"mesh":0}] [0]  [{"children":[1]},{"children":[0],"mesh":0}] [0]
    [{"children":[1]},{"children":[2]},{"children":[1],"mesh":0}] [0]  [{"children":[1,1]},{"mesh":0}] [0]
    [{"children":[2]},{"children":[2]},{"mesh":0}] [0,1]  [{"children":[1]},{"mesh":0}] [1]  [{"mesh":0}] [0,0]
    [{"mesh":0}] [1]  [{"mesh":1}] [0]  [{"children":[7],"mesh":0}] [0]  [7] [0])");
  GltfParts parts;
  for (std::string scenes; words >> parts.nodes >> scenes;) {
    parts.scenes = R"([{"nodes":)" + scenes + "}]";
    refuse(parts);
  }
}

TEST_F(Gltf, other_versions_are_unsupported) {
  GltfParts parts;
  for (const char* asset : {R"({"version":"1.0"})", R"({"version":"2.1","minVersion":"2.1"})"}) {
    parts.asset = asset;
    refuse(parts, ErrorCode::unsupported_format);
  }
  parts.asset = R"({"version":"2.1"})";
  read_parts(parts);
  parts.asset = "{}";
  refuse(parts);
  std::string bytes = GltfParts().glb();
  bytes[4] = 1;
  refused("a.glb", bytes, ErrorCode::unsupported_format);
}

TEST_F(Gltf, names_that_an_object_has_twice_are_malformed) {
  GltfParts parts;
  parts.accessors = with(parts.accessors, R"("count":3)", R"("count":3,"co\u0075nt":1)");
  refuse(parts, ErrorCode::malformed_file, "two properties of one name");
}

TEST_F(Gltf, data_that_is_not_base64_is_malformed) {
  for (const char* uri : {"data:,abc", "data:;base64", "data:;base64,A", "data:;base64,AA*A", "data:;base64,AA A",
                          "data:;base64,====", "data:application/octet-stream;base64,AAAA\\n"}) {
    GltfParts parts;
    parts.uri = uri;
    refuse(parts);
  }
}

TEST_F(Gltf, compressed_primitives_are_read_only_if_plain_data_is_there_too) {
  GltfParts parts;
  parts.primitives = R"([{"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}}])";
  read_parts(parts);
  parts.accessors = with(parts.accessors, R"("bufferView":0,)", "");
  refuse(parts, ErrorCode::unsupported_format);
}

TEST_F(Gltf, broken_binary_containers_are_malformed) {
  const std::string sound = GltfParts().glb();
  ASSERT_TRUE(read("a.glb", sound));
  const std::size_t binary = sound.find(std::string_view("BIN\0", 4));
  std::string changed = sound;
  refused("a.glb", changed.replace(16, 4, "JSOM"));
  changed = sound;
  refused("a.glb", changed.replace(binary, 3, "BIM"), ErrorCode::malformed_file, "no binary chunk");
  refused("a.glb", sound.substr(0, 12));
  changed = sound;
  changed[binary - 4] += 4;
  refused("a.glb", changed, ErrorCode::malformed_file, "promises");
  for (const char length : {'\0', '\x0c', '\x13'}) {  // of the file, too short for a chunk
    changed = sound;
    changed.replace(8, 4, std::string{length, '\0', '\0', '\0'});
    refused("a.glb", changed, ErrorCode::malformed_file, "no room for a chunk");
  }
}

}  // namespace
}  // namespace limber
