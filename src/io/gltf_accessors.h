// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf_json.h"

namespace limber::io {

/// The buffers of a glTF file: the binary chunk, data in the description, and files beside it. Each is read when it is
/// first asked for, and a file that several buffers name is read once.
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

/// Elements in a row, or at equal steps, in a buffer.
struct GltfElements {
  std::string_view bytes;   ///< from the first element on
  std::size_t stride = 0;   ///< bytes from one element to the next
  bool is_present = false;  ///< otherwise all elements are zero
};

/// What the elements of an accessor must be. A set of component types has bit i for the type 5120 + i.
struct GltfElementKind {
  const char* what;  ///< in messages
  std::string_view type;
  std::size_t component_count;
  unsigned plain_types, normalized_types;
  bool may_have_stride;
};

namespace gltf_kinds {
inline constexpr unsigned bytes = 1, unsigned_bytes = 2, shorts = 4, unsigned_shorts = 8, unsigned_ints = 32,
                          floats = 64;
inline constexpr unsigned quantized = bytes | unsigned_bytes | shorts | unsigned_shorts;  // KHR_mesh_quantization

inline constexpr GltfElementKind positions = {"positions", "VEC3", 3, quantized | floats, quantized, true};
inline constexpr GltfElementKind indices = {"indices", "SCALAR", 1, unsigned_bytes | unsigned_shorts | unsigned_ints,
                                            0,         false};
inline constexpr GltfElementKind joints = {"joints", "VEC4", 4, unsigned_bytes | unsigned_shorts, 0, true};
inline constexpr GltfElementKind weights = {"weights", "VEC4", 4, floats, unsigned_bytes | unsigned_shorts, true};
inline constexpr GltfElementKind matrices = {"matrices", "MAT4", 16, floats, 0, true};
inline constexpr GltfElementKind vectors = {"vectors", "VEC3", 3, floats, 0, true};
inline constexpr GltfElementKind rotations = {"rotations", "VEC4", 4, floats, bytes | shorts, true};
}  // namespace gltf_kinds

/// A checked accessor: every element it names lies in its buffer view.
struct GltfAccessor {
  std::string name;
  std::size_t count = 0;
  std::size_t component_count = 0, component_bytes = 0;
  std::uint64_t component_type = 0;
  bool is_normalized = false;
  GltfElements elements;

  // Elements that stand in for those of the list above.
  std::size_t sparse_count = 0;
  std::size_t sparse_index_bytes = 0;
  std::string_view sparse_indices, sparse_values;
};

/// Checks accessors as section 5.1 of the glTF 2.0 specification asks, and reads them.
class GltfAccessors {
 public:
  GltfAccessors(const JsonItem& description, GltfBuffers& buffers) : description_(description), buffers_(buffers) {}

  GltfAccessor check(std::uint64_t index, const JsonItem& user, const GltfElementKind& kind);

 private:
  /// `count` elements of `element_bytes`, aligned to `component_bytes`, from the item's `byteOffset` on.
  GltfElements elements(const JsonItem& item, std::uint64_t count, std::size_t element_bytes,
                        std::size_t component_bytes, bool may_have_stride);
  void check_sparse(const JsonItem& accessor, std::size_t element_bytes, GltfAccessor& result);

  const JsonItem& description_;
  GltfBuffers& buffers_;
};

/// The components of all elements, one element after the other.
std::vector<double> read_numbers(const GltfAccessor& accessor);

}  // namespace limber::io
