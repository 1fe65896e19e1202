// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf_json.h"
#include "io/parse_mesh.h"

namespace limber::io {

/// The buffers of a glTF file: the binary chunk, data in the description, and files beside it. Each is read when it is
/// first asked for, and a file that several buffers name is read once. Errors as in gltf_json.h.
class GltfBuffers {
 public:
  /// `chunk` is the binary chunk of a .glb file; `max_bytes` bounds the buffer files together. All must outlive this.
  GltfBuffers(const JsonItem& description, std::optional<std::string_view> chunk, const BufferSource& external,
              std::uint64_t max_bytes);

  /// The first `byteLength` bytes of a buffer, which must have as many.
  std::string_view bytes(std::uint64_t index, const JsonItem& user);

  /// How much has been read from files so far.
  std::uint64_t file_bytes() const { return max_bytes_ - bytes_left_; }

 private:
  std::string_view load(const JsonItem& buffer, std::uint64_t index);
  std::string_view load_file(const JsonItem& buffer, std::string_view uri);

  const JsonItem& description_;
  std::optional<std::string_view> chunk_;
  const BufferSource& external_;
  std::uint64_t max_bytes_, bytes_left_;
  std::vector<std::optional<std::string_view>> loaded_;
  std::map<std::uint64_t, std::string> decoded_;           // by index of the buffer
  std::map<std::string, std::string, std::less<>> files_;  // by path
};

}  // namespace limber::io
