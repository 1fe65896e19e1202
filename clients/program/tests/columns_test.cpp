// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "contact_meshes.h"

/// Names are promises: here they stand once more, and nowhere else in the tests.
namespace limber::program_tests {
namespace {

const std::string witness_columns =
    "point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,triangle_a,triangle_b,face_a,face_b";
const std::string of_pair =
    "triangle_a,triangle_b,distance,depth,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,normal_x,"
    "normal_y,normal_z,normal_side,feature_a,feature_b,face_a,face_b";
const std::string of_answer = "status,lower,upper," + witness_columns +
                              ",too_close,inside,clash,solids,depth,accepted,query_us,node_tests,primitive_tests";
const std::string of_frame = "frame,update_us,query_us,status,lower,upper," + witness_columns +
                             ",moved_vertices,refits,absorbed,node_tests,primitive_tests";
const std::string of_point =
    "row,x,y,z,distance,closest_x,closest_y,closest_z,triangle,face,feature,weight_0,weight_1,weight_2";
/// Each column with something before its name.
std::string prefixed(const std::string& prefix, std::string columns) {
  for (std::size_t at = 0; at != std::string::npos; at = columns.find(',', at + prefix.size())) {
    columns.insert(at + (at > 0 ? 1 : 0), prefix);
  }
  return ',' + columns;
}

std::string without_line_ends(std::string text) {
  std::erase(text, '\n');
  std::erase(text, ' ');
  return text;
}

/// A line, the columns of its answer, and the verb whose help names them, if it does.
struct Answer {
  std::string line, columns, verb;
};

TEST(ProgramColumns, AreThoseOfCsvOfJsonAndOfHelp) {
  const Soups soups(1, 0.8);
  const std::string points = soups.folder.store("points.csv", "0,0,3\n0.1,0.2,0\n");
  const std::string pairs = soups.folder.store("pairs.csv", "model_a,model_b\nscene:ball,scene:ball\n");
  const std::string parts = soups.folder.store("parts.csv", "model,pose_tx\nscene:ball,0\nscene:ball,3\n");
  const std::string contacts = "contacts" + soups.files();
  const std::string track = "track --a " + soups.file_a + ' ' + soups.file_a + " --b scene:ball ";
  const std::string of_contacts = "query_us,count,intersecting," + of_pair;
  for (const auto& [line, columns, verb] : std::vector<Answer>{
           {contacts + "--margin 0.1 --out -", of_pair, "contacts"},
           {contacts + "--intersections --out -", "triangle_a,triangle_b,face_a,face_b", "self"},
           {"self scene:ball --closest 1 --out -", of_pair, "self"},
           {"points scene:ball " + points, of_point, ""},
           {"points scene:ball " + points + " --signed", of_point + ",is_inside", "points"},
           {"distance --pairs " + pairs, "row,model_a,model_b," + of_answer, "distance"},
           {"distance --parts " + parts, "row,part_a,part_b,name_a,name_b," + of_answer, ""},
           {track, of_frame, ""},
           {"track --a scene:ball --b scene:ball --depth --min-clearance 1", of_frame + ",too_close,depth", ""},
           {track + "--contacts --self",
            of_frame + prefixed("contact_", of_contacts) + prefixed("self_a_", of_contacts), ""}}) {
    SCOPED_TRACE(line);
    const Outcome outcome = run(line);
    EXPECT_EQ(lines_of(outcome.out).at(0), columns);
    if (!verb.empty()) {
      EXPECT_NE(without_line_ends(answer_to("help " + verb)).find(columns), std::string::npos) << verb;
    }
    const std::vector<Row> rows = table_of(outcome.out);
    EXPECT_GT(rows.size(), 0U);
    if (line.ends_with("--out -")) continue;  // its JSON is one object
    const std::vector<nlohmann::json> objects = json_lines_of(run(line + " --json"));
    ASSERT_EQ(objects.size(), rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) expect_same(rows[r], objects[r]);
  }
}

/// Fields of the objects that verbs about one pair or one model answer with, in alphabetical order.
TEST(ProgramColumns, OfOneAnswerAreFields) {
  const std::string two = " scene:ball scene:square ", work = "build_us node_tests primitive_tests query query_us ";
  const auto sorted = [](const std::string& words) {
    Words names;
    std::istringstream stream(words);
    for (std::string word; stream >> word;) names.push_back(word);
    std::sort(names.begin(), names.end());
    return names;
  };
  for (const auto& [line, fields] : std::vector<std::pair<std::string, std::string>>{
           {"distance" + two, "clash depth inside lower solids status too_close upper witness"},
           {"collide" + two, "inside is_yes witness"},
           {"within --max-distance 1" + two, "inside is_yes max_distance witness"},
           {"contacts --margin 0" + two, "closest count inside intersecting margin pairs"},
           {"contacts --intersections" + two, "closest count inside intersecting margin pairs"},
           {"self scene:ball", "closest count distance intersecting is_yes margin pairs"}}) {
    const nlohmann::json json = json_of(line);
    EXPECT_EQ(keys_of(json), sorted(work + fields)) << line;
    EXPECT_EQ(json["query"], line.substr(0, line.find(' ')));
    EXPECT_GT(json["query_us"].get<double>(), 0);
    if (!json.contains("witness")) continue;
    EXPECT_EQ(keys_of(json["witness"]), sorted("face_a face_b point_a point_b triangle_a triangle_b"));
  }
}

}  // namespace
}  // namespace limber::program_tests
