// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "limber/shapes.h"

/// What the parts of the module share: names of types, errors, the GIL, and who uses an object.
namespace limber::python {

namespace nb = nanobind;
using nb::literals::operator""_a;

void bind_arrays();
void bind_records(nb::module_& module);
void bind_results(nb::module_& module);
void bind_model(nb::module_& module);
void bind_bodies(nb::module_& module);
void bind_queries(nb::module_& module);
void bind_contacts(nb::module_& module);
void bind_elements(nb::module_& module);
void bind_motion(nb::module_& module);
void bind_gradients(nb::module_& module);
void bind_points(nb::module_& module);
void bind_solids(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_scene_batch(nb::module_& module);
void bind_batch(nb::module_& module);

// --- signatures ---

template <std::size_t size>
struct Text {
  consteval Text(const char (&text)[size]) { std::copy_n(text, size, characters); }
  char characters[size];
};

/// Any object of Python. Signatures call it by a name of limber3d.typing; whoever takes it checks what it is.
template <Text name>
class Named : public nb::object {
 public:
  static constexpr auto Name = nb::detail::const_name(name.characters);  // NOLINT(readability-identifier-naming)
  Named(nb::handle value, nb::detail::borrow_t tag) : nb::object(value, tag) {}
  Named(nb::handle value, nb::detail::steal_t tag) : nb::object(value, tag) {}
  Named(nb::object&& value) : nb::object(std::move(value)) {}
  static bool check_(nb::handle) { return true; }
};

using ArrayLike = Named<"ArrayLike">;
using PoseLike = Named<"PoseLike">;
using PosesLike = Named<"PosesLike">;
using FloatArray = Named<"FloatArray">;
using IdArray = Named<"IdArray">;
using RecordArray = Named<"RecordArray">;
using ContactsLike = Named<"ContactsLike">;

/// The argument max_distance, without a limit unless it is given.
inline auto max_distance_argument() {
  return nb::arg("max_distance").sig("float('inf')") = std::numeric_limits<double>::infinity();
}

// --- errors ---

/// Raises the exception of limber3d.errors that stands for the error. Pre: the GIL is held.
[[noreturn]] void raise(const Error& error);

template <typename T>
T value_or_raise(Result<T> result) {
  if (!result) raise(result.error());
  return std::move(result).value();
}

inline void value_or_raise(const Result<void>& result) {
  if (!result) raise(result.error());
}

// --- the GIL ---

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

/// Calls `work` without the GIL, unless it is needed: for a filter in Python.
template <typename Work>
auto without_gil_unless(bool is_needed, const Work& work) {
  std::optional<Released> released;
  if (!is_needed) released.emplace();
  return work();
}

template <typename Work>
auto without_gil(const Work& work) {
  return without_gil_unless(false, work);
}

// --- signals ---

bool is_main_thread();

/// Runs handlers of signals. Throws what they raise, such as KeyboardInterrupt. Pre: the GIL is held.
inline void run_signal_handlers() {
  if (is_main_thread() && PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// Calls work(begin, end) for pieces of 0 to `count`, and runs handlers of signals in between: for long loops that hold
/// the GIL, as arguments and answers are copied. `most` is how many take some milliseconds.
template <typename Work>
void in_pieces(std::size_t count, const Work& work, std::size_t most = std::size_t{1} << 16) {
  for (std::size_t begin = 0; begin < count; begin += most) {
    if (begin > 0) run_signal_handlers();
    work(begin, std::min(begin + most, count));
  }
}

// --- who uses an object ---

/// Somebody else uses the object in a way that excludes the call. Python sees limber3d.BusyError.
class Busy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Counts the users of an object: any number of readers, or one that changes it. A call that may not go on waits for up
/// to a second, and new readers let one go first that waits to change the object; then it throws Busy. A thread that
/// uses some object already does not wait: whom it would wait for may wait for it.
///
/// Threads  Functions need the GIL, which others get while one waits.
class Users {
  struct EndReading {
    void operator()(Users* users) const { users->count_.fetch_sub(1, std::memory_order_release), --used_by_thread; }
  };
  struct EndChanging {
    void operator()(Users* users) const { users->count_.store(0, std::memory_order_release), --used_by_thread; }
  };

 public:
  using Reading = std::unique_ptr<Users, EndReading>;
  using Changing = std::unique_ptr<Users, EndChanging>;

  /// The object is read for as long as the result lives.
  [[nodiscard]] Reading read(const char* refusal) {
    wait_until(refusal, [&] {
      int users = count_.load(std::memory_order_relaxed);
      while (users >= 0 && (waiting_ == 0 || used_by_thread > 0)) {
        if (count_.compare_exchange_weak(users, users + 1, std::memory_order_acquire, std::memory_order_relaxed)) {
          return true;
        }
      }
      return false;
    });
    return Reading(this);
  }

  /// The object is changed for as long as the result lives.
  [[nodiscard]] Changing change(const char* refusal) {
    struct Waiting {
      std::atomic<int>& count;
      ~Waiting() { --count; }
    } waiting{waiting_};
    ++waiting.count;
    wait_until(refusal, [&] {
      int nobody = 0;
      return count_.compare_exchange_strong(nobody, -1, std::memory_order_acquire, std::memory_order_relaxed);
    });
    return Changing(this);
  }

 private:
  template <typename Try>
  static void wait_until(const char* refusal, const Try& succeeds) {
    using Clock = std::chrono::steady_clock;
    bool is_mine = succeeds();
    if (!is_mine && used_by_thread == 0) {
      const Released released;
      for (const auto end = Clock::now() + std::chrono::seconds(1); !is_mine && Clock::now() < end;) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        is_mine = succeeds();
      }
    }
    if (!is_mine) throw Busy(refusal);
    ++used_by_thread;
  }

  static inline thread_local int used_by_thread = 0;  // objects
  std::atomic<int> count_ = 0;                        // of readers; -1 while the object is changed
  std::atomic<int> waiting_ = 0;                      // to change it
};

using Reading = Users::Reading;
using Changing = Users::Changing;

/// What queries of two bodies are about, and the calls that use it at the moment.
class BodyObject {
 public:
  BodyObject() = default;
  BodyObject(const BodyObject&) = delete;
  BodyObject& operator=(const BodyObject&) = delete;
  virtual ~BodyObject() = default;
  virtual Body body() const = 0;
  virtual Users& users() { return users_; }
  /// What __reduce__() returns of bodies whose class in Python has none of its own.
  virtual nb::object reduced() const { return nb::none(); }

 private:
  Users users_;
};

struct ModelObject : BodyObject {
  explicit ModelObject(Model built) : model(std::move(built)) {}
  Body body() const override { return model; }

  Model model;
};

/// A shape, which nobody changes.
struct ShapeObject : BodyObject {
  explicit ShapeObject(Shape built) : shape(std::move(built)) {}
  Body body() const override { return shape; }

  Shape shape;
  nb::object made_by;  // for pickles: the name of the function of Shape, and its arguments
};

/// A model with a radius. Whoever creates it keeps the model alive.
class ModelWithRadius : public BodyObject {
 public:
  ModelWithRadius(ModelObject& model, double radius) : model_(model), body_(model.model, radius) {}
  Body body() const override { return body_; }
  Users& users() override { return model_.users(); }
  nb::object reduced() const override {
    return nb::make_tuple(nb::type<BodyObject>(), nb::make_tuple(nb::find(model_), body_.radius()));
  }

 private:
  ModelObject& model_;
  Body body_;
};

[[nodiscard]] inline Reading reading(BodyObject& object) {
  return object.users().read("the model is being changed by another thread, or by a call that has not returned");
}

/// Keeps an object alive, and unchanged.
struct InUse {
  explicit InUse(BodyObject& object) : owner(nb::find(object)), guard(reading(object)) {}
  nb::object owner;
  Reading guard;
};

[[nodiscard]] inline Changing changing(ModelObject& object) {
  return object.users().change("the model is in use by another thread, or by a query that has not returned");
}

/// A cache, and who uses it.
template <typename Cache>
struct CacheObject {
  template <typename... Arguments>
  explicit CacheObject(Arguments... arguments) : cache(arguments...) {}

  Cache cache;
  Users users;
};
using QueryCacheObject = CacheObject<QueryCache>;

/// The cache that a query uses, if it was given one.
template <typename Cache>
class Used {
 public:
  explicit Used(CacheObject<Cache>* object) : object_(object) {
    if (object == nullptr) return;
    changing_ = object->users.change("the cache is in use by another thread, or by a query that has not returned");
  }
  Cache* get() const { return object_ != nullptr ? &object_->cache : nullptr; }

 private:
  CacheObject<Cache>* object_;
  Changing changing_;
};

template <typename Cache>
void clear(CacheObject<Cache>& object) {
  Used(&object).get()->clear();
}

/// How Python's garbage collector sees objects that keep others alive: through visit_references() of class T. A cycle
/// through such an object passes through the dictionary of an object too, where the collector breaks it.
template <typename T>
int traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  return nb::inst_ptr<T>(self)->visit_references(visit, arg);
}
template <typename T>
inline PyType_Slot collectable[] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse<T>)}, {0, nullptr}};

}  // namespace limber::python
