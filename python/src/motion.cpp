// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "budget.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"
#include "value_class.h"

namespace limber::python {
namespace {

/// A moving model, which shares its model with Python.
class MovingModelObject {
 public:
  explicit MovingModelObject(ModelObject& model) : model_(model), moving_(model.model) {}

  void set_motion(const ArrayLike& end_positions, const PoseLike& start_pose, const PoseLike& end_pose) {
    Motion motion{points_from(end_positions, "end_positions"), pose_from(start_pose, "start_pose"),
                  pose_from(end_pose, "end_pose")};
    const std::size_t size = motion.end.size();
    value_or_raise(aside(
        size, [this, motion = std::move(motion), owner = nb::find(*this),
               own = users_.change("the moving model is in use by another thread"), guard = reading(model_)]() mutable {
          Result<void> is_set = moving_.set_motion(motion.end, motion.start_pose, motion.end_pose);
          if (is_set) motion_ = std::move(motion);
          return is_set;
        }));
  }

  nb::tuple reduced() {
    const Reading own = reading_motion();
    nb::object motion = nb::none();
    const auto end = [&] { return array_of(std::span<const Vec3>(motion_->end)); };
    if (motion_) motion = nb::make_tuple(end(), array_of(motion_->start_pose), array_of(motion_->end_pose));
    return restored_by(nb::type<MovingModelObject>(), nb::make_tuple(nb::find(model_)), motion);
  }

  /// A moving model, and the right to read it and its model while a query runs.
  struct InUse {
    nb::object owner;
    Reading own, model;
    const MovingModel& moving;
  };
  InUse use() {
    Reading own = reading_motion();
    Reading model = reading(model_);
    if (!motion_) throw nb::value_error("the moving model has no motion: call set_motion()");
    return {nb::find(*this), std::move(own), std::move(model), moving_};
  }

 private:
  /// The arguments of set_motion(), for pickles.
  struct Motion {
    std::vector<Vec3> end;
    Transform start_pose, end_pose;
  };
  Reading reading_motion() { return users_.read("the motion is being set by another thread"); }
  ModelObject& model_;
  Users users_;
  MovingModel moving_;
  std::optional<Motion> motion_;
};

/// A filter as Python passes it: called with an ElementPair.
struct ElementFilter {
  nb::object function;
  bool operator()(const ElementPair& pair) const { return nb::cast<bool>(nb::bool_(function(pair))); }
};

/// The options that all queries have, and whether they need the GIL.
struct ImpactArguments {
  ImpactArguments(double max_time, double time_error, double min_separation, double separation_fraction,
                  nb::handle filter, bool parallel, const BudgetObject* limits)
      : options{max_time, time_error, min_separation, separation_fraction}, budget(limits) {
    options.parallel = parallel && filter.is_none();  // this thread holds the GIL
    if (filter.is_none()) return;
    if (PyCallable_Check(filter.ptr()) == 0) throw nb::type_error("filter: expected None or something to call");
    predicate = {nb::borrow(filter)};
    options.filter.emplace(predicate);
  }
  ImpactArguments(const ImpactArguments&) = delete;
  ImpactArguments& operator=(const ImpactArguments&) = delete;

  /// Returns query(options).
  template <typename Query>
  auto ask(const Query& query) {
    const auto within = [&](const QueryBudget& limits) {
      options.budget = limits;
      return query(static_cast<const ImpactOptions&>(options));
    };
    return interruptible(budget, within, options.filter.has_value());
  }

  ElementFilter predicate;
  ImpactOptions options;
  const BudgetObject* budget;
};

ImpactResult time_of_impact_of(MovingModelObject& a, MovingModelObject& b, double max_time, double time_error,
                               double min_separation, double separation_fraction, bool ignore_crossings,
                               bool any_contact, nb::handle filter, bool parallel, const BudgetObject* budget) {
  ImpactArguments given(max_time, time_error, min_separation, separation_fraction, filter, parallel, budget);
  given.options.ignore_crossings = ignore_crossings, given.options.any_contact = any_contact;
  const auto use_a = a.use(), use_b = b.use();
  return given.ask([&](const ImpactOptions& options) { return time_of_impact(use_a.moving, use_b.moving, options); });
}

ImpactResult self_time_of_impact_of(MovingModelObject& model, double max_time, double time_error, double min_separation,
                                    double separation_fraction, bool ignore_crossings, bool any_contact,
                                    nb::handle filter, bool parallel, const BudgetObject* budget) {
  ImpactArguments given(max_time, time_error, min_separation, separation_fraction, filter, parallel, budget);
  given.options.ignore_crossings = ignore_crossings, given.options.any_contact = any_contact;
  const auto use = model.use();
  return given.ask([&](const ImpactOptions& options) { return self_time_of_impact(use.moving, options); });
}

/// The pairs that search(visitor, options) visits, without the GIL, as a result of that class.
template <typename Pair, typename Search>
nb::object found_impacts(const char* class_name, nb::handle dtype, ImpactArguments& given, const Search& search) {
  std::deque<Pair> pairs;
  const PairCount count = given.ask([&](const ImpactOptions& options) {
    pairs.clear();
    return search([&](const Pair& pair) { return pairs.push_back(pair), !*options.budget.abandon; }, options);
  });
  return found(class_name, array_of(pairs, dtype), count);
}

Named<"Impacts"> impacts_of(MovingModelObject& a, MovingModelObject& b, double max_time, double time_error,
                            double min_separation, double separation_fraction, bool parallel,
                            const BudgetObject* budget) {
  ImpactArguments given(max_time, time_error, min_separation, separation_fraction, nb::none(), parallel, budget);
  const auto use_a = a.use(), use_b = b.use();
  return found_impacts<Impact>("Impacts", dtypes().impact, given, [&](auto visit, const ImpactOptions& options) {
    return visit_impacts(use_a.moving, use_b.moving, visit, options);
  });
}

Named<"Impacts"> self_impacts_of(MovingModelObject& model, double max_time, double time_error, double min_separation,
                                 double separation_fraction, bool parallel, const BudgetObject* budget) {
  ImpactArguments given(max_time, time_error, min_separation, separation_fraction, nb::none(), parallel, budget);
  const auto use = model.use();
  return found_impacts<Impact>("Impacts", dtypes().impact, given, [&](auto visit, const ImpactOptions& options) {
    return visit_self_impacts(use.moving, visit, options);
  });
}

Named<"ImpactCandidates"> impact_candidates_of(MovingModelObject& a, MovingModelObject& b, double max_time,
                                               double min_separation, bool parallel, const BudgetObject* budget) {
  ImpactArguments given(max_time, 0, min_separation, 0, nb::none(), parallel, budget);
  const auto use_a = a.use(), use_b = b.use();
  return found_impacts<ElementPair>("ImpactCandidates", dtypes().element_pair, given,
                                    [&](auto visit, const ImpactOptions& options) {
                                      return visit_impact_candidates(use_a.moving, use_b.moving, visit, options);
                                    });
}

Named<"ImpactCandidates"> self_impact_candidates_of(MovingModelObject& model, double max_time, double min_separation,
                                                    bool parallel, const BudgetObject* budget) {
  ImpactArguments given(max_time, 0, min_separation, 0, nb::none(), parallel, budget);
  const auto use = model.use();
  return found_impacts<ElementPair>("ImpactCandidates", dtypes().element_pair, given,
                                    [&](auto visit, const ImpactOptions& options) {
                                      return visit_self_impact_candidates(use.moving, visit, options);
                                    });
}

ElementState state_of_pair(MovingModelObject& a, MovingModelObject& b, const ElementPair& elements, double time) {
  const auto use_a = a.use(), use_b = b.use();
  return state_of(use_a.moving, use_b.moving, elements, time);
}

ElementState self_state_of_pair(MovingModelObject& model, const ElementPair& elements, double time) {
  const auto use = model.use();
  return self_state_of(use.moving, elements, time);
}

/// Displacements as Python passes them: an array of one number for each vertex.
std::vector<double> displacements_from(nb::handle object, const char* name) {
  constexpr const char* expected = "shape (v,) and dtype float32 or float64";
  const Array array(object, name, expected, Lists::floats);
  if (!array.has_numbers({-1})) array.refuse();
  return array.numbers();
}

FloatArray array_of_numbers(const std::vector<double>& numbers) {
  return array_of(std::span<const double>(numbers), nb::str("float64"), {numbers.size()});
}

FloatArray limit_self_displacements_of(ModelObject& model, double separation, const ArrayLike& displacements) {
  return array_of_numbers(aside(may_take_long(model.model, model.model) ? any_size : 0,
                                [&body = model.model, separation, use = InUse(model),
                                 limits = displacements_from(displacements, "displacements")]() mutable {
                                  limit_self_displacements(body, separation, limits);
                                  return limits;
                                }));
}

Named<"DisplacementLimits"> limits_of(const std::vector<double>& of_a, const std::vector<double>& of_b, nb::handle b) {
  const auto allowed_b = b.is_none() ? std::nullopt : std::optional<FloatArray>(array_of_numbers(of_b));
  return result("DisplacementLimits", "of_a"_a = array_of_numbers(of_a), "of_b"_a = allowed_b);
}

Named<"DisplacementLimits"> limit_displacements_of(ModelObject& a, ModelObject& b, double separation,
                                                   const ArrayLike& of_a, nb::handle of_b, const PoseLike& pose_a,
                                                   const PoseLike& pose_b) {
  std::vector<double> limits_a = displacements_from(of_a, "of_a"), limits_b;
  if (!of_b.is_none()) limits_b = displacements_from(of_b, "of_b");
  const Placed placed_a(a.model, pose_from(pose_a, "pose_a")), placed_b(b.model, pose_from(pose_b, "pose_b"));
  std::tie(limits_a, limits_b) =
      aside(may_take_long(a.model, b.model) ? any_size : 0, [=, use_a = InUse(a), use_b = InUse(b)]() mutable {
        limit_displacements(placed_a, placed_b, separation, limits_a, limits_b);
        return std::pair(limits_a, limits_b);
      });
  return limits_of(limits_a, limits_b, of_b);
}

FloatArray limit_self_motions_of(MovingModelObject& model, double separation, const ArrayLike& fractions) {
  return array_of_numbers(
      aside(any_size, [separation, use = model.use(), limits = displacements_from(fractions, "fractions")]() mutable {
        limit_self_motions(use.moving, separation, limits);
        return limits;
      }));
}

Named<"DisplacementLimits"> limit_motions_of(MovingModelObject& a, MovingModelObject& b, double separation,
                                             const ArrayLike& of_a, nb::handle of_b) {
  std::vector<double> limits_a = displacements_from(of_a, "of_a"), limits_b;
  if (!of_b.is_none()) limits_b = displacements_from(of_b, "of_b");
  std::tie(limits_a, limits_b) = aside(any_size, [=, use_a = a.use(), use_b = b.use()]() mutable {
    limit_motions(use_a.moving, use_b.moving, separation, limits_a, limits_b);
    return std::pair(limits_a, limits_b);
  });
  return limits_of(limits_a, limits_b, of_b);
}

// --- rigid bodies ---

PathImpact path_impact_of(BodyObject& a, const RigidMotion& motion_a, BodyObject& b, const RigidMotion& motion_b,
                          double max_time, double min_separation, std::optional<double> distance_error,
                          const BudgetObject* budget, QueryCacheObject* cache) {
  const Reading reading_a = reading(a), reading_b = reading(b);
  const Used used(cache);
  return interruptible(true, false, budget, used.get(), [&](const QueryBudget& limits) {
    const PathOptions options{max_time, min_separation, distance_error, used.get(), limits};
    return time_of_impact(a.body(), motion_a, b.body(), motion_b, options);
  });
}

PathDistance min_distance_of(BodyObject& a, const RigidMotion& motion_a, BodyObject& b, const RigidMotion& motion_b,
                             double max_time, std::optional<double> distance_error, const BudgetObject* budget,
                             QueryCacheObject* cache) {
  const Reading reading_a = reading(a), reading_b = reading(b);
  const Used used(cache);
  return interruptible(true, false, budget, used.get(), [&](const QueryBudget& limits) {
    const PathOptions options{max_time, 0, distance_error, used.get(), limits};
    return min_distance(a.body(), motion_a, b.body(), motion_b, options);
  });
}

FloatArray matrix_at(const RigidMotion& motion, double time) { return array_of(motion.at(time)); }

void bind_values(nb::module_& m) {
  nb::enum_<ImpactStatus>(m, "ImpactStatus", nb::is_arithmetic(), "Whether, and how, moving models touch.")
      .value("clear", ImpactStatus::clear, docs::ImpactStatus_clear)
      .value("contact", ImpactStatus::contact, docs::ImpactStatus_contact)
      .value("initial_contact", ImpactStatus::initial_contact, docs::ImpactStatus_initial_contact)
      .value("undecided", ImpactStatus::undecided, docs::ImpactStatus_undecided);
  nb::enum_<ElementPair::Kind>(m, "ElementPairKind", nb::is_arithmetic(), "What two elements are.")
      .value("vertex_face", ElementPair::Kind::vertex_face, docs::ElementPair_vertex_face)
      .value("face_vertex", ElementPair::Kind::face_vertex, docs::ElementPair_face_vertex)
      .value("edge_edge", ElementPair::Kind::edge_edge, docs::ElementPair_edge_edge);
  ValueClass<ElementPair>(m, "ElementPair", docs::ElementPair)
      .field("kind", &ElementPair::kind, "An ElementPairKind.")
      .field("a", &ElementPair::a, docs::ElementPair_a)
      .field("b", &ElementPair::b, docs::ElementPair_a)
      .binding()
      .def(nb::init<ElementPair::Kind, std::uint32_t, std::uint32_t>(), "kind"_a, "a"_a, "b"_a);
  ValueClass<ImpactResult>(m, "ImpactResult", "When two models touch first.")
      .field("status", &ImpactResult::status, "An ImpactStatus.")
      .field("lower", &ImpactResult::lower, docs::ImpactResult_lower)
      .field("upper", &ImpactResult::upper, docs::ImpactResult_lower)
      .field("elements", &ImpactResult::elements, docs::ImpactResult_elements)
      .field("witness", &ImpactResult::witness, docs::ImpactResult_witness)
      .field("normal", &ImpactResult::normal, docs::ImpactResult_normal)
      .field("stopped_by", &ImpactResult::stopped_by, docs::ImpactResult_stopped_by)
      .field("stats", &ImpactResult::stats, docs::ImpactResult_stats);
  ValueClass<PathImpact>(m, "PathImpact", docs::PathImpact)
      .field("status", &PathImpact::status, "An ImpactStatus.")
      .field("time", &PathImpact::time, docs::PathImpact_time)
      .field("witness", &PathImpact::witness, docs::PathImpact_witness)
      .field("normal", &PathImpact::normal, docs::PathImpact_normal)
      .field("distance_count", &PathImpact::distance_count, docs::PathImpact_distance_count)
      .field("stopped_by", &PathImpact::stopped_by, "Which limit of its budget has ended the query.")
      .field("stats", &PathImpact::stats, docs::QueryStats);
  ValueClass<PathDistance>(m, "PathDistance", docs::PathDistance)
      .field("lower", &PathDistance::lower, docs::PathDistance_lower)
      .field("upper", &PathDistance::upper, docs::PathDistance_upper)
      .field("time", &PathDistance::time, "When they are so near.")
      .field("witness", &PathDistance::witness, docs::PathDistance_witness)
      .field("distance_count", &PathDistance::distance_count, docs::PathDistance_distance_count)
      .field("stopped_by", &PathDistance::stopped_by, "Which limit of its budget has ended the query.")
      .field("stats", &PathDistance::stats, docs::QueryStats);
}

const std::string options_documentation = std::string("\n\nmax_time: ") + docs::ElementImpactOptions_max_time +
                                          "\n\ntime_error: " + docs::ElementImpactOptions_time_error +
                                          "\n\nmin_separation: " + docs::ElementImpactOptions_min_separation +
                                          "\n\nseparation_fraction: " + docs::ImpactOptions_separation_fraction;

const std::string threads_note = std::string("\n\nparallel: ") + docs::ImpactOptions_parallel +
                                 " So does a query with a filter in Python, which needs the GIL.";

std::string first_documentation(const char* what) {
  return std::string(what) + options_documentation + "\n\nignore_crossings: " + docs::ImpactOptions_ignore_crossings +
         "\n\nany_contact: " + docs::ImpactOptions_any_contact +
         "\n\nfilter: None, or called with an ElementPair: whether it counts. " + docs::ImpactOptions_filter +
         threads_note;
}

void bind_moving_models(nb::module_& m) {
  nb::class_<MovingModelObject>(m, "MovingModel", docs::MovingModel)
      .def(nb::init<ModelObject&>(), "model"_a, nb::keep_alive<1, 2>(), "Of a model. It has no motion yet.")
      .def("set_motion", &MovingModelObject::set_motion, "end_positions"_a, "start_pose"_a = nb::none(),
           "end_pose"_a = nb::none(), docs::MovingModel_set_motion)
      .def("__reduce__", &MovingModelObject::reduced, nb::sig("def __reduce__(self) -> tuple[Any, ...]"))
      .def(
          "_restore",
          [](MovingModelObject& self, const nb::tuple& motion) {
            self.set_motion(nb::object(motion[0]), nb::object(motion[1]), nb::object(motion[2]));
          },
          nb::sig("def _restore(self, state: tuple[Any, ...], /) -> None"));
  m.def("time_of_impact", &time_of_impact_of, "a"_a, "b"_a, nb::kw_only(), "max_time"_a = 1.0, "time_error"_a = 0.0,
        "min_separation"_a = 0.0, "separation_fraction"_a = 0.0, "ignore_crossings"_a = false, "any_contact"_a = false,
        "filter"_a = nb::none(), "parallel"_a = false, "budget"_a = nb::none(),
        first_documentation("The first time at which two moving models touch; or two rigid bodies on their way.")
            .c_str());
  m.def("self_time_of_impact", &self_time_of_impact_of, "model"_a, nb::kw_only(), "max_time"_a = 1.0,
        "time_error"_a = 0.0, "min_separation"_a = 0.0, "separation_fraction"_a = 0.0, "ignore_crossings"_a = false,
        "any_contact"_a = false, "filter"_a = nb::none(), "parallel"_a = false, "budget"_a = nb::none(),
        first_documentation(docs::self_time_of_impact).c_str());
  const std::string impacts =
      std::string(
          "All pairs of elements that touch up to max_time, each once, with the first time at which they do.\n\n"
          "Budget   As intersections().\nReturns  Records of limber3d.impact_dtype.") +
      options_documentation + threads_note + impact_fields();
  m.def("impacts", &impacts_of, "a"_a, "b"_a, nb::kw_only(), "max_time"_a = 1.0, "time_error"_a = 0.0,
        "min_separation"_a = 0.0, "separation_fraction"_a = 0.0, "parallel"_a = false, "budget"_a = nb::none(),
        impacts.c_str());
  m.def("self_impacts", &self_impacts_of, "model"_a, nb::kw_only(), "max_time"_a = 1.0, "time_error"_a = 0.0,
        "min_separation"_a = 0.0, "separation_fraction"_a = 0.0, "parallel"_a = false, "budget"_a = nb::none(),
        impacts.c_str());
  const std::string candidates = std::string(docs::visit_impact_candidates) + threads_note +
                                 "\nBudget   As intersections().\nReturns  Records of limber3d.element_pair_dtype." +
                                 element_pair_fields();
  m.def("impact_candidates", &impact_candidates_of, "a"_a, "b"_a, nb::kw_only(), "max_time"_a = 1.0,
        "min_separation"_a = 0.0, "parallel"_a = false, "budget"_a = nb::none(), candidates.c_str());
  m.def("self_impact_candidates", &self_impact_candidates_of, "model"_a, nb::kw_only(), "max_time"_a = 1.0,
        "min_separation"_a = 0.0, "parallel"_a = false, "budget"_a = nb::none(), candidates.c_str());
  m.def("limit_self_displacements", &limit_self_displacements_of, "model"_a, "separation"_a, "displacements"_a,
        (std::string(docs::limit_self_displacements) + "\n\nReturns  The limits, as a new array.").c_str());
  m.def("limit_displacements", &limit_displacements_of, "a"_a, "b"_a, "separation"_a, "of_a"_a, "of_b"_a = nb::none(),
        "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        (std::string(docs::limit_displacements) + "\n\nReturns  The limits of both, as new arrays of_a and of_b.")
            .c_str());
  m.def("limit_self_motions", &limit_self_motions_of, "model"_a, "separation"_a, "fractions"_a,
        (std::string(docs::limit_self_motions) + "\n\nReturns  The fractions, as a new array.").c_str());
  m.def("limit_motions", &limit_motions_of, "a"_a, "b"_a, "separation"_a, "of_a"_a, "of_b"_a = nb::none(),
        (std::string(docs::limit_motions) + "\n\nReturns  The fractions, as new arrays of_a and of_b.").c_str());
}

void bind_element_states(nb::module_& m) {
  nb::class_<ElementState>(m, "ElementState", docs::ElementState)
      .def_prop_ro(
          "vertices",
          [](const ElementState& s) { return read_only(array_of(std::span<const std::uint32_t>(s.vertices))); },
          docs::ElementState_vertices)
      .def_ro("count_of_a", &ElementState::count_of_a, docs::ElementState_count_of_a)
      .def_prop_ro(
          "weights",
          [](const ElementState& s) -> FloatArray {
            return read_only(array_of(std::span<const double>(s.weights), nb::str("float64"), {4}));
          },
          docs::ElementState_weights)
      .def_prop_ro(
          "point_a", [](const ElementState& s) { return read_only(array_of(s.point_a)); }, docs::ElementState_point_a)
      .def_prop_ro(
          "point_b", [](const ElementState& s) { return read_only(array_of(s.point_b)); }, docs::ElementState_point_a)
      .def_prop_ro(
          "normal", [](const ElementState& s) { return read_only(array_of(s.normal)); }, docs::ElementState_normal);
  m.def("state_of", &state_of_pair, "a"_a, "b"_a, "elements"_a, "time"_a, docs::state_of);
  m.def("self_state_of", &self_state_of_pair, "model"_a, "elements"_a, "time"_a, docs::state_of);
}

void bind_rigid_motions(nb::module_& m) {
  nb::class_<RigidMotion>(m, "RigidMotion", docs::RigidMotion)
      .def(
          "__init__",
          [](RigidMotion* self, const PoseLike& start, const PoseLike& end, nb::handle center) {
            const Transform from = pose_from(start, "start");
            new (self) RigidMotion(from, end.is_none() ? from : pose_from(end, "end"),
                                   center.is_none() ? Vec3{} : point_from(center, "center"));
          },
          "start"_a = nb::none(), "end"_a = nb::none(), "center"_a = nb::none(),
          "From one pose to another; without an end the body stands still.")
      .def_static(
          "screw",
          [](const PoseLike& start, const PoseLike& end) {
            return RigidMotion::screw(pose_from(start, "start"), pose_from(end, "end"));
          },
          "start"_a.none(), "end"_a.none(), docs::RigidMotion_screw)
      .def(
          "__reduce__",
          [](const RigidMotion& self) {
            return nb::make_tuple(nb::type<RigidMotion>(),
                                  nb::make_tuple(matrix_at(self, 0), matrix_at(self, 1), array_of(self.center())));
          },
          nb::sig("def __reduce__(self) -> tuple[Any, ...]"))
      .def("at", &matrix_at, "time"_a, "The pose at a time, as a 4 x 4 matrix.")
      .def("speed", &RigidMotion::speed, "radius"_a, docs::RigidMotion_speed);
  m.def("time_of_impact", &path_impact_of, "a"_a, "motion_a"_a, "b"_a, "motion_b"_a, nb::kw_only(), "max_time"_a = 1.0,
        "min_separation"_a = 0.0, "distance_error"_a = nb::none(), "budget"_a = nb::none(), "cache"_a = nb::none());
  m.def("min_distance", &min_distance_of, "a"_a, "motion_a"_a, "b"_a, "motion_b"_a, nb::kw_only(), "max_time"_a = 1.0,
        "distance_error"_a = nb::none(), "budget"_a = nb::none(), "cache"_a = nb::none(), docs::min_distance);
}

}  // namespace

void bind_motion(nb::module_& m) {
  bind_values(m);
  bind_moving_models(m);
  bind_element_states(m);
  bind_rigid_motions(m);
}

}  // namespace limber::python
