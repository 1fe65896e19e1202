// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <memory>
#include <optional>

#include "gil.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "model_object.h"
#include "poses.h"

/// Keyword arguments that queries share.
namespace limber::python {

/// What ends a query from another thread.
class CancelFlag {
 public:
  void set() { flag_.store(true); }
  void clear() { flag_.store(false); }
  bool is_set() const { return flag_.load(); }
  const std::atomic<bool>& flag() const { return flag_; }

 private:
  std::atomic<bool> flag_ = false;
};

/// A budget. Whoever creates it keeps the flag alive.
struct BudgetObject {
  /// `deadline` counts the seconds of time.monotonic().
  ///
  /// Throws   nb::value_error for a deadline that is not a number.
  BudgetObject(std::optional<double> deadline, std::optional<std::uint64_t> max_steps, const CancelFlag* cancel);

  QueryBudget budget;
};

/// Two models that are read until the call returns, and where they stand.
class PlacedPair {
 public:
  PlacedPair(ModelObject& a, ModelObject& b, nb::handle pose_a, nb::handle pose_b)
      : reading_a_(reading(a)),
        reading_b_(reading(b)),
        a_(a.model, pose_from(pose_a, "pose_a")),
        b_(b.model, pose_from(pose_b, "pose_b")) {}

  const Placed& a() const { return a_; }
  const Placed& b() const { return b_; }

 private:
  Reading reading_a_, reading_b_;
  Placed a_, b_;
};

/// The cache that a query uses, if it was given one. `Object` holds it as Python does.
template <typename Object>
class Used {
 public:
  explicit Used(Object* object) : object_(object) {
    if (object == nullptr) return;
    object->users.begin_changing("the cache is in use by another thread, or by a query that has not returned");
  }
  Used(const Used&) = delete;
  Used& operator=(const Used&) = delete;
  ~Used() {
    if (object_ != nullptr) object_->users.end_changing();
  }
  auto* get() const { return object_ != nullptr ? &object_->cache : nullptr; }

 private:
  Object* object_;
};

/// The budget that a query gets: without limits if Python gave none.
inline QueryBudget budget_of(const BudgetObject* budget) { return budget != nullptr ? budget->budget : QueryBudget{}; }

/// A filter of pairs as Python passes it: None, rings of neighbors, or something that is called with two ids.
template <typename FilterRef>
class PairFilter {
 public:
  explicit PairFilter(nb::handle filter) {
    if (filter.is_none()) return;
    if constexpr (std::is_same_v<FilterRef, TrianglePairFilter>) {
      if (nb::try_cast(filter, rings_)) return;
    }
    if (PyCallable_Check(filter.ptr()) == 0) throw nb::type_error("filter: expected None or something to call");
    predicate_ = {nb::borrow(filter)};
  }

  /// Whether the query has to hold the GIL.
  bool needs_gil() const { return predicate_.function.is_valid(); }

  /// For the options of a query; refers to this object.
  std::optional<FilterRef> get() const {
    if (needs_gil()) return FilterRef(predicate_);
    if constexpr (std::is_same_v<FilterRef, TrianglePairFilter>) {
      if (rings_ != nullptr) return FilterRef(*rings_);
    }
    return std::nullopt;
  }

 private:
  struct Predicate {
    nb::object function;
    bool operator()(std::uint32_t a, std::uint32_t b) const { return nb::cast<bool>(nb::bool_(function(a, b))); }
  };
  Predicate predicate_;
  const NeighborRings* rings_ = nullptr;
};

using TriangleFilter = PairFilter<TrianglePairFilter>;

}  // namespace limber::python
