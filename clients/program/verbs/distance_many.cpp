// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/distance_many.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "answers/answers.h"
#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv.h"
#include "formats/csv_inputs.h"
#include "limber/io.h"
#include "limber/scene.h"
#include "reports/study.h"

namespace limber::program {
namespace {

/// `--accept`: pairs of parts that may touch, or even overlap.
class AcceptedPairs {
 public:
  /// Accepts nothing if the path is empty. Errors: BadInput of read_csv(), and where a word is neither.
  explicit AcceptedPairs(std::string path);

  /// The first line that accepts the answer to a pair of names, counted from 1.
  std::optional<std::size_t> accept(const std::string& name_a, const std::string& name_b, const DistanceAnswer& answer);

  /// Warns of each line that has accepted nothing.
  void warn_about_unused() const;

 private:
  struct Rule {
    std::string a, b;  ///< patterns
    bool allows_all = false, is_used = false;
    std::size_t line = 0;
  };

  std::string path_;
  std::vector<Rule> rules_;
};

constexpr std::array<std::string_view, 3> accept_columns = {"name_a", "name_b", "allowed"};

/// Whether a pattern with * and ? is that of a name. Each * takes as little as will do; none has to take more.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, after_star = std::string_view::npos, resumed = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p, resumed = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (after_star != std::string_view::npos) {
      p = after_star, n = ++resumed;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

/// Whether the parts touch or may touch, and nothing worse is possible.
bool is_touching(const DistanceAnswer& answer) {
  const bool may_touch = answer.clash == Clash::cannot_tell && !answer.may_clash && answer.result.lower == 0;
  return answer.clash == Clash::touching || may_touch;
}

AcceptedPairs::AcceptedPairs(std::string path) : path_(std::move(path)) {
  if (path_.empty()) return;
  const CsvFormat format{"pair", accept_columns, 2, true, "; the first row names the columns: name_a,name_b,allowed",
                         true};
  read_csv(path_, format, [&](const std::vector<std::string>& fields, std::size_t line) {
    const std::string& allowed = fields[2];
    if (allowed != "all" && allowed != "touching" && !allowed.empty()) {
      throw BadInput(fmt::format("column allowed: must be touching or all, not '{}'", shown(allowed)));
    }
    rules_.push_back({fields[0], fields[1], allowed == "all", false, line});
  });
}

std::optional<std::size_t> AcceptedPairs::accept(const std::string& name_a, const std::string& name_b,
                                                 const DistanceAnswer& answer) {
  if (answer.clash == Clash::clear || answer.clash == Clash::surfaces_apart) return std::nullopt;
  std::optional<std::size_t> first;
  for (Rule& rule : rules_) {
    if (!rule.allows_all && !is_touching(answer)) continue;
    const bool is_meant =
        (matches(rule.a, name_a) && matches(rule.b, name_b)) || (matches(rule.a, name_b) && matches(rule.b, name_a));
    if (!is_meant) continue;
    rule.is_used = true;
    if (!first) first = rule.line;
  }
  return first;
}

void AcceptedPairs::warn_about_unused() const {
  for (const Rule& rule : rules_) {
    if (!rule.is_used) warn("distance", fmt::format("{}: line {}: accepts no pair", path_, rule.line));
  }
}

struct FilePart {
  std::string name;  ///< as the file has it; may be empty
  MeshFile file;     ///< its triangles in their order; faces are numbered as in the whole file
};

/// Whether a name ends as those of mesh files do.
bool is_mesh_file(const std::string& path) {
  constexpr std::array<std::string_view, 6> endings = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// The parts of one mesh file, such as the nodes of a glTF scene or the objects of an OBJ file, as meshes of their own.
std::vector<FilePart> read_file_parts(const std::string& path) {
  const MeshFile whole = value_or_bad_input(read_mesh_file(path, {.parts = true}));
  for (const std::filesystem::path& read : whole.files) add_input(read);
  const MeshView mesh = whole.mesh;
  std::vector<std::vector<TriangleId>> triangles_of(whole.parts.size());
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) triangles_of[whole.part_of_triangle[t]].push_back(t);
  std::vector<std::size_t> named_by(mesh.positions.size(), triangles_of.size());  // the part that named a vertex last
  std::vector<VertexId> number_in_part(mesh.positions.size());
  std::vector<FilePart> parts;
  for (std::size_t part = 0; part < triangles_of.size(); ++part) {
    std::vector<Vec3> positions;
    std::vector<Corners> triangles;
    std::vector<std::uint32_t> faces;
    for (const TriangleId t : triangles_of[part]) {
      Corners corners = mesh.triangles[t];
      for (VertexId& v : corners) {
        if (std::exchange(named_by[v], part) != part) {
          number_in_part[v] = static_cast<VertexId>(positions.size());
          positions.push_back(mesh.positions[v]);
        }
        v = number_in_part[v];
      }
      triangles.push_back(corners);
      faces.push_back(whole.face_of_triangle[t]);
    }
    Mesh own = value_or_bad_input(Mesh::create(std::move(positions), std::move(triangles)));
    MeshFile& file = parts.emplace_back(FilePart{whole.parts[part], {std::move(own), faces, 0, {}, {}, {}, {}}}).file;
    file.face_count = static_cast<std::size_t>(std::unique(faces.begin(), faces.end()) - faces.begin());
  }
  return parts;
}

/// Models by their names. A file that is named in several ways is still one model.
class Models {
 public:
  const RigidModel* load(const std::string& name) {
    std::unique_ptr<RigidModel>& model = models_[key_of(name)];
    if (model) return model.get();
    MeshFile file = load_mesh_argument(name);
    file.parts.clear();  // rows have no cells for their names
    model = std::make_unique<RigidModel>(std::move(file));
    return model.get();
  }

  const RigidModel* keep(MeshFile mesh) {
    return parts_.emplace_back(std::make_unique<RigidModel>(std::move(mesh))).get();
  }

 private:
  static std::string key_of(const std::string& name) {
    if (is_scene(name)) return name;
    std::error_code failed;
    const std::filesystem::path path = std::filesystem::weakly_canonical(name, failed);
    return failed ? name : path.string();
  }

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
  for (const StudyPart& part : parts) static_cast<void>(scene.add({part.model->model(), part.pose}));
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

AnswerColumns columns_of(StudyKind kind) {
  const AskedPairs sample{kind, std::vector<StudyPart>(2), {}};
  DistanceAnswer answer;
  answer.witness.emplace();
  return AnswerColumns(answer_in_row(0, sample, {0, 1}, answer, {}));
}

}  // namespace

std::string pairs_answer_columns() { return columns_of(StudyKind::pairs).help(); }

ExitCode answer_pairs(const ManyPairsArguments& arguments, const DistanceQuestion& question) {
  Models models;
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
  const AnswerColumns columns = columns_of(asked.kind);
  if (!arguments.json) out.write(columns.header());
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
    out.write_rows(arguments.json ? to_line(json) : columns.line(json));
  }
  bar.clear();
  warn_about(nested_count);
  accepted_pairs.warn_about_unused();
  if (report) report->write(study->to_json());
  return exit_code;
}

}  // namespace limber::program
