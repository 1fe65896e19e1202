// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "records.h"

/// Classes of values, such as results: fields that are read, and what follows from them.
namespace limber::python {

/// A field as it is compared, written and pickled: three numbers are a tuple, everything else is what Python gets.
template <typename Field>
nb::object plain(const Field& field) {
  if constexpr (std::is_same_v<Field, Vec3>) {
    const auto& [x, y, z] = field;
    return nb::make_tuple(x, y, z);
  } else if constexpr (std::is_same_v<Field, ObjectPair>) {
    return field.a == no_id ? nb::object(nb::none()) : nb::make_tuple(field.a, field.b);
  } else {
    return nb::cast(field, nb::rv_policy::copy);
  }
}

/// The reverse of plain(). Throws nb::python_error or nb::cast_error for something else.
template <typename Field>
void assign(Field& field, nb::handle value) {
  if constexpr (std::is_same_v<Field, Vec3>) {
    field = {nb::cast<double>(value[0]), nb::cast<double>(value[1]), nb::cast<double>(value[2])};
  } else if constexpr (std::is_same_v<Field, ObjectPair>) {
    if (!value.is_none()) field = {nb::cast<ObjectId>(value[0]), nb::cast<ObjectId>(value[1])};
  } else {
    field = nb::cast<Field>(value);
  }
}

/// The fields of a class of values, and what follows from them.
template <typename Value>
struct Fields {
  struct Field {
    const char* name;
    std::function<nb::object(const Value&)> read;
    std::function<void(Value&, nb::handle)> write;
  };

  const char* class_name;
  std::vector<Field> all;

  nb::tuple state(const Value& value) const {
    nb::list state;
    for (const Field& field : all) state.append(field.read(value));
    return nb::tuple(state);
  }

  Value restored(const nb::tuple& state) const {
    if (state.size() != all.size()) throw nb::value_error("the state has other fields");
    Value value;
    for (std::size_t i = 0; i < all.size(); ++i) all[i].write(value, state[i]);
    return value;
  }

  std::string text(const Value& value) const {
    const nb::object enumeration = nb::module_::import_("enum").attr("Enum");
    std::string fields;
    for (const Field& field : all) {
      const nb::object content = field.read(value);
      const nb::str written = nb::isinstance(content, enumeration) ? nb::str(content) : nb::repr(content);
      fields.append(fields.empty() ? "" : ", ").append(field.name).append("=").append(written.c_str());
    }
    return std::string(class_name).append("(").append(fields).append(")");
  }
};

/// Binds a class of values. Its fields are read-only; two values are equal where all of their fields are; repr(),
/// hash(), copies and pickles consist of the fields.
template <typename Value>
class ValueClass {
 public:
  ValueClass(nb::module_& module, const char* name, const char* documentation) : class_(module, name, documentation) {
    fields_->class_name = name;
    class_.def("__repr__", [f = fields_](const Value& value) { return f->text(value); })
        .def(
            "__eq__", [f = fields_](const Value& a, const Value& b) { return f->state(a).equal(f->state(b)); },
            nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__hash__", [f = fields_](const Value& value) { return nb::hash(f->state(value)); })
        .def(
            "__getstate__", [f = fields_](const Value& value) { return f->state(value); },
            nb::sig("def __getstate__(self) -> tuple[Any, ...]"))
        .def(
            "__setstate__",
            [f = fields_](Value& value, const nb::tuple& state) { new (&value) Value(f->restored(state)); },
            nb::sig("def __setstate__(self, state: tuple[Any, ...], /) -> None"));
  }

  template <typename Field>
  ValueClass& field(const char* name, Field Value::*member, const char* documentation) {
    const auto read = [member](const Value& value) { return plain(value.*member); };
    fields_->all.push_back({name, read, [member](Value& value, nb::handle from) { assign(value.*member, from); }});
    if constexpr (std::is_same_v<Field, Vec3>) {
      class_.def_prop_ro(
          name, [member](const Value& value) { return read_only(array_of(value.*member)); }, documentation);
    } else if constexpr (std::is_same_v<Field, ObjectPair>) {
      using Pair = Named<"tuple[int, int] | None">;
      class_.def_prop_ro(
          name, [read](const Value& value) { return Pair(read(value)); }, documentation);
    } else {
      class_.def_ro(name, member, documentation);
    }
    return *this;
  }

  /// A field that is an id, or None for no_id.
  ValueClass& id_or_none(const char* name, std::uint32_t Value::*member, const char* documentation) {
    using Id = std::optional<std::uint32_t>;
    const auto read = [member](const Value& value) { return value.*member == no_id ? Id() : Id(value.*member); };
    const auto write = [member](Value& value, nb::handle from) { value.*member = nb::cast<Id>(from).value_or(no_id); };
    fields_->all.push_back({name, [read](const Value& value) { return nb::cast(read(value)); }, write});
    class_.def_prop_ro(name, read, documentation);
    return *this;
  }

  /// For what is no field.
  nb::class_<Value>& binding() { return class_; }

 private:
  std::shared_ptr<Fields<Value>> fields_ = std::make_shared<Fields<Value>>();
  nb::class_<Value> class_;
};

}  // namespace limber::python
