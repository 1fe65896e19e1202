// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_buffers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace limber::io {
namespace {

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
  Result<std::string> bytes = external_(*path, bytes_left_);
  if (!bytes) {
    const bool is_too_large = bytes.error().code == ErrorCode::too_large;
    buffer.refuse(in_quotes(*path, shown_uri_length) + " " + bytes.error().text,
                  is_too_large ? ErrorCode::too_large : ErrorCode::malformed_file);
  }
  bytes_left_ -= std::min<std::uint64_t>(bytes_left_, bytes->size());
  return files_.emplace(*path, std::move(*bytes)).first->second;
}

}  // namespace limber::io
