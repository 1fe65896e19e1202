// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"
#include "support/real_meshes.h"

namespace limber {
namespace {

namespace fs = std::filesystem;
using testing::real_mesh;

struct Known {
  const char* name;
  std::size_t triangle_count;
};

void PrintTo(const Known& known, std::ostream* out) { *out << known.name; }

class RealFiles : public ::testing::TestWithParam<Known> {};

TEST_P(RealFiles, have_their_known_number_of_triangles) {
  const fs::path path = real_mesh(GetParam().name);
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  const Result<MeshFile> file = read_mesh_file(path);
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->mesh.triangles().size(), GetParam().triangle_count);
  EXPECT_EQ(file->face_of_triangle.back() + 1, file->face_count);
}

INSTANTIATE_TEST_SUITE_P(All, RealFiles,
                         ::testing::Values(Known{"stanford-bunny.obj", 69451}, Known{"armadillo.obj", 86482},
                                           Known{"fandisk.obj", 12946}, Known{"spot.obj", 5856}, Known{"cow.obj", 5804},
                                           Known{"teapot.obj", 6320}, Known{"beetle.obj", 2053},
                                           Known{"cloth_ball_92.ply", 92230}, Known{"cloth_ball_93.ply", 92230}),
                         [](const auto& test) {
                           std::string name = fs::path(test.param.name).stem().string();
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(RealSequence, cloth_frames_share_their_connectivity) {
  const fs::path first = real_mesh("cloth_ball_92.ply"), second = real_mesh("cloth_ball_93.ply");
  if (!fs::exists(first) || !fs::exists(second)) GTEST_SKIP() << "no data";
  const Result<MeshSequence> frames = MeshSequence::open(first);
  ASSERT_TRUE(frames) << frames.error().text;
  const Result<std::vector<Vec3>> positions = frames->read_positions(second, 1);
  ASSERT_TRUE(positions) << positions.error().text;
  ASSERT_EQ(positions->size(), frames->first().mesh.positions().size());
  EXPECT_NE(*positions, frames->first().mesh.positions());
}

}  // namespace
}  // namespace limber
