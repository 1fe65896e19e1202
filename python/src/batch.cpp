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
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

using WholeNumber = Named<"int">;  // that thread_count() looks at

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
  Batch(nb::handle_t<ModelObject> a, nb::handle_t<ModelObject> b, const PosesLike& poses_a, const PosesLike& poses_b,
        const WholeNumber& threads)
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

  /// Writes the records of query(a, b) for poses begin to end.
  template <typename Query>
  void run(nb::handle records, std::size_t begin, std::size_t end, const Query& query) {
    const Reading reading_a = reading(a_), reading_b = reading(b_);
    require_within(end);
    using Record = decltype(record_of(query(placed_a(0), placed_b(0))));
    auto* const out = static_cast<Record*>(memory_of(records, (std::max(begin, end) - begin) * sizeof(Record)));
    without_gil([&] {
      for_all(begin, end, [&](std::size_t i) { out[i - begin] = record_of(query(placed_a(i), placed_b(i))); });
    });
  }

  /// The contacts of poses begin to end, one pose after the other, and how many each has.
  std::pair<RecordArray, IdArray> contacts(double margin, std::size_t begin, std::size_t end,
                                           const NeighborRings* rings) {
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
    return {array_of(std::span<const Contact>(all), dtypes().contact),
            array_of(std::span<const std::uint32_t>(counts))};
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

void run_distance(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end, double relative_error,
                  double absolute_error, double max_distance) {
  const DistanceOptions options{relative_error, absolute_error, max_distance};
  batch.run(records, begin, end, [&](const Placed& a, const Placed& b) { return distance(a, b, options); });
}

void run_collide(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end) {
  batch.run(records, begin, end, [](const Placed& a, const Placed& b) { return collide(a, b); });
}

void run_within(Batch& batch, const RecordArray& records, std::size_t begin, std::size_t end, double max_distance) {
  batch.run(records, begin, end, [&](const Placed& a, const Placed& b) { return within(a, b, max_distance); });
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
      .def(nb::init<nb::handle_t<ModelObject>, nb::handle_t<ModelObject>, PosesLike, PosesLike, WholeNumber>(), "a"_a,
           "b"_a, "poses_a"_a.none(), "poses_b"_a.none(), "threads"_a.none() = nb::none())
      .def_prop_ro("size", &Batch::size, "How many poses there are; None if there is one for all.")
      .def("distance", &run_distance, "records"_a, "begin"_a, "end"_a, "relative_error"_a, "absolute_error"_a,
           "max_distance"_a, "Writes the distances of poses begin to end.")
      .def("collide", &run_collide, "records"_a, "begin"_a, "end"_a, "Writes the collisions of poses begin to end.")
      .def("within", &run_within, "records"_a, "begin"_a, "end"_a, "max_distance"_a,
           "Writes the answers of within() for poses begin to end.")
      .def("contacts", &Batch::contacts, "margin"_a, "begin"_a, "end"_a, "rings"_a.none(),
           "Contacts of poses begin to end, and how many each pose has.");
  m.def("set_thread_limit", &set_thread_limit, "count"_a.none(),
        "Limits the threads that builds, commits, batches and scenes use in this process, to 1 to 4096; None ends the "
        "limit.\n\n"
        "Raises   ValueError for other numbers.\n"
        "Threads  Not while another thread calls it.");
}

}  // namespace limber::python
