// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bending_model.h"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "number_text.h"
#include "options.h"

namespace limber::program {
namespace {

const std::vector<std::pair<std::string, BendingEngine>> engine_words = {{"fast", BendingEngine::fast},
                                                                         {"classic", BendingEngine::classic}};
const std::vector<std::pair<std::string, classic::Maintenance>> mode_words = {
    {"immediate", classic::Maintenance::immediate},
    {"batched", classic::Maintenance::batched},
    {"by-depth", classic::Maintenance::by_depth},
};

/// Slack of the classic engine multiplies from level to level; at most this much of it keeps every radius and its
/// square finite in a tree of 32 levels.
constexpr double max_classic_slack = 100;
constexpr double max_stale_ratio = 1e6;

template <typename T>
std::string word_of(const std::vector<std::pair<std::string, T>>& words, T wanted) {
  for (const auto& [word, value] : words) {
    if (value == wanted) return word;
  }
  throw std::logic_error("a choice has no word");
}

double read_slack(const std::string& text) {
  if (text == "auto") return ModelOptions::automatic;
  const std::optional<double> number = parsed_number(text);
  if (!number || !(*number >= 0 && *number <= std::numeric_limits<double>::max())) {
    throw CLI::ValidationError("--slack", fmt::format("must be a finite number >= 0, or auto, not '{}'", text));
  }
  return *number;
}

std::variant<Model, classic::Model> made(Mesh mesh, const BendingOptions& options) {
  using Either = std::variant<Model, classic::Model>;
  if (options.engine == BendingEngine::fast) return Either(std::in_place_type<Model>, std::move(mesh), options.fast);
  return Either(std::in_place_type<classic::Model>, std::move(mesh), options.classic);
}

}  // namespace

void add_bending(CLI::App& command, BendingOptions& target) {
  add_choice(command, "--engine", target.engine, engine_words, "what answers");
  const auto slack = std::make_shared<double>(0);
  command
      .add_option_function<std::string>(
          "--slack", [slack](const std::string& text) { *slack = read_slack(text); },
          "fast: how far vertices may go before the tree follows, a length, or auto; classic: extra radius of spheres, "
          "as a fraction")
      ->type_name("NUMBER|auto")
      ->default_str("0");
  CLI::Option* const mode = add_choice(
      command, "--mode", target.classic.maintenance, mode_words,
      "classic: when spheres above moved triangles are recomputed: at once, per triangle at the end of the update, or "
      "deepest first at the end");
  CLI::Option* const stale = add_number(
      command, "--stale-ratio", target.classic.looseness.stale_ratio, {1, max_stale_ratio, "a number from 1 to 1e6"},
      "classic: a loose sphere is recomputed once its radius is this many times that of a new one");
  command.parse_complete_callback([&target, slack, mode, stale] {
    if (target.engine == BendingEngine::fast) {
      for (const CLI::Option* option : {mode, stale}) {
        if (option->count() > 0) throw CLI::ValidationError(option->get_name(), "belongs to --engine classic");
      }
      target.fast.slack = *slack;
      return;
    }
    if (!(*slack >= 0 && *slack <= max_classic_slack)) {
      throw CLI::ValidationError("--slack", "must be a number from 0 to 100 for the classic engine");
    }
    target.classic.looseness.slack = *slack;
  });
}

const char* to_text(BendingEngine engine) { return engine == BendingEngine::fast ? "fast" : "classic"; }

std::string words_of(const BendingOptions& options) {
  if (options.engine == BendingEngine::classic) {
    return fmt::format("classic, {}, slack {:g}", word_of(mode_words, options.classic.maintenance),
                       options.classic.looseness.slack);
  }
  const double slack = options.fast.slack;
  return slack == ModelOptions::automatic ? "fast, tuned slack" : fmt::format("fast, slack {:g}", slack);
}

BendingWork& BendingWork::operator+=(const BendingWork& other) {
  moved_vertices += other.moved_vertices;
  refits += other.refits;
  absorbed += other.absorbed;
  return *this;
}

BendingWork BendingWork::operator-(const BendingWork& earlier) const {
  return {moved_vertices - earlier.moved_vertices, refits - earlier.refits, absorbed - earlier.absorbed};
}

BendingModel::BendingModel(Mesh mesh, const BendingOptions& options) : model_(made(std::move(mesh), options)) {}

Result<void> BendingModel::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  return std::visit([&](auto& model) { return model.move_vertices(ids, positions); }, model_);
}

Result<void> BendingModel::move_all(std::span<const Vec3> positions) {
  return std::visit([&](auto& model) { return model.move_all(positions); }, model_);
}

void BendingModel::commit() {
  std::visit([](auto& model) { model.commit(); }, model_);
}

const Mesh& BendingModel::mesh() const {
  return std::visit([](const auto& model) -> const Mesh& { return model.mesh(); }, model_);
}

BendingWork BendingModel::work() const {
  return std::visit(
      [](const auto& model) {
        const auto stats = model.maintenance_stats();
        return BendingWork{stats.moved_vertices, stats.refits, stats.absorbed};
      },
      model_);
}

DistanceResult BendingModel::distance(const BendingModel& a, const Transform& pose_a, const BendingModel& b,
                                      const Transform& pose_b, const DistanceOptions& options) {
  if (const auto* const fast = std::get_if<Model>(&a.model_)) {
    return limber::distance({*fast, pose_a}, {std::get<Model>(b.model_), pose_b}, options);
  }
  return classic::distance({std::get<classic::Model>(a.model_), pose_a}, {std::get<classic::Model>(b.model_), pose_b},
                           options);
}

}  // namespace limber::program
