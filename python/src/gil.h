// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <optional>
#include <thread>

/// Work without Python's global lock.
namespace limber::python {

/// Other threads of Python may run while this lives.
///
/// Where Python has ended meanwhile, the thread stops in the destructor for good, as Python has it from 3.14 on.
/// Earlier versions end the thread by unwinding its stack, which the C++ in between does not allow: the process would
/// abort.
class Released {
 public:
  Released() : state_(PyEval_SaveThread()) {}
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;
  ~Released() {
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {  // nothing but that unwinding comes out of a function in C
      while (true) std::this_thread::sleep_for(std::chrono::hours(1));
    }
  }

 private:
  PyThreadState* state_;
};

/// Calls `work` without the GIL.
template <typename Work>
auto without_gil(const Work& work) {
  const Released released;
  return work();
}

/// Calls `work` without the GIL, unless it is needed: for a filter in Python.
template <typename Work>
auto without_gil_unless(bool is_needed, const Work& work) {
  std::optional<Released> released;
  if (!is_needed) released.emplace();
  return work();
}

/// The thread that runs handlers of signals, and that does not outlive Python. Set when the module is imported.
inline unsigned long main_thread = 0;

/// Raises what the handler of a signal raises, such as KeyboardInterrupt. Does nothing except in the main thread.
inline void look_for_signals() {
  if (PyThread_get_thread_ident() != main_thread) return;
  const nanobind::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
}

}  // namespace limber::python
