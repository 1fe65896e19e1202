// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

/// The most threads that an argument may ask for. oneTBB takes memory for each of them at once.
constexpr Py_ssize_t most_threads = 4096;

}  // namespace

std::optional<int> thread_count(nb::handle argument, const char* name) {
  if (argument.is_none()) return std::nullopt;
  const Py_ssize_t count = PyNumber_AsSsize_t(argument.ptr(), nullptr);  // the nearest one, for numbers beyond
  if (count == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
  if (count >= 1 && count <= most_threads) return static_cast<int>(count);
  throw nb::value_error((std::string(name) + ": expected 1 to " + std::to_string(most_threads) + ", or None").c_str());
}

namespace {

/// Two models and many poses. The package asks for a part at a time, so that it can show progress and be interrupted.
class Batch {
 public:
  /// `threads`: at most so many, the caller's included; None: all. Names are those that poses have in messages.
  Batch(nb::handle_t<BodyObject> a, nb::handle_t<BodyObject> b, const PosesLike& poses_a, const PosesLike& poses_b,
        const WholeNumber& threads, const char* name_a = "poses_a", const char* name_b = "poses_b")
      : owner_a_(nb::borrow(a)),
        owner_b_(nb::borrow(b)),
        a_(nb::cast<BodyObject&>(a)),
        b_(nb::cast<BodyObject&>(b)),
        poses_a_(poses_a, name_a),
        poses_b_(poses_b, name_b),
        threads_(thread_count(threads, "threads")) {
    count(poses_a_, name_a);
    count(poses_b_, name_b);
  }

  /// How many poses there are; nothing if there is one for all.
  std::optional<std::size_t> size() const { return size_; }

  /// Writes the records of query(a, b, budget) for poses begin to end.
  template <typename Query>
  void run(nb::handle records, std::size_t begin, std::size_t end, const BudgetObject* given, const Query& query) {
    write(records, begin, end, given,
          [&](std::size_t i, const QueryBudget& budget) { return query(placed_a(i), placed_b(i), budget); });
  }

  /// The contacts of poses begin to end, one pose after the other, and how many each has: of fewer, where the budget is
  /// spent before.
  std::pair<RecordArray, IdArray> contacts(std::size_t begin, std::size_t end, double margin,
                                           const NeighborRings* rings, const BudgetObject* given) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(end);
    struct OfPose {
      std::deque<Contact> contacts;
      bool is_whole = false;
    };
    std::vector<OfPose> found;
    interruptible(given, [&](const QueryBudget& budget) {
      PairOptions options{.budget = budget};
      if (rings != nullptr) options.filter = TrianglePairFilter(*rings);
      found.clear(), found.resize(end - std::min(begin, end));
      for_all(begin, end, [&](std::size_t i) {
        OfPose& of_pose = found[i - begin];
        if (has_ended(budget)) return;
        const auto keep = [&](const Contact& contact) { return of_pose.contacts.push_back(contact), true; };
        const PairCount count = visit_contacts(placed_a(i), placed_b(i), margin, keep, options);
        of_pose.is_whole = count.stopped_by == StoppedBy::nothing;
      });
      return true;
    });
    std::vector<std::uint32_t> counts;
    std::size_t total = 0;
    for (const OfPose& of_pose : found) {
      if (!of_pose.is_whole) break;
      counts.push_back(static_cast<std::uint32_t>(of_pose.contacts.size()));
      total += counts.back();
    }
    nb::object all = new_array(dtypes().contact, {total});
    auto* out = static_cast<Contact*>(memory_of(all, total * sizeof(Contact)));
    for (std::size_t i = 0; i < counts.size(); ++i) {
      out = std::copy(found[i].contacts.begin(), found[i].contacts.end(), out);
    }
    return {RecordArray(std::move(all)), array_of(std::span<const std::uint32_t>(counts))};
  }

 protected:
  /// Writes the records of answer(i, budget) for i from begin to end.
  template <typename Answer>
  void write(nb::handle records, std::size_t begin, std::size_t end, const BudgetObject* given, const Answer& answer) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(end);
    using Record = decltype(record_of(answer(begin, QueryBudget{})));
    auto* const out = static_cast<Record*>(memory_of(records, (std::max(begin, end) - begin) * sizeof(Record)));
    interruptible(given, [&](const QueryBudget& budget) {
      for_all(begin, end, [&](std::size_t i) { out[i - begin] = record_of(answer(i, budget)); });
      return true;
    });
  }

  /// Takes another list of poses into account.
  ///
  /// Throws   nb::value_error if an earlier one has another number of poses.
  void count(const PoseList& poses, const char* name) {
    if (poses.is_one_for_all()) return;
    if (size_ && *size_ != poses.size()) {
      throw nb::value_error((std::string(counted_) + " and " + name + ": " + std::to_string(*size_) + " and " +
                             std::to_string(poses.size()) + " poses; expected as many of both, or one pose")
                                .c_str());
    }
    size_ = poses.size();
    counted_ = name;
  }

  Body body_a() const { return a_.body(); }
  Body body_b() const { return b_.body(); }
  const PoseList& poses_a() const { return poses_a_; }
  const PoseList& poses_b() const { return poses_b_; }

 private:
  template <typename Body>
  void for_all(std::size_t begin, std::size_t end, const Body& body) const {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    if (begin >= end) return;
    const auto run_all = [&] {
      oneapi::tbb::parallel_for(Range(begin, end), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      });
    };
    if (threads_) {
      oneapi::tbb::task_arena(*threads_).execute(run_all);
    } else {
      run_all();
    }
  }

  void require_within(std::size_t end) const {
    if (size_ && end > *size_) throw nb::index_error("there are fewer poses");
  }

  Placed placed_a(std::size_t i) const { return {a_.body(), poses_a_[i]}; }
  Placed placed_b(std::size_t i) const { return {b_.body(), poses_b_[i]}; }

  nb::object owner_a_, owner_b_;
  BodyObject &a_, &b_;
  PoseList poses_a_, poses_b_;
  std::optional<int> threads_;
  std::optional<std::size_t> size_;
  const char* counted_ = nullptr;  // the list that has so many
};

/// Two models and many rigid motions, from the poses of a batch to others.
class MotionBatch : public Batch {
 public:
  /// Without ends a model stands still. Centers are points, or None for the origin of a model.
  MotionBatch(nb::handle_t<BodyObject> a, nb::handle_t<BodyObject> b, const PosesLike& starts_a,
              const PosesLike& ends_a, const PosesLike& starts_b, const PosesLike& ends_b, nb::handle center_a,
              nb::handle center_b, const WholeNumber& threads)
      : Batch(a, b, starts_a, starts_b, threads, "starts_a", "starts_b"),
        ends_a_(ends_a.is_none() ? poses_a() : PoseList(ends_a, "ends_a")),
        ends_b_(ends_b.is_none() ? poses_b() : PoseList(ends_b, "ends_b")),
        center_a_(center_a.is_none() ? Vec3{} : point_from(center_a, "center_a")),
        center_b_(center_b.is_none() ? Vec3{} : point_from(center_b, "center_b")) {
    count(ends_a_, "ends_a");
    count(ends_b_, "ends_b");
  }

  /// Writes the records of query(model a, its motion, model b, its motion, budget) for motions begin to end.
  template <typename Query>
  void run(nb::handle records, std::size_t begin, std::size_t end, const BudgetObject* given, const Query& query) {
    write(records, begin, end, given, [&](std::size_t i, const QueryBudget& budget) {
      return query(body_a(), RigidMotion(poses_a()[i], ends_a_[i], center_a_), body_b(),
                   RigidMotion(poses_b()[i], ends_b_[i], center_b_), budget);
    });
  }

 private:
  PoseList ends_a_, ends_b_;
  Vec3 center_a_, center_b_;
};

void run_distance(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end, double relative_error,
                  double absolute_error, double max_distance, const BudgetObject* given) {
  batch.run(records, begin, end, given, [&](const Placed& a, const Placed& b, const QueryBudget& budget) {
    return distance(a, b, {relative_error, absolute_error, max_distance, nullptr, budget});
  });
}

void run_collide(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end,
                 const BudgetObject* given) {
  batch.run(records, begin, end, given, [](const Placed& a, const Placed& b, const QueryBudget& budget) {
    return collide(a, b, {nullptr, budget});
  });
}

void run_within(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end, double max_distance,
                const BudgetObject* given) {
  batch.run(records, begin, end, given, [&](const Placed& a, const Placed& b, const QueryBudget& budget) {
    return within(a, b, max_distance, {nullptr, budget});
  });
}

void run_time_of_impact(MotionBatch& batch, const RecordArray& records, std::size_t begin, std::size_t end,
                        double max_time, double min_separation, std::optional<double> distance_error,
                        const BudgetObject* given) {
  batch.run(records, begin, end, given, [&](auto a, auto motion_a, auto b, auto motion_b, const QueryBudget& budget) {
    return time_of_impact(a, motion_a, b, motion_b, {max_time, min_separation, distance_error, nullptr, budget});
  });
}

void run_min_distance(MotionBatch& batch, const RecordArray& records, std::size_t begin, std::size_t end,
                      double max_time, std::optional<double> distance_error, const BudgetObject* given) {
  batch.run(records, begin, end, given, [&](auto a, auto motion_a, auto b, auto motion_b, const QueryBudget& budget) {
    return min_distance(a, motion_a, b, motion_b, {max_time, 0, distance_error, nullptr, budget});
  });
}

std::unique_ptr<oneapi::tbb::global_control> thread_limit;

void set_thread_limit(const WholeNumber& count) {
  const std::optional<int> threads = thread_count(count, "count");
  thread_limit.reset();
  if (!threads) return;
  using Control = oneapi::tbb::global_control;
  thread_limit = std::make_unique<Control>(Control::max_allowed_parallelism, static_cast<std::size_t>(*threads));
}

}  // namespace

void bind_batch(nb::module_& m) {
  nb::class_<Batch>(m, "Batch", "Two models and many poses.")
      .def(nb::init<nb::handle_t<BodyObject>, nb::handle_t<BodyObject>, PosesLike, PosesLike, WholeNumber>(), "a"_a,
           "b"_a, "poses_a"_a.none(), "poses_b"_a.none(), "threads"_a.none() = nb::none())
      .def_prop_ro("size", &Batch::size, "How many poses there are; None if there is one for all.")
      .def("distance", &run_distance, "records"_a, "begin"_a, "end"_a, "relative_error"_a, "absolute_error"_a,
           "max_distance"_a, "budget"_a = nb::none(), "Writes the distances of poses begin to end.")
      .def("collide", &run_collide, "records"_a, "begin"_a, "end"_a, "budget"_a = nb::none(),
           "Writes the collisions of poses begin to end.")
      .def("within", &run_within, "records"_a, "begin"_a, "end"_a, "max_distance"_a, "budget"_a = nb::none(),
           "Writes the answers of within() for poses begin to end.")
      .def("contacts", &Batch::contacts, "begin"_a, "end"_a, "margin"_a, "rings"_a.none(), "budget"_a.none(),
           "Contacts of poses begin to end, and how many each pose has.");
  nb::class_<MotionBatch, Batch>(m, "MotionBatch", "Two models and many rigid motions.")
      .def(nb::init<nb::handle_t<BodyObject>, nb::handle_t<BodyObject>, PosesLike, PosesLike, PosesLike, PosesLike,
                    nb::handle, nb::handle, WholeNumber>(),
           "a"_a, "b"_a, "starts_a"_a.none(), "ends_a"_a.none(), "starts_b"_a.none(), "ends_b"_a.none(),
           "center_a"_a.none(), "center_b"_a.none(), "threads"_a.none())
      .def("time_of_impact", &run_time_of_impact, "records"_a, "begin"_a, "end"_a, "max_time"_a, "min_separation"_a,
           "distance_error"_a.none(), "budget"_a = nb::none(), "Writes the first contacts of motions begin to end.")
      .def("min_distance", &run_min_distance, "records"_a, "begin"_a, "end"_a, "max_time"_a, "distance_error"_a.none(),
           "budget"_a = nb::none(), "Writes the least distances of motions begin to end.");
  m.def("set_thread_limit", &set_thread_limit, "count"_a.none(),
        "Limits the threads that builds, commits, batches and scenes use in this process, to 1 to 4096; None ends the "
        "limit.\n\n"
        "Raises   ValueError for other numbers.\n"
        "Threads  Not while another thread calls it.");
}

}  // namespace limber::python
