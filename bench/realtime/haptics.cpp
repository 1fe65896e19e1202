// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        How long do the ticks of a force loop take, and how many come too late?
// Workload        A tool of 10 000 triangles is pressed up to 3 mm into tissue of 51 200, and drawn along. Each tick
//                 moves up to a few hundred vertices, commits, asks for the distance within 25 %, at most 1 mm, until
//                 its deadline, and moves a proxy. The tick's number alone decides what is commanded and how the tissue
//                 gives way.
// Metric          Times of whole ticks and their parts, how late they start, next to a loop that only waits; ticks that
//                 end after their period; how queries end, and how wide the intervals of interrupted ones are.
// Expected shape  Ticks within their budget, but for what the machine adds. No collision: the tool stays in front.
// Checked         Intervals hold the exact distance, in a second run without a clock that repeats every pose.
#include <oneapi/tbb/global_control.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "examples/proxy.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

// Lengths are in mm, z is up.
constexpr std::uint32_t side = 160;  // squares
constexpr double width = 120, spacing = width / side;
constexpr Vec3 semi_axes{8, 8, 16};  // of the tool, an ellipsoid
constexpr double fastest = 60;       // mm/s, of the device
constexpr double stiffness = 0.5;    // N/mm, of the spring between device and proxy
constexpr double press_s = 2;        // for one approach, pressing and lifting

double height_at_rest(double x, double y) {
  constexpr double k = 2 * std::numbers::pi / 40;
  return 2 * scenes::sine(k * x) * scenes::cosine(k * y);
}

Vec3 at_rest(VertexId v) {
  const double x = v % (side + 1) * spacing - width / 2, y = v / (side + 1) * spacing - width / 2;
  return {x, y, height_at_rest(x, y)};
}

/// A wavy sheet that gives way to two thirds of the depth to which a tool is commanded, in a paraboloid, and comes back
/// in 50 ms to a third of it.
class Tissue {
 public:
  explicit Tissue(double tick_s) : kept_(std::exp(-tick_s / 0.05)), depth_(vertices_), told_(vertices_) {
    dented_.reserve(vertices_), ids.reserve(vertices_), positions.reserve(vertices_);
    for (VertexId v = 0; v < vertices_; ++v) rest_.push_back(at_rest(v));
  }

  Mesh mesh() const { return Mesh::create(rest_, scenes::grid(side, side, 0, 0, 1, 1).triangles()).value(); }

  /// Sets `ids` and `positions` to what moves in a tick while the tool's lowest point is commanded to be at `tip`; less
  /// than 0.005 mm is left for later.
  void press(const Vec3& tip) {
    for (const VertexId v : dented_) depth_[v] *= kept_;
    double deepest = 0;
    for_each_above(tip, [&](VertexId, double depth) { deepest = std::max(deepest, depth); });
    for_each_above(tip + Vec3{0, 0, deepest / 3}, [&](VertexId v, double depth) {
      if (depth_[v] == 0) dented_.push_back(v);
      depth_[v] = std::max(depth_[v], depth);
    });
    ids.clear(), positions.clear();
    for (std::size_t i = dented_.size(); i-- > 0;) {
      const VertexId v = dented_[i];
      if (depth_[v] < 0.02) depth_[v] = 0, dented_[i] = dented_.back(), dented_.pop_back();
      if (depth_[v] > 0 && std::abs(depth_[v] - told_[v]) < 0.005) continue;
      told_[v] = depth_[v];
      ids.push_back(v), positions.push_back(rest_[v] - Vec3{0, 0, depth_[v]});
    }
  }

  std::vector<VertexId> ids;
  std::vector<Vec3> positions;

 private:
  template <typename Function>
  void for_each_above(const Vec3& tip, const Function& f) const {
    if (tip.z >= 2) return;
    const double curvature = 1. / 24, reach = std::sqrt((2 - tip.z) / curvature);
    const auto index = [](double x) {
      return static_cast<VertexId>(std::clamp(std::ceil((x + width / 2) / spacing), 0., side + 1.));
    };
    for (VertexId j = index(tip.y - reach), j_end = index(tip.y + reach); j < j_end; ++j) {
      for (VertexId i = index(tip.x - reach), i_end = index(tip.x + reach); i < i_end; ++i) {
        const Vec3 above = rest_[j * (side + 1) + i] - tip;
        const double depth = above.z - curvature * (above.x * above.x + above.y * above.y);
        if (depth > 0) f(j * (side + 1) + i, depth);
      }
    }
  }

  static constexpr std::size_t vertices_ = (side + 1) * (side + 1);
  double kept_;  // of a depth after a tick
  std::vector<Vec3> rest_;
  std::vector<double> depth_, told_;
  std::vector<VertexId> dented_;
};

Mesh tool_mesh() {
  const Mesh ball = scenes::ball(100, 51);
  std::vector<Vec3> positions = ball.positions();
  for (Vec3& p : positions) p = {semi_axes.x * p.x, semi_axes.y * p.y, semi_axes.z * p.z};
  return Mesh::create(std::move(positions), ball.triangles()).value();
}

/// From the tool's center to its lowest point: S S d / |S d| is farthest along d, with the semi-axes as S.
Vec3 to_tip(const Mat3& rotation) {
  const Vec3 down = transpose(rotation) * Vec3{0, 0, -1}, &s = semi_axes;
  const Vec3 scaled{s.x * down.x, s.y * down.y, s.z * down.z};
  return rotation * (Vec3{s.x * scaled.x, s.y * scaled.y, s.z * scaled.z} * (1 / length(scaled)));
}

/// Where the tool would be without tissue. Periods have no common multiple, so it hardly comes the same way twice.
Transform device_at(double seconds) {
  const auto turn = [seconds](double period) { return 2 * std::numbers::pi * seconds / period; };
  const double x = 42 * scenes::sine(turn(13)), y = 42 * scenes::sine(turn(9.7) + 0.7);
  const double z = height_at_rest(x, y) + 1 + 4 * scenes::cosine(turn(press_s)), tilt = scenes::sine(0.15);
  const double i = tilt * scenes::cosine(turn(17)), j = tilt * scenes::sine(turn(17));
  const Mat3 rotation = transform_from_quaternion({}, scenes::cosine(0.15), i, j, 0).value().rotation;
  return {rotation, Vec3{x, y, z} - to_tip(rotation)};
}

struct Tick {
  double late = 0, work = 0, move = 0, commit = 0, query = 0;  // us
  double lower = 0, upper = 0, force = 0;
  Vec3 place;  // of the tool
  std::size_t moved = 0;
  DistanceStatus status = DistanceStatus::exact;
  bool has_waited = false;  // the tick before had ended when this one's time came
};

struct Loop {
  double rate, budget_us;
  Tissue sheet{1 / rate};
  Model tissue{sheet.mesh(), ModelOptions::real_time(10)}, tool{tool_mesh()};
  Proxy proxy{.place = device_at(0).translation, .retreat = fastest / rate};
  QueryCache cache{};

  /// Returns where the device is.
  Transform deform(std::uint64_t number, Tick& tick, Clock::time_point start) {
    const Transform device = device_at(static_cast<double>(number) / rate);
    sheet.press(device.translation + to_tip(device.rotation));
    tissue.move_vertices(sheet.ids, sheet.positions).value();
    tick.move = us_since(start);
    tissue.commit();
    tick.commit = us_since(start) - tick.move;
    tick.moved = sheet.ids.size();
    return device;
  }

  void run(std::uint64_t number, Tick& tick) {
    const auto start = Clock::now();
    const Transform device = deform(number, tick, start);
    // The last 5 us are for the force, and for what a query overruns its deadline by.
    const auto deadline = start + std::chrono::nanoseconds(std::llround(1000 * (budget_us - 5)));
    const DistanceOptions options{.relative_error = 0.25,
                                  .max_distance = std::max(1.0, 4 * fastest / rate),
                                  .cache = &cache,
                                  .budget = {.deadline = deadline}};
    tick.place = proxy.place;
    const DistanceResult found = distance({tissue}, {tool, {device.rotation, proxy.place}}, options);
    tick.query = us_since(start) - tick.move - tick.commit;
    proxy.follow(device.translation, found);
    tick.force = stiffness * length(proxy.place - device.translation);
    tick.lower = found.lower, tick.upper = found.upper, tick.status = found.status;
    tick.work = us_since(start);
  }
};

/// Tick i starts i periods after the first, at once if its time has passed. Sleeps end `spin` before.
template <typename Work>
void run_ticks(double rate, std::vector<Tick>& ticks, const Work& work) {
  constexpr std::chrono::microseconds spin{30};
  const std::chrono::nanoseconds period(std::llround(1e9 / rate));
  auto time = Clock::now() + std::chrono::milliseconds(1);
  for (std::size_t i = 0; i < ticks.size(); ++i, time += period) {
    ticks[i].has_waited = Clock::now() < time;
    if (Clock::now() < time - spin) std::this_thread::sleep_until(time - spin);
    while (Clock::now() < time) {
    }
    ticks[i].late = us_since(time);
    work(i, ticks[i]);
  }
}

/// Asks Linux for a core, for priority over ordinary threads, and for memory that stays. Returns what it got.
std::string real_time(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof(cores), &cores);
  for (int c = CPU_SETSIZE; core < 0 && c-- > 0;) core = CPU_ISSET(c, &cores) ? c : -1;
  CPU_ZERO(&cores);
  CPU_SET(core, &cores);
  if (sched_setaffinity(0, sizeof(cores), &cores) != 0) throw std::runtime_error(fmt::format("no core {}", core));
  prctl(PR_SET_TIMERSLACK, 1UL);  // ordinary threads may sleep 50 us longer, to wake several at once
  const sched_param priority{.sched_priority = 80};
  const bool has_priority = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
  const bool has_memory = mlockall(MCL_CURRENT) == 0;
  return fmt::format("core {}, {}, {}", core, has_priority ? "SCHED_FIFO 80" : "no priority",
                     has_memory ? "locked memory" : "memory not locked");
}

void end_real_time() {
  const sched_param none{};
  sched_setscheduler(0, SCHED_OTHER, &none);
  munlockall();
}

/// The tissue is deformed as before, and asked exactly with the tool where it was, in one of `every` ticks.
void check(Loop& loop, std::uint64_t first, const std::vector<Tick>& ticks, std::size_t every, Checker& checker) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    Tick again;
    const Transform device = loop.deform(first + i, again, Clock::now());
    const Tick& tick = ticks[i];
    if (i % every != 0 && tick.status != DistanceStatus::interrupted) continue;
    const double truth = distance({loop.tissue}, {loop.tool, {device.rotation, tick.place}}).upper;
    checker.check(tick.lower <= truth + 1e-12 && tick.upper >= truth - 1e-12, "tick {}: [{}, {}] does not hold {}", i,
                  tick.lower, tick.upper, truth);
  }
}

struct Settings {
  std::vector<double> rates{1000, 5000};
  double seconds = 60;
  std::optional<double> budget_us;
  int core = -1;
};

void play(double rate, const Settings& settings, const Options& options, Checker& checker, Table& text) {
  const double seconds = options.quick ? 2.5 : settings.seconds;
  // 45 % of the period: a tick that starts late by half of it still ends in time.
  const double budget_us = settings.budget_us.value_or(std::min(0.45e6 / rate, 130.0));
  const auto warm = static_cast<std::uint64_t>(press_s * rate), step = std::max<std::uint64_t>(warm / 500, 1);
  Loop loop{rate, budget_us}, same{rate, budget_us};
  const auto warm_up = [&](const auto& tick) {
    for (std::uint64_t n = 0; n < warm; n += step) tick(n);
  };
  Tick unused;
  warm_up([&](std::uint64_t n) { loop.run(n, unused); });
  std::vector<Tick> ticks(static_cast<std::size_t>(std::max(1.0, rate * seconds))), empty(ticks.size() / 6 + 1);
  const std::string granted = real_time(settings.core);
  run_ticks(rate, empty, [](std::uint64_t, Tick&) {});
  run_ticks(rate, ticks, [&](std::uint64_t i, Tick& tick) { loop.run(warm + i, tick); });
  end_real_time();
  warm_up([&](std::uint64_t n) { same.deform(n, unused, Clock::now()); });
  check(same, warm, ticks, 20, checker);

  text.line("\n## {} Hz\n\n| us | p50 | p99 | p99.9 | p99.99 | max |\n|:--|--:|--:|--:|--:|--:|", rate);
  const auto row = [&](const char* name, const std::vector<Tick>& of, double Tick::*us, bool waited_only) {
    std::vector<double> times;
    for (const Tick& tick : of) {
      if (!waited_only || tick.has_waited) times.push_back(tick.*us);
    }
    text.line("| {} | {} |", name, summarize(std::move(times)).tail());
  };
  row("whole tick", ticks, &Tick::work, false);
  row("move and deform", ticks, &Tick::move, false);
  row("commit", ticks, &Tick::commit, false);
  row("query", ticks, &Tick::query, false);
  row("late wake-up", ticks, &Tick::late, true);
  row("late wake-up, empty loop", empty, &Tick::late, true);
  std::map<DistanceStatus, std::size_t> answers;
  std::vector<double> widths;
  std::size_t missed = 0, late_starts = 0, moved = 0;
  double force = 0;
  for (const Tick& tick : ticks) {
    ++answers[tick.status];
    if (tick.status == DistanceStatus::interrupted) widths.push_back(100 * (1 - tick.lower / tick.upper));
    missed += tick.late + tick.work > 1e6 / rate ? 1 : 0;
    late_starts += tick.has_waited ? 0 : 1;
    moved += tick.moved, force = std::max(force, tick.force);
  }
  const Summary width_of = summarize(std::move(widths));
  text.line("\n- {} ticks, {} missed, {} late starts; {}; a budget of {:g} us", ticks.size(), missed, late_starts,
            granted, budget_us);
  text.line("- answers: {} within 25 %, {} beyond the limit, {} collisions, {} interrupted",
            answers[DistanceStatus::within_error] + answers[DistanceStatus::exact],
            answers[DistanceStatus::beyond_limit], answers[DistanceStatus::collision],
            answers[DistanceStatus::interrupted]);
  text.line("- interrupted intervals are {:.1f} % of upper wide, p99 {:.1f}, at most {:.1f}", width_of.median,
            width_of.p99, width_of.max);
  text.line("- {} vertices moved in a tick on average; the largest force is {:.2f} N", moved / ticks.size(), force);
  text.line("- {} triangles rebuilt", loop.tissue.maintenance_stats().rebuilt_triangles);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  using oneapi::tbb::global_control;
  const global_control one_thread(global_control::max_allowed_parallelism, 1);  // a commit waits for no other thread
  Settings settings;
  const auto run = [&](const Options& options, Checker& checker) {
    Table text(options, "haptics.md");
    text.line("# A force loop, as printed by `limber_bench_haptics`");
    for (const double rate : settings.rates) play(rate, settings, options, checker, text);
  };
  return run_bench(argc, argv, "A force loop in deforming tissue: times of ticks, and what their answers say", run,
                   [&](CLI::App& app) {
                     app.add_option("--rates", settings.rates, "Ticks in a second")->check(CLI::Range(1, 100'000));
                     app.add_option("--seconds", settings.seconds, "How long each rate is kept up");
                     app.add_option("--tick-budget-us", settings.budget_us, "For all of a tick's work");
                     app.add_option("--core", settings.core, "Where the loop runs; without it the last");
                   });
}
