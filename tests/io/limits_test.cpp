// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>

#include <chrono>
#include <tuple>

#include "files.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

using Limits = FilesTest;

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

TEST_F(Limits, pipes_and_devices_are_refused_without_being_read) {
  ASSERT_EQ(mkfifo(path("pipe.obj").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", path("zero.obj"));
  for (const char* name : {"pipe.obj", "zero.obj"}) {
    const Error error = read_mesh_file(path(name)).error();
    EXPECT_EQ(error.code, ErrorCode::unreadable_file);
    EXPECT_EQ(error.text, path(name).string() + ": is not a regular file");
  }
}

TEST_F(Limits, files_above_the_limit_are_refused_without_being_read) {
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.gltf", "a.glb"}) {
    write(name, "");
    fs::resize_file(path(name), mesh_file_limits::bytes + 1);  // takes no room on disk
    EXPECT_EQ(read_mesh_file(path(name)).error().code, ErrorCode::too_large);
  }
  GltfParts parts;
  write("a.bin", "");
  fs::resize_file(path("a.bin"), mesh_file_limits::bytes);  // the description is above the limit with it
  parts.uri = "a.bin";
  refused("a.gltf", parts.gltf(), ErrorCode::too_large);
}

TEST_F(Limits, descriptions_nested_too_deeply_or_of_too_many_values_are_refused) {
  GltfParts parts;
  const auto nested = [&](std::size_t depth) {
    parts.more = R"("extras":)" + repeated("[", depth) + repeated("]", depth) + ",";
    return parts.gltf();
  };
  EXPECT_TRUE(read("a.gltf", nested(mesh_file_limits::gltf_json_depth - 1)));
  refused("a.gltf", nested(mesh_file_limits::gltf_json_depth), ErrorCode::too_large);
  refused("a.gltf", nested(1'500'000), ErrorCode::too_large);
  refused("a.gltf", R"({"a":)" + repeated(R"({"a":)", 1'000'000), ErrorCode::too_large);
  parts.more = R"("extras":[0)" + repeated(",0", mesh_file_limits::gltf_json_values) + "],";
  refused("a.gltf", parts.gltf(), ErrorCode::too_large);
}

TEST_F(Limits, scenes_of_too_many_elements_are_refused_by_what_they_show) {
  GltfParts parts;
  // One accessor of zeros and one triangle of it: 2^20 elements each time the mesh is shown.
  constexpr std::size_t shown = mesh_file_limits::gltf_elements >> 20U;
  const std::string with_view = R"("bufferView":0,"componentType":5126,"count":3)",
                    of_zeros = R"("componentType":5126,)";
  parts.accessors = with(parts.accessors, with_view, of_zeros + R"("count":)" + std::to_string((1U << 20U) - 1));
  const auto scene = [&](std::size_t node_count) {
    std::string roots = "0";
    for (std::size_t n = 1; n < node_count; ++n) roots += "," + std::to_string(n);
    parts.scenes = R"([{"nodes":[)" + roots + "]}]";
    parts.nodes = "[" + repeated(R"({"mesh":0},)", node_count - 1) + R"({"mesh":0}])";
    return parts.gltf();
  };
  EXPECT_EQ(read("a.gltf", scene(shown)).value().face_count, shown);
  refused("a.gltf", scene(shown + 1), ErrorCode::too_large);
  // As many elements, nearly all of them triangles of three vertices.
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"componentType":5125,"count":)" +
                    std::to_string(3 * ((1U << 20U) - 3)) + R"(,"type":"SCALAR"}])";
  refused("a.gltf", scene(shown + 1), ErrorCode::too_large);
  parts = {};
  parts.accessors = with(parts.accessors, with_view, of_zeros + R"("count":100000000)");
  refused("a.gltf", parts.gltf(), ErrorCode::too_large, "node 0: shows a mesh of 100000000 vertices and 1 triangles");
  for (const auto& [count, name, mode] :
       {std::tuple{"4000000000", 1U, "4"}, {"4000000000", 1U, "0"}, {"10000", 1'000'000U, "4"}}) {
    GltfParts instances;
    instances.primitives = with(instances.primitives, R"("indices":1)", R"("indices":1,"mode":)" + std::string(mode));
    instances.accessors = with(instances.accessors, "}]",
                               R"(},{"componentType":5126,"type":"VEC3","count":)" + std::string(count) + "}]");
    instances.nodes = R"([{"mesh":0,"name":")" + std::string(name, 'n') +
                      R"(","extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"SCALE":2}}}}])";
    refused("a.gltf", instances.gltf(), ErrorCode::too_large);
  }
}

#if defined(__SANITIZE_ADDRESS__)
constexpr long memory_factor = 8;  // freed memory is kept for a while
#else
constexpr long memory_factor = 1;
#endif

/// Files of nearly a megabyte whose content takes the most memory for its length in each format.
std::vector<std::pair<std::string, std::string>> dense_files() {
  constexpr std::size_t bytes = 1'000'000;
  const auto with_extras = [](const std::string& extras) {
    GltfParts parts;
    parts.more = R"("extras":)" + extras + ",";
    return parts.gltf();
  };
  std::string object = "{\"\":0";
  for (std::size_t i = 0; object.size() < bytes - 1000; ++i) object += ",\"" + std::to_string(i) + "\":0";
  GltfParts most;
  most.accessors = R"([{"componentType":5126,"type":"VEC3","count":2097148},)"
                   R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}])";
  GltfParts strip;
  strip.buffer = std::string(36, '\0') + repeated(std::string_view("\0\1\2\0", 4), bytes / 6);
  strip.views = R"([{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":)" +
                std::to_string(strip.buffer.size() - 36) + "}]";
  strip.accessors = R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
                    R"({"bufferView":1,"componentType":5121,"type":"SCALAR","count":)" +
                    std::to_string(strip.buffer.size() - 36) + "}]";
  strip.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"mode":5}])";
  return {{"faces.obj", obj_corner + repeated("f\n", bytes / 2 - 20) + "f 1 2 3\n"},
          {"corners.obj", obj_corner + "f 1 2 3" + repeated(" 1", bytes / 2 - 20) + "\n"},
          {"vertices.obj", obj_corner + "f 1 2 3\n" + repeated("v 0 0 0\n", bytes / 8 - 5)},
          {"faces.ply",
           "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nelement face 900000\nproperty list uchar int vertex_index\nend_header\n" +
               std::string(12 + 900'000, '\0')},
          {"zeros.gltf", most.gltf()},
          {"strip.glb", strip.glb()},
          {"list.gltf", with_extras("[0" + repeated(",0", bytes / 2 - 500) + "]")},
          {"lists.gltf", with_extras("[[]" + repeated(",[]", bytes / 3 - 500) + "]")},
          {"object.gltf", with_extras(object + "}")}};
}

TEST_F(Limits, files_below_a_megabyte_take_little_memory_and_time) {
  for (const auto& [name, bytes] : dense_files()) {
    ASSERT_LT(bytes.size(), 1'000'000U) << name;
    const auto start = std::chrono::steady_clock::now();
    static_cast<void>(read(name, bytes));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    EXPECT_LT(elapsed.count(), 8) << name;  // far above what it takes, for busy machines and sanitizers
    rusage used{};
    ASSERT_EQ(getrusage(RUSAGE_SELF, &used), 0);
    EXPECT_LT(used.ru_maxrss, 256 * 1024 * memory_factor) << name;
  }
}

TEST_F(Limits, every_truncation_is_refused_with_one_line) {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Result<MeshFile> file = read(name, bytes.substr(0, size));
      if (!file) {
        EXPECT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
      } else if (!name.ends_with(".obj")) {  // the others state their length, except one of trailing blanks
        // A truncation may leave out the last line's end, a solid's name after "endsolid", or digits of the last index.
        const bool keeps_all = size + 1 == bytes.size() || bytes.substr(0, size).find("endsolid") != std::string::npos;
        EXPECT_TRUE(keeps_all) << name << " truncated at " << size << " of " << bytes.size();
      } else {
        EXPECT_LE(file->face_count, 4U);
      }
    }
  }
}

}  // namespace
}  // namespace limber
