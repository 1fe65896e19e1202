// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/distance_pairs.h"

#include <filesystem>
#include <map>
#include <memory>
#include <system_error>
#include <vector>

#include "command/bad_input.h"
#include "command/progress_bar.h"
#include "command/text.h"
#include "formats/csv.h"
#include "formats/pairs_csv.h"

namespace limber::program {
namespace {

/// Models by their names. A file that is named in several ways is still one model.
class Models {
 public:
  explicit Models(Engine engine) : engine_(engine) {}

  const RigidModel* load(const std::string& name) {
    std::unique_ptr<RigidModel>& model = models_[key_of(name)];
    if (!model) model = std::make_unique<RigidModel>(load_mesh_argument(name), engine_);
    return model.get();
  }

  /// The files that have been loaded.
  Names files() const {
    Names files;
    for (const auto& [name, model] : models_) files.push_back(name);
    return files;
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
};

/// The models of one row.
struct LoadedPair {
  const RigidModel *a = nullptr, *b = nullptr;
};

std::vector<LoadedPair> load_all(const std::vector<PairRow>& rows, const std::string& path, Models& models) {
  std::vector<LoadedPair> pairs;
  pairs.reserve(rows.size());
  const auto load = [&](const PairRow& row, const char* column, const std::string& name) {
    try {
      return models.load(name);
    } catch (const BadInput& error) {
      throw BadInput(fmt::format("{}: line {}: column {}: {}", path, row.line, column, error.what()));
    }
  };
  for (const PairRow& row : rows) {
    pairs.push_back({load(row, "model_a", row.model_a), load(row, "model_b", row.model_b)});
  }
  return pairs;
}

const char* word_of(const std::optional<bool>& is_true) { return !is_true ? "" : *is_true ? "true" : "false"; }

std::string csv_line(std::size_t number, const PairRow& row, const DistanceAnswer& answer) {
  const Json nesting = to_json(answer.nesting);
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", number, csv_field(row.model_a), csv_field(row.model_b),
                     csv_cells(answer.result, answer.witness), word_of(answer.too_close),
                     nesting.is_null() ? "" : nesting.get<std::string>(), to_text(answer.elapsed_us),
                     answer.result.stats.node_tests, answer.result.stats.triangle_tests);
}

std::string json_line(std::size_t number, const PairRow& row, const DistanceAnswer& answer) {
  Json json = {{"row", number}, {"model_a", row.model_a}, {"model_b", row.model_b}};
  append_answer(json, answer);
  append_work(json, answer.result.stats, answer.elapsed_us);
  return to_line(json);
}

void warn_about(std::size_t nested_count) {
  if (nested_count == 0) return;
  const std::string where =
      nested_count == 1 ? "in 1 row a model lies" : fmt::format("in {} rows a model lies", nested_count);
  warn("distance", where + " inside the other without touching it; models are surfaces, not solids (column inside)");
}

}  // namespace

std::string pairs_answer_columns() {
  return fmt::format("row,model_a,model_b,{},{},too_close,inside,query_us,node_tests,triangle_tests", distance_columns,
                     witness_columns);
}

ExitCode answer_pairs(const PairsArguments& arguments, const DistanceQuestion& question) {
  const std::vector<PairRow> rows = read_pairs(arguments.pairs);
  Models models(arguments.engine);
  const std::vector<LoadedPair> pairs = load_all(rows, arguments.pairs, models);
  Names inputs = models.files();
  inputs.push_back(arguments.pairs);
  OutputFile out("--out", arguments.out, inputs, {});
  ProgressBar bar(rows.size(), "pairs");
  ExitCode exit_code = ExitCode::answered;
  std::size_t nested_count = 0;
  if (!arguments.json) out.write(pairs_answer_columns() + '\n');
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bar.draw(i);
    const DistanceAnswer answer = answer_to(question, {*pairs[i].a, rows[i].pose_a}, {*pairs[i].b, rows[i].pose_b});
    if (answer.nesting != Nesting::none) ++nested_count;
    if (exit_code_of(question, answer) == ExitCode::found) exit_code = ExitCode::found;
    if (out.is_terminal()) bar.clear();
    out.write(arguments.json ? json_line(i, rows[i], answer) : csv_line(i, rows[i], answer));
  }
  bar.clear();
  warn_about(nested_count);
  return exit_code;
}

}  // namespace limber::program
