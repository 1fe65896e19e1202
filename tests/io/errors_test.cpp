// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <sstream>

#include "files.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

class Errors : public FilesTest {
 protected:
  void expect_unreadable(const fs::path& path, const std::string& reason) const {
    const Result<MeshFile> file = read_mesh_file(path);
    ASSERT_FALSE(file) << path << " was read";
    EXPECT_TRUE(is_one_line_about(path, file.error().text)) << file.error().text;
    EXPECT_NE(file.error().text.find(reason), std::string::npos) << file.error().text;
    EXPECT_EQ(file.error().code, ErrorCode::unreadable_file);
  }

  /// Of face or vertex `where`.
  void expect_place(const std::string& name, const std::string& bytes, ErrorCode code, std::size_t where) const {
    const Error error = refused(name, bytes, code);
    EXPECT_EQ(error.where, where) << bytes;
    if (code == ErrorCode::non_finite) {
      EXPECT_EQ(error.text, path(name).string() + ": vertex " + std::to_string(where) + " is not finite");
    }
  }
};

TEST_F(Errors, missing_file_and_folder_are_unreadable) {
  fs::create_directories(path("folder.obj"));
  expect_unreadable(path("missing.obj"), ": no such file");
  expect_unreadable(path("folder.obj"), ": is a folder");
  expect_unreadable(write("file", "v") / "below.obj", ": ");
  expect_unreadable("/dev/zero", ": ");
#if !defined(_WIN32)
  const fs::path secret = write("secret.obj", tetrahedron("obj/plain.obj"));
  fs::permissions(secret, fs::perms::none);
  if (geteuid() != 0) expect_unreadable(secret, ": ");  // root may read everything
#endif
}

TEST_F(Errors, unknown_extensions_are_named) {
  refused("a.fbx", tetrahedron("obj/plain.obj"), ErrorCode::unsupported_format, ".fbx");
  refused("obj", tetrahedron("obj/plain.obj"), ErrorCode::unsupported_format);
  EXPECT_EQ(read("two\nlines.obj", "").error().text.find('\n'), std::string::npos);
}

TEST_F(Errors, empty_files_and_other_texts_are_malformed) {
  const auto format_of = [](const std::string& name) {
    const std::string extension = fs::path(name).extension().string();
    return extension == ".glb" ? ".gltf" : extension;
  };
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.gltf", "a.glb"}) {
    for (const std::string& bytes : {std::string(), std::string("The quick brown fox\njumps over the lazy dog.\n"),
                                     std::string("\n \n"), std::string(1000, '\0')}) {
      refused(name, bytes);
    }
    for (const auto& [other, bytes] : tetrahedron_files()) {
      if (format_of(other) != format_of(name)) refused(name, bytes);
    }
  }
}

TEST_F(Errors, files_without_a_face_are_empty) {
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"a.obj", obj_corner},
           {"a.obj", obj_corner + "f 1 2\nf\n"},
           {"a.obj", "v 0 0 0\nf\n"},
           {"a.off", "OFF\n0 0 0\n"},
           {"a.off", "OFF\n1 0 0\n0 0 0\n"},
           {"a.stl", "solid nothing\nendsolid nothing\n"},
           {"a.ply", ply_header(1, 0) + "0 0 0\n"},
           {"a.ply",
            with(ply_header(1, 0), "element face 0\nproperty list uchar int vertex_indices\n", "") + "0 0 0\n"}}) {
    refused(name, bytes, ErrorCode::empty_mesh);
  }
}

TEST_F(Errors, coordinates_that_are_not_finite_are_named) {
  for (const std::string bad :
       {"nan", "-NaN", "inf", "-Infinity", "nan(0x7)", "1e999", "-1e999", "1.#QNAN", "-1.#IND", "1.#INF", "+inf"}) {
    for (std::size_t vertex = 0; vertex < 3; ++vertex) {
      std::array<std::string, 3> vertices{"0 0 0", "1 0 0", "0 1 0"};
      vertices[vertex] = "0 " + bad + " 0";
      for (const auto& [name, bytes] : triangle_files(vertices)) {
        expect_place(name, bytes, ErrorCode::non_finite, vertex);
      }
    }
  }
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::string little, big;
    append(little, bad), append(big, bad, true);
    const auto put = [](std::string bytes, std::size_t at, const std::string& number) {
      return bytes.replace(at, number.size(), number);
    };
    const std::string ply = tetrahedron("ply/little.ply"), big_ply = tetrahedron("ply/big.ply");
    expect_place("a.ply", put(ply, ply.find("end_header\n") + 11 + 16, little), ErrorCode::non_finite, 1);
    expect_place("a.ply", put(big_ply, big_ply.find("end_header\n") + 11 + 44, big), ErrorCode::non_finite, 3);
    expect_place("a.stl", put(tetrahedron("stl/binary.stl"), 84 + 50 + 12 + 12, little), ErrorCode::non_finite, 4);
    GltfParts gltf;
    gltf.buffer = put(gltf.buffer, 24, little);
    expect_place("a.glb", gltf.glb(), ErrorCode::non_finite, 2);
  }
}

TEST_F(Errors, coordinates_above_the_limit_are_too_large) {
  // The vertex of the file, although vertices 0 and 1 are the same.
  expect_place("a.obj", "v 0 0 0\nv 0 0 0\nv 1e61 0 0\nv 0 1 0\nf 1 3 4\n", ErrorCode::too_large, 2);
}

TEST_F(Errors, faces_that_name_missing_vertices_are_named) {
  for (const std::string face :
       {"f 1 2 4", "f 1 2 5", "f 1 2 99", "f 0 1 2", "f 1 2 -4", "f -1 -2 -2147483648", "f 1 2 2147483647"}) {
    expect_place("a.obj", obj_corner + "f 1 2 3\n" + face + "\n", ErrorCode::index_out_of_range, 1);
  }
  expect_place("a.obj", "f 1 2 3\n", ErrorCode::index_out_of_range, 0);
  expect_place("a.obj", obj_corner + "f 0 1 2\n" + obj_corner, ErrorCode::index_out_of_range, 0);
  expect_place("a.obj", obj_corner + "f 1 2 -4\n" + obj_corner, ErrorCode::index_out_of_range, 0);
  for (const std::string face : {"3 0 1 3", "3 0 1 -1", "3 0 1 4294967296"}) {
    const std::string lines = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" + face + "\n";
    expect_place("a.off", "OFF\n3 2 0\n" + lines, ErrorCode::index_out_of_range, 1);
    expect_place("a.ply", ply_header(3, 2) + lines, ErrorCode::index_out_of_range, 1);
  }
  std::string ply = tetrahedron("ply/big.ply");
  ply.back() = 4;
  refused("a.ply", ply, ErrorCode::index_out_of_range);
  ply[ply.size() - 4] = '\xff';
  refused("a.ply", ply, ErrorCode::index_out_of_range, "vertex -");
}

TEST_F(Errors, broken_obj_records_are_malformed) {
  for (const char* record :
       {"v 1 2", "v", "v 1 2 x", "v 1-2 3 4", "v 1,5 2 3", "v 1.2.3 2 3", "v 0x10 0 0", "f 1 2 x", "f 1 2 3.5",
        "f 1,2,3", "f 1 2 99999999999", "f 1 2 3/a", "f /1 /2 /3", "7 8 9", "@!", "v +-1 0 0"}) {
    refused("a.obj", obj_corner + "f 1 2 3\n" + record + "\n");
  }
}

TEST_F(Errors, broken_off_files_are_malformed) {
  const std::string corner = "0 0 0\n1 0 0\n0 1 0\n", body = corner + "3 0 1 2\n";
  EXPECT_TRUE(read("a.off", "OFF\n3 1 0\n" + body));
  for (const std::string head :
       {"OFF\n3\n", "OFF\n-3 1 0\n", "OFF BINARY\n", "4OFF\n3 1 0\n", "STCN OFF\n", "nOFF\n3\n3 1 0\n", "XOFF\n3 1 0\n",
        "off\n3 1 0\n", "3 1 0\n", "OFF\n4294967295 4294967295 0\n", "OFF\n99999999999 1 0\n", "OFF\n3 2 0\n",
        "OFF\n4 1 0\n", "OFF\n3.5 1 0\n"}) {
    refused("a.off", head + body);
  }
  refused("a.off", "OFF\n3 1 0\n" + body.substr(2));
  for (const std::string face : {"3 0 1", "4000000000 0 1 2", "3 0 1 x", "-3 0 1 2", "3 0 1 1.5", "x"}) {
    refused("a.off", "OFF\n3 1 0\n" + corner + face + "\n");
  }
}

TEST_F(Errors, broken_ply_files_are_malformed) {
  // Parts of a sound file, and what stands instead.
  std::istringstream changes(
      "ply>plx|format ascii 1.0>|ascii>utf8|element vertex 4>|vertex 4>vertex 4294967295|vertex 4>vertex -4|"
      "vertex 4>vertex 99999999999999999999|face 4>face 4294967295|face 4>face 5|property float x>|"
      "property float x>property half x|property float x>property list uchar float x|"
      "property float y>property float x|uchar int>float int|uchar int>uchar float|uchar int>uchar int64|"
      "vertex_indices>corners|end_header>|0.25 0.5 1>0.25 0,5 1|3 2 0 3>3 2 0|3 1 2 3>4000000000 1 2 3|"
      "3 1 2 3>-3 1 2 3|3 1 2 3>3 1 2 x");
  for (std::string change; std::getline(changes, change, '|');) {
    const std::size_t cut = change.find('>');
    refused("a.ply", with(tetrahedron("ply/text.ply"), change.substr(0, cut), change.substr(cut + 1)));
  }
  const std::string two_of_a_name =
      with(tetrahedron("ply/text.ply"), "element face", "property double z\nelement face");
  refused("a.ply", two_of_a_name, ErrorCode::malformed_file, "coordinate z");
}

TEST_F(Errors, files_that_promise_gigabytes_are_refused_at_once) {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n", other(50, '7');
  const std::string no_vertices = "element vertex 0\n" + vertices;
  for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string head = std::string("ply\nformat ") + encoding + " 1.0\n";
    for (const std::string& bytes :
         {"element vertex 4000000000\n" + vertices + "end_header\n" + other,
          no_vertices + "element face 4000000000\nproperty list uint int vertex_indices\nend_header\n" + other,
          no_vertices + "element face 1\nproperty list int int vertex_indices\nend_header\n2000000000 " +
              std::string(50, '\xff'),
          "element other 4000000000\n" + no_vertices +
              "element face 4000000000\nproperty list int int vertex_indices\nend_header\n"}) {
      refused("a.ply", head + bytes);
    }
  }
  const std::string sound = GltfParts().glb();
  const std::size_t second_chunk =
      20 + static_cast<unsigned char>(sound[12]) + 256U * static_cast<unsigned char>(sound[13]);
  for (const std::size_t length_at : {std::size_t{8}, std::size_t{12}, second_chunk}) {
    std::string lying = sound;
    refused("a.glb", lying.replace(length_at, 4, "\xf0\xff\xff\xff"), ErrorCode::malformed_file, "promises");
  }
}

TEST_F(Errors, broken_stl_files_are_malformed) {
  const std::string text = tetrahedron("stl/text.stl"), binary = tetrahedron("stl/binary.stl");
  refused("a.stl", text.substr(text.find('\n') + 1));
  for (const std::string part :
       {"facet", "normal", "normal 0", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid"}) {
    std::string bytes = text;
    refused("a.stl", bytes.erase(bytes.rfind(part), part.size()));
  }
  refused("a.stl", binary.substr(0, binary.size() - 50));
  for (const char count : {'\x7f', '\x80'}) {  // 4 + 2^31 facets are as many bytes in 32-bit arithmetic
    std::string lying = binary;
    lying[83] = count;
    refused("a.stl", lying);
  }
}

}  // namespace
}  // namespace limber
