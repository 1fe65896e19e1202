// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "records.h"

/// Classes of values, such as results: fields that are read, and what follows from them.
namespace limber::python {

/// A field as it is compared, written and pickled: vectors are tuples, everything else is what Python gets anyway.
template <typename Field>
nb::object plain(const Field& field) {
  return nb::cast(field, nb::rv_policy::copy);
}
inline nb::object plain(const Vec3& vector) { return nb::make_tuple(vector.x, vector.y, vector.z); }
inline nb::object plain(const std::array<double, 3>& numbers) {
  return nb::make_tuple(numbers[0], numbers[1], numbers[2]);
}
inline nb::object plain(const ObjectPair& pair) {
  if (pair.a == no_id) return nb::none();
  return nb::make_tuple(pair.a, pair.b);
}

/// The reverse of plain(). Throws nb::python_error or nb::cast_error for something else.
template <typename Field>
void assign(Field& field, nb::handle value) {
  field = nb::cast<Field>(value);
}
inline void assign(std::array<double, 3>& numbers, nb::handle value) {
  for (std::size_t i = 0; i < 3; ++i) numbers[i] = nb::cast<double>(value[i]);
}
inline void assign(Vec3& vector, nb::handle value) {
  std::array<double, 3> numbers;
  assign(numbers, value);
  vector = {numbers[0], numbers[1], numbers[2]};
}
inline void assign(ObjectPair& pair, nb::handle value) {
  if (!value.is_none()) pair = {nb::cast<ObjectId>(value[0]), nb::cast<ObjectId>(value[1])};
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
    if constexpr (std::is_same_v<Field, Vec3> || std::is_same_v<Field, std::array<double, 3>>) {
      class_.def_prop_ro(
          name, [member](const Value& value) { return array_of(value.*member); }, documentation);
    } else if constexpr (std::is_same_v<Field, ObjectPair>) {
      using Pair = Named<"tuple[int, int] | None">;
      class_.def_prop_ro(
          name, [read](const Value& value) { return Pair(read(value)); }, documentation);
    } else {
      class_.def_ro(name, member, documentation);
    }
    return *this;
  }

  /// For what is no field.
  nb::class_<Value>& binding() { return class_; }

 private:
  std::shared_ptr<Fields<Value>> fields_ = std::make_shared<Fields<Value>>();
  nb::class_<Value> class_;
};

}  // namespace limber::python
