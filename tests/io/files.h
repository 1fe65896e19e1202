// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "limber/io.h"

/// Mesh files that tests write, each test in a folder of its own.
namespace limber {

class FilesTest : public ::testing::Test {
 protected:
  FilesTest() : folder_(std::filesystem::temp_directory_path() / folder_name()) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~FilesTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// A file or folder with a name in UTF-8.
  std::filesystem::path path(const std::string& name) const {
    return folder_ / std::u8string(name.begin(), name.end());
  }

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::remove(path(name));  // overwriting waits for the disk, a new file does not
    std::ofstream(path(name), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path(name);
  }

  Result<MeshFile> read(const std::string& name, std::string_view bytes) const {
    return read_mesh_file(write(name, bytes));
  }

  /// Reads a file that must be refused with this code, and checks the form of the message.
  Error refused(const std::string& name, std::string_view bytes, ErrorCode code = ErrorCode::malformed_file) const {
    const Result<MeshFile> file = read(name, bytes);
    if (file) {
      ADD_FAILURE() << name << " was accepted:\n" << bytes;
      return {};
    }
    EXPECT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
    EXPECT_EQ(file.error().code, code) << file.error().text << "\n" << bytes.substr(0, 1000);
    return file.error();
  }
  /// The same, with a part of the message.
  void refused(const std::string& name, std::string_view bytes, ErrorCode code, const std::string& part) const {
    const std::string text = refused(name, bytes, code).text;
    EXPECT_NE(text.find(part), text.npos) << text;
  }

  static bool is_one_line_about(const std::filesystem::path& path, const std::string& text) {
    return text.starts_with(path.string() + ": ") && text.size() > path.string().size() + 2 &&
           text.find_first_of("\r\n") == text.npos;
  }

 private:
  static std::string folder_name() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = "limber_io_" + std::to_string(getpid()) + "_" + info->test_suite_name() + "_" + info->name();
    for (char& c : name) c = c == '/' ? '_' : c;
    return name;
  }

  std::filesystem::path folder_;
};

/// Appends a number in the given byte order.
template <typename Number>
void append(std::string& bytes, Number number, bool big_endian = false) {
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  const bool is_native = big_endian == (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < raw.size(); ++i) bytes += raw[is_native ? i : raw.size() - 1 - i];
}

// The same tetrahedron in every format; the faces are outward and in the same order.
inline const std::vector<Vec3> tetrahedron_positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.5, 1}};
inline const std::vector<Corners> tetrahedron_triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

/// The bytes of the tetrahedron from a file of fuzz/corpus.
inline std::string tetrahedron(const std::string& name) {
  std::ifstream file(std::filesystem::path(LIMBER_SOURCE_DIR) / "fuzz/corpus" / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The header of a text PLY file of float coordinates and lists of vertices.
std::string ply_header(std::size_t vertex_count, std::size_t face_count);
/// A triangle in each text format, of which these are the lines of the three vertices.
std::vector<std::pair<std::string, std::string>> triangle_files(const std::array<std::string, 3>& vertices);
inline const std::string obj_corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A text with the first `part` replaced.
inline std::string with(std::string text, const std::string& part, const std::string& instead) {
  EXPECT_NE(text.find(part), text.npos) << part;
  return text.replace(text.find(part), part.size(), instead);
}

/// A binary glTF file of a description and a buffer.
std::string glb(std::string json, std::string buffer);
std::string gltf_buffer(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles);
std::string base64(std::string_view bytes);

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
  /// The description and the buffer as one binary file.
  std::string glb() const { return limber::glb(description(""), buffer); }

 private:
  std::string description(const std::string& buffer_uri) const {
    return "{" + more + R"("asset":)" + asset + R"(,"scenes":)" + scenes + R"(,"nodes":)" + nodes +
           R"(,"meshes":[{"primitives":)" + primitives + R"(}],"accessors":)" + accessors + R"(,"bufferViews":)" +
           views + R"(,"buffers":[{)" + (buffer_uri.empty() ? "" : R"("uri":")" + buffer_uri + R"(",)") +
           R"("byteLength":)" + std::to_string(buffer.size()) + "}]}";
  }
};

/// These triangles, as glTF.
GltfParts gltf_of(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles);

/// The tetrahedron in every format, as (file name, bytes).
std::vector<std::pair<std::string, std::string>> tetrahedron_files();

}  // namespace limber
