// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "files.h"

namespace limber {
namespace {

class Formats : public FilesTest {
 protected:
  void expect_mesh(const std::string& name, const std::string& bytes, const std::vector<Vec3>& positions,
                   const std::vector<Corners>& triangles) const {
    const Result<MeshFile> file = read(name, bytes);
    ASSERT_TRUE(file) << bytes << file.error().text;
    EXPECT_EQ(file->mesh.positions(), positions) << bytes;
    EXPECT_EQ(file->mesh.triangles(), triangles) << bytes;
  }
};
using Faces = std::vector<std::uint32_t>;

const std::vector<Vec3> right_corner{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST_F(Formats, every_format_gives_the_same_tetrahedron_from_disk_and_from_memory) {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    std::string capitals = name;
    for (char& c : capitals) c = static_cast<char>(std::toupper(c));
    EXPECT_TRUE(read(capitals, bytes)) << capitals;
    for (const Result<MeshFile>& file : {read(name, bytes), read_mesh_bytes(std::as_bytes(std::span(bytes)), name)}) {
      ASSERT_TRUE(file) << file.error().text;
      EXPECT_EQ(file->face_count, 4U) << name;
      EXPECT_EQ(file->face_of_triangle, (Faces{0, 1, 2, 3})) << name;
      EXPECT_TRUE(name.ends_with(".stl") || file->mesh.positions() == tetrahedron_positions) << name;
      ASSERT_EQ(file->mesh.positions().size(), 4U) << name;
      for (TriangleId t = 0; t < 4; ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
          EXPECT_EQ(file->mesh.triangle(t)[i], tetrahedron_positions[tetrahedron_triangles[t][i]]) << name;
        }
      }
    }
    const std::string half = bytes.substr(0, bytes.size() / 2);
    const Result<MeshFile> damaged = read_mesh_bytes(std::as_bytes(std::span(half)), path(name));
    const Result<MeshFile> damaged_on_disk = read(name, half);
    EXPECT_EQ(damaged ? "" : damaged.error().text, damaged_on_disk ? "" : damaged_on_disk.error().text) << name;
  }
  EXPECT_EQ(read_mesh_bytes({}, "empty.obj").error().text, "empty.obj: is empty");
  EXPECT_EQ(read_mesh_bytes({}, "no_extension").error().code, ErrorCode::unsupported_format);
  GltfParts parts;  // buffer files are not looked for beside a file in memory
  parts.uri = "beside.bin";
  const std::string bytes = parts.gltf();
  write("beside.bin", parts.buffer);
  const Result<MeshFile> file = read_mesh_bytes(std::as_bytes(std::span(bytes)), path("text.gltf"));
  EXPECT_EQ(file.error().code, ErrorCode::malformed_file) << file.error().text;
}

TEST_F(Formats, obj_records_without_geometry_are_passed_over) {
  expect_mesh("a.obj",
              "\xEF\xBB\xBF# byte order mark\nmtllib a.mtl\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\r\n"
              "v 1 1 0 # comment\nvt 0 0\nvn 0 0 1\nvp 0\ng one\nusemtl red\ns off\nl 1 2\np 1\n"
              "my_extension 7\nf\t1/1/1\t2/1/1\t3/1/1\nfo 1 2 3\n\n   \nf 1//1 2//1 3//1  # comment\n"
              "f 1/1 \\\n  2/1 \\\r\n 3/1\no next\nf -3 -1 2\n",
              {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 2, 1}});
}

TEST_F(Formats, obj_comments_end_with_their_line_and_records_do_not) {
  for (const std::string& bytes :
       {"# C:\\work\\\n" + obj_corner + "f 1 2 3\n", obj_corner + "# \\ \\\r\nf 1 2 3\n",
        obj_corner + "f 1 2 3 # D:\\\n", obj_corner + "f 1 \\ \t\n 2 \\\r\n 3\n",
        std::string("v 0 0 \\\n0\nv 1 0 0 # \\\nv 0 1 0\nf 1 2\\\n 3"), "f 1 2 3\n" + obj_corner}) {
    expect_mesh("a.obj", bytes, right_corner, {{0, 1, 2}});
  }
  expect_mesh("a.obj", obj_corner + "f 1 2 3 # D:\\\nf 1 3 2\n", right_corner, {{0, 1, 2}, {0, 2, 1}});
}

TEST_F(Formats, parts_are_objects_or_groups_and_stay_apart_if_asked_to) {
  const std::string vertices = obj_corner + "v 0 0 0\nv 1 0 0\nv 0 -1 0\n";
  const auto parts_of = [&](const std::string& faces) {
    const MeshFile file = read("a.obj", vertices + faces).value();
    EXPECT_EQ(file.part_of_triangle.size(), file.mesh.triangles().size());
    return std::pair(file.parts, file.part_of_triangle);
  };
  using Parts = std::pair<std::vector<std::string>, Faces>;
  EXPECT_EQ(parts_of("f 1 2 3\n"), Parts({""}, {0}));
  EXPECT_EQ(parts_of("o none\no a b \ng x\nf 1 2 3\no \xFF\t2\ng x\nf 4 5 6 4\n"),
            Parts({"a b", "\xEF\xBF\xBD?2"}, {0, 1, 1}));
  EXPECT_EQ(parts_of("o all\ng x\nf 1 2 3\ng y\nf 4 5 6\ng x\nf 1 3 2\n"), Parts({"x", "y"}, {0, 1, 0}));
  EXPECT_EQ(parts_of("f 1 2 3\no all\nf 4 5 6\n"), Parts({"", "all"}, {0, 1}));
  EXPECT_EQ(parts_of("o all\nf 4 5 6\n"), Parts({"all"}, {0}));
  const auto path = write("b.obj", vertices + "g x\nf 1 2 3\ng y\nf 4 5 6\n");
  EXPECT_EQ(read_mesh_file(path).value().vertex_of_file_vertex, (Faces{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(read_mesh_file(path, {.parts = true}).value().vertex_of_file_vertex, (Faces{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(read_mesh_file(path).value().files, std::vector{path});
  for (const ReadOptions& wrong :
       {ReadOptions{.weld_tolerance = -1}, {.weld = false, .weld_tolerance = 1}, {.weld_tolerance = NAN}}) {
    EXPECT_THROW(static_cast<void>(read_mesh_file(path, wrong)), std::invalid_argument);
  }
}

TEST_F(Formats, stl_may_have_data_behind_facets_or_no_count_and_several_solids_and_capitals) {
  const std::string plain = tetrahedron("stl/binary.stl");
  std::string attributes = plain.substr(0, 84), uncounted = plain;
  for (std::size_t at = 84; at < plain.size(); at += 50) {
    attributes += plain.substr(at, 48) + std::string("\x04\0", 2) + "abcd";
  }
  uncounted[80] = 0;
  const Mesh expected = read("a.stl", plain).value().mesh;
  for (const std::string& bytes : {attributes, uncounted, plain + "x", plain + plain}) {
    expect_mesh("a.stl", bytes, expected.positions(), expected.triangles());
  }
  for (const std::string& bytes : {attributes.substr(0, attributes.size() - 1), attributes + "x", uncounted + "x"}) {
    refused("a.stl", bytes);
  }
  std::string capitals = tetrahedron("stl/text.stl");
  for (char& c : capitals) c = static_cast<char>(std::toupper(c));
  std::vector<Corners> twice = expected.triangles();
  twice.insert(twice.end(), expected.triangles().begin(), expected.triangles().end());
  expect_mesh("a.stl", tetrahedron("stl/text.stl") + capitals, expected.positions(), twice);
}

TEST_F(Formats, off_may_break_lines_anywhere_and_comments_normals_colors_and_textures_are_passed_over) {
  const std::string plain = "0 0 0\n1 0 0\n0 1 0\n";
  for (const std::string& bytes :
       {std::string("OFF\n3 1 0\n0\n0 0\n1 # x\n0 0 0 1\n0\n3\n0 1 2\n"),
        std::string("OFF 3 1 0\n0 0 0 1 0 0 0 1 0 3 0 1 2"),
        std::string("CNOFF\n3 1 0\n0 0 0\n0 0 1\n9 9 9 1\n1 0 0\n0 0 1\n9 9 9 1\n0 1 0\n0 0 1\n9 9 9 1\n3 0 1\n2"),
        "# made by hand\nOFF # really\n# counts\n3 1 3 # v f e\n\n" + plain + "# faces\n3 0 1 2 # end\n",
        "OFF 3 1 0\n" + plain + "3 0 1 2 255 0 0\n", "OFF3 1 0\n" + plain + "3 0 1 2 0.5 0.5 0.5 1.0\n",
        "OFF\n3 1\n" + plain + "3 0 1 2 7",
        std::string("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"),
        std::string("COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 1.0 0.5 0 1\n0 1 0\n3 0 1 2 -5\n"),
        std::string("STCNOFF\r\n3 1 0\r\n0 0 0 0 0 1 9 9 9 0 1\r\n1 0 0 0 0 1 9 9 9 0 1\r\n"
                    "0 1 0 0 0 1 9 9 9 0 1\r\n3 0 1 2\r\n")}) {
    expect_mesh("a.off", bytes, right_corner, {{0, 1, 2}});
  }
  refused("a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2 7\n");
}

TEST_F(Formats, ply_strips_become_triangles_of_one_direction) {
  const std::string head =
      with(with(ply_header(5, 1), "face", "tristrips"), "uchar", "int") + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
  const MeshFile file = read("a.ply", head + "13 0 1 2 3 4 -1 2 1 3 3 4 -1 0\n").value();
  EXPECT_EQ(file.mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 1, 3}}));
  EXPECT_EQ(file.face_of_triangle, (Faces{0, 1, 2, 3}));
  for (const char* strip : {"3 0 1 5\n", "3 0 1 -2\n"}) {
    refused("a.ply", head + strip, ErrorCode::index_out_of_range);
  }
}

TEST_F(Formats, ply_properties_and_elements_without_geometry_are_passed_over) {
  expect_mesh("a.ply",
              "ply\r\ncomment before the format\r\nformat ascii 1.0\r\n\r\nobj_info 7\r\n"
              "element camera 1\r\nproperty list uchar float values\r\n"
              "element vertex 3\r\nproperty float nx\r\nproperty uchar red\r\nproperty uchar g\r\n"
              "property float green\r\nproperty uchar blue\r\nproperty int z\r\n"
              "property float y\r\nproperty float64 x\r\nproperty list uint8 int8 tags\r\n"
              "element face 2\r\nproperty list uchar float texcoord\r\n"
              "property list uint16 ushort vertex_index\r\nproperty int flags\r\n"
              "element edge 1\r\nproperty int vertex1\r\nproperty int vertex2\r\nend_header\r\n"
              "2 0.5 nan\r\n"
              "nan 300 1 0.5 9 3 2 1 0\r\n inf 1 1 1 1 6 5 4 1 7\r\n 0 1 1 1 1 9 8 7 2 1 2\r\n"
              "6 0 0 0 0 1 1 3 0 1 2 -1\r\n 0 3 2 1 0 7\r\n0 1\r\n",
              {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{0, 1, 2}, {2, 1, 0}});
}

TEST_F(Formats, binary_ply_may_have_integers_between_other_properties_and_narrow_indices) {
  for (const bool big_endian : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                        "_endian 1.0\nelement vertex 3\nproperty uchar red\nproperty int x\nproperty short s\n"
                        "property double y\nproperty list int double extra\nproperty uchar z\n"
                        "element face 1\nproperty uchar flag\nproperty list ushort short vertex_indices\nend_header\n";
    const auto add = [&](auto... numbers) { (append(bytes, numbers, big_endian), ...); };
    for (const double d : {0.0, 1.0, 2.0}) {
      add(std::uint8_t{255}, static_cast<std::int32_t>(d - 0x1p31), std::int16_t{-1}, 0.1 * d * d);
      add(std::int32_t{1}, 7.0, std::uint8_t{255});
    }
    add(std::uint8_t{1}, std::uint16_t{3}, std::int16_t{0}, std::int16_t{1}, std::int16_t{2});
    expect_mesh("a.ply", bytes, {{-0x1p31, 0, 255}, {1 - 0x1p31, 0.1, 255}, {2 - 0x1p31, 0.1 * 4, 255}}, {{0, 1, 2}});
  }
}

}  // namespace
}  // namespace limber
