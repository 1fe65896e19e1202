// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

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
  const Result<MeshFile> scene = read("a.glb", glb(gltf_json(5, 3), gltf_buffer(positions, {{1, 2, 4}})));
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->mesh.positions(), positions);
  EXPECT_EQ(scene->mesh.triangles(), (std::vector<Corners>{{1, 2, 4}}));
}

TEST_F(Meaning, grid_of_loose_triangles_is_welded_to_the_grid) {
  constexpr int n = 40;
  std::string obj;
  const auto add_vertex = [&](int i, int j) {
    obj += "v " + std::to_string(0.1 * i) + " " + std::to_string(0.1 * j) + " 0\n";
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      add_vertex(i, j), add_vertex(i + 1, j), add_vertex(i + 1, j + 1), add_vertex(i, j + 1);
      obj += "f -4 -3 -2 -1\n";
    }
  }
  const Result<MeshFile> file = read("a.obj", obj);
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.positions().size(), static_cast<std::size_t>((n + 1) * (n + 1)));
  EXPECT_EQ(file->mesh.triangles().size(), static_cast<std::size_t>(2 * n * n));
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

}  // namespace
}  // namespace limber
