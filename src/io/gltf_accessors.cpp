// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_accessors.h"

#include <optional>

#include "base/check.h"
#include "io/byte_order.h"

namespace limber::io {
namespace {

// Values of componentType (glTF 2.0, 3.6.2.2).
constexpr std::uint64_t unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, float32 = 5126;

/// The size of an unsigned integer of a component type, none if it is no such type.
std::optional<std::size_t> bytes_of_unsigned(std::uint64_t component_type) {
  if (component_type == unsigned_byte) return 1;
  if (component_type == unsigned_short) return 2;
  if (component_type == unsigned_int) return 4;
  return {};
}

/// Replaces the elements that the sparse part of an accessor names. Their indices have to rise.
template <typename Element, typename Read>
void apply_sparse(const GltfAccessor& accessor, std::size_t element_bytes, std::vector<Element>& elements,
                  const Read& read) {
  LIMBER_ASSERT(accessor.sparse_count * accessor.sparse_index_bytes <= accessor.sparse_indices.size());
  LIMBER_ASSERT(accessor.sparse_count * element_bytes <= accessor.sparse_values.size());
  std::uint64_t smallest_allowed = 0;
  for (std::size_t i = 0; i < accessor.sparse_count; ++i) {
    const std::string_view raw =
        accessor.sparse_indices.substr(i * accessor.sparse_index_bytes, accessor.sparse_index_bytes);
    const std::uint64_t at = unsigned_number(raw);
    if (at < smallest_allowed || at >= elements.size()) {
      throw BadResult(malformed(accessor.name + ": sparse index " + std::to_string(at) +
                                (at < smallest_allowed ? " does not follow the one before it" : " names no element")));
    }
    smallest_allowed = at + 1;
    elements[static_cast<std::size_t>(at)] = read(accessor.sparse_values.substr(i * element_bytes, element_bytes));
  }
}

/// Reads all elements of a checked accessor. Without bytes they are zero, apart from its sparse part.
template <typename Element, typename Read>
std::vector<Element> read_elements(const GltfAccessor& accessor, std::size_t element_bytes, const Read& read) {
  LIMBER_ASSERT(!accessor.elements.is_present ||
                (accessor.count - 1) * accessor.elements.stride + element_bytes <= accessor.elements.bytes.size());
  std::vector<Element> elements(accessor.count);
  for (std::size_t i = 0; i < accessor.count && accessor.elements.is_present; ++i) {
    elements[i] = read(accessor.elements.bytes.substr(i * accessor.elements.stride, element_bytes));
  }
  apply_sparse(accessor, element_bytes, elements, read);
  return elements;
}

}  // namespace

GltfAccessors::View GltfAccessors::view(const JsonItem& user) {
  const JsonItem item = description_.item("bufferViews", user.whole("bufferView"), "buffer view", user);
  const std::string_view buffer = buffers_.bytes(item.whole("buffer"), item);
  const std::uint64_t offset = item.whole("byteOffset", 0), length = item.whole("byteLength");
  if (length == 0) item.refuse("has no bytes");
  if (offset > buffer.size() || length > buffer.size() - offset) {
    item.refuse("its " + std::to_string(length) + " bytes from byte " + std::to_string(offset) + " leave buffer " +
                std::to_string(item.whole("buffer")) + " of " + std::to_string(buffer.size()) + " bytes");
  }
  View view{item.name(), buffer.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length)), offset, 0};
  if (item.has("byteStride")) {
    const std::uint64_t stride = item.whole("byteStride");
    if (stride < 4 || stride > 252 || stride % 4 != 0) item.refuse("byteStride is not a multiple of 4 from 4 to 252");
    view.stride = static_cast<std::size_t>(stride);
  }
  return view;
}

GltfElements GltfAccessors::elements(const JsonItem& item, std::uint64_t count, std::size_t element_bytes,
                                     std::size_t component_bytes, bool may_have_stride) {
  const View in = view(item);
  const std::uint64_t offset = item.whole("byteOffset", 0);
  if (offset % component_bytes != 0 || in.offset % component_bytes != 0) {
    item.refuse("is not aligned to components of " + std::to_string(component_bytes) + " bytes");
  }
  if (in.stride != 0 && !may_have_stride) item.refuse(in.name + " must not have a byteStride");
  const std::size_t stride = in.stride == 0 ? element_bytes : in.stride;
  if (stride < element_bytes) item.refuse(in.name + " has a byteStride smaller than an element");
  if (offset > in.bytes.size() || element_bytes > in.bytes.size() - offset ||
      count - 1 > (in.bytes.size() - offset - element_bytes) / stride) {
    item.refuse("its " + std::to_string(count) + " elements from byte " + std::to_string(offset) + " leave " + in.name +
                " of " + std::to_string(in.bytes.size()) + " bytes");
  }
  return {in.bytes.substr(static_cast<std::size_t>(offset)), stride, true};
}

GltfAccessor GltfAccessors::check(std::uint64_t index, const JsonItem& user, Kind kind) {
  const JsonItem item = description_.item("accessors", index, "accessor", user);
  const bool is_position = kind == Kind::position;
  const std::uint64_t component_type = item.whole("componentType");
  GltfAccessor result;
  result.name = item.name();
  if (is_position) {
    if (component_type != float32) {
      item.refuse("positions of component type " + std::to_string(component_type) + " are not read, only of float",
                  ErrorCode::unsupported_format);
    }
    if (item.text("type") != "VEC3")
      item.refuse("positions are of type " + in_quotes(item.text("type")) + ", not VEC3");
    result.component_bytes = 4;
  } else {
    const std::optional<std::size_t> bytes = bytes_of_unsigned(component_type);
    if (!bytes)
      item.refuse("indices of component type " + std::to_string(component_type) + " are no unsigned integers");
    if (item.text("type") != "SCALAR")
      item.refuse("indices are of type " + in_quotes(item.text("type")) + ", not SCALAR");
    result.component_bytes = *bytes;
  }
  if (item.flag("normalized")) item.refuse("must not be normalized");
  const std::size_t element_bytes = is_position ? 3 * result.component_bytes : result.component_bytes;
  const std::uint64_t count = item.whole("count");
  if (count == 0) item.refuse("has no elements");
  if (count >= no_id) item.refuse("has more elements than ids can count", ErrorCode::too_large);
  result.count = static_cast<std::size_t>(count);
  if (item.has("bufferView")) {
    result.elements = elements(item, count, element_bytes, result.component_bytes, is_position);
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
  const std::optional<std::size_t> index_bytes = bytes_of_unsigned(indices.whole("componentType"));
  if (!index_bytes) indices.refuse("componentType is not that of unsigned integers");
  result.sparse_count = static_cast<std::size_t>(count);
  result.sparse_index_bytes = *index_bytes;
  result.sparse_indices = elements(indices, count, *index_bytes, *index_bytes, false).bytes;
  result.sparse_values = elements(values, count, element_bytes, result.component_bytes, false).bytes;
}

std::vector<Vec3> read_positions(const GltfAccessor& accessor) {
  return read_elements<Vec3>(accessor, 12, [](std::string_view raw) {
    return Vec3{float_number(raw.substr(0, 4)), float_number(raw.substr(4, 4)), float_number(raw.substr(8, 4))};
  });
}

std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor) {
  return read_elements<std::uint32_t>(accessor, accessor.component_bytes, [](std::string_view raw) {
    return static_cast<std::uint32_t>(unsigned_number(raw));
  });
}

}  // namespace limber::io
