// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <optional>
#include <type_traits>

#include "arrays.h"
#include "bindings.h"
#include "limber/contacts.h"
#include "limber/scene.h"

/// Arguments that queries share.
namespace limber::python {

/// Two bodies that are read until the call returns, and where they stand.
class PlacedPair {
 public:
  PlacedPair(BodyObject& a, BodyObject& b, nb::handle pose_a, nb::handle pose_b)
      : reading_a_(reading(a)),
        reading_b_(reading(b)),
        a_(a.body(), pose_from(pose_a, "pose_a")),
        b_(b.body(), pose_from(pose_b, "pose_b")) {}

  const Placed& a() const { return a_; }
  const Placed& b() const { return b_; }

 private:
  Reading reading_a_, reading_b_;
  Placed a_, b_;
};

using WholeNumber = Named<"int">;  // that thread_count() looks at

/// How many threads an argument asks for; nothing for None.
///
/// Throws   nb::value_error for a number out of range, nb::python_error (TypeError) for what is no whole number.
std::optional<int> thread_count(nb::handle argument, const char* name);

using ObjectFilter = Named<"ObjectFilter">;  // of pairs

/// A filter of pairs as Python passes it: None, rings of neighbors for triangles, a matrix for objects, or something
/// that is called with two ids.
template <typename FilterRef>
class PairFilter {
 public:
  explicit PairFilter(nb::handle filter) {
    if (filter.is_none()) return;
    if constexpr (has_rings) {
      if (nb::try_cast(filter, rings_)) return;
    }
    if constexpr (has_matrix) {
      const ObjectPairMatrix* matrix = nullptr;
      if (nb::try_cast(filter, matrix)) {
        const nb::ft_object_guard lock(filter);
        matrix_ = *matrix;  // a copy: other threads may change theirs
        return;
      }
    }
    if (PyCallable_Check(filter.ptr()) == 0) throw nb::type_error("filter: expected None or something to call");
    predicate_ = {nb::borrow(filter)};
  }

  /// Whether the query has to hold the GIL.
  bool needs_gil() const { return predicate_.function.is_valid(); }

  /// The matrix that the filter is, if it is one.
  const std::optional<ObjectPairMatrix>& matrix() const { return matrix_; }

  /// For the options of a query; refers to this object.
  std::optional<FilterRef> get() const {
    if (needs_gil()) return FilterRef(predicate_);
    if constexpr (has_rings) {
      if (rings_ != nullptr) return FilterRef(*rings_);
    }
    if constexpr (has_matrix) {
      if (matrix_) return FilterRef(*matrix_);
    }
    return std::nullopt;
  }

 private:
  struct Predicate {
    nb::object function;
    bool operator()(std::uint32_t a, std::uint32_t b) const { return nb::cast<bool>(nb::bool_(function(a, b))); }
  };
  static constexpr bool has_rings = std::is_same_v<FilterRef, TrianglePairFilter>;
  static constexpr bool has_matrix = std::is_same_v<FilterRef, ObjectPairFilter>;
  Predicate predicate_;
  const NeighborRings* rings_ = nullptr;
  std::optional<ObjectPairMatrix> matrix_;
};

}  // namespace limber::python
