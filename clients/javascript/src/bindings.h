// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "limber/model.h"
#include "tables.h"

/// What the folder limber3d, the JavaScript half of the package, calls and reads. Whatever is declared here is private
/// to the two: the public interface is the one of JavaScript.
///
/// Numbers go as arguments; poses, arrays and answers through memory. Functions that can fail return whether they have
/// succeeded, or what they have made; if not, `errorText` says why.
namespace limber::web {

/// Makes a function callable from JavaScript.
#define LIMBER_EXPORT(name) extern "C" __attribute__((export_name(#name)))

/// What JavaScript owns, knows by its address, and frees with release().
struct Owner {
  virtual ~Owner() = default;
};

template <typename T>
struct Owned final : Owner, T {
  template <typename... Arguments>
  explicit Owned(Arguments&&... arguments) : T(std::forward<Arguments>(arguments)...) {}
};

/// What a query may be about: a model or a shape.
struct OwnedBody : Owner {
  virtual Body body() const = 0;
};

struct OwnedModel final : OwnedBody, Model {
  using Model::Model;
  Body body() const override { return static_cast<const Model&>(*this); }
};

/// How a pose is written in Exchange::poses.
enum class PoseForm : std::uint32_t {
  identity,    ///< not at all
  matrix,      ///< 16 numbers, by columns
  quaternion,  ///< x, y, z, w, then the translation
};

/// Where JavaScript writes poses, and reads answers.
struct Exchange {
  double poses[2][16];
  double numbers[8];  ///< what is no table
  double answer[64];  ///< a table of one answer
};
extern Exchange exchange;

/// The pose in Exchange::poses[which].
///
/// Throws   BadResult, which begins with the name of the argument.
Transform pose_from(PoseForm form, std::size_t which, const char* name);

/// A body and its pose.
inline Placed placed_from(const OwnedBody* body, PoseForm form, std::size_t which) {
  return {body->body(), pose_from(form, which, which == 0 ? "poseA" : "poseB")};
}

/// Memory for arrays on their way from JavaScript, until the next call of reserve_input().
std::byte* input();

/// Coordinates at the beginning of input().
PositionsView positions_from(std::size_t count, bool is_float32);
std::vector<Vec3> points_from(std::size_t count, bool is_float32);

/// Ids in input(), after that many bytes.
inline std::span<const std::uint32_t> ids_from(std::size_t count, std::size_t bytes_before = 0) {
  return {reinterpret_cast<const std::uint32_t*>(input() + bytes_before), count};
}

inline double address_of(const void* p) { return static_cast<double>(reinterpret_cast<std::uintptr_t>(p)); }

/// Writes to Exchange::numbers.
template <typename... Numbers>
void give_numbers(Numbers... numbers) {
  double* to = exchange.numbers;
  ((*to++ = static_cast<double>(numbers)), ...);
}

/// Writes where something begins and how many bytes it has, both numbers.
inline void give_bytes(const void* first, std::size_t bytes) { give_numbers(address_of(first), bytes); }

/// Memory for one table of many answers.
std::byte* table_memory(std::size_t bytes);

/// Gives one answer.
template <typename Answer>
void give(const Answer& answer) {
  static_assert(table_bytes<Answer>(1) <= sizeof(exchange.answer));
  write_table(std::span(&answer, 1), reinterpret_cast<std::byte*>(exchange.answer));
}

/// Gives many answers, as give_bytes() does.
template <typename Answer>
void give_all(std::span<const Answer> answers) {
  const std::size_t bytes = table_bytes<Answer>(answers.size());
  std::byte* const memory = table_memory(bytes);
  write_table(answers, memory);
  give_bytes(memory, bytes);
}

/// Writes the error for what is being thrown. Pre: called by an exception handler.
void keep_current_error();

/// Runs `body`; returns whether it has returned.
template <typename Body>
bool guarded(const Body& body) {
  try {
    body();
    return true;
  } catch (const std::exception&) {
    keep_current_error();
  }
  return false;
}

/// What make() has made; null if it has thrown.
template <typename Make>
auto made(const Make& make) -> decltype(make()) {
  decltype(make()) owned = nullptr;
  guarded([&] { owned = make(); });
  return owned;
}

/// The budget that JavaScript asks for: a deadline in milliseconds of performance.now(), and a number of steps. Both
/// are infinite where there is none.
QueryBudget budget_from(double deadline_ms, double max_steps);

}  // namespace limber::web
