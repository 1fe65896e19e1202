// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>

namespace limber::testing {

/// Where a real mesh lies: in tests/data, in the folder that the environment's LIMBER_MESHES names, or beside the source
/// folder. Tests of those that are not in tests/data skip where there are none.
inline std::filesystem::path real_mesh(const char* name) {
  const std::filesystem::path own = std::filesystem::path(LIMBER_SOURCE_DIR) / "tests" / "data" / name;
  if (std::filesystem::exists(own)) return own;
  const char* folder = std::getenv("LIMBER_MESHES");
  const std::filesystem::path beside = std::filesystem::path(LIMBER_SOURCE_DIR) / ".." / "shared" / "meshes";
  return (folder != nullptr ? std::filesystem::path(folder) : beside) / name;
}

}  // namespace limber::testing
