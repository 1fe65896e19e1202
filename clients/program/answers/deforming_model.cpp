// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/deforming_model.h"
#include "limber/distance.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "command/options.h"
#include "command/text.h"

namespace limber::program {
namespace {

const std::vector<std::pair<std::string, DeformingEngine>> engine_words = {{"fast", DeformingEngine::fast},
                                                                           {"classic", DeformingEngine::classic}};
const std::vector<std::pair<std::string, classic::Maintenance>> mode_words = {
    {"immediate", classic::Maintenance::immediate},
    {"batched", classic::Maintenance::batched},
    {"by-depth", classic::Maintenance::by_depth},
};

/// The extra radius of the classic engine compounds from level to level; at most this much of it keeps every radius and
/// its square finite in a tree of 32 levels.
constexpr double max_extra_radius = 100;
constexpr double max_stale_ratio = 1e6;

template <typename T>
std::string word_of(const std::vector<std::pair<std::string, T>>& words, T wanted) {
  for (const auto& [word, value] : words) {
    if (value == wanted) return word;
  }
  throw std::logic_error("a choice has no word");
}

std::variant<Model, classic::Model> made(Mesh mesh, const DeformingOptions& options) {
  using Either = std::variant<Model, classic::Model>;
  if (options.engine == DeformingEngine::fast) return Either(std::in_place_type<Model>, std::move(mesh), options.fast);
  return Either(std::in_place_type<classic::Model>, std::move(mesh), options.classic);
}

}  // namespace

void add_deforming(CLI::App& command, DeformingOptions& target) {
  add_choice(command, "--engine", target.engine, engine_words, "the engine that answers");
  CLI::Option* const margin = add_number(command, "--motion-margin", target.fast.motion_margin, not_negative,
                                         "fast: how far a vertex may move before its bounds are refitted");
  CLI::Option* const extra_radius = add_number(
      command, "--extra-radius", target.classic.looseness.extra_radius, {0, max_extra_radius, "a number from 0 to 100"},
      "classic: how much larger than needed spheres are made, as a fraction of their radius");
  CLI::Option* const mode = add_choice(
      command, "--mode", target.classic.maintenance, mode_words,
      "classic: when spheres above moved triangles are recomputed: at once, per triangle at the end of the update, or "
      "deepest first at the end");
  CLI::Option* const stale = add_number(
      command, "--stale-ratio", target.classic.looseness.stale_ratio, {1, max_stale_ratio, "a number from 1 to 1e6"},
      "classic: a loose sphere is recomputed once its radius is this many times that of a new one");
  command.parse_complete_callback([&target, margin, extra_radius, mode, stale] {
    const auto refuse = [](const CLI::Option* option, const char* engine) {
      if (option->count() > 0) {
        throw CLI::ValidationError(option->get_name(), fmt::format("belongs to --engine {}", engine));
      }
    };
    if (target.engine == DeformingEngine::classic) return refuse(margin, "fast");
    for (const CLI::Option* option : {extra_radius, mode, stale}) refuse(option, "classic");
  });
}

const char* to_text(DeformingEngine engine) { return engine == DeformingEngine::fast ? "fast" : "classic"; }

std::string words_of(const DeformingOptions& options) {
  if (options.engine == DeformingEngine::classic) {
    return fmt::format("classic, {}, extra radius {}", word_of(mode_words, options.classic.maintenance),
                       options.classic.looseness.extra_radius);
  }
  return fmt::format("fast, motion margin {}", options.fast.motion_margin);
}

DeformingWork& DeformingWork::operator+=(const DeformingWork& other) {
  moved_vertices += other.moved_vertices;
  refits += other.refits;
  absorbed += other.absorbed;
  return *this;
}

DeformingWork DeformingWork::operator-(const DeformingWork& earlier) const {
  return {moved_vertices - earlier.moved_vertices, refits - earlier.refits, absorbed - earlier.absorbed};
}

DeformingModel::DeformingModel(Mesh mesh, const DeformingOptions& options) : model_(made(std::move(mesh), options)) {}

Result<void> DeformingModel::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  return std::visit([&](auto& model) { return model.move_vertices(ids, positions); }, model_);
}

Result<void> DeformingModel::move_all(std::span<const Vec3> positions) {
  return std::visit([&](auto& model) { return model.move_all(positions); }, model_);
}

void DeformingModel::commit() {
  std::visit([](auto& model) { model.commit(); }, model_);
}

const Mesh& DeformingModel::mesh() const {
  return std::visit([](const auto& model) -> const Mesh& { return model.mesh(); }, model_);
}

DeformingWork DeformingModel::work() const {
  return std::visit(
      [](const auto& model) {
        const auto stats = model.maintenance_stats();
        return DeformingWork{stats.moved_vertices, stats.refits, stats.absorbed};
      },
      model_);
}

DistanceResult DeformingModel::distance(const DeformingModel& a, const Transform& pose_a, const DeformingModel& b,
                                        const Transform& pose_b, const DistanceOptions& options) {
  if (const auto* const fast = std::get_if<Model>(&a.model_)) {
    return limber::distance({*fast, pose_a}, {std::get<Model>(b.model_), pose_b}, options);
  }
  return classic::distance({std::get<classic::Model>(a.model_), pose_a}, {std::get<classic::Model>(b.model_), pose_b},
                           options);
}

}  // namespace limber::program
