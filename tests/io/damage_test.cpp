// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <random>

#include "files.h"

namespace limber {
namespace {

using Damage = FilesTest;

/// Formats that say how much they hold, so that no truncation can go unnoticed but that of trailing blanks.
bool states_its_length(const std::string& name) { return !name.ends_with(".obj"); }

TEST_F(Damage, every_truncation_is_refused_with_one_line) {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Result<MeshFile> file = read(name, bytes.substr(0, size));
      if (!file) {
        EXPECT_TRUE(is_one_line_about(path(name), file.error().text)) << file.error().text;
      } else if (states_its_length(name)) {
        // What is left out may be the last line's end, a solid's name after "endsolid", or digits of the last index.
        const bool keeps_all = size + 1 == bytes.size() || bytes.substr(0, size).find("endsolid") != std::string::npos;
        EXPECT_TRUE(keeps_all) << name << " cut at " << size << " of " << bytes.size();
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

}  // namespace
}  // namespace limber
