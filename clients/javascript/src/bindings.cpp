// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>

namespace limber::web {

Exchange exchange;

namespace {

/// Codes beyond those of ErrorCode, which come first.
enum OtherCode : std::int32_t { invalid_argument = 100, out_of_memory, other };

struct LastError {
  std::int32_t code = 0;
  double where = -1;  // none if negative
  std::string text;
};
LastError last_error;

std::vector<double> input_memory, answers;  // of double for the sake of alignment

std::byte* resized(std::vector<double>& memory, std::size_t bytes) {
  memory.resize((bytes + sizeof(double) - 1) / sizeof(double));
  return reinterpret_cast<std::byte*>(memory.data());
}

void keep(std::int32_t code, const char* text, double where = -1) {
  last_error.code = code, last_error.where = where;
  last_error.text = text;
}

}  // namespace

std::byte* input() { return reinterpret_cast<std::byte*>(input_memory.data()); }
std::byte* table_memory(std::size_t bytes) { return resized(answers, bytes); }

void keep_current_error() {
  try {
    throw;
  } catch (const BadResult& bad) {
    const std::optional<std::size_t>& where = bad.error().where;
    keep(static_cast<std::int32_t>(bad.error().code), bad.what(), where ? static_cast<double>(*where) : -1);
  } catch (const std::invalid_argument& invalid) {
    keep(invalid_argument, invalid.what());
  } catch (const std::bad_alloc&) {
    keep(out_of_memory, "limber: out of memory");
  } catch (const std::length_error&) {
    keep(out_of_memory, "limber: out of memory");
  } catch (const std::exception& unexpected) {
    keep(other, unexpected.what());
  }
}

Transform pose_from(PoseForm form, std::size_t which, const char* name) {
  if (form == PoseForm::identity) return {};
  const double(&p)[16] = exchange.poses[which];
  const Result<Transform> pose = form == PoseForm::matrix
                                     ? transform_from_matrix(std::span<const double, 16>(p), MatrixOrder::column_major)
                                     : transform_from_quaternion({p[4], p[5], p[6]}, p[3], p[0], p[1], p[2]);
  if (!pose) throw BadResult({pose.error().code, name + (": " + pose.error().text), {}});
  return *pose;
}

PositionsView positions_from(std::size_t count, bool is_float32) {
  if (is_float32) return PositionsView::packed(std::span(reinterpret_cast<const float*>(input()), 3 * count));
  return PositionsView::packed(std::span(reinterpret_cast<const double*>(input()), 3 * count));
}

std::vector<Vec3> points_from(std::size_t count, bool is_float32) {
  std::vector<Vec3> points(count);
  positions_from(count, is_float32).copy_to(points);
  return points;
}

QueryBudget budget_from(double deadline_ms, double max_steps) {
  using Clock = std::chrono::steady_clock;
  QueryBudget budget;
  if (std::isnan(deadline_ms)) throw std::invalid_argument("limber: budget.deadline is not a number");
  if (!(max_steps >= 0)) throw std::invalid_argument("limber: budget.maxSteps is not a number of steps");
  if (deadline_ms < 1e15) {
    const std::chrono::duration<double, std::milli> since_start(std::max(deadline_ms, 0.0));
    budget.deadline = Clock::time_point(std::chrono::duration_cast<Clock::duration>(since_start));
  }
  if (max_steps < 0x1p63) budget.max_steps = static_cast<std::uint64_t>(max_steps);
  return budget;
}

LIMBER_EXPORT(exchange) Exchange* exported_exchange() { return &exchange; }

/// Gives the list of tables, in JSON.
LIMBER_EXPORT(tables) bool exported_tables() {
  return guarded([] {
    static const std::string text =
        '{' + description_of<DistanceResult>("distance") + ',' + description_of<CollideResult>("collide") + ',' +
        description_of<Contact>("contact") + ',' + description_of<PointResult>("point") + ',' +
        description_of<SignedDistance>("signedDistance") + ',' + description_of<ImpactResult>("impact") + ',' +
        description_of<PathImpact>("rigidImpact") + '}';
    give_bytes(text.data(), text.size());
  });
}

/// Makes room for arrays from JavaScript; returns where, or null.
LIMBER_EXPORT(reserveInput) std::byte* reserve_input(std::size_t bytes) {
  return made([&] { return resized(input_memory, bytes); });
}

LIMBER_EXPORT(release) void release(Owner* owner) { delete owner; }

LIMBER_EXPORT(errorCode) std::int32_t error_code() { return last_error.code; }
LIMBER_EXPORT(errorWhere) double error_where() { return last_error.where; }
LIMBER_EXPORT(errorText) void error_text() { give_bytes(last_error.text.data(), last_error.text.size()); }

}  // namespace limber::web

// The clock behind std::chrono, in place of the C library's: one call of JavaScript that gives a double.
extern "C" {

/// performance.now().
__attribute__((import_module("limber"), import_name("now"))) double limber_now_ms();

int clock_gettime(clockid_t, timespec* time) {
  const double ms = limber_now_ms(), s = std::floor(ms / 1000);
  time->tv_sec = static_cast<time_t>(s);
  time->tv_nsec = static_cast<long>((ms - s * 1000) * 1e6);
  return 0;
}
}
