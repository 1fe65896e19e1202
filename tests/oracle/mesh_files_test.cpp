// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <random>
#include <sstream>

#include "limber/io.h"

// Plain text files of random polygons, read by limber::io and by CGAL.

namespace limber {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

struct Polygons {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
};

Polygons random_polygons(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-10, 10);
  Polygons polygons;
  for (int v = 0; v < 50; ++v) polygons.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  for (int f = 0; f < 40; ++f) {
    polygons.faces.emplace_back();
    for (unsigned i = 0, n = 3 + random() % 4; i < n; ++i) polygons.faces.back().push_back(random() % 50);
  }
  return polygons;
}

/// The text of a file: `before_vertex` and `before_face` start the lines, corners count from `first_index`.
std::string text_of(const Polygons& polygons, const std::string& header, const std::string& before_vertex,
                    const std::string& before_face, bool has_sizes, std::size_t first_index) {
  std::ostringstream out;
  out << std::setprecision(17) << header;
  for (const Point& p : polygons.points) out << before_vertex << p.x() << " " << p.y() << " " << p.z() << "\n";
  for (const auto& face : polygons.faces) {
    out << before_face;
    if (has_sizes) out << face.size();
    for (const std::size_t corner : face) out << " " << corner + first_index;
    out << "\n";
  }
  return out.str();
}

void expect_same(const std::string& extension, const std::string& text, const Polygons& expected) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("limber_oracle_" + std::to_string(getpid()) + extension);
  std::ofstream(path) << text;
  const Result<MeshFile> file = read_mesh_file(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(file) << file.error().text;
  ASSERT_EQ(file->mesh.positions().size(), expected.points.size());
  for (std::size_t v = 0; v < expected.points.size(); ++v) {
    const Point& p = expected.points[v];
    EXPECT_EQ(file->mesh.positions()[v], (Vec3{p.x(), p.y(), p.z()})) << extension << " vertex " << v;
  }
  // Faces of more corners cross themselves, so which triangles they become is not CGAL's to say.
  TriangleId t = 0;
  for (std::uint32_t f = 0; f < expected.faces.size(); ++f) {
    const auto& face = expected.faces[f];
    for (std::size_t i = 2; i < face.size(); ++i, ++t) {
      ASSERT_LT(t, file->face_of_triangle.size());
      EXPECT_EQ(file->face_of_triangle[t], f) << extension;
      for (std::size_t j = 0; j < 3; ++j) {
        const auto corner = std::find(face.begin(), face.end(), file->mesh.triangles()[t][j]);
        EXPECT_TRUE(face.size() > 3 ? corner != face.end() : face[j] == file->mesh.triangles()[t][j]) << extension;
      }
    }
  }
  EXPECT_EQ(t, file->mesh.triangles().size()) << extension;
}

TEST(MeshFilesOracle, plain_text_is_read_as_cgal_reads_it) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    const Polygons polygons = random_polygons(random);
    const std::string obj = text_of(polygons, "", "v ", "f", false, 1);
    const std::string off = text_of(polygons, "OFF\n50 40 0\n", "", "", true, 0);
    const std::string ply = text_of(polygons,
                                    "ply\nformat ascii 1.0\nelement vertex 50\nproperty double x\nproperty double y\n"
                                    "property double z\nelement face 40\nproperty list uchar uint vertex_indices\n"
                                    "end_header\n",
                                    "", "", true, 0);
    Polygons read;
    std::istringstream obj_in(obj), off_in(off), ply_in(ply);
    ASSERT_TRUE(CGAL::IO::read_OBJ(obj_in, read.points, read.faces));
    expect_same(".obj", obj, read);
    read = {};
    ASSERT_TRUE(CGAL::IO::read_OFF(off_in, read.points, read.faces));
    expect_same(".off", off, read);
    read = {};
    ASSERT_TRUE(CGAL::IO::read_PLY(ply_in, read.points, read.faces));
    expect_same(".ply", ply, read);
  }
}

}  // namespace
}  // namespace limber
