// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf_buffers.h"
#include "limber/math.h"

namespace limber::io {

/// Elements in a row, or at equal steps, in a buffer.
struct GltfElements {
  std::string_view bytes;   ///< from the first element on
  std::size_t stride = 0;   ///< bytes from one element to the next
  bool is_present = false;  ///< otherwise all elements are zero
};

/// A checked accessor: every element it names lies in its buffer view.
struct GltfAccessor {
  std::string name;
  std::size_t count = 0;
  std::size_t component_bytes = 0;
  GltfElements elements;

  // Elements that stand in for those of the list above.
  std::size_t sparse_count = 0;
  std::size_t sparse_index_bytes = 0;
  std::string_view sparse_indices, sparse_values;
};

/// Checks accessors as section 5.1 of the glTF 2.0 specification asks, and reads them. Errors as in gltf_json.h.
class GltfAccessors {
 public:
  GltfAccessors(const JsonItem& description, GltfBuffers& buffers) : description_(description), buffers_(buffers) {}

  /// Three float32 each.
  GltfAccessor positions(std::uint64_t index, const JsonItem& user) { return check(index, user, Kind::position); }
  /// Unsigned integers of 8, 16 or 32 bits.
  GltfAccessor indices(std::uint64_t index, const JsonItem& user) { return check(index, user, Kind::index); }

 private:
  enum class Kind { position, index };
  struct View {
    std::string name;
    std::string_view bytes;
    std::uint64_t offset = 0;  // in its buffer
    std::size_t stride = 0;    // 0: not given
  };

  GltfAccessor check(std::uint64_t index, const JsonItem& user, Kind kind);
  View view(const JsonItem& user);
  /// `count` elements of `element_bytes`, aligned to `component_bytes`, from the item's `byteOffset` on.
  GltfElements elements(const JsonItem& item, std::uint64_t count, std::size_t element_bytes,
                        std::size_t component_bytes, bool may_have_stride);
  void check_sparse(const JsonItem& accessor, std::size_t element_bytes, GltfAccessor& result);

  const JsonItem& description_;
  GltfBuffers& buffers_;
};

/// Reads what GltfAccessors::positions() has checked.
std::vector<Vec3> read_positions(const GltfAccessor& accessor);

/// Reads what GltfAccessors::indices() has checked.
std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor);

}  // namespace limber::io
