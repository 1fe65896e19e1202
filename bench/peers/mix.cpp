// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  How fast are queries next to FCL's and Coal's on a broad mix that nobody has tuned to?
// Workload  scenes.h: pairs of mesh files overlapping and at three gaps; floors, a wall, a room and a maze; scenes of
//           motion planners; FCL's own test scene; ball over square; linked rings; soups; bunny and armadillo, just
//           overlapping and beside each other. 40 random poses each, without a cache, and 200 along a path with one.
//           Collision, exact distance, distance within 10 %.
// Metric    Their time over ours, pose by pose: median, ratio of the sums, least. All libraries have their turn in
//           every round; the median of the rounds counts. A turn repeats the query until it takes 30 us; along a path
//           it is one query, without Coal. No other library has a cache. FCL ignores the error it is given, so
//           within 10 % an FCL is measured that is made to stop there; Coal answers exactly. "Faster" is at a pose
//           the library that takes less there, in a sum the one with the smaller sum.
// Checked   Answers agree, within the error asked for. Where they do not, the classic engine decides: FCL's wrong poses
//           are counted and not timed, and so is Coal at poses that it answers wrongly; a wrong answer of ours ends the
//           table, and the exit code is 1.
// Shape     Above 1; least where the bounds of the roots decide, and where few large triangles are near a fine mesh.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/peers/scenes.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/model.h"

namespace limber::bench {
namespace {

constexpr Question questions[] = {Question::collide, Question::exact, Question::rough};
constexpr const char* path_name = "path with a cache";

struct Answer {
  double value;  // the distance, 0 in contact; for `collide` 0 or 1: 0 means contact
  QueryStats stats;
};

Answer ask(const Model& a, const Model& b, Question question, const Transform& pose, QueryCache* cache) {
  const Placed pa{a}, pb{b, pose};
  if (question == Question::collide) {
    const CollideResult found = collide(pa, pb, {.cache = cache});
    return {found.is_yes() ? 0.0 : 1.0, found.stats};
  }
  const DistanceOptions options{.relative_error = question == Question::rough ? rough_error : 0, .cache = cache};
  const DistanceResult found = distance(pa, pb, options);
  return {found.upper, found.stats};
}

/// Models of one scene in every library.
class Contest {
 public:
  explicit Contest(const PeerScene& scene) : scene_(scene), a_(scene.a), b_(scene.b) {
#ifdef LIMBER_PEER_FCL
    fcl_ = make_fcl(scene.a, scene.b), forced_ = make_fcl_forced(scene.a, scene.b);
#else
    throw std::runtime_error("the mix is a comparison with FCL, which was not found");
#endif
#ifdef LIMBER_PEER_COAL
    coal_ = make_coal(scene.a, scene.b);
#endif
    const auto size = [](const Model& model) { return length(model.bounding_box().high - model.bounding_box().low); };
    size_ = size(a_) + size(b_);
  }

  Answer ours(Question question, const Transform& pose, QueryCache* cache = nullptr) const {
    return ask(a_, b_, question, pose, cache);
  }
  Peer& fcl(Question question) { return question == Question::rough ? *forced_ : *fcl_; }
  Peer* coal() { return coal_.get(); }

  /// Whether a library agrees with our answer. If not, the classic engine decides who is wrong.
  bool is_right(Peer& library, Question question, const Transform& pose, double answer, const std::string& row,
                Checker& checker) {
    const double theirs = library.ask(question, pose);
    if (agree(question, answer, theirs, 1e-9 * size_)) return true;
    if (classic_ == nullptr) classic_ = make_classic(scene_.a, scene_.b);
    const double classic = classic_->ask(question, pose);
    checker.check(agree(question, answer, classic, 1e-9 * size_),
                  "{}: {}, not {} as {} says, or {} as the classic engine", row, answer, theirs,
                  &library == coal_.get() ? "Coal" : "FCL", classic);
    return false;
  }

 private:
  const PeerScene& scene_;
  Model a_, b_;
  std::unique_ptr<Peer> fcl_, forced_, coal_, classic_;
  double size_ = 0;
};

constexpr double no_time = std::numeric_limits<double>::infinity();

/// Their times over ours, at the poses that have a time.
struct Ratios {
  std::vector<double> all = {};
  double our_sum = 0, their_sum = 0;

  void add(double our_us, double their_us) {
    if (their_us == no_time) return;
    all.push_back(their_us / our_us);
    our_sum += our_us, their_sum += their_us;
  }
  double of_sums() const { return their_sum / our_sum; }
};

/// What is measured at the poses of one row, those left out that FCL answers wrongly.
struct Row {
  std::string scene, situation;
  Question question;
  std::vector<double> ours_us = {}, fcl_us = {}, coal_us = {};
  Ratios fcl = {}, coal = {};
  Ratios long_ones = {};  // the faster of both, at poses that take limber more than 1 us
  std::vector<double> node_tests = {}, primitive_tests = {};
  int fcl_wrong = 0, coal_wrong = 0;  // poses

  std::string name() const { return fmt::format("{}, {}, {}", scene, situation, to_text(question)); }

  /// `coal` is `no_time` where it does not take part, or is wrong.
  void add(double ours, double theirs, double coals, const QueryStats& stats) {
    ours_us.push_back(ours), fcl_us.push_back(theirs), coal_us.push_back(coals);
    fcl.add(ours, theirs), coal.add(ours, coals);
    if (ours > 1) long_ones.add(ours, std::min(theirs, coals));
    node_tests.push_back(static_cast<double>(stats.node_tests));
    primitive_tests.push_back(static_cast<double>(stats.primitive_tests));
  }
};

void measure_cold(Contest& contest, const std::vector<Transform>& poses, int rounds, Checker& checker, Row& row) {
  const Question question = row.question;
  for (const Transform& pose : poses) {
    const Answer answer = contest.ours(question, pose);
    const auto is_right = [&](Peer& library) {
      return contest.is_right(library, question, pose, answer.value, row.name(), checker);
    };
    if (!is_right(contest.fcl(question))) {
      ++row.fcl_wrong;
      continue;
    }
    std::vector<Turn> turns = {{[&] { contest.ours(question, pose); }},
                               {[&] { contest.fcl(question).ask(question, pose); }}};
    if (contest.coal() != nullptr && is_right(*contest.coal())) {
      turns.push_back({[&] { contest.coal()->ask(question, pose); }});
    } else if (contest.coal() != nullptr) {
      ++row.coal_wrong;
    }
    for (Turn& turn : turns) turn.repetitions = repetitions_for(mean_us(1, turn.call));
    const std::vector<double> us = medians_in_turn(turns, rounds);
    row.add(us[0], us[1], us.size() > 2 ? us[2] : no_time, answer.stats);
  }
}

void measure_path(Contest& contest, const std::vector<Transform>& path, int rounds, Checker& checker, Row& row) {
  const Question question = row.question;
  std::vector<std::vector<double>> ours_us(path.size()), fcl_us(path.size());
  std::vector<Answer> answers(path.size());
  for (int round = 0; round < rounds; ++round) {
    QueryCache cache;
    for (std::size_t i = 0; i < path.size(); ++i) {
      ours_us[i].push_back(mean_us(1, [&] { answers[i] = contest.ours(question, path[i], &cache); }));
      fcl_us[i].push_back(mean_us(1, [&] { contest.fcl(question).ask(question, path[i]); }));
    }
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (contest.is_right(contest.fcl(question), question, path[i], answers[i].value, row.name(), checker)) {
      row.add(median(ours_us[i]), median(fcl_us[i]), no_time, answers[i].stats);
    } else {
      ++row.fcl_wrong;
    }
  }
}

/// A number, or an empty cell where there is nothing to say.
std::string cell(const Ratios& ratios, double value) { return ratios.all.empty() ? "" : fmt::format("{:.3g}", value); }
std::string count_cell(const std::vector<double>& counts) {
  return counts.empty() ? "" : fmt::format("{}", median(counts));
}
std::string median_cell(const Ratios& ratios) { return cell(ratios, median(ratios.all)); }
std::string sums_cell(const Ratios& ratios) { return cell(ratios, ratios.of_sums()); }
std::string least_cell(const Ratios& ratios) { return cell(ratios, summarize(ratios.all).min); }

void report_head(Table& table) {
  table.line("# A broad mix next to FCL and Coal, as printed by `limber_bench_mix`\n");
  table.line("A library's time over limber's, pose by pose: median, ratio of the sums, least; the least against the");
  table.line(
      "faster of both is of poses that take limber more than 1 us. Microseconds and tests of limber are medians.\n");
  table.line(
      "| scene | situation | query | poses | FCL: median | sums | least | Coal: median | sums | faster: least "
      "| limber us | FCL us | Coal us | node tests | triangle tests |");
  table.line("|:--|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
}

void report(const Row& row, Table& table) {
  std::string poses = std::to_string(row.fcl.all.size());
  if (row.fcl_wrong > 0) poses += fmt::format(", FCL wrong in {} more", row.fcl_wrong);
  if (row.coal_wrong > 0) poses += fmt::format(", Coal in {} of them", row.coal_wrong);
  table.line("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |", row.scene, row.situation,
             to_text(row.question), poses, median_cell(row.fcl), sums_cell(row.fcl), least_cell(row.fcl),
             median_cell(row.coal), sums_cell(row.coal), least_cell(row.long_ones), cell(row.fcl, median(row.ours_us)),
             cell(row.fcl, median(row.fcl_us)), cell(row.coal, median(row.coal_us)), count_cell(row.node_tests),
             count_cell(row.primitive_tests));
}

/// One line for each query: what the rows say together.
void report_all(const std::vector<Row>& rows, Table& table) {
  table.line("\n## All rows\n");
  table.line(
      "Next to FCL; the last three columns next to the faster of both, at poses that take limber more than 1 us.\n");
  table.line(
      "| query | rows | median of medians | least median | rows with a median below 1 | poses | below 1 | least "
      "| poses above 1 us | below 1 | least |");
  table.line("|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
  for (const bool warm : {false, true}) {
    for (const Question question : questions) {
      std::vector<double> medians, poses, long_ones;
      for (const Row& row : rows) {
        if (row.question != question || row.fcl.all.empty() || (row.situation == path_name) != warm) continue;
        medians.push_back(median(row.fcl.all));
        poses.insert(poses.end(), row.fcl.all.begin(), row.fcl.all.end());
        long_ones.insert(long_ones.end(), row.long_ones.all.begin(), row.long_ones.all.end());
      }
      const auto below_1 = [](const std::vector<double>& ratios) {
        return std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio < 1; });
      };
      const Summary rows_in_all = summarize(medians);
      table.line("| {}{} | {} | {:.3g} | {:.3g} | {} | {} | {} | {:.3g} | {} | {} | {:.3g} |", to_text(question),
                 warm ? ", path with a cache" : "", medians.size(), rows_in_all.median, rows_in_all.min,
                 below_1(medians), poses.size(), below_1(poses), summarize(poses).min, long_ones.size(),
                 below_1(long_ones), summarize(long_ones).min);
    }
  }
}

/// One line for each scene whose poses are scattered, as planners scatter them: sums next to the faster library.
void report_scattered(const std::vector<Row>& rows, Table& table) {
  table.line("\n## Scattered poses\n");
  table.line("The sum over the poses, of the library that is faster in the row over limber.\n");
  table.line("| scene | collide, meeting | collide, apart | distance, meeting | distance, apart |");
  table.line("|:--|--:|--:|--:|--:|");
  constexpr std::pair<Question, const char*> columns[] = {{Question::collide, meeting_name},
                                                          {Question::collide, apart_name},
                                                          {Question::exact, meeting_name},
                                                          {Question::exact, apart_name}};
  std::string last;
  for (const Row& row : rows) {
    if (row.scene == last || (row.situation != meeting_name && row.situation != apart_name)) continue;
    last = row.scene;
    std::string line = "| " + last;
    for (const auto& [question, situation] : columns) {
      const auto found =
          std::find_if(rows.begin(), rows.end(), [&, asked = question, wanted = situation](const Row& r) {
            return r.scene == last && r.situation == wanted && r.question == asked;
          });
      line += " | ";
      if (found == rows.end()) continue;
      const bool coal_is_faster = !found->coal.all.empty() && found->coal.of_sums() < found->fcl.of_sums();
      line += sums_cell(coal_is_faster ? found->coal : found->fcl);
    }
    table.line("{} |", line);
  }
}

void run(const Options& options, std::size_t pose_count, int rounds, const std::vector<std::string>& name_parts,
         Checker& checker) {
  std::vector<Row> rows;
  Table table(options, "peers_mix.md");
  report_head(table);
  const auto use = [&](const PeerScene& scene) {
    if (!checker.all_right()) return;
    Contest contest(scene);
    const auto measure = [&](const std::string& situation, const std::vector<Transform>& poses, auto how) {
      if (poses.empty()) return;
      for (const Question question : questions) {
        Row row{scene.name, situation, question};
        how(contest, poses, rounds, checker, row);
        if (!checker.all_right()) return;
        report(row, table);
        rows.push_back(std::move(row));
      }
    };
    for (const Situation& situation : scene.situations) measure(situation.name, situation.poses, measure_cold);
    measure(path_name, scene.path, measure_path);
  };
  for_each_mix_scene(options.meshes, pose_count, use, name_parts);
  if (name_parts.empty() && !options.meshes.empty()) {
    use(two_scans("bunny beside armadillo", options.meshes / "stanford-bunny.obj", options.meshes / "armadillo.obj",
                  pose_count));
  }
  if (!checker.all_right()) return;
  if (rows.empty()) throw std::runtime_error("no scene has that in its name");
  report_all(rows, table);
  report_scattered(rows, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::size_t poses = 40;
  int rounds = 7;
  std::vector<std::string> name_parts;
  return run_bench(
      argc, argv, "How fast are queries next to FCL's and Coal's on a broad mix of scenes?",
      [&](const Options& options, Checker& checker) { run(options, poses, rounds, name_parts, checker); },
      [&](CLI::App& app) {
        app.add_option("--poses", poses, "random poses of each situation; default: 40")->check(CLI::Range(1, 1000));
        app.add_option("--rounds", rounds, "turns of each library at a pose; default: 7")->check(CLI::Range(1, 99));
        app.add_option("--scene", name_parts, "only scenes with one of these in their names");
      });
}
