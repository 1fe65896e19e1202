// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "interrupts.h"
#include "limber/points.h"
#include "records.h"

namespace limber::python {

/// A closed surface, and the model that it refers to.
class ClosedSurfaceObject {
  static ClosedSurface checked(ModelObject& model) {
    return value_or_raise(aside(model.model.mesh().triangles().size(),
                                [&body = model.model, use = InUse(model)] { return ClosedSurface::create(body); }));
  }

  template <typename Query>
  auto ask(const ArrayLike& point, const PoseLike& pose, const Query& query) {
    const Reading guard = reading(model_);
    const Vec3 p = point_from(point, "point");
    const Transform placed = pose_from(pose, "pose");
    return without_gil([&] { return query(p, placed); });
  }

 public:
  explicit ClosedSurfaceObject(nb::handle_t<ModelObject> model)
      : owner_(nb::borrow(model)), model_(nb::cast<ModelObject&>(model)), surface_(checked(model_)) {}

  Named<"Model"> model() const { return nb::object(owner_); }

  int visit_references(visitproc visit, void* argument) const { return visit(owner_.ptr(), argument); }

  /// Nobody changes the model for as long as the result lives.
  [[nodiscard]] Reading reading_model() { return reading(model_); }
  Users& users() { return model_.users(); }
  const ClosedSurface& surface() const { return surface_; }

  bool contains(const ArrayLike& point, const PoseLike& pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.contains(p, t); });
  }

  std::optional<int> winding_number(const ArrayLike& point, const PoseLike& pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.winding_number(p, t); });
  }

  SignedDistance signed_distance(const ArrayLike& point, const PoseLike& pose, double max_distance) {
    return ask(point, pose,
               [&](const Vec3& p, const Transform& t) { return surface_.signed_distance(p, t, {max_distance}); });
  }

  Named<"NDArray[numpy.bool_]"> contains_many(const ArrayLike& points, const PoseLike& pose,
                                              const BudgetObject* budget) {
    const Reading guard = reading(model_);
    const std::vector<Vec3> asked = points_from(points, "points");
    const Transform placed = pose_from(pose, "pose");
    nb::object answers = new_array(nb::str("bool"), {asked.size()});
    auto* const inside = static_cast<bool*>(memory_of(answers, asked.size()));
    const auto ask_part = [&](std::size_t begin, std::size_t end, const QueryBudget&) {
      constexpr std::size_t grain = 16;
      using Range = oneapi::tbb::blocked_range<std::size_t>;
      oneapi::tbb::parallel_for(Range(begin, end, grain), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) inside[i] = surface_.contains(asked[i], placed);
      });
      return end - begin;
    };
    return in_parts(asked.size(), has_bad_point(asked), budget, Spent::leaves_out, ask_part,
                    [&](std::size_t done) { return first(answers, done); });
  }

  RecordArray signed_distance_many(const ArrayLike& points, const PoseLike& pose, double max_distance,
                                   const BudgetObject* budget) {
    const Reading guard = reading(model_);
    const std::vector<Vec3> asked = points_from(points, "points");
    const Transform placed = pose_from(pose, "pose");
    const auto ask_part = [&](auto part, auto results, const QueryBudget&) {
      surface_.signed_distance_many(part, results, placed, {max_distance});
    };
    return recorded_in_parts<SignedDistance>(asked, has_bad_point(asked), budget, Spent::leaves_out,
                                             dtypes().signed_distance, ask_part);
  }

 private:
  nb::object owner_;
  ModelObject& model_;
  ClosedSurface surface_;
};

/// A closed surface with its inside. Whoever creates it keeps the surface alive.
class SolidObject : public BodyObject {
 public:
  explicit SolidObject(ClosedSurfaceObject& surface) : surface_(surface) {}
  /// Throws   std::invalid_argument if the model has been reset.
  Body body() const override { return Body(surface_.surface()); }
  Users& users() override { return surface_.users(); }
  nb::object reduced() const override {
    return nb::make_tuple(nb::module_::import_("operator").attr("methodcaller")("solid"),
                          nb::make_tuple(nb::find(surface_)));
  }

 private:
  ClosedSurfaceObject& surface_;
};

}  // namespace limber::python
