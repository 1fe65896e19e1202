// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>

namespace limber::testing {

/// Where a real mesh lies: in the environment's LIMBER_MESHES, or beside the source folder. Tests skip without it.
inline std::filesystem::path real_mesh(const char* name) {
  const char* folder = std::getenv("LIMBER_MESHES");
  const std::filesystem::path beside = std::filesystem::path(LIMBER_SOURCE_DIR) / ".." / "shared" / "meshes";
  return (folder != nullptr ? std::filesystem::path(folder) : beside) / name;
}

}  // namespace limber::testing
