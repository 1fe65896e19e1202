// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <locale>
#include <random>

#include "files.h"

namespace limber {
namespace {

using Meaning = FilesTest;
using Faces = std::vector<std::uint32_t>;

TEST_F(Meaning, polygon_becomes_a_fan_around_its_first_corner) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
  const Result<MeshFile> file = read("a.obj", square + "f 1 2 3\nf 2 3 4 1\nf 3 4 5 1 2\nf 5 4 1\n");
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.triangles(),
            (std::vector<Corners>{{0, 1, 2}, {1, 2, 3}, {1, 3, 0}, {2, 3, 4}, {2, 4, 0}, {2, 0, 1}, {4, 3, 0}}));
  EXPECT_EQ(file->face_of_triangle, (Faces{0, 1, 1, 2, 2, 2, 3}));
  EXPECT_EQ(file->face_count, 4U);
}

TEST_F(Meaning, faces_of_fewer_than_three_corners_are_counted_but_skipped) {
  const std::string off = "OFF\n3 5 0\n0 0 0\n1 0 0\n0 1 0\n0\n1 0\n3 0 1 2\n2 0 1\n3 2 1 0\n";
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf\nf 1\nf 1 2 3\nf 1 2\nf 3 2 1\n";
  for (const Result<MeshFile>& file : {read("a.off", off), read("a.obj", obj)}) {
    ASSERT_TRUE(file) << file.error().text;
    EXPECT_EQ(file->mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {2, 1, 0}}));
    EXPECT_EQ(file->face_of_triangle, (Faces{2, 4}));
    EXPECT_EQ(file->face_count, 5U);
  }
}

TEST_F(Meaning, equal_positions_are_welded_in_order_of_first_appearance) {
  const Result<MeshFile> file = read("a.obj",
                                     "v 5 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 5 0 0\nv 0 0 1\n"
                                     "f 6 2 3\nf 4 5 6\nf 1 5 4\n");
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions(), (std::vector<Vec3>{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(file->mesh.triangles(), (std::vector<Corners>{{3, 1, 2}, {1, 0, 3}, {0, 0, 1}}));
}

TEST_F(Meaning, minus_zero_is_welded_with_zero_and_neighbours_are_not) {
  const Result<MeshFile> file =
      read("a.obj",
           "v -0.0 0 -0\nv 1 0 0\nv 0 1 0\nv 0 -0.0 0.0\nv 5e-324 0 0\nv 0 1.0000000000000002 0\n"
           "f 1 2 3\nf 4 2 3\nf 5 2 6\n");
  ASSERT_TRUE(file) << file.error().text;
  ASSERT_EQ(file->mesh.positions().size(), 5U);
  EXPECT_TRUE(std::signbit(file->mesh.positions()[0].x));
  EXPECT_EQ(file->mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {0, 1, 2}, {3, 1, 4}}));
}

TEST_F(Meaning, unreferenced_vertices_and_duplicate_faces_are_kept) {
  const Result<MeshFile> file =
      read("a.off", "OFF\n6 3 0\n9 9 9\n0 0 0\n1 0 0\n8 8 8\n0 1 0\n7 7 7\n3 1 2 4\n3 1 2 4\n3 1 1 1\n");
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions().size(), 6U);
  EXPECT_EQ(file->mesh.triangles(), (std::vector<Corners>{{1, 2, 4}, {1, 2, 4}, {1, 1, 1}}));
  const std::vector<Vec3> positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}};
  const Result<MeshFile> scene = read("a.glb", gltf_of(positions, {{1, 2, 4}}).glb());
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->mesh.positions(), positions);
  EXPECT_EQ(scene->mesh.triangles(), (std::vector<Corners>{{1, 2, 4}}));
}

TEST_F(Meaning, load_mesh_gives_the_mesh_of_the_file_and_the_same_errors) {
  const Result<Mesh> mesh = load_mesh(write("a.obj", tetrahedron_obj()));
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions(), tetrahedron_positions);
  EXPECT_EQ(mesh->triangles(), tetrahedron_triangles);
  const Result<Mesh> missing = load_mesh(path("missing.obj"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().text, read_mesh_file(path("missing.obj")).error().text);
}

class Numbers : public FilesTest {
 protected:
  /// A text file of one triangle whose first vertex has the decimals as its coordinates.
  static std::vector<std::pair<std::string, std::string>> files_with(const std::string& decimals) {
    return {{"a.obj", "v " + decimals + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
            {"a.off", "OFF\n3 1 0\n" + decimals + "\n1 0 0\n0 1 0\n3 0 1 2\n"},
            {"a.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_index\nend_header\n" +
                 decimals + "\n1 0 0\n0 1 0\n3 0 1 2\n"},
            {"a.stl", "solid\nfacet normal 0 0 1 outer loop vertex " + decimals +
                          " vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid\n"}};
  }

  void expect_value(const std::string& decimal, double value) const {
    for (const auto& [name, bytes] : files_with(decimal + " 7 7")) {
      const Result<MeshFile> file = read(name, bytes);
      ASSERT_TRUE(file) << decimal << " " << file.error().text;
      EXPECT_EQ(file->mesh.positions()[0].x, value) << name << " " << decimal;
      EXPECT_EQ(std::signbit(file->mesh.positions()[0].x), std::signbit(value)) << name << " " << decimal;
    }
  }

  void expect_not_finite(const std::string& decimal) const {
    for (const auto& [name, bytes] : files_with("7 7 " + decimal)) {
      EXPECT_EQ(refused(name, bytes).code, ErrorCode::non_finite) << name << " " << decimal;
    }
  }
};

const std::string zeros_400(400, '0');

TEST_F(Numbers, below_the_range_are_zero_however_they_are_written) {
  for (const std::string& decimal :
       {"0." + zeros_400 + "1", "." + zeros_400 + "1", std::string("1e-400"), std::string("1E-99999999999999999999"),
        "0." + zeros_400 + "1e0", "0." + zeros_400 + zeros_400 + "1e+400", std::string("123e-400"),
        std::string("0.0000001e-320")}) {
    expect_value(decimal, 0.0);
    expect_value("-" + decimal, -0.0);
    expect_value("+" + decimal, 0.0);
  }
}

TEST_F(Numbers, above_the_range_are_not_finite_however_they_are_written) {
  for (const std::string& decimal :
       {"1" + zeros_400, "1" + zeros_400 + ".0", std::string("1e400"), std::string("0.001e+400"),
        std::string("1e99999999999999999999"), "0." + zeros_400 + "1e800", "1" + zeros_400 + "e-1"}) {
    expect_not_finite(decimal);
    expect_not_finite("-" + decimal);
    expect_not_finite("+" + decimal);
  }
}

TEST_F(Numbers, of_any_length_are_rounded_correctly) {
  expect_value("1" + zeros_400 + "e-400", 1);
  expect_value("0." + zeros_400 + "1e401", 1);
  expect_value(zeros_400 + "2.5" + zeros_400, 2.5);
  expect_value("0e99999999999999999999", 0);
  expect_value("0." + zeros_400 + "e400", 0);
  expect_value("4.9406564584124654e-324", 5e-324);
  expect_value("2.4703282292062328e-324", 5e-324);  // just above half of the smallest number
  expect_value("2.4703282292062327e-324", 0);
  const std::string halfway = "9007199254740993";  // 2^53 + 1; ties go to the even neighbour
  expect_value(halfway + "." + zeros_400, 9007199254740992.0);
  expect_value(halfway + "." + zeros_400 + "1", 9007199254740994.0);
}

TEST_F(Numbers, do_not_depend_on_the_global_locale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  expect_value("123456.789012345678", 123456.789012345678);
  EXPECT_TRUE(read("a.glb", GltfParts().glb()));
  std::locale::global(before);
}

TEST_F(Numbers, agree_with_the_standard_library_for_random_decimals) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string decimals;
    std::array<double, 3> expected{};
    for (double& value : expected) {
      std::string decimal(random() % 2, '-');
      const std::size_t digit_count = 1 + random() % 40, point = random() % (digit_count + 1);
      for (std::size_t i = 0; i < digit_count; ++i) {
        if (i == point) decimal += '.';
        decimal += static_cast<char>('0' + random() % 10);
      }
      decimal.append(1, 'e').append(std::to_string(static_cast<int>(random() % 340) - 320));
      value = exact(decimal.c_str());
      if (!(std::abs(value) < max_coordinate)) decimal.assign(1, '1'), value = 1;
      decimals.append(decimal).append(1, ' ');
    }
    for (const auto& [name, bytes] : files_with(decimals)) {
      const Result<MeshFile> file = read(name, bytes);
      ASSERT_TRUE(file) << decimals << file.error().text;
      EXPECT_EQ(file->mesh.positions()[0], (Vec3{expected[0], expected[1], expected[2]})) << name << " " << decimals;
    }
  }
}

TEST_F(Numbers, other_words_are_malformed) {
  for (const char* word : {"1e", "1e+", "--1", "+-1", "-+1", "++1", "+", "-", ".", "e5", "0x1p3", "1_000", "1f", "1,0",
                           "infinit", "nanx", "1.2.3", "\xEF\xBC\x91"}) {
    for (const auto& [name, bytes] : files_with(std::string(word) + " 0 0")) {
      EXPECT_EQ(refused(name, bytes).code, ErrorCode::malformed_file) << name << " " << word;
    }
  }
}

}  // namespace
}  // namespace limber
