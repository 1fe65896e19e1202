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
#error "limber decides exactly and bounds its rounding: compile its sources without -ffast-math (callers may use it)"
#endif

/// The library's exact decisions and its bounds need the IEEE default environment: rounding to nearest, subnormal
/// numbers kept, no traps. Callers may run in another one: a program linked with -ffast-math flushes subnormals,
/// interval libraries change the rounding mode.
namespace limber::base {

/// A scope guard: the constructor puts the calling thread into the default floating-point environment, the destructor
/// restores the caller's.
///
/// If the caller's environment is the default one, nothing is written, and compilers may move arithmetic anywhere.
/// Otherwise it must stay between the two writes of the control register. Compilers do not know that it depends on that
/// register, but they move no load or store across write(). So two rules keep arithmetic inside:
///
/// Entry    Its operands are loaded after the first write: public functions take coordinates by reference or read them
///          from models. Arithmetic on nothing but numbers passed by value, as of a quaternion, is not held.
/// Exit     A value that a function computes in its return statement must go through computed_before_restore().
/// Limits   Exception flags raised inside may stay raised, or be lost if the register was written. On i386 the
///          environment is that of SSE: compile with -mfpmath=sse. On processors other than x86, AArch64 and
///          WebAssembly only the rounding mode is set.
/// Cost     One read of the control register, by the constructor, when the environment is the default one: about 1 ns.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment() : saved_(read()) {
    if (!is_default(saved_)) [[unlikely]] {
      write(default_control);
    }
  }
  ~DefaultFloatEnvironment() {
    if (!is_default(saved_)) [[unlikely]] {
      write(saved_);
    }
  }
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

  /// Returns `value`, computed before the destructor restores the environment: the asm reads it from memory, and
  /// compilers do not move the destructor's write before a volatile asm.
  template <typename T>
  T computed_before_restore(T value) const {
#if !defined(__wasm__)  // WebAssembly has no environment to restore
    asm volatile("" : "+m"(value) : : "memory");
#endif
    return value;
  }

 private:
#if defined(__x86_64__) || defined(__i386__)
  using Control = std::uint32_t;
  // MXCSR: all exceptions masked, rounding to nearest, neither flush-to-zero nor denormals-are-zero. The six sticky
  // flags, which note past exceptions, do not matter.
  static constexpr Control default_mxcsr = 0x1f80, sticky_flags = 0x3f;
#if defined(__MINGW32__)
  // MinGW's mathematical functions compute on the x87 unit. The upper half is its control word: exceptions masked, 64
  // bits of precision, rounding to nearest.
  static constexpr Control default_control = default_mxcsr | 0x037f'0000;
  static Control read() {
    std::uint16_t x87 = 0;
    asm volatile("fnstcw %0" : "=m"(x87));
    return _mm_getcsr() | Control{x87} << 16U;
  }
  static void write(Control control) {
    const auto x87 = static_cast<std::uint16_t>(control >> 16U);
    asm volatile("fldcw %0" ::"m"(x87) : "memory");  // no load or store moves across
    _mm_setcsr(control & 0xffffU);
    asm volatile("" ::: "memory");
  }
#else
  static constexpr Control default_control = default_mxcsr;
  static Control read() { return _mm_getcsr(); }
  static void write(Control control) {
    asm volatile("" ::: "memory");  // no load or store moves across
    _mm_setcsr(control);
    asm volatile("" ::: "memory");
  }
#endif
  static bool is_default(Control control) { return (control & ~sticky_flags) == default_control; }
#elif defined(__aarch64__)
  using Control = std::uint64_t;
  static constexpr Control default_control = 0;  // FPCR: traps off, rounding to nearest, no flush-to-zero
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
  using Control = int;  // the functions of <cfenv> are opaque calls: no load or store moves across
  static constexpr Control default_control = FE_TONEAREST;  // the rounding mode is all that <cfenv> can set
  static Control read() { return std::fegetround(); }
  static void write(Control control) { std::fesetround(control); }
  static bool is_default(Control control) { return control == default_control; }
#endif

  Control saved_;
};

}  // namespace limber::base
