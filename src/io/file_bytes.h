// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/parse_mesh.h"

namespace limber::io {

/// All bytes of a regular file. Never waits: pipes, devices and sockets are refused without being read.
///
/// Errors   `unreadable_file`; `too_large` when there are more than `max_bytes`. The texts do not name the file.
Result<std::string> read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Buffer files in the folder of `mesh_file` or below it. Symbolic links that lead out of the folder are refused.
BufferSource buffers_beside(const std::filesystem::path& mesh_file);

}  // namespace limber::io
