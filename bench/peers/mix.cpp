// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  How fast are queries next to FCL's on a broad mix that nobody has tuned to?
// Workload  scenes.h: pairs of mesh files overlapping and at three gaps; floors, a wall, a room and a maze; FCL's
//           own test scene; ball over square; linked rings; soups. 40 random poses each, without a cache, and 200 along
//           a path with one. Collision, exact distance, distance within 10 %.
// Metric    FCL's time over ours, pose by pose: median, ratio of the sums, least. Both libraries have their turn in
//           every round; the median of the rounds counts. A turn repeats the query until it takes 30 us; along a path
//           it is one query. FCL has no cache, and its error is forced in distances within 10 %.
// Checked   Answers agree, within the error asked for. Where they do not, the classic engine decides: FCL's wrong poses
//           are counted and not timed; a wrong answer of ours ends the table, and the exit code is 1.
// Shape     Above 1; least where the bounds of the roots decide, and where few large triangles are near a fine mesh.
#include <CLI/CLI.hpp>
#include <algorithm>
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
    const auto size = [](const Model& model) { return length(model.bounding_box().high - model.bounding_box().low); };
    size_ = size(a_) + size(b_);
  }

  Answer ours(Question question, const Transform& pose, QueryCache* cache = nullptr) const {
    return ask(a_, b_, question, pose, cache);
  }
  double theirs(Question question, const Transform& pose) const {
    return (question == Question::rough ? *forced_ : *fcl_).ask(question, pose);
  }

  /// Whether FCL agrees with our answer. If not, the classic engine decides who is wrong.
  bool fcl_is_right(Question question, const Transform& pose, double answer, const std::string& row, Checker& checker) {
    const double fcl = theirs(question, pose);
    if (agree(question, answer, fcl, 1e-9 * size_)) return true;
    if (classic_ == nullptr) classic_ = make_classic(scene_.a, scene_.b);
    const double classic = classic_->ask(question, pose);
    checker.check(agree(question, answer, classic, 1e-9 * size_),
                  "{}: {}, not {} as FCL says, or {} as the classic engine", row, answer, fcl, classic);
    return false;
  }

 private:
  const PeerScene& scene_;
  Model a_, b_;
  std::unique_ptr<Peer> fcl_, forced_, classic_;
  double size_ = 0;
};

/// What is measured at the poses of one row, those left out that FCL answers wrongly.
struct Row {
  std::string scene, situation;
  Question question;
  std::vector<double> ours_us = {}, theirs_us = {}, ratios = {};
  std::vector<double> node_tests = {}, triangle_tests = {};
  int wrong = 0;  // poses that FCL answers wrongly

  std::string name() const { return fmt::format("{}, {}, {}", scene, situation, to_text(question)); }
  double ratio_of_sums() const { return mean(theirs_us) / mean(ours_us); }

  void add(double our_us, double their_us, const QueryStats& stats) {
    ours_us.push_back(our_us), theirs_us.push_back(their_us), ratios.push_back(their_us / our_us);
    node_tests.push_back(static_cast<double>(stats.node_tests));
    triangle_tests.push_back(static_cast<double>(stats.triangle_tests));
  }
};

void measure_cold(Contest& contest, const std::vector<Transform>& poses, int rounds, Checker& checker, Row& row) {
  for (const Transform& pose : poses) {
    const Answer answer = contest.ours(row.question, pose);
    if (!contest.fcl_is_right(row.question, pose, answer.value, row.name(), checker)) {
      ++row.wrong;
      continue;
    }
    const auto ours = [&] { contest.ours(row.question, pose); };
    const auto theirs = [&] { contest.theirs(row.question, pose); };
    const std::vector<double> us = medians_in_turn(
        {{ours, repetitions_for(mean_us(1, ours))}, {theirs, repetitions_for(mean_us(1, theirs))}}, rounds);
    row.add(us[0], us[1], answer.stats);
  }
}

void measure_path(Contest& contest, const std::vector<Transform>& path, int rounds, Checker& checker, Row& row) {
  std::vector<std::vector<double>> ours_us(path.size()), theirs_us(path.size());
  std::vector<Answer> answers(path.size());
  for (int round = 0; round < rounds; ++round) {
    QueryCache cache;
    for (std::size_t i = 0; i < path.size(); ++i) {
      ours_us[i].push_back(mean_us(1, [&] { answers[i] = contest.ours(row.question, path[i], &cache); }));
      theirs_us[i].push_back(mean_us(1, [&] { contest.theirs(row.question, path[i]); }));
    }
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (contest.fcl_is_right(row.question, path[i], answers[i].value, row.name(), checker)) {
      row.add(median(ours_us[i]), median(theirs_us[i]), answers[i].stats);
    } else {
      ++row.wrong;
    }
  }
}

void report(const Row& row, Table& table) {
  if (row.ratios.empty()) {
    table.line("| {} | {} | {} | FCL wrong in all {} | | | | | | | |", row.scene, row.situation, to_text(row.question),
               row.wrong);
    return;
  }
  const Summary ratio = summarize(row.ratios);
  const double ours = median(row.ours_us), theirs = median(row.theirs_us);
  const double nodes = median(row.node_tests), triangles = median(row.triangle_tests);
  const std::string wrong = row.wrong > 0 ? fmt::format(", FCL wrong in {} more", row.wrong) : "";
  table.line("| {} | {} | {} | {}{} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {} | {} |", row.scene, row.situation,
             to_text(row.question), row.ratios.size(), wrong, ratio.median, row.ratio_of_sums(), ratio.min, ours,
             theirs, nodes, triangles);
}

/// One line for each query: what the rows say together.
void report_all(const std::vector<Row>& rows, Table& table) {
  table.line("\n## All rows\n");
  table.line(
      "| query | rows | median of medians | least median | rows with a median below 1 | poses | below 1 | least |");
  table.line("|:--|--:|--:|--:|--:|--:|--:|--:|");
  for (const bool warm : {false, true}) {
    for (const Question question : questions) {
      std::vector<double> medians, poses;
      for (const Row& row : rows) {
        if (row.question != question || row.ratios.empty() || (row.situation == path_name) != warm) continue;
        medians.push_back(median(row.ratios));
        poses.insert(poses.end(), row.ratios.begin(), row.ratios.end());
      }
      const auto below_1 = [](const std::vector<double>& ratios) {
        return std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio < 1; });
      };
      const Summary rows_in_all = summarize(medians);
      table.line("| {}{} | {} | {:.3g} | {:.3g} | {} | {} | {} | {:.3g} |", to_text(question),
                 warm ? ", path with a cache" : "", medians.size(), rows_in_all.median, rows_in_all.min,
                 below_1(medians), poses.size(), below_1(poses), summarize(poses).min);
    }
  }
}

void run(const Options& options, std::size_t pose_count, int rounds, Checker& checker) {
  std::vector<Row> rows;
  Table table(options, "peers_mix.md");
  table.line("# A broad mix next to FCL, as printed by `limber_bench_mix`\n");
  table.line("FCL's time over limber's, pose by pose; microseconds and tests of limber are medians over the poses.\n");
  table.line(
      "| scene | situation | query | poses | median ratio | ratio of sums | least ratio | limber us | FCL us | node "
      "tests "
      "| triangle tests |");
  table.line("|:--|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|");
  for_each_mix_scene(options.meshes, pose_count, [&](const PeerScene& scene) {
    if (!checker.all_right()) return;
    Contest contest(scene);
    const auto measure = [&](const std::string& situation, const std::vector<Transform>& poses, auto how) {
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
  });
  if (checker.all_right()) report_all(rows, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::size_t poses = 40;
  int rounds = 7;
  return run_bench(
      argc, argv, "How fast are queries next to FCL's on a broad mix of scenes?",
      [&](const Options& options, Checker& checker) { run(options, poses, rounds, checker); },
      [&](CLI::App& app) {
        app.add_option("--poses", poses, "random poses of each situation; default: 40")->check(CLI::Range(1, 1000));
        app.add_option("--rounds", rounds, "turns of each library at a pose; default: 7")->check(CLI::Range(1, 99));
      });
}
