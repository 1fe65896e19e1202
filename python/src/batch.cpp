// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "limber/limber.h"
#include "model_object.h"
#include "poses.h"
#include "query_arguments.h"
#include "records.h"

namespace limber::python {
namespace {

/// The most threads that an argument may ask for. oneTBB takes memory for each of them at once.
constexpr Py_ssize_t most_threads = 4096;

/// How many threads an argument asks for; nothing for None.
///
/// Throws   nb::value_error for a number out of range, nb::python_error (TypeError) for what is no whole number.
std::optional<int> thread_count(nb::handle argument, const char* name) {
  if (argument.is_none()) return std::nullopt;
  const Py_ssize_t count = PyNumber_AsSsize_t(argument.ptr(), nullptr);  // the nearest one, for numbers beyond
  if (count == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
  if (count >= 1 && count <= most_threads) return static_cast<int>(count);
  throw nb::value_error((std::string(name) + ": expected 1 to " + std::to_string(most_threads) + ", or None").c_str());
}

/// Two models and many poses. The package asks for a part at a time, so that it can show progress and be interrupted.
class Batch {
 public:
  /// `threads`: at most so many, the caller's included; None: all.
  Batch(nb::handle_t<ModelObject> a, nb::handle_t<ModelObject> b, nb::handle poses_a, nb::handle poses_b,
        nb::handle threads)
      : owner_a_(nb::borrow(a)),
        owner_b_(nb::borrow(b)),
        a_(nb::cast<ModelObject&>(a)),
        b_(nb::cast<ModelObject&>(b)),
        poses_a_(poses_a, "poses_a"),
        poses_b_(poses_b, "poses_b"),
        threads_(thread_count(threads, "threads")) {
    const bool is_list_a = !poses_a_.is_one_for_all(), is_list_b = !poses_b_.is_one_for_all();
    if (is_list_a) size_ = poses_a_.size();
    if (is_list_b) size_ = poses_b_.size();
    if (is_list_a && is_list_b && poses_a_.size() != poses_b_.size()) {
      throw nb::value_error((std::string("poses_a and poses_b: ") + std::to_string(poses_a_.size()) + " and " +
                             std::to_string(poses_b_.size()) + " poses; expected as many of both, or one pose")
                                .c_str());
    }
  }

  /// How many poses there are; nothing if there is one for all.
  std::optional<std::size_t> size() const { return size_; }

  /// Writes record(a, b) of poses begin to end to that part of `records`, on all threads.
  template <typename Record, typename Query>
  void run(nb::handle records, std::size_t begin, std::size_t end, const Query& query) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(end);
    auto* const out = static_cast<Record*>(memory_of(records, end * sizeof(Record)));
    without_gil([&] { for_all(begin, end, [&](std::size_t i) { out[i] = query(placed_a(i), placed_b(i)); }); });
  }

  /// Writes the answer for one pose to the first record.
  template <typename Record, typename Query>
  void run_at(nb::handle records, std::size_t i, const Query& query) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(i + 1);
    auto* const out = static_cast<Record*>(memory_of(records, sizeof(Record)));
    without_gil([&] { *out = query(placed_a(i), placed_b(i)); });
  }

  /// The contacts of poses begin to end, one pose after the other, and how many each has.
  nb::tuple contacts(double margin, std::size_t begin, std::size_t end, const NeighborRings* rings) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(end);
    std::vector<std::vector<Contact>> found(end - std::min(begin, end));
    std::vector<Contact> all;
    std::vector<std::uint32_t> counts;
    without_gil([&] {
      PairOptions options;
      if (rings != nullptr) options.filter = TrianglePairFilter(*rings);
      for_all(begin, end, [&](std::size_t i) {
        const auto keep = [&](const Contact& contact) { return found[i - begin].push_back(contact), true; };
        visit_contacts(placed_a(i), placed_b(i), margin, keep, options);
      });
      for (const std::vector<Contact>& part : found) {
        counts.push_back(static_cast<std::uint32_t>(part.size()));
        all.insert(all.end(), part.begin(), part.end());
      }
    });
    return nb::make_tuple(array_of(std::span<const Contact>(all), dtypes().contact),
                          array_of(std::span<const std::uint32_t>(counts)));
  }

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

  Placed placed_a(std::size_t i) const { return {a_.model, poses_a_[i]}; }
  Placed placed_b(std::size_t i) const { return {b_.model, poses_b_[i]}; }

  nb::object owner_a_, owner_b_;
  ModelObject &a_, &b_;
  PoseList poses_a_, poses_b_;
  std::optional<int> threads_;
  std::optional<std::size_t> size_;
};

void run_distance(Batch& batch, nb::handle records, std::size_t begin, std::size_t end, double relative_error,
                  double absolute_error, double max_distance) {
  const DistanceOptions options{relative_error, absolute_error, max_distance};
  batch.run<DistanceRecord>(records, begin, end, [&](const Placed& a, const Placed& b) {
    return record_of(limber::distance(a, b, options));
  });
}

void run_distance_at(Batch& batch, nb::handle records, std::size_t i, double relative_error, double absolute_error,
                     double max_distance) {
  const DistanceOptions options{relative_error, absolute_error, max_distance};
  batch.run_at<DistanceRecord>(
      records, i, [&](const Placed& a, const Placed& b) { return record_of(limber::distance(a, b, options)); });
}

void run_collide(Batch& batch, nb::handle records, std::size_t begin, std::size_t end) {
  batch.run<CollideRecord>(records, begin, end,
                           [](const Placed& a, const Placed& b) { return record_of(limber::collide(a, b)); });
}

void run_within(Batch& batch, nb::handle records, std::size_t begin, std::size_t end, double max_distance) {
  batch.run<CollideRecord>(records, begin, end, [&](const Placed& a, const Placed& b) {
    return record_of(limber::within(a, b, max_distance));
  });
}

std::unique_ptr<oneapi::tbb::global_control> thread_limit;

void set_thread_limit(nb::handle count) {
  const std::optional<int> threads = thread_count(count, "count");
  thread_limit.reset();
  if (!threads) return;
  using Control = oneapi::tbb::global_control;
  thread_limit = std::make_unique<Control>(Control::max_allowed_parallelism, static_cast<std::size_t>(*threads));
}

}  // namespace

void bind_batch(nb::module_& m) {
  nb::class_<Batch>(m, "Batch", "Two models and many poses.")
      .def(nb::init<nb::handle_t<ModelObject>, nb::handle_t<ModelObject>, nb::handle, nb::handle, nb::handle>(), "a"_a,
           "b"_a, "poses_a"_a.none(), "poses_b"_a.none(), "threads"_a.none() = nb::none(),
           nb::sig("def __init__(self, a: Model, b: Model, poses_a: PosesLike, poses_b: PosesLike, "
                   "threads: int | None = None) -> None"))
      .def_prop_ro("size", &Batch::size, "How many poses there are; None if there is one for all.")
      .def("distance", &run_distance, "records"_a, "begin"_a, "end"_a, "relative_error"_a, "absolute_error"_a,
           "max_distance"_a,
           nb::sig("def distance(self, records: RecordArray, begin: int, end: int, relative_error: float, "
                   "absolute_error: float, max_distance: float) -> None"),
           "Writes the distances of poses begin to end.")
      .def("distance_at", &run_distance_at, "records"_a, "i"_a, "relative_error"_a, "absolute_error"_a,
           "max_distance"_a,
           nb::sig("def distance_at(self, records: RecordArray, i: int, relative_error: float, "
                   "absolute_error: float, max_distance: float) -> None"),
           "Writes the distance of pose i to the first record.")
      .def("collide", &run_collide, "records"_a, "begin"_a, "end"_a,
           nb::sig("def collide(self, records: RecordArray, begin: int, end: int) -> None"),
           "Writes the collisions of poses begin to end.")
      .def("within", &run_within, "records"_a, "begin"_a, "end"_a, "max_distance"_a,
           nb::sig("def within(self, records: RecordArray, begin: int, end: int, max_distance: float) -> None"),
           "Writes the answers of within() for poses begin to end.")
      .def("contacts", &Batch::contacts, "margin"_a, "begin"_a, "end"_a, "rings"_a.none(),
           nb::sig("def contacts(self, margin: float, begin: int, end: int, rings: NeighborRings | None) "
                   "-> tuple[RecordArray, IdArray]"),
           "Contacts of poses begin to end, and how many each pose has.");
  m.def("set_thread_limit", &set_thread_limit, "count"_a.none(),
        nb::sig("def set_thread_limit(count: int | None) -> None"),
        "Limits the threads that builds, commits, batches and scenes use in this process, to 1 to 4096; None ends the "
        "limit.\n\n"
        "Raises   ValueError for other numbers.\n"
        "Threads  Not while another thread calls it.");
}

}  // namespace limber::python
