// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings.h"
#include "budget.h"
#include "records.h"

/// Ctrl-C during long calls. Python runs handlers of signals in its main thread, where that executes Python; so a call
/// of the main thread has to notice by itself that there is one to run.
namespace limber::python {

/// While one lives, SIGINT sets its flag, besides what it does for Python. One within another's life does nothing, nor
/// does one of another thread than the main one.
class Interruption {
 public:
  explicit Interruption(bool is_wanted);
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  std::atomic<bool> has_come = false;

 private:
  bool is_listening_ = false;
};

/// Returns work(budget), done without the GIL unless it is needed. Ctrl-C ends work that keeps to its budget, raising
/// KeyboardInterrupt; if the handler raises nothing, the work is done again. `cache` is what it uses, or null. Calls
/// that are certainly short say so by `is_long`, and save three calls of the system.
template <typename Cache, typename Work>
auto interruptible(bool is_long, bool needs_gil, const BudgetObject* given, Cache* cache, const Work& work) {
  while (true) {
    Interruption interruption(is_long);
    QueryBudget budget = budget_of(given);
    budget.abandon = is_long ? &interruption.has_come : nullptr;
    if (is_long) run_signal_handlers();  // those that came while arguments were read
    auto result = without_gil_unless(needs_gil, [&] { return work(budget); });
    if (!interruption.has_come) return result;
    if (cache != nullptr) cache->clear();
    run_signal_handlers();
  }
}

template <typename Work>
auto interruptible(const BudgetObject* given, const Work& work, bool needs_gil = false) {
  return interruptible<QueryCache>(true, needs_gil, given, nullptr, work);
}

/// Whether a query of two bodies may take a tenth of a second: by the number of pairs of triangles.
inline bool may_take_long(const Body& a, const Body& b) {
  constexpr std::size_t few_pairs = std::size_t{1} << 20;
  return a.model().mesh().triangles().size() * b.model().mesh().triangles().size() > few_pairs;
}

/// Raises limber3d.BatchInterrupted with results: the first `count` of those that were asked for.
[[noreturn]] void raise_interrupted(const nb::object& results, std::size_t count);

/// Who looks at the budget of a call with many answers: each of them, which tells whether it was spent; or the call,
/// which then returns fewer answers.
enum class Spent { is_told, leaves_out };

/// Calls ask(begin, end, budget), which returns how many it has done, for parts of 0 to `count` that take about a tenth
/// of a second each, without the GIL; for all at once if `is_one`: where something is refused, so that its place is
/// named. Returns results(done), and raises them as those that were done after Ctrl-C.
template <typename Ask, typename Results>
nb::object in_parts(std::size_t count, bool is_one, const BudgetObject* given, Spent spent, const Ask& ask,
                    const Results& results) {
  const bool is_hurried = given != nullptr && spent == Spent::leaves_out;  // then parts are short, to end in time
  const double least_s = is_hurried ? 0.0005 : 0.03, most_s = 4 * least_s;
  std::size_t done = 0, size = is_one ? count : 1;
  bool goes_on = true;
  do {
    const std::size_t asked = std::min(size, count - done);
    const auto start = std::chrono::steady_clock::now();
    try {
      const std::size_t answered = interruptible(given, [&](auto& budget) { return ask(done, done + asked, budget); });
      done += answered, goes_on = answered == asked && !(is_hurried && has_ended(given->budget));
      run_signal_handlers();
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_KeyboardInterrupt)) throw;
      raise_interrupted(results(done), done);
    }
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (elapsed_s < least_s) size *= 4;
    if (elapsed_s > most_s) size = std::max<std::size_t>(1, size / 2);
  } while (done < count && goes_on);
  return results(done);
}

/// The answers that ask(questions, results, budget) gives, in parts, as an array of records.
template <typename Result, typename Question, typename Ask>
RecordArray recorded_in_parts(const std::vector<Question>& all, bool is_one, const BudgetObject* given, Spent spent,
                              nb::handle dtype, const Ask& ask) {
  using Record = decltype(record_of(Result{}));
  nb::object records = new_array(dtype, {all.size()});
  auto* const out = static_cast<Record*>(memory_of(records, all.size() * sizeof(Record)));
  const auto ask_part = [&](std::size_t begin, std::size_t end, const QueryBudget& budget) {
    std::vector<Result> results(end - begin);
    ask(std::span(all).subspan(begin, end - begin), std::span(results), budget);
    std::transform(results.begin(), results.end(), out + begin, [](const Result& r) { return record_of(r); });
    return end - begin;
  };
  return in_parts(all.size(), is_one, given, spent, ask_part, [&](std::size_t done) { return first(records, done); });
}

/// Whether some point is none that queries take.
inline bool has_bad_point(std::span<const Vec3> points) {
  return !std::all_of(points.begin(), points.end(),
                      [](const Vec3& p) { return is_finite(p) && max_abs(p) <= max_coordinate; });
}

/// Runs work on a thread of its own, and waits without the GIL until it is done. If a handler of a signal raises
/// something meanwhile, throws that; the work then goes on, and is destroyed by the main thread later. Pre: this is the
/// main thread.
void run_aside(std::function<void()> work);
/// Waits for work that was given up: before Python ends.
void wait_for_abandoned();

/// Returns work(), which cannot be cut short, done without the GIL. In the main thread Ctrl-C raises KeyboardInterrupt
/// at once, while the work goes on to its end and its result is dropped. So it owns all that it uses: guards and also
/// objects of Python. `size` is how many triangles, vertices or the like it is about: few are not worth a thread.
constexpr std::size_t any_size = std::numeric_limits<std::size_t>::max();  // of work that may take long
template <typename Work>
auto aside(std::size_t size, Work work) {
  constexpr std::size_t few = 50'000;  // some ten milliseconds of most work
  using Value = std::invoke_result_t<Work&>;
  if (size <= few || !is_main_thread()) return without_gil([&] { return work(); });
  struct Job {
    Work work;
    std::optional<Value> value;
    std::exception_ptr error;
  };
  const auto job = std::make_shared<Job>(Job{std::move(work), std::nullopt, nullptr});
  run_aside([job] {
    try {
      job->value.emplace(job->work());
    } catch (...) {
      job->error = std::current_exception();
    }
  });
  if (job->error) std::rethrow_exception(job->error);
  return *std::move(job->value);
}

}  // namespace limber::python
