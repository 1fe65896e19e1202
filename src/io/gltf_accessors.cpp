// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_accessors.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "io/byte_order.h"

namespace limber::io {
namespace {

constexpr std::uint64_t first_type = 5120, float32 = 5126;  // of componentType (glTF 2.0, 3.6.2.2)

bool is_in(unsigned types, std::uint64_t component_type) {
  return component_type >= first_type && component_type <= float32 &&
         (types >> (component_type - first_type) & 1U) != 0;
}

std::size_t bytes_of(std::uint64_t component_type) {
  LIMBER_ASSERT(component_type >= first_type && component_type <= float32);
  return std::array<std::size_t, 7>{1, 1, 2, 2, 4, 4, 4}[static_cast<std::size_t>(component_type - first_type)];
}

/// The number that a component stands for (glTF 2.0, 3.11, for normalized integers).
double component(std::string_view raw, std::uint64_t type, bool is_normalized) {
  if (type == float32) return float_number(raw);
  const bool is_signed = is_in(gltf_kinds::bytes | gltf_kinds::shorts, type);
  const auto number_count = static_cast<double>(std::uint64_t{1} << 8 * raw.size());
  auto number = static_cast<double>(unsigned_number(raw));
  if (is_signed && number >= number_count / 2) number -= number_count;
  if (!is_normalized) return number;
  return is_signed ? std::max(number / (number_count / 2 - 1), -1.0) : number / (number_count - 1);
}

}  // namespace

GltfElements GltfAccessors::elements(const JsonItem& item, std::uint64_t count, std::size_t element_bytes,
                                     std::size_t component_bytes, bool may_have_stride) {
  const JsonItem view = description_.item("bufferViews", item.whole("bufferView"), "buffer view", item);
  const std::string_view buffer = buffers_.bytes(view.whole("buffer"), view);
  const std::uint64_t start = view.whole("byteOffset", 0), length = view.whole("byteLength");
  if (length == 0) view.refuse("has no bytes");
  if (start > buffer.size() || length > buffer.size() - start) {
    view.refuse("its " + std::to_string(length) + " bytes from byte " + std::to_string(start) + " leave buffer " +
                std::to_string(view.whole("buffer")) + " of " + std::to_string(buffer.size()) + " bytes");
  }
  const std::uint64_t stride = view.whole("byteStride", element_bytes), offset = item.whole("byteOffset", 0);
  if (view.has("byteStride")) {
    if (stride < 4 || stride > 252 || stride % 4 != 0) view.refuse("byteStride is not a multiple of 4 from 4 to 252");
    if (!may_have_stride) item.refuse(view.name() + " must not have a byteStride");
    if (stride < element_bytes) item.refuse(view.name() + " has a byteStride smaller than an element");
  }
  if (offset % component_bytes != 0 || start % component_bytes != 0) {
    item.refuse("is not aligned to components of " + std::to_string(component_bytes) + " bytes");
  }
  if (offset > length || element_bytes > length - offset || count - 1 > (length - offset - element_bytes) / stride) {
    item.refuse("its " + std::to_string(count) + " elements from byte " + std::to_string(offset) + " leave " +
                view.name() + " of " + std::to_string(length) + " bytes");
  }
  const std::string_view bytes = buffer.substr(static_cast<std::size_t>(start), static_cast<std::size_t>(length));
  return {bytes.substr(static_cast<std::size_t>(offset)), static_cast<std::size_t>(stride), true};
}

GltfAccessor GltfAccessors::check(std::uint64_t index, const JsonItem& user, const GltfElementKind& kind) {
  const JsonItem item = description_.item("accessors", index, "accessor", user);
  GltfAccessor result;
  result.name = item.name();
  result.component_count = kind.component_count;
  result.component_type = item.whole("componentType");
  result.is_normalized = item.flag("normalized");
  if (!is_in(result.is_normalized ? kind.normalized_types : kind.plain_types, result.component_type)) {
    item.refuse(std::string(kind.what) + " of component type " + std::to_string(result.component_type) +
                (result.is_normalized ? ", normalized," : "") + " are not read");
  }
  if (item.text("type") != kind.type) {
    item.refuse(std::string(kind.what) + " are of type " + in_quotes(item.text("type")) + ", not " +
                std::string(kind.type));
  }
  result.component_bytes = bytes_of(result.component_type);
  const std::size_t element_bytes = kind.component_count * result.component_bytes;
  const std::uint64_t count = item.whole("count");
  if (count == 0) item.refuse("has no elements");
  if (count >= no_id) item.refuse("has more elements than ids can count", ErrorCode::too_large);
  result.count = static_cast<std::size_t>(count);
  if (item.has("bufferView")) {
    result.elements = elements(item, count, element_bytes, result.component_bytes, kind.may_have_stride);
  } else if (item.whole("byteOffset", 0) != 0) {
    item.refuse("has a byteOffset without a bufferView");
  }
  if (item.has("sparse")) check_sparse(item, element_bytes, result);
  return result;
}

void GltfAccessors::check_sparse(const JsonItem& accessor, std::size_t element_bytes, GltfAccessor& result) {
  const JsonItem sparse = accessor.item("sparse");
  const std::uint64_t count = sparse.whole("count");
  if (count == 0 || count > result.count) sparse.refuse("count is not from 1 to the accessor's");
  const JsonItem indices = sparse.item("indices"), values = sparse.item("values");
  const std::uint64_t index_type = indices.whole("componentType");
  if (!is_in(gltf_kinds::indices.plain_types, index_type)) {
    indices.refuse("componentType is not that of unsigned integers");
  }
  const std::size_t index_bytes = bytes_of(index_type);
  result.sparse_count = static_cast<std::size_t>(count);
  result.sparse_index_bytes = index_bytes;
  result.sparse_indices = elements(indices, count, index_bytes, index_bytes, false).bytes;
  result.sparse_values = elements(values, count, element_bytes, result.component_bytes, false).bytes;
}

std::vector<double> read_numbers(const GltfAccessor& accessor) {
  const GltfElements& elements = accessor.elements;
  const std::size_t n = accessor.component_count, size = accessor.component_bytes;
  LIMBER_ASSERT(!elements.is_present || (accessor.count - 1) * elements.stride + n * size <= elements.bytes.size());
  LIMBER_ASSERT(accessor.sparse_count * accessor.sparse_index_bytes <= accessor.sparse_indices.size());
  LIMBER_ASSERT(accessor.sparse_count * n * size <= accessor.sparse_values.size());
  std::vector<double> numbers(n * accessor.count);
  const auto read = [&](std::size_t element, std::string_view raw) {
    for (std::size_t i = 0; i < n; ++i) {
      numbers[n * element + i] = component(raw.substr(i * size, size), accessor.component_type, accessor.is_normalized);
    }
  };
  for (std::size_t i = 0; i < accessor.count && elements.is_present; ++i) {
    read(i, elements.bytes.substr(i * elements.stride, n * size));
  }
  std::uint64_t smallest_allowed = 0;  // sparse indices have to rise
  for (std::size_t i = 0; i < accessor.sparse_count; ++i) {
    const std::uint64_t at =
        unsigned_number(accessor.sparse_indices.substr(i * accessor.sparse_index_bytes, accessor.sparse_index_bytes));
    if (at < smallest_allowed || at >= accessor.count) {
      throw BadResult(malformed(accessor.name + ": sparse index " + std::to_string(at) +
                                (at < smallest_allowed ? " does not follow the one before it" : " names no element")));
    }
    smallest_allowed = at + 1;
    read(static_cast<std::size_t>(at), accessor.sparse_values.substr(i * n * size, n * size));
  }
  return numbers;
}

}  // namespace limber::io
