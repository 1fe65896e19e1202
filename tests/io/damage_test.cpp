// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <random>

#include "gltf_parts.h"

namespace limber {
namespace {

using Damage = FilesTest;

/// Formats that state their length, so that every truncation is noticed, except one of trailing blanks.
bool states_its_length(const std::string& name) { return !name.ends_with(".obj"); }

TEST_F(Damage, every_truncation_is_refused_with_one_line) {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Result<MeshFile> file = read(name, bytes.substr(0, size));
      if (!file) {
        EXPECT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
      } else if (states_its_length(name)) {
        // A truncation may leave out the last line's end, a solid's name after "endsolid", or digits of the last index.
        const bool keeps_all = size + 1 == bytes.size() || bytes.substr(0, size).find("endsolid") != std::string::npos;
        EXPECT_TRUE(keeps_all) << name << " truncated at " << size << " of " << bytes.size();
      } else {
        EXPECT_LE(file->face_count, 4U);
      }
    }
  }
}

TEST_F(Damage, flipped_bytes_never_do_worse_than_another_mesh) {
  std::mt19937 random(20);
  for (const auto& [name, bytes] : tetrahedron_files()) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1U << random() % 8));
      const Result<MeshFile> file = read(name, damaged);
      if (!file) {
        EXPECT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
        continue;
      }
      EXPECT_TRUE(check_mesh(file->mesh));
      EXPECT_EQ(file->face_of_triangle.size(), file->mesh.triangles().size());
    }
  }
}

/// One file of every format that uses more of it than the tetrahedra do.
std::vector<std::pair<std::string, std::string>> varied_files() {
  const std::string header_end = "end_header\n";
  std::string ply = tetrahedron_ply_binary(true);
  ply.insert(ply.find("element face"), "element edge 2\nproperty list uchar short marks\n");
  ply.insert(ply.find(header_end) + header_end.size() + 48, std::string("\1\0\7\0", 4));
  return {
      {"a.obj", "\xEF\xBB\xBFmtllib m\nv 1e-3 +2 .5 # c\nv -1 0 0 1\nv 0 1e2 0\nvt 0 0\nf 1/1 -2 3//1\nf -1 \\\n1 2\n"},
      {"b.off", "# c\nSTCNOFF 3 2 # c\n0 0 0 0 0 1\n1e0 0 0\n0 +1 0\n3 0 1 2 255 0 0\n2 0 1\n"},
      {"c.ply", tetrahedron_ply_ascii() + "9 9\n"},
      {"d.ply", ply},
      {"e.stl", tetrahedron_stl_text() + tetrahedron_stl_text()},
      {"f.stl", tetrahedron_stl_binary()},
      {"g.gltf", varied_gltf().gltf()},
      {"h.glb", varied_gltf().glb()}};
}

class Random {
 public:
  std::size_t below(std::size_t limit) { return engine_() % limit; }

  /// Cuts, repeats, moves and overwrites pieces, as disks, networks and people do.
  void damage(std::string& bytes) {
    const std::size_t at = below(bytes.size()), length = 1 + below(std::min<std::size_t>(bytes.size() - at, 16));
    switch (below(7)) {
      case 0:
        bytes.resize(at + 1);
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes = bytes.substr(0, at + length) + bytes.substr(at);
        break;
      case 3:
        bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << below(8)));
        break;
      case 4:
        bytes.replace(at, length, length, below(2) == 0 ? '\xff' : '\0');
        break;
      case 5:
        bytes[at] = "0123456789-+.eE/\\\"{}[],: \n"[below(26)];
        break;
      default:
        bytes = bytes.substr(0, at) + std::string(1 + below(20), '9') + bytes.substr(at);
    }
    if (bytes.empty()) bytes.assign(1, ' ');
  }

 private:
  std::mt19937 engine_{5};
};

TEST_F(Damage, of_many_kinds_gives_one_line_or_a_sound_mesh) {
  Random random;
  std::size_t read_count = 0, refused_count = 0;
  for (const auto& [name, bytes] : varied_files()) {
    ASSERT_TRUE(read(name, bytes)) << name << read(name, bytes).error().text;
    for (int round = 0; round < 1500; ++round) {
      std::string damaged = bytes;
      for (std::size_t i = 0; i <= random.below(4); ++i) random.damage(damaged);
      const Result<MeshFile> file = read(name, damaged);
      if (!file) {
        ++refused_count;
        ASSERT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
        continue;
      }
      ++read_count;
      ASSERT_TRUE(check_mesh(file->mesh));
      ASSERT_EQ(file->face_of_triangle.size(), file->mesh.triangles().size());
      ASSERT_LT(file->face_of_triangle.back(), file->face_count);
    }
  }
  EXPECT_GT(read_count, 100U);  // otherwise the damage is too coarse to find anything
  EXPECT_GT(refused_count, 1000U);
}

}  // namespace
}  // namespace limber
