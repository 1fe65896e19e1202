// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/distance_many.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv_inputs.h"
#include "limber/scene.h"
#include "reports/study.h"
#include "verbs/accepted_pairs.h"
#include "verbs/file_parts.h"

namespace limber::program {
namespace {

/// Models by their names. A file that is named in several ways is still one model.
class Models {
 public:
  explicit Models(Engine engine) : engine_(engine) {}

  const RigidModel* load(const std::string& name) {
    std::unique_ptr<RigidModel>& model = models_[key_of(name)];
    if (model) return model.get();
    MeshFile file = load_mesh_argument(name);
    file.parts.clear();  // rows have no cells for their names
    model = std::make_unique<RigidModel>(std::move(file), engine_);
    return model.get();
  }

  const RigidModel* keep(MeshFile mesh) {
    return parts_.emplace_back(std::make_unique<RigidModel>(std::move(mesh), engine_)).get();
  }

 private:
  static std::string key_of(const std::string& name) {
    if (is_scene(name)) return name;
    std::error_code failed;
    const std::filesystem::path path = std::filesystem::weakly_canonical(name, failed);
    return failed ? name : path.string();
  }

  Engine engine_;
  std::map<std::string, std::unique_ptr<RigidModel>> models_;
  std::vector<std::unique_ptr<RigidModel>> parts_;  // of one file
};

/// What is asked about.
struct AskedPairs {
  StudyKind kind = StudyKind::pairs;
  std::vector<StudyPart> parts;
  std::vector<PartPair> pairs;
};

/// Loads the model that stands in a row of a file. Errors: BadInput naming the place.
StudyPart loaded(Models& models, const std::string& path, std::size_t line, const char* column,
                 const std::string& model, const Transform& pose) {
  try {
    return {shown_name(model), model, models.load(model), pose};
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("{}: line {}: column {}: {}", path, line, column, error.what()));
  }
}

AskedPairs pairs_of_file(const std::string& path, Models& models) {
  AskedPairs asked;
  for (const PairRow& row : read_pairs(path)) {
    asked.pairs.push_back({asked.parts.size(), asked.parts.size() + 1});
    asked.parts.push_back(loaded(models, path, row.line, "model_a", row.model_a, row.pose_a));
    asked.parts.push_back(loaded(models, path, row.line, "model_b", row.model_b, row.pose_b));
  }
  return asked;
}

/// The pairs of parts that may be so near, or one inside the other, in their order.
std::vector<PartPair> near_pairs(const std::vector<StudyPart>& parts, double max_distance) {
  std::vector<PartPair> pairs;
  if (!std::isfinite(max_distance)) {
    for (std::size_t a = 0; a < parts.size(); ++a) {
      for (std::size_t b = a + 1; b < parts.size(); ++b) pairs.push_back({a, b});
    }
    return pairs;
  }
  Scene scene;
  for (const StudyPart& part : parts) static_cast<void>(scene.add({part.model->in_fast_engine(), part.pose}));
  scene.commit();
  scene.visit_candidate_pairs(max_distance, [&](const ObjectPair& pair) {
    pairs.push_back({pair.a, pair.b});
    return true;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

AskedPairs pairs_of_parts(const std::string& path, Models& models, double max_distance) {
  AskedPairs asked{StudyKind::parts, {}, {}};
  if (is_mesh_file(path)) {
    for (FilePart& part : read_file_parts(path)) {
      asked.parts.push_back(
          {part.name.empty() ? shown_name(path) : part.name, path, models.keep(std::move(part.file)), Transform{}});
    }
  }
  for (const PartRow& row : is_mesh_file(path) ? std::vector<PartRow>() : read_parts(path)) {
    asked.parts.push_back(loaded(models, path, row.line, "model", row.model, row.pose));
    if (!row.name.empty()) asked.parts.back().name = row.name;
  }
  if (asked.parts.size() < 2) throw BadInput(path + ": has one part alone, which makes no pair");
  asked.pairs = near_pairs(asked.parts, max_distance);
  return asked;
}

Json answer_in_row(std::size_t number, const AskedPairs& asked, const PartPair& pair, const DistanceAnswer& answer,
                   const std::optional<std::size_t>& accepted) {
  const auto& [a, b] = pair;
  const StudyPart &part_a = asked.parts[a], &part_b = asked.parts[b];
  Json json = {{"row", number}};
  if (asked.kind == StudyKind::pairs) {
    json["model_a"] = part_a.file;
    json["model_b"] = part_b.file;
  } else {
    json["part_a"] = a;
    json["part_b"] = b;
    json["name_a"] = part_a.name;
    json["name_b"] = part_b.name;
  }
  append_answer(json, answer);
  json["accepted"] = to_json(accepted);
  append_work(json, answer.result.stats, answer.elapsed_us);
  return json;
}

/// Makes what models make when they are first asked for it, so that threads may ask them.
void prepare(const AskedPairs& asked) {
  for (const StudyPart& part : asked.parts) {
    static_cast<void>(part.model->surface());
    static_cast<void>(part.model->is_closed());
  }
}

/// Answers the pairs from `first` on, as many as `answers` has room for, on all threads.
void answer_next(const DistanceQuestion& question, const AskedPairs& asked, std::size_t first,
                 std::vector<DistanceAnswer>& answers) {
  const std::size_t count = std::min(answers.size(), asked.pairs.size() - first);
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto& [a, b] = asked.pairs[first + i];
    answers[i] = answer_to(question, asked.parts[a].placed(), asked.parts[b].placed());
  });
}

void warn_about(std::size_t nested_count) {
  if (nested_count == 0) return;
  const std::string where =
      nested_count == 1 ? "in 1 row a model lies" : fmt::format("in {} rows a model lies", nested_count);
  warn("distance", where + " inside the other without touching it; models are surfaces, not solids (column inside)");
}

/// The columns that answer_in_row() fills after those that name the pair.
std::string answer_columns() {
  return fmt::format("{},{},too_close,inside,clash,solids,depth,accepted,query_us,node_tests,primitive_tests",
                     distance_columns, witness_columns);
}

std::string parts_answer_columns() { return "row,part_a,part_b,name_a,name_b," + answer_columns(); }

}  // namespace

std::string pairs_answer_columns() { return "row,model_a,model_b," + answer_columns(); }

ExitCode answer_pairs(const ManyPairsArguments& arguments, const DistanceQuestion& question) {
  Models models(arguments.engine);
  const std::string& path = arguments.parts.empty() ? arguments.pairs : arguments.parts;
  const double max_distance = question.options.max_distance + question.tolerances.of_pair();
  const AskedPairs asked =
      arguments.parts.empty() ? pairs_of_file(path, models) : pairs_of_parts(path, models, max_distance);
  AcceptedPairs accepted_pairs(arguments.accept);
  std::optional<Study> study;
  if (!arguments.report.path.empty()) study.emplace(asked.kind, question, asked.parts);
  OutputFile out("--out", arguments.out);
  std::optional<ReportFile> report;
  if (study) report.emplace(arguments.report);
  ProgressBar bar(asked.pairs.size(), "pairs");
  ExitCode exit_code = ExitCode::answered;
  std::size_t nested_count = 0, row = 0;
  if (!arguments.json) {
    out.write((asked.kind == StudyKind::pairs ? pairs_answer_columns() : parts_answer_columns()) + '\n');
  }
  prepare(asked);
  std::vector<DistanceAnswer> answers(32 * static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency()));
  for (std::size_t i = 0; i < asked.pairs.size(); ++i) {
    bar.draw(i);
    const auto& [a, b] = asked.pairs[i];
    if (i % answers.size() == 0) answer_next(question, asked, i, answers);
    const DistanceAnswer& answer = answers[i % answers.size()];
    const bool is_far = answer.result.status == DistanceStatus::beyond_limit && !answer.may_clash;
    if (is_far && asked.kind == StudyKind::parts) continue;
    const auto accepted = accepted_pairs.accept(asked.parts[a].name, asked.parts[b].name, answer);
    if (answer.relation.nesting != Nesting::none) ++nested_count;
    if (!accepted) exit_code = worse_of(exit_code, exit_code_of(question, answer));
    if (study) study->add(row, asked.pairs[i], answer, accepted);
    if (out.is_terminal()) bar.clear();
    const Json json = answer_in_row(row++, asked, asked.pairs[i], answer, accepted);
    out.write_rows(arguments.json ? to_line(json) : csv_line(json));
  }
  bar.clear();
  warn_about(nested_count);
  accepted_pairs.warn_about_unused();
  if (report) report->write(study->to_json());
  return exit_code;
}

}  // namespace limber::program
