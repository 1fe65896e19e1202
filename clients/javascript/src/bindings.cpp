// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace limber::web {

Exchange exchange;

namespace {

/// Codes beyond those of ErrorCode, which come first.
enum OtherCode : std::int32_t { invalid_argument = 100, out_of_memory, filter_has_thrown, other };

struct LastError {
  std::int32_t code = 0;
  double where = -1;  // none if negative
  std::string text;
};
LastError last_error;

std::vector<double> input_memory;  // of double for the sake of alignment

void keep(std::int32_t code, const char* text, double where = -1) {
  last_error.code = code, last_error.where = where;
  last_error.text = text;
}

}  // namespace

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
  } catch (const FilterHasThrown&) {
    keep(filter_has_thrown, "");
  } catch (const std::exception& unexpected) {
    keep(other, unexpected.what());
  }
}

Transform pose_from(PoseForm form, std::size_t which, const char* name) {
  const double(&p)[16] = exchange.poses[which];
  const auto placed = [&]() -> Result<Transform> {
    switch (form) {
      case PoseForm::identity:
        return Transform{};
      case PoseForm::matrix:
        return transform_from_matrix(std::span<const double, 16>(p), MatrixOrder::column_major);
      case PoseForm::quaternion:
        return transform_from_quaternion({p[4], p[5], p[6]}, p[3], p[0], p[1], p[2]);
      case PoseForm::rotation:
        break;
    }
    const std::array<double, 16> matrix{p[0], p[1], p[2], 0, p[3], p[4],  p[5],  0,
                                        p[6], p[7], p[8], 0, p[9], p[10], p[11], 1};
    return transform_from_matrix(matrix, MatrixOrder::column_major);
  };
  const Result<Transform> pose = placed();
  if (!pose) throw BadResult({pose.error().code, name + (": " + pose.error().text), {}});
  return *pose;
}

std::byte* input() { return reinterpret_cast<std::byte*>(input_memory.data()); }

PositionsView positions_from(std::size_t count, bool is_float32) {
  if (is_float32) return PositionsView::packed(std::span(reinterpret_cast<const float*>(input()), 3 * count));
  return PositionsView::packed(std::span(reinterpret_cast<const double*>(input()), 3 * count));
}

std::vector<Vec3> points_from(std::size_t count, bool is_float32) {
  std::vector<Vec3> points(count);
  positions_from(count, is_float32).copy_to(points);
  return points;
}

Mesh mesh_from(std::size_t vertex_count, bool is_float32, std::size_t triangle_count) {
  std::vector<Corners> triangles(triangle_count);
  const std::size_t coordinate_bytes = is_float32 ? sizeof(float) : sizeof(double);
  if (triangle_count > 0) {
    std::memcpy(triangles.data(), input() + 3 * vertex_count * coordinate_bytes, triangle_count * sizeof(Corners));
  }
  return Mesh::create(positions_from(vertex_count, is_float32), std::move(triangles)).value();
}

void give_mesh(const Mesh& mesh) {
  exchange.words[0] = address_of(mesh.positions().data());
  exchange.words[1] = static_cast<std::uint32_t>(mesh.positions().size());
  exchange.words[2] = address_of(mesh.triangles().data());
  exchange.words[3] = static_cast<std::uint32_t>(mesh.triangles().size());
}

extern "C" {
/// The filter of the query under way: 1 if a pair counts, 0 if not, and something else if the filter has thrown.
__attribute__((import_module("limber"), import_name("filter"))) std::int32_t limber_filter(std::uint32_t a,
                                                                                           std::uint32_t b);
}

bool ask_filter(std::uint32_t a, std::uint32_t b) {
  const std::int32_t answer = limber_filter(a, b);
  if (answer != 0 && answer != 1) throw FilterHasThrown{};
  return answer == 1;
}

void give_bytes(const void* first, std::size_t bytes) {
  exchange.words[0] = address_of(first);
  exchange.words[1] = static_cast<std::uint32_t>(bytes);
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

void give(const std::optional<Witness>& witness, const QueryStats& stats, std::uint32_t status, StoppedBy stopped_by) {
  const Witness w = witness.value_or(Witness{});
  double* to = exchange.numbers + 2;
  put(to, w.point_a), put(to, w.point_b);
  give_stats(stats, 8);
  const std::uint32_t words[4] = {w.triangle_a, w.triangle_b, status, static_cast<std::uint32_t>(stopped_by)};
  std::copy(std::begin(words), std::end(words), exchange.words);
}

void give_stats(const QueryStats& stats, std::size_t first) {
  exchange.numbers[first] = static_cast<double>(stats.node_tests);
  exchange.numbers[first + 1] = static_cast<double>(stats.primitive_tests);
}

void give_count(std::size_t count, bool is_complete, const QueryStats& stats) {
  exchange.words[2] = static_cast<std::uint32_t>(count);
  exchange.words[3] = is_complete ? 1 : 0;
  give_stats(stats, 0);
}

void give(const DistanceResult& result) {
  exchange.numbers[0] = result.lower, exchange.numbers[1] = result.upper;
  give(result.witness, result.stats, static_cast<std::uint32_t>(result.status), result.stopped_by);
}

void give(const CollideResult& result) {
  give(result.witness, result.stats, static_cast<std::uint32_t>(result.answer), result.stopped_by);
}

LIMBER_EXPORT(exchange) Exchange* exported_exchange() { return &exchange; }

/// Makes room for arrays from JavaScript; returns where, or null.
LIMBER_EXPORT(reserveInput) void* reserve_input(std::size_t bytes) {
  if (!guarded([&] { input_memory.resize((bytes + sizeof(double) - 1) / sizeof(double)); })) return nullptr;
  return input();
}

LIMBER_EXPORT(errorCode) std::int32_t error_code() { return last_error.code; }
LIMBER_EXPORT(errorWhere) double error_where() { return last_error.where; }
LIMBER_EXPORT(errorText) const char* error_text() { return last_error.text.data(); }
LIMBER_EXPORT(errorTextSize) std::size_t error_text_size() { return last_error.text.size(); }

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
