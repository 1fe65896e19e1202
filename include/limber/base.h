// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

/// Marks what a shared library shows to programs; all other names stay inside. A static library shows nothing, so that
/// a shared library of somebody else's that contains limber does not show limber's names.
#if defined(__GNUC__) && !defined(LIMBER_STATIC)
#define LIMBER_API __attribute__((visibility("default")))
#else
#define LIMBER_API
#endif

/// Ids, errors and results shared by every header of the library.
namespace limber {

using VertexId = std::uint32_t;
using TriangleId = std::uint32_t;

/// Stands where an id is asked for and none exists.
inline constexpr std::uint32_t no_id = 0xffff'ffffU;

// Containers have other sizes with _GLIBCXX_DEBUG, which no symbol tells. Each program refers to that of these two
// constants that it was compiled for, and the library has one of them: where they disagree, linking fails by that name.
#if defined(__GLIBCXX__) && defined(__ELF__)
#ifdef _GLIBCXX_DEBUG
#define LIMBER_LAYOUT compiled_with_GLIBCXX_DEBUG
#else
#define LIMBER_LAYOUT compiled_without_GLIBCXX_DEBUG
#endif
LIMBER_API extern const char LIMBER_LAYOUT;
[[gnu::used]] static const char* const layout_of_library = &LIMBER_LAYOUT;
#endif

/// What was wrong with something that came from outside.
enum class ErrorCode {
  empty_mesh,            ///< no triangle
  non_finite,            ///< a NaN or an infinity
  too_large,             ///< a coordinate above `max_coordinate`, or more elements than ids can count
  index_out_of_range,    ///< a triangle or an update names a vertex that does not exist
  size_mismatch,         ///< two lists that belong together differ in length
  not_rigid,             ///< a matrix that is no rigid motion
  unreadable_file,       ///< missing, a folder, or no permission
  malformed_file,        ///< truncated, or not what its name says
  unsupported_format,    ///< the file's extension is not one of those read
  changed_connectivity,  ///< a frame whose faces differ from those of the first frame
  broken_invariant,      ///< `validate()` found the structure damaged
  not_closed,            ///< a surface that has no inside: an edge that is not shared by two triangles, in order
  not_convex,            ///< a concave edge, or what else keeps a mesh from being convex
};

/// One line for a person, a code for a program, and the place.
struct LIMBER_API Error {
  ErrorCode code{};
  std::string text;  ///< names what is wrong and where; no trailing newline
  /// Index of the offending vertex, triangle, list entry or frame, where there is one.
  std::optional<std::size_t> where;
};

/// Thrown by `Result::value()` when there is only an error to give.
class LIMBER_API BadResult : public std::runtime_error {
 public:
  explicit BadResult(Error error);
  ~BadResult() override;

  const Error& error() const { return error_; }

 private:
  Error error_;
};

/// For the library's own use: throws BadResult. What is thrown through code without exceptions ends the program.
[[noreturn]] LIMBER_API void throw_bad_result(const Error& error);

/// A value, or the reason why there is none.
///
/// Errors   `value()` throws BadResult; `operator*` and `operator->` must only be used after a check.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  const T& operator*() const& { return *std::get_if<0>(&state_); }
  T& operator*() & { return *std::get_if<0>(&state_); }
  const T* operator->() const { return std::get_if<0>(&state_); }
  T* operator->() { return std::get_if<0>(&state_); }

  const T& value() const& { return check(), **this; }
  T& value() & { return check(), **this; }
  T&& value() && { return check(), std::move(**this); }
  const Error& error() const { return *std::get_if<1>(&state_); }

 private:
  void check() const {
    if (!*this) throw_bad_result(error());
  }
  std::variant<T, Error> state_;
};

/// Success, or the reason for a failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  void value() const {
    if (error_) throw_bad_result(*error_);
  }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

/// Called when a precondition is violated in a build with checks (presets `dev`, `checked`, `asan`).
///
/// The default handler throws std::logic_error. A handler that returns lets the program go on.
using AssertHandler = void (*)(const char* expression, const char* file, int line);

/// Replaces the handler for the whole process and returns the previous one.
///
/// Threads  Safe to call at any time; calls in flight may still use the previous handler.
LIMBER_API AssertHandler set_assert_handler(AssertHandler handler);
/// The handler in use.
LIMBER_API AssertHandler assert_handler();

/// The SIMD instructions that the engine uses on this processor, by Highway's name: "AVX2", "NEON". It chooses the best
/// of those that it was compiled for; answers have the same bits with all of them.
LIMBER_API const char* instruction_set() noexcept;

template <typename Signature>
class FunctionRef;

/// A reference to something that can be called: a function, a lambda. For arguments: whoever gets one calls it before
/// returning and keeps no copy.
///
/// Cost     Two pointers, no allocation.
template <typename R, typename... Arguments>
class FunctionRef<R(Arguments...)> {
 public:
  template <typename F>
  requires(!std::is_same_v<F, FunctionRef> && std::is_invocable_r_v<R, F&, Arguments...>) FunctionRef(const F& f)
  noexcept {
    if constexpr (std::is_function_v<F>) {
      called_.function = reinterpret_cast<void (*)()>(&f);
      call_ = [](Target t, Arguments... a) -> R {
        return reinterpret_cast<F*>(t.function)(std::forward<Arguments>(a)...);
      };
    } else {
      // A lambda may change what it holds; then it was not constant.
      using Called = std::conditional_t<std::is_invocable_r_v<R, const F&, Arguments...>, const F, F>;
      called_.object = const_cast<F*>(std::addressof(f));
      call_ = [](Target t, Arguments... a) -> R {
        return (*static_cast<Called*>(t.object))(std::forward<Arguments>(a)...);
      };
    }
  }

  R operator()(Arguments... a) const { return call_(called_, std::forward<Arguments>(a)...); }

 private:
  union Target {
    void* object;
    void (*function)();
  };
  Target called_;
  R (*call_)(Target, Arguments...);
};

}  // namespace limber
