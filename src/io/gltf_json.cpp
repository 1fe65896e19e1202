// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "limber/io.h"

namespace limber::io {
namespace {

/// Recursion is bounded by `mesh_file_limits::gltf_json_depth`.
std::size_t count_properties(const Json& json) {
  std::size_t count = json.is_object() ? json.size() : 0;
  for (const Json& value : json) count += value.is_structured() ? count_properties(value) : 0;
  return count;
}

}  // namespace

Json parse_json(std::string_view text) {
  // The limits are checked before anything is built.
  std::size_t depth = 0, largest_depth = 0, value_count = 1, property_count = 0;
  bool is_in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') is_in_string = !is_in_string;
    if (is_in_string) {
      i += c == '\\' ? 1 : 0;  // whatever it stands before
      continue;
    }
    const bool opens = c == '[' || c == '{', closes = c == ']' || c == '}';
    if (closes && depth > 0) --depth;
    if (opens) largest_depth = std::max(largest_depth, ++depth);
    if (opens || c == ',') ++value_count;
    if (c == ':') ++property_count;
  }
  const auto refuse_above = [](std::size_t limit, std::size_t count, const char* what) {
    if (count <= limit) return;
    throw BadResult({ErrorCode::too_large, "has a JSON description of more than " + std::to_string(limit) + what, {}});
  };
  refuse_above(mesh_file_limits::gltf_json_depth, largest_depth, " levels");
  refuse_above(mesh_file_limits::gltf_json_values, value_count, " values");

  Json json;
  try {
    json = Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    throw malformed("is not valid JSON at byte " + std::to_string(error.byte) + " of its description");
  } catch (const Json::exception&) {
    throw malformed("has a number in its JSON description that float64 cannot hold");
  }
  if (count_properties(json) != property_count) {
    throw malformed("has an object with two properties of one name in its JSON description");
  }
  return json;
}

JsonItem::JsonItem(const Json& json, std::string name) : json_(&json), name_(std::move(name)) {
  if (!json.is_object()) refuse("is not a JSON object");
}

void JsonItem::refuse(const std::string& reason, ErrorCode code) const {
  throw BadResult({code, name_.empty() ? reason : name_ + ": " + reason, {}});
}

const Json& JsonItem::at(const char* key) const {
  const auto found = json_->find(key);
  if (found == json_->end()) refuse("has no " + std::string(key));
  return *found;
}

std::uint64_t JsonItem::whole(const char* key, std::optional<std::uint64_t> otherwise) const {
  if (otherwise && !has(key)) return *otherwise;
  return whole_entry(at(key), *this, key);
}

std::string_view JsonItem::text(const char* key, std::optional<std::string_view> otherwise) const {
  if (otherwise && !has(key)) return *otherwise;
  const Json& value = at(key);
  if (!value.is_string()) refuse(std::string(key) + " is not a string");
  return value.get_ref<const std::string&>();
}

bool JsonItem::flag(const char* key, bool otherwise) const {
  if (!has(key)) return otherwise;
  if (!at(key).is_boolean()) refuse(std::string(key) + " is neither true nor false");
  return at(key).get<bool>();
}

std::vector<double> JsonItem::numbers(const char* key, std::optional<std::size_t> count,
                                      std::vector<double> otherwise) const {
  if (!has(key)) return otherwise;
  std::vector<double> values;
  for (const Json& entry : list(key)) {
    if (!entry.is_number()) refuse(std::string(key) + " holds something that is not a number");
    values.push_back(entry.get<double>());
  }
  if (count && values.size() != *count)
    refuse(std::string(key) + " does not have " + std::to_string(*count) + " numbers");
  return values;
}

const Json::array_t& JsonItem::list(const char* key) const {
  static const Json::array_t none;
  if (!has(key)) return none;
  if (!at(key).is_array()) refuse(std::string(key) + " is not a list");
  return at(key).get_ref<const Json::array_t&>();
}

JsonItem JsonItem::item(const char* key) const { return {at(key), name_.empty() ? key : name_ + " " + key}; }

std::optional<JsonItem> JsonItem::extension(const char* name) const {
  if (!has("extensions")) return {};
  const JsonItem extensions = item("extensions");
  return extensions.has(name) ? std::optional(extensions.item(name)) : std::nullopt;
}

JsonItem JsonItem::item(const char* key, std::uint64_t index, const char* kind, const JsonItem& user) const {
  const Json::array_t& entries = list(key);
  std::string name = std::string(kind) + " " + std::to_string(index);
  if (index >= entries.size()) user.refuse("names " + name + ", but there are only " + std::to_string(entries.size()));
  return {entries[static_cast<std::size_t>(index)], std::move(name)};
}

std::uint64_t whole_entry(const Json& entry, const JsonItem& user, const char* key) {
  if (!entry.is_number_unsigned()) user.refuse(std::string(key) + " is not a whole number from 0 to 2^64 - 1");
  return entry.get<std::uint64_t>();
}

}  // namespace limber::io
