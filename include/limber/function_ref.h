// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace limber {

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
