// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <random>
#include <tuple>

#include "files.h"

namespace limber {
namespace {

using Positions = std::vector<Vec3>;

class Sequence : public FilesTest {
 protected:
  /// A sequence whose only known frame holds these bytes.
  MeshSequence opened(const std::string& name, const std::string& bytes) const {
    return MeshSequence::open(write(name, bytes)).value();
  }
  /// A later frame is refused with a text that holds `part`.
  void expect_refused(const MeshSequence& frames, const std::string& bytes, ErrorCode code,
                      const std::string& part = "") const {
    const Result<Positions> frame = frames.read_positions(write("17.obj", bytes), 17);
    ASSERT_FALSE(frame);
    const Error& error = frame.error();
    EXPECT_TRUE(is_one_line_about(path("17.obj"), error.text));
    EXPECT_EQ(error.code, code) << error.text;
    EXPECT_NE(error.text.find(part), std::string::npos) << error.text;
    if (code == ErrorCode::changed_connectivity) {
      EXPECT_EQ(error.where, 17U);
    }
  }
};

/// Two triangles side by side with corners of their own, the second shifted.
std::string two_loose_triangles(const std::string& shift) {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 " + shift + "\nv 1 1 " + shift + "\nv 0 1 " + shift + "\nf 1 2 3\nf 4 5 6\n";
}

TEST_F(Sequence, vertices_that_meet_later_stay_apart) {
  const MeshSequence frames = opened("0.obj", two_loose_triangles("1"));
  EXPECT_EQ(frames.first().mesh.positions().size(), 6U);
  EXPECT_EQ(frames.read_positions(write("1.obj", two_loose_triangles("0")), 1).value(),
            (Positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
}

TEST_F(Sequence, vertices_that_part_later_are_two_or_the_frame_is_refused) {
  const std::vector<std::filesystem::path> files = {write("0.obj", two_loose_triangles("0")),
                                                    write("1.obj", two_loose_triangles("7"))};
  const Positions parted = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 7}, {1, 1, 7}, {0, 1, 7}};
  for (const MeshSequence& frames :
       {MeshSequence::open(files).value(), MeshSequence::open(files[0], {.weld = false}).value()}) {
    EXPECT_EQ(frames.read_positions(files[1], 1).value(), parted);
  }
  const MeshSequence first_alone = MeshSequence::open(files[0]).value();
  EXPECT_EQ(first_alone.first().mesh.triangles(), (std::vector<Corners>{{0, 1, 2}, {1, 3, 2}}));
  expect_refused(first_alone, two_loose_triangles("7"), ErrorCode::changed_connectivity,
                 "frame 17 parts vertices 1 and 3 of the file");
  EXPECT_THROW(static_cast<void>(MeshSequence::open(std::vector<std::filesystem::path>())), std::invalid_argument);
  EXPECT_EQ(MeshSequence::open(std::vector{files[0], write("2.obj", tetrahedron("obj/plain.obj"))}).error().where, 1U);
}

TEST_F(Sequence, closed_parts_of_stl_files_stay_closed_when_they_part) {
  const auto two_tetrahedra = [](const char* x) {
    std::string moved = tetrahedron("stl/text.stl");
    for (std::size_t at = 0; (at = moved.find("vertex ", at)) != moved.npos; at += 7) moved.insert(at + 7, x);
    return tetrahedron("stl/text.stl") + moved;  // vertices at 0 and 1 along x go to 10 and 11, or to -0 and -1
  };
  const MeshSequence frames =
      MeshSequence::open(std::vector{write("0.stl", two_tetrahedra("-")), write("1.stl", two_tetrahedra("1"))}).value();
  EXPECT_EQ(frames.first().mesh.positions().size(), 8U);
  EXPECT_TRUE(frames.first().mesh.is_closed());
  EXPECT_EQ(frames.first().parts, (std::vector<std::string>(2, "body")));
  EXPECT_EQ(frames.first().part_of_triangle, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1}));
}

/// Frames of random vertices on a small grid, moved a little where there is a tolerance. Welds as they are defined.
TEST_F(Sequence, welds_what_is_together_in_every_frame) {
  std::mt19937 random(5);
  for (int round = 0; round < 60; ++round) {
    const double tolerance = round % 2 == 0 ? 0 : 0.5;
    std::vector<std::filesystem::path> files;
    std::vector<Positions> frames;
    for (int f = 0; f < 1 + round % 3; ++f) {
      std::string bytes;
      frames.emplace_back();
      for (int v = 0; v < 24; ++v) {
        Vec3 p;
        for (std::size_t axis = 0; axis < 3; ++axis)
          p[axis] = (f == 0 ? 1 : 7) * static_cast<int>(random() % 2) + tolerance * static_cast<int>(random() % 3) / 4;
        frames.back().push_back(p);
        bytes += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
      }
      files.push_back(
          write(std::to_string(round) + "_" + std::to_string(f) + ".obj", bytes + "o a\nf 1 2 3\no b\nf 4 5 6\n"));
    }
    const bool parts = round % 4 < 2;
    const MeshFile file = MeshSequence::open(files, {.weld_tolerance = tolerance, .parts = parts}).value().first();
    const auto part = [&](std::size_t v) { return !parts ? 0 : v < 3 ? 1 : v < 6 ? 2 : 0; };
    const auto together = [&](std::size_t v, std::size_t u) {
      return part(v) == part(u) && std::all_of(frames.begin(), frames.end(),
                                               [&](const Positions& p) { return length(p[v] - p[u]) <= tolerance; });
    };
    std::vector<VertexId> first_of, expected;  // where there is one frame, or no tolerance
    for (VertexId v = 0; v < 24; ++v) {
      const auto first = std::find_if(first_of.begin(), first_of.end(), [&](VertexId u) { return together(v, u); });
      expected.push_back(static_cast<VertexId>(first - first_of.begin()));
      if (first == first_of.end()) first_of.push_back(v);
    }
    if (files.size() == 1 || tolerance == 0) {
      EXPECT_EQ(file.vertex_of_file_vertex, expected) << round;
    }
    std::vector<VertexId> firsts(24, no_id);
    for (VertexId v = 0; v < 24; ++v) {
      VertexId& first = firsts[file.vertex_of_file_vertex[v]];
      first = std::min(first, v);
      EXPECT_TRUE(together(v, first)) << round << " " << v;
      EXPECT_EQ(file.mesh.positions()[file.vertex_of_file_vertex[v]], frames[0][first]);
    }
  }
}

TEST_F(Sequence, every_format_can_be_a_frame_of_its_own_kind) {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    const MeshSequence frames = opened(name, bytes);
    EXPECT_EQ(frames.read_positions(path(name), 1).value(), frames.first().mesh.positions()) << name;
  }
}

TEST_F(Sequence, frames_that_collapse_to_a_point_keep_their_vertices) {
  std::string stl = tetrahedron("stl/binary.stl");
  std::fill(stl.begin() + 84, stl.end(), '\0');
  EXPECT_EQ(opened("0.stl", tetrahedron("stl/binary.stl")).read_positions(write("1.stl", stl), 1).value(),
            Positions(4));
  const std::string glb = gltf_of(Positions(4), tetrahedron_triangles).glb();
  EXPECT_EQ(opened("0.glb", gltf_of(tetrahedron_positions, tetrahedron_triangles).glb())
                .read_positions(write("1.glb", glb), 1)
                .value(),
            Positions(4));
}

TEST_F(Sequence, changed_counts_and_the_first_face_that_differs_are_named) {
  const MeshSequence two = opened("0.obj", two_loose_triangles("1"));
  for (const auto& [bytes, counts] : std::vector<std::pair<std::string, std::string>>{
           {tetrahedron("obj/plain.obj"), "4 vertices and 4 faces"},
           {two_loose_triangles("1") + "v 9 9 9\n", "7 vertices and 2 faces"},
           {two_loose_triangles("1") + "f 1 2\n", "6 vertices and 3 faces"}}) {
    expect_refused(two, bytes, ErrorCode::changed_connectivity,
                   ": frame 17 has " + counts + ", the first frame 6 and 2");
  }
  const std::string vertices = obj_corner + "v 1 1 0\n";
  const MeshSequence four = opened("0.obj", vertices + "f 1 2 3\nf 2 4 3\nf 1 2 4 3\nf 1 4 3\n");
  for (const auto& [faces, differing] : std::vector<std::pair<std::string, std::string>>{
           {"f 1 2 3\nf 4 3 2\nf 1 2 4 3\nf 1 4 3\n", "face 1"},
           {"f 1 2 3\nf 2 4 3\nf 1 2 4\nf 3 1 4 3\n", "face 2"},  // the same corners, split elsewhere
           {"f 1 2 3\nf 2 4 3\nf 1 2 4 3\nf 1 4 2\n", "face 3"}}) {
    expect_refused(four, vertices + faces, ErrorCode::changed_connectivity, differing);
  }
  // Vertices 2 and 4 are at the same place.
  expect_refused(opened("0.obj", two_loose_triangles("0")), with(two_loose_triangles("0"), "f 4 5 6", "f 2 5 6"),
                 ErrorCode::changed_connectivity);
}

TEST_F(Sequence, later_frames_are_checked_like_the_first) {
  const MeshSequence frames = opened("0.obj", two_loose_triangles("1"));
  expect_refused(frames, two_loose_triangles("nan"), ErrorCode::non_finite);
  expect_refused(frames, two_loose_triangles("1e70"), ErrorCode::too_large);
  expect_refused(frames, two_loose_triangles("x"), ErrorCode::malformed_file);
  expect_refused(frames, "", ErrorCode::malformed_file);
  EXPECT_EQ(frames.read_positions(path("missing.obj"), 2).error().code, ErrorCode::unreadable_file);
}

}  // namespace
}  // namespace limber
