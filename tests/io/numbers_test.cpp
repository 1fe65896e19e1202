// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <random>

#include "files.h"

namespace limber {
namespace {

class Numbers : public FilesTest {
 protected:
  /// A text file of one triangle whose first vertex has the decimals as its coordinates.
  static std::vector<std::pair<std::string, std::string>> files_with(const std::string& decimals) {
    return {{"a.obj", "v " + decimals + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
            {"a.off", "OFF\n3 1 0\n" + decimals + "\n1 0 0\n0 1 0\n3 0 1 2\n"},
            {"a.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_index\nend_header\n" +
                 decimals + "\n1 0 0\n0 1 0\n3 0 1 2\n"},
            {"a.stl", "solid\nfacet normal 0 0 1 outer loop vertex " + decimals +
                          " vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid\n"}};
  }

  void expect_value(const std::string& decimal, double value) const {
    for (const auto& [name, bytes] : files_with(decimal + " 7 7")) {
      const Result<MeshFile> file = read(name, bytes);
      ASSERT_TRUE(file) << decimal << " " << file.error().text;
      EXPECT_EQ(file->mesh.positions()[0].x, value) << name << " " << decimal;
      EXPECT_EQ(std::signbit(file->mesh.positions()[0].x), std::signbit(value)) << name << " " << decimal;
    }
  }

  void expect_not_finite(const std::string& decimal) const {
    for (const auto& [name, bytes] : files_with("7 7 " + decimal)) {
      EXPECT_EQ(refused(name, bytes).code, ErrorCode::non_finite) << name << " " << decimal;
    }
  }
};

const std::string zeros_400(400, '0');

TEST_F(Numbers, below_the_range_are_zero_however_they_are_written) {
  for (const std::string& decimal :
       {"0." + zeros_400 + "1", "." + zeros_400 + "1", std::string("1e-400"), std::string("1E-99999999999999999999"),
        "0." + zeros_400 + "1e0", "0." + zeros_400 + zeros_400 + "1e+400", std::string("123e-400"),
        std::string("0.0000001e-320")}) {
    expect_value(decimal, 0.0);
    expect_value("-" + decimal, -0.0);
    expect_value("+" + decimal, 0.0);
  }
}

TEST_F(Numbers, above_the_range_are_not_finite_however_they_are_written) {
  for (const std::string& decimal :
       {"1" + zeros_400, "1" + zeros_400 + ".0", std::string("1e400"), std::string("0.001e+400"),
        std::string("1e99999999999999999999"), "0." + zeros_400 + "1e800", "1" + zeros_400 + "e-1"}) {
    expect_not_finite(decimal);
    expect_not_finite("-" + decimal);
    expect_not_finite("+" + decimal);
  }
}

TEST_F(Numbers, of_any_length_are_rounded_correctly) {
  expect_value("1" + zeros_400 + "e-400", 1);
  expect_value("0." + zeros_400 + "1e401", 1);
  expect_value(zeros_400 + "2.5" + zeros_400, 2.5);
  expect_value("0e99999999999999999999", 0);
  expect_value("0." + zeros_400 + "e400", 0);
  expect_value("4.9406564584124654e-324", 5e-324);
  expect_value("2.4703282292062328e-324", 5e-324);  // just above half of the smallest number
  expect_value("2.4703282292062327e-324", 0);
  const std::string halfway = "9007199254740993";  // 2^53 + 1; ties go to the even neighbour
  expect_value(halfway + "." + zeros_400, 9007199254740992.0);
  expect_value(halfway + "." + zeros_400 + "1", 9007199254740994.0);
}

TEST_F(Numbers, agree_with_the_standard_library_for_random_decimals) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string decimals;
    std::array<double, 3> expected{};
    for (double& value : expected) {
      std::string decimal(random() % 2, '-');
      const std::size_t digit_count = 1 + random() % 40, point = random() % (digit_count + 1);
      for (std::size_t i = 0; i < digit_count; ++i) {
        if (i == point) decimal += '.';
        decimal += static_cast<char>('0' + random() % 10);
      }
      decimal.append(1, 'e').append(std::to_string(static_cast<int>(random() % 340) - 320));
      value = exact(decimal.c_str());
      if (!(std::abs(value) < max_coordinate)) decimal.assign(1, '1'), value = 1;
      decimals.append(decimal).append(1, ' ');
    }
    for (const auto& [name, bytes] : files_with(decimals)) {
      const Result<MeshFile> file = read(name, bytes);
      ASSERT_TRUE(file) << decimals << file.error().text;
      EXPECT_EQ(file->mesh.positions()[0], (Vec3{expected[0], expected[1], expected[2]})) << name << " " << decimals;
    }
  }
}

TEST_F(Numbers, other_words_are_malformed) {
  for (const char* word : {"1e", "1e+", "--1", "+-1", "-+1", "++1", "+", "-", ".", "e5", "0x1p3", "1_000", "1f", "1,0",
                           "infinit", "nanx", "1.2.3", "\xEF\xBC\x91"}) {
    for (const auto& [name, bytes] : files_with(std::string(word) + " 0 0")) {
      EXPECT_EQ(refused(name, bytes).code, ErrorCode::malformed_file) << name << " " << word;
    }
  }
}

}  // namespace
}  // namespace limber
