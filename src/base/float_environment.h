// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#if defined(__x86_64__) || defined(__i386__)
#include <xmmintrin.h>
#elif !defined(__aarch64__) && !defined(__wasm__)
#include <cfenv>
#endif

#if defined(__FAST_MATH__)
#error \
    "limber decides exactly and bounds its rounding: compile its sources without -ffast-math (programs that use it may)"
#endif

/// Exactness and bounds hold in the IEEE default environment: rounding to nearest, subnormal numbers kept, no traps.
/// Callers may run in another one: a program linked with -ffast-math flushes subnormals, interval libraries change the
/// rounding mode.
namespace limber::base {

/// Puts the calling thread into the default floating-point environment for the lifetime of the object.
///
/// A function whose last step is arithmetic on its return value passes that value through `settled`: a compiler may
/// otherwise move the arithmetic behind the change back.
///
/// Cost     One read of the control register when the environment is the default one, about 1 ns.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment() : saved_(read()) {
    if (!is_default(saved_)) [[unlikely]]
      write(default_control);
  }
  ~DefaultFloatEnvironment() {
    if (!is_default(saved_)) [[unlikely]]
      write(saved_);
  }
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

  /// `value`, computed before this object changes the environment back.
  template <typename T>
  T settled(T value) const {
#if !defined(__wasm__)
    asm volatile("" : "+m"(value) : : "memory");
#endif
    return value;
  }

 private:
  // The barriers keep loads of operands, and so the arithmetic on them, from moving across a change.
#if defined(__x86_64__) || defined(__i386__)
  using Control = std::uint32_t;
  static constexpr Control default_control = 0x1f80, sticky_flags = 0x3f;
  static Control read() { return _mm_getcsr(); }
  static void write(Control control) {
    asm volatile("" ::: "memory");
    _mm_setcsr(control);
    asm volatile("" ::: "memory");
  }
  static bool is_default(Control control) { return (control & ~sticky_flags) == default_control; }
#elif defined(__aarch64__)
  using Control = std::uint64_t;
  static constexpr Control default_control = 0;
  static Control read() {
    Control control;
    asm volatile("mrs %0, fpcr" : "=r"(control)::"memory");
    return control;
  }
  static void write(Control control) { asm volatile("msr fpcr, %0" ::"r"(control) : "memory"); }
  static bool is_default(Control control) { return control == default_control; }
#elif defined(__wasm__)
  // WebAssembly has the default environment and no other.
  struct Control {};
  static constexpr Control default_control{};
  static Control read() { return {}; }
  static void write(Control) {}
  static bool is_default(Control) { return true; }
#else
  using Control = int;
  static constexpr Control default_control = FE_TONEAREST;
  static Control read() { return std::fegetround(); }
  static void write(Control control) { std::fesetround(control); }
  static bool is_default(Control control) { return control == default_control; }
#endif

  Control saved_;
};

}  // namespace limber::base
