// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/soup.h"

/// The JSON description of a glTF file.
namespace limber::io {

using Json = nlohmann::json;

/// Parses a description.
///
/// Errors   `malformed_file` for what is not JSON and for names that an object has twice; `too_large` beyond
///          `mesh_file_limits::gltf_json_depth` or `gltf_json_values`.
Json parse_json(std::string_view text);

/// An object of the description with its name for messages, as "accessor 3"; the whole description has none.
class JsonItem {
 public:
  /// Errors   `malformed_file` unless `json` is an object.
  JsonItem(const Json& json, std::string name);

  const std::string& name() const { return name_; }
  bool has(const char* key) const { return json_->contains(key); }

  /// A whole number >= 0; without a default it must be there.
  std::uint64_t whole(const char* key, std::optional<std::uint64_t> otherwise = {}) const;
  std::string_view text(const char* key, std::optional<std::string_view> otherwise = {}) const;
  bool flag(const char* key, bool otherwise = false) const;
  /// The numbers of a list, `otherwise` when the property is missing.
  ///
  /// Errors   `malformed_file` unless there are `count`, where that is given.
  std::vector<double> numbers(const char* key, std::optional<std::size_t> count = {},
                              std::vector<double> otherwise = {}) const;
  /// The entries of a list, none when the property is missing.
  const Json::array_t& list(const char* key) const;
  JsonItem item(const char* key) const;
  std::optional<JsonItem> extension(const char* name) const;
  /// Entry `index` of a list of objects, named `kind` and index.
  JsonItem item(const char* key, std::uint64_t index, const char* kind, const JsonItem& user) const;

  [[noreturn]] void refuse(const std::string& reason, ErrorCode code = ErrorCode::malformed_file) const;

 private:
  const Json& at(const char* key) const;

  const Json* json_;
  std::string name_;
};

/// A whole number >= 0 that stands in a list of `user`.
std::uint64_t whole_entry(const Json& entry, const JsonItem& user, const char* key);

}  // namespace limber::io
