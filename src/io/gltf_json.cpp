// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_json.h"

#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/io.h"

namespace limber::io {
namespace {

/// Builds the tree of values while the parser, which does not recurse, reports them one by one.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder() noexcept(false) = default;
  Builder(const Builder&) = delete;  // it points into itself
  Builder& operator=(const Builder&) = delete;

  Json take() { return std::move(root_); }
  const std::optional<Error>& error() const { return error_; }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return fail(malformed("is not JSON")); }
  bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    LIMBER_ASSERT(!open_.empty() && open_.back()->is_object());
    const auto [entry, is_new] = open_.back()->emplace(name, nullptr);
    if (!is_new) return fail(malformed("has an object with two properties " + in_quotes(name)));
    named_ = &*entry;
    return true;
  }

  bool parse_error(std::size_t position, const std::string& /*token*/, const Json::exception& /*why*/) override {
    return fail(malformed("is not valid JSON at byte " + std::to_string(position) + " of its description"));
  }

 private:
  bool fail(Error error) {
    error_ = std::move(error);
    return false;
  }

  /// Adds a value to the innermost open list or object. Pointers to outer ones stay valid, since only that one grows.
  bool add(Json value) {
    if (++value_count_ > mesh_file_limits::gltf_json_values) {
      return fail(
          {ErrorCode::too_large,
           "has a JSON description of more than " + std::to_string(mesh_file_limits::gltf_json_values) + " values",
           {}});
    }
    if (open_.empty()) {
      root_ = std::move(value);
      latest_ = &root_;
    } else if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      latest_ = &open_.back()->back();
    } else {
      *named_ = std::move(value);
      latest_ = named_;
    }
    return true;
  }

  bool open(Json value) {
    if (open_.size() >= mesh_file_limits::gltf_json_depth) {
      return fail(
          {ErrorCode::too_large,
           "has a JSON description nested deeper than " + std::to_string(mesh_file_limits::gltf_json_depth) + " levels",
           {}});
    }
    if (!add(std::move(value))) return false;
    open_.push_back(latest_);
    return true;
  }

  bool close() {
    LIMBER_ASSERT(!open_.empty());
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Json*> open_;  // lists and objects that have not ended, outermost first
  Json* named_ = nullptr;    // the value of the property whose name came last
  Json* latest_ = nullptr;
  std::size_t value_count_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Json parse_json(std::string_view text) {
  Builder builder;
  Json::sax_parse(text.begin(), text.end(), &builder);
  if (builder.error()) throw BadResult(*builder.error());
  return builder.take();
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

std::string_view JsonItem::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) refuse(std::string(key) + " is not a string");
  return value.get_ref<const std::string&>();
}

bool JsonItem::flag(const char* key) const {
  if (!has(key)) return false;
  if (!at(key).is_boolean()) refuse(std::string(key) + " is neither true nor false");
  return at(key).get<bool>();
}

const Json::array_t& JsonItem::list(const char* key) const {
  static const Json::array_t none;
  if (!has(key)) return none;
  if (!at(key).is_array()) refuse(std::string(key) + " is not a list");
  return at(key).get_ref<const Json::array_t&>();
}

JsonItem JsonItem::item(const char* key) const { return {at(key), name_.empty() ? key : name_ + " " + key}; }

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
