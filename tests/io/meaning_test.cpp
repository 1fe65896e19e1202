// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <locale>

#include "files.h"

namespace limber {
namespace {

using Meaning = FilesTest;
using Faces = std::vector<std::uint32_t>;

TEST_F(Meaning, polygon_becomes_a_fan_around_its_first_corner) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
  const MeshFile file = read("a.obj", square + "f 1 2 3\nf 2 3 4 1\nf 3 4 5 1 2\nf 5 4 1\n").value();
  EXPECT_EQ(file.mesh.triangles(),
            (std::vector<Corners>{{0, 1, 2}, {1, 2, 3}, {1, 3, 0}, {2, 3, 4}, {2, 4, 0}, {2, 0, 1}, {4, 3, 0}}));
  EXPECT_EQ(file.face_of_triangle, (Faces{0, 1, 1, 2, 2, 2, 3}));
  EXPECT_EQ(file.face_count, 4U);
}

TEST_F(Meaning, faces_of_fewer_than_three_corners_are_counted_but_skipped) {
  const std::string off = "OFF\n3 5 0\n0 0 0\n1 0 0\n0 1 0\n0\n1 0\n3 0 1 2\n2 0 1\n3 2 1 0\n";
  const std::string obj = obj_corner + "f\nf 1\nf 1 2 3\nf 1 2\nf 3 2 1\n";
  for (const MeshFile& file : {read("a.off", off).value(), read("a.obj", obj).value()}) {
    EXPECT_EQ(file.mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {2, 1, 0}}));
    EXPECT_EQ(file.face_of_triangle, (Faces{2, 4}));
    EXPECT_EQ(file.face_count, 5U);
  }
}

TEST_F(Meaning, equal_positions_are_welded_in_order_of_first_appearance_and_neighbours_are_not) {
  const MeshFile file =
      read("a.obj", "v 5 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 5 0 0\nv 0 0 1\nf 6 2 3\nf 4 5 6\nf 1 5 4\n").value();
  EXPECT_EQ(file.mesh.positions(), (std::vector<Vec3>{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(file.mesh.triangles(), (std::vector<Corners>{{3, 1, 2}, {1, 0, 3}, {0, 0, 1}}));
  const MeshFile zeros = read("a.obj",
                              "v -0.0 0 -0\nv 1 0 0\nv 0 1 0\nv 0 -0.0 0.0\nv 5e-324 0 0\nv 0 1.0000000000000002 0\n"
                              "f 1 2 3\nf 4 2 3\nf 5 2 6\n")
                             .value();
  ASSERT_EQ(zeros.mesh.positions().size(), 5U);
  EXPECT_TRUE(std::signbit(zeros.mesh.positions()[0].x));
  EXPECT_EQ(zeros.mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {0, 1, 2}, {3, 1, 4}}));
}

TEST_F(Meaning, unreferenced_vertices_and_duplicate_faces_are_kept) {
  const MeshFile file =
      read("a.off", "OFF\n6 3 0\n9 9 9\n0 0 0\n1 0 0\n8 8 8\n0 1 0\n7 7 7\n3 1 2 4\n3 1 2 4\n3 1 1 1\n").value();
  EXPECT_EQ(file.mesh.positions().size(), 6U);
  EXPECT_EQ(file.mesh.triangles(), (std::vector<Corners>{{1, 2, 4}, {1, 2, 4}, {1, 1, 1}}));
  const std::vector<Vec3> positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}};
  const MeshFile scene = read("a.glb", gltf_of(positions, {{1, 2, 4}}).glb()).value();
  EXPECT_EQ(scene.mesh.positions(), positions);
  EXPECT_EQ(scene.mesh.triangles(), (std::vector<Corners>{{1, 2, 4}}));
}

TEST_F(Meaning, load_mesh_gives_the_mesh_of_the_file_and_the_same_errors) {
  const Mesh mesh = load_mesh(write("a.obj", tetrahedron("obj/plain.obj"))).value();
  EXPECT_EQ(mesh.positions(), tetrahedron_positions);
  EXPECT_EQ(mesh.triangles(), tetrahedron_triangles);
  EXPECT_EQ(load_mesh(path("missing.obj")).error().text, read_mesh_file(path("missing.obj")).error().text);
}

class Numbers : public FilesTest {
 protected:
  /// Text files of one triangle whose first vertex has the decimals as its coordinates.
  static std::vector<std::pair<std::string, std::string>> files_with(const std::string& decimals) {
    return triangle_files({decimals, "1 0 0", "0 1 0"});
  }

  void expect_value(const std::string& decimal, double value) const {
    for (const auto& [name, bytes] : files_with(decimal + " 7 7")) {
      const double found = read(name, bytes).value().mesh.positions()[0].x;
      EXPECT_EQ(found, value) << name << " " << decimal;
      EXPECT_EQ(std::signbit(found), std::signbit(value)) << name << " " << decimal;
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
    for (const std::string sign : {"", "-", "+"}) {
      for (const auto& [name, bytes] : files_with("7 7 " + sign + decimal)) {
        refused(name, bytes, ErrorCode::non_finite);
      }
    }
  }
}

TEST_F(Numbers, of_any_length_are_rounded_correctly) {
  const std::string halfway = "9007199254740993";  // 2^53 + 1; ties go to the even neighbour
  for (const auto& [decimal, value] : std::vector<std::pair<std::string, double>>{
           {"1" + zeros_400 + "e-400", 1},
           {"0." + zeros_400 + "1e401", 1},
           {zeros_400 + "2.5" + zeros_400, 2.5},
           {"0e99999999999999999999", 0},
           {"0." + zeros_400 + "e400", 0},
           {"4.9406564584124654e-324", 5e-324},
           {"2.4703282292062328e-324", 5e-324},  // just above half of the smallest number
           {"2.4703282292062327e-324", 0},
           {halfway + "." + zeros_400, 9007199254740992.0},
           {halfway + "." + zeros_400 + "1", 9007199254740994.0}}) {
    expect_value(decimal, value);
  }
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

TEST_F(Numbers, other_words_are_malformed) {
  for (const char* word : {"1e", "1e+", "--1", "+-1", "-+1", "++1", "+", "-", ".", "e5", "0x1p3", "1_000", "1f", "1,0",
                           "infinit", "nanx", "1.2.3", "\xEF\xBC\x91"}) {
    for (const auto& [name, bytes] : files_with(std::string(word) + " 0 0")) refused(name, bytes);
  }
}

}  // namespace
}  // namespace limber
