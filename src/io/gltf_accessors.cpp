// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "base/check.h"
#include "io/scan.h"

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

constexpr std::size_t shown_uri_length = 80;

/// Decodes base64 (RFC 4648, section 4), with or without padding; none for other text.
std::optional<std::string> decoded_base64(std::string_view text) {
  static constexpr auto value_of = [] {
    std::array<signed char, 256> values{};
    values.fill(-1);
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < digits.size(); ++i) {
      values[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
    }
    return values;
  }();
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1) return {};
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (const char c : text) {
    const signed char value = value_of[static_cast<unsigned char>(c)];
    if (value < 0) return {};
    bits = bits << 6U | static_cast<unsigned char>(value);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += static_cast<char>(bits >> bit_count & 0xffU);
  }
  return bytes;
}

/// Replaces %20 and the like (RFC 3986, section 2.1); none when a percent sign starts no two digits.
std::optional<std::string> percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    text += uri[i];
    if (uri[i] != '%') continue;
    const std::string_view digits = uri.substr(i + 1, 2);
    unsigned value = 0;
    if (digits.size() < 2 || std::from_chars(digits.data(), digits.data() + 2, value, 16).ptr != digits.data() + 2) {
      return {};
    }
    text.back() = static_cast<char>(value);
    i += 2;
  }
  return text;
}

/// Whether a decoded path stays below the folder it is relative to, symbolic links aside.
bool stays_in_folder(std::string_view path) {
  if (path.empty() || path.starts_with('/') || path.find_first_of(std::string_view("\\\0", 2)) != path.npos) {
    return false;
  }
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    if (path.substr(0, end) == "..") return false;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return true;
}

}  // namespace

GltfBuffers::GltfBuffers(const JsonItem& description, std::optional<std::string_view> chunk,
                         const BufferSource& external, std::uint64_t max_bytes)
    : description_(description),
      chunk_(chunk),
      external_(external),
      max_bytes_(max_bytes),
      bytes_left_(max_bytes),
      loaded_(description.list("buffers").size()) {}

std::string_view GltfBuffers::bytes(std::uint64_t index, const JsonItem& user) {
  const JsonItem buffer = description_.item("buffers", index, "buffer", user);
  std::optional<std::string_view>& loaded = loaded_[static_cast<std::size_t>(index)];
  if (!loaded) {
    const std::string_view all = load(buffer, index);
    const std::uint64_t length = buffer.whole("byteLength");
    if (length > all.size()) {
      buffer.refuse("promises " + std::to_string(length) + " bytes but has " + std::to_string(all.size()));
    }
    loaded = all.substr(0, static_cast<std::size_t>(length));
  }
  return *loaded;
}

std::string_view GltfBuffers::load(const JsonItem& buffer, std::uint64_t index) {
  if (!buffer.has("uri")) {
    if (index != 0 || !chunk_) buffer.refuse("has no uri, and there is no binary chunk for it");
    return *chunk_;
  }
  const std::string_view uri = buffer.text("uri");
  constexpr std::string_view data_scheme = "data:", marker = ";base64";
  if (!uri.starts_with(data_scheme)) return load_file(buffer, uri);
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos || !uri.substr(0, comma).ends_with(marker)) buffer.refuse("has a data uri that is not base64");
  std::optional<std::string> bytes = decoded_base64(uri.substr(comma + 1));
  if (!bytes) buffer.refuse("has a data uri with characters or a length that base64 does not have");
  return decoded_.emplace(index, std::move(*bytes)).first->second;
}

std::string_view GltfBuffers::load_file(const JsonItem& buffer, std::string_view uri) {
  if (uri.find(':') < uri.find('/'))
    buffer.refuse("uri " + in_quotes(uri, shown_uri_length) + " is not a relative path");
  const std::optional<std::string> path = percent_decoded(uri);
  if (!path) buffer.refuse("uri " + in_quotes(uri, shown_uri_length) + " has a percent sign without two digits");
  if (!stays_in_folder(*path)) {
    buffer.refuse("uri " + in_quotes(uri, shown_uri_length) + " is not a path below the folder of the glTF file");
  }
  const auto known = files_.find(*path);
  if (known != files_.end()) return known->second;
  if (!external_) buffer.refuse("uri " + in_quotes(uri, shown_uri_length) + " names a file, and none are read here");
  std::string bytes;
  try {
    bytes = external_(*path, bytes_left_);
  } catch (const BadResult& refused) {
    const bool is_too_large = refused.error().code == ErrorCode::too_large;
    buffer.refuse(in_quotes(*path, shown_uri_length) + " " + refused.error().text,
                  is_too_large ? ErrorCode::too_large : ErrorCode::malformed_file);
  }
  bytes_left_ -= std::min<std::uint64_t>(bytes_left_, bytes.size());
  return files_.emplace(*path, std::move(bytes)).first->second;
}

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
      throw malformed(accessor.name + ": sparse index " + std::to_string(at) +
                      (at < smallest_allowed ? " does not follow the one before it" : " names no element"));
    }
    smallest_allowed = at + 1;
    read(static_cast<std::size_t>(at), accessor.sparse_values.substr(i * n * size, n * size));
  }
  return numbers;
}

}  // namespace limber::io
