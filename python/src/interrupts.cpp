// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "interrupts.h"

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>
#include <vector>

namespace limber::python {
namespace {

std::atomic<std::atomic<bool>*> listening = nullptr;  // what SIGINT sets
struct sigaction action_of_python;                    // for SIGINT, meanwhile

void note_interruption(int number, siginfo_t* information, void* context) {
  if (std::atomic<bool>* const flag = listening) *flag = true;
  if ((action_of_python.sa_flags & SA_SIGINFO) != 0) return action_of_python.sa_sigaction(number, information, context);
  action_of_python.sa_handler(number);
}

/// Work on a thread of its own.
struct Task {
  std::function<void()> work;
  std::mutex mutex;
  std::condition_variable has_ended;
  bool is_done = false, is_abandoned = false;
};

std::mutex ended_mutex;
std::vector<std::unique_ptr<Task>> ended;  // that were abandoned

/// Destroys all abandoned tasks that have ended: work holds objects of Python. Pre: the GIL is held.
int destroy_ended(void*) {
  std::vector<std::unique_ptr<Task>> tasks;
  const std::lock_guard lock(ended_mutex);
  tasks.swap(ended);
  return 0;
}

void run(Task* task) {
  task->work();
  std::unique_lock lock(task->mutex);
  task->is_done = true;
  if (!task->is_abandoned) return task->has_ended.notify_one();
  lock.unlock();
  const std::lock_guard ended_lock(ended_mutex);
  ended.emplace_back(task);
  Py_AddPendingCall(&destroy_ended, nullptr);  // where there is no room for it, one is there that will do
}

/// Waits for a moment, or until the task is done; returns whether it is.
bool wait_for(Task& task) {
  const Released released;
  std::unique_lock lock(task.mutex);
  return task.has_ended.wait_for(lock, std::chrono::milliseconds(20), [&] { return task.is_done; });
}

std::vector<std::thread> abandoned;  // of the main thread alone

}  // namespace

bool is_main_thread() {
  static const auto main_thread =
      nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  return PyThread_get_thread_ident() == main_thread;
}

Interruption::Interruption(bool is_wanted) {
  if (!is_wanted || !is_main_thread() || listening != nullptr) return;
  sigaction(SIGINT, nullptr, &action_of_python);
  const bool is_plain = (action_of_python.sa_flags & SA_SIGINFO) == 0;
  if (is_plain && (action_of_python.sa_handler == SIG_DFL || action_of_python.sa_handler == SIG_IGN)) return;
  listening = &has_come, is_listening_ = true;
  struct sigaction action = {};
  action.sa_sigaction = &note_interruption, action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaction(SIGINT, &action, nullptr);
}

Interruption::~Interruption() {
  if (!is_listening_) return;
  struct sigaction action = {};
  sigaction(SIGINT, nullptr, &action);
  // A handler that ran meanwhile may have set another one.
  if (action.sa_sigaction == &note_interruption) sigaction(SIGINT, &action_of_python, nullptr);
  listening = nullptr;
}

void raise_interrupted(const nb::object& results, std::size_t count) {
  const nb::object interrupted = nb::module_::import_("limber3d.many").attr("BatchInterrupted")(results, count);
  PyErr_SetObject(interrupted.type().ptr(), interrupted.ptr());
  throw nb::python_error();
}

void run_aside(std::function<void()> work) {
  auto task = std::make_unique<Task>();
  task->work = std::move(work);
  std::thread thread(&run, task.get());
  bool is_interrupted = false;
  while (!is_interrupted && !wait_for(*task)) {
    is_interrupted = PyErr_CheckSignals() != 0;
    const std::lock_guard lock(task->mutex);
    task->is_abandoned = is_interrupted && !task->is_done;
  }
  if (task->is_abandoned) {
    static_cast<void>(task.release());  // destroy_ended() has it
    abandoned.push_back(std::move(thread));
  } else {
    thread.join();
  }
  if (is_interrupted) throw nb::python_error();
}

void wait_for_abandoned() {
  {
    const Released released;
    for (std::thread& thread : abandoned) thread.join();
  }
  abandoned.clear();
  destroy_ended(nullptr);
}

}  // namespace limber::python
