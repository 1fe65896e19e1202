// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "files.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

class Errors : public FilesTest {
 protected:
  Error unreadable(const fs::path& path) const {
    const Result<MeshFile> file = read_mesh_file(path);
    if (file) {
      ADD_FAILURE() << path << " was read";
      return {};
    }
    EXPECT_TRUE(is_one_line_about(path, file.error().text)) << file.error().text;
    return file.error();
  }
};

TEST_F(Errors, missing_file_and_folder_are_unreadable) {
  EXPECT_EQ(unreadable(path("missing.obj")).code, ErrorCode::unreadable_file);
  EXPECT_EQ(unreadable(path("missing.obj")).text, path("missing.obj").string() + ": no such file");
  fs::create_directories(path("folder.obj"));
  EXPECT_EQ(unreadable(path("folder.obj")).code, ErrorCode::unreadable_file);
  EXPECT_EQ(unreadable(path("folder.obj")).text, path("folder.obj").string() + ": is a folder");
  EXPECT_EQ(unreadable(write("file", "v") / "below.obj").code, ErrorCode::unreadable_file);
  EXPECT_EQ(unreadable("/dev/zero").code, ErrorCode::unreadable_file);
}

#if !defined(_WIN32)
TEST_F(Errors, file_without_permission_is_unreadable) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const fs::path file = write("secret.obj", tetrahedron_obj());
  fs::permissions(file, fs::perms::none);
  EXPECT_EQ(unreadable(file).code, ErrorCode::unreadable_file);
}
#endif

TEST_F(Errors, unknown_extensions_are_named) {
  EXPECT_EQ(refused("a.fbx", tetrahedron_obj()).code, ErrorCode::unsupported_format);
  EXPECT_EQ(refused("obj", tetrahedron_obj()).code, ErrorCode::unsupported_format);
  EXPECT_NE(refused("a.fbx", "x").text.find(".fbx"), std::string::npos);
  EXPECT_EQ(read("two\nlines.obj", "").error().text.find('\n'), std::string::npos);
}

TEST_F(Errors, empty_files_and_other_texts_are_malformed) {
  const std::string prose = "The quick brown fox\njumps over the lazy dog.\n";
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.gltf", "a.glb"}) {
    EXPECT_EQ(refused(name, "").code, ErrorCode::malformed_file) << name;
    EXPECT_EQ(refused(name, prose).code, ErrorCode::malformed_file) << name;
    EXPECT_EQ(refused(name, "\n \n").code, ErrorCode::malformed_file) << name;
    EXPECT_EQ(refused(name, std::string(1000, '\0')).code, ErrorCode::malformed_file) << name;
    for (const auto& [other, bytes] : tetrahedron_files()) {
      const std::string extension = fs::path(name).extension().string();
      if (other.ends_with(extension) || (extension == ".glb" && other.ends_with(".gltf")) ||
          (extension == ".gltf" && other.ends_with(".glb"))) {
        continue;
      }
      EXPECT_EQ(refused(name, bytes).code, ErrorCode::malformed_file) << name << " holding " << other;
    }
  }
}

TEST_F(Errors, files_without_a_face_are_empty) {
  EXPECT_EQ(refused("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.obj", "v 0 0 0\nf\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.off", "OFF\n0 0 0\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.off", "OFF\n1 0 0\n0 0 0\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.stl", "solid nothing\nendsolid nothing\n").code, ErrorCode::empty_mesh);
  EXPECT_EQ(refused("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n0 0 0\n")
                .code,
            ErrorCode::empty_mesh);
}

TEST_F(Errors, coordinates_that_are_not_finite_are_named) {
  const auto expect_vertex = [&](const std::string& name, const std::string& bytes, std::size_t vertex) {
    const Error error = refused(name, bytes);
    EXPECT_EQ(error.code, ErrorCode::non_finite) << error.text;
    EXPECT_EQ(error.text, path(name).string() + ": vertex " + std::to_string(vertex) + " is not finite");
    EXPECT_EQ(error.where, vertex);
  };
  for (const std::string bad :
       {"nan", "-NaN", "inf", "-Infinity", "nan(0x7)", "1e999", "-1e999", "1.#QNAN", "-1.#IND", "1.#INF", "+inf"}) {
    expect_vertex("a.obj", "v 0 0 0\nv 1 0 0\nv 0 " + bad + " 0\nf 1 2 3\n", 2);
    expect_vertex("a.off", "OFF\n3 1 0\n0 0 0\n0 0 " + bad + "\n0 1 0\n3 0 1 2\n", 1);
    expect_vertex("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 1\nproperty list uchar int vertex_index\nend_header\n" +
                      bad +
                      " 0 0\n1 0 0\n0 1 0\n"
                      "3 0 1 2\n",
                  0);
    expect_vertex("a.stl",
                  "solid\nfacet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 " + bad +
                      "\nendloop endfacet\nendsolid\n",
                  2);
  }
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::string little, big;
    append(little, bad);
    append(big, bad, true);
    const auto with = [](std::string bytes, std::size_t at, const std::string& number) {
      return bytes.replace(at, number.size(), number);
    };
    const std::string ply = tetrahedron_ply_binary(false);
    expect_vertex("a.ply", with(ply, ply.find("end_header\n") + 11 + 16, little), 1);
    const std::string big_ply = tetrahedron_ply_binary(true);
    expect_vertex("a.ply", with(big_ply, big_ply.find("end_header\n") + 11 + 44, big), 3);
    expect_vertex("a.stl", with(tetrahedron_stl_binary(), 84 + 50 + 12 + 12, little), 4);
    GltfParts gltf;
    gltf.buffer = with(gltf.buffer, 24, little);
    expect_vertex("a.glb", gltf.glb(), 2);
  }
}

TEST_F(Errors, coordinates_above_the_limit_are_too_large) {
  const Error error = refused("a.obj", "v 0 0 0\nv 0 0 0\nv 1e61 0 0\nv 0 1 0\nf 1 3 4\n");
  EXPECT_EQ(error.code, ErrorCode::too_large);
  EXPECT_EQ(error.where, 2U);  // of the file, although vertices 0 and 1 are the same
}

TEST_F(Errors, faces_that_name_missing_vertices_are_named) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face :
       {"f 1 2 4", "f 1 2 5", "f 1 2 99", "f 0 1 2", "f 1 2 -4", "f -1 -2 -2147483648", "f 1 2 2147483647"}) {
    const Error error = refused("a.obj", vertices + "f 1 2 3\n" + face + "\n");
    EXPECT_EQ(error.code, ErrorCode::index_out_of_range) << face;
    EXPECT_EQ(error.where, 1U) << face;
  }
  EXPECT_EQ(refused("a.obj", "f 1 2 3\n").code, ErrorCode::index_out_of_range);
  EXPECT_EQ(refused("a.obj", vertices + "f 0 1 2\n" + vertices).code, ErrorCode::index_out_of_range);
  EXPECT_EQ(refused("a.obj", vertices + "f 1 2 -4\n" + vertices).code, ErrorCode::index_out_of_range);
  for (const char* face : {"3 0 1 3", "3 0 1 -1", "3 0 1 4294967296"}) {
    const Error off = refused("a.off", std::string("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") + face + "\n");
    EXPECT_EQ(off.code, ErrorCode::index_out_of_range) << face;
    EXPECT_EQ(off.where, 1U) << face;
    const Error ply =
        refused("a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                     "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") +
                             face + "\n");
    EXPECT_EQ(ply.code, ErrorCode::index_out_of_range) << face;
    EXPECT_EQ(ply.where, 1U) << face;
  }
  std::string ply = tetrahedron_ply_binary(true);
  ply.back() = 4;
  EXPECT_EQ(refused("a.ply", ply).code, ErrorCode::index_out_of_range);
  ply[ply.size() - 4] = '\xff';
  const Error negative = refused("a.ply", ply);
  EXPECT_EQ(negative.code, ErrorCode::index_out_of_range);
  EXPECT_NE(negative.text.find("vertex -"), std::string::npos) << negative.text;
}

TEST_F(Errors, broken_obj_records_are_malformed) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = "f 1 2 3\n";
  for (const char* record :
       {"v 1 2", "v", "v 1 2 x", "v 1-2 3 4", "v 1,5 2 3", "v 1.2.3 2 3", "v 0x10 0 0", "f 1 2 x", "f 1 2 3.5",
        "f 1,2,3", "f 1 2 99999999999", "f 1 2 3/a", "f /1 /2 /3", "7 8 9", "@!", "v +-1 0 0"}) {
    EXPECT_EQ(refused("a.obj", vertices + face + record + "\n").code, ErrorCode::malformed_file) << record;
  }
}

TEST_F(Errors, broken_off_files_are_malformed) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_TRUE(read("a.off", "OFF\n3 1 0\n" + body));
  for (const std::string bytes :
       {"OFF\n3\n", "OFF\n-3 1 0\n", "OFF BINARY\n", "4OFF\n3 1 0\n", "STCN OFF\n", "nOFF\n3\n3 1 0\n", "XOFF\n3 1 0\n",
        "off\n3 1 0\n", "3 1 0\n", "OFF\n4294967295 4294967295 0\n", "OFF\n99999999999 1 0\n", "OFF\n3 2 0\n",
        "OFF\n4 1 0\n", "OFF\n3.5 1 0\n"}) {
    EXPECT_EQ(refused("a.off", bytes + body).code, ErrorCode::malformed_file) << bytes;
  }
  for (const char* face : {"3 0 1", "4000000000 0 1 2", "3 0 1 x", "-3 0 1 2", "3 0 1 1.5", "x"}) {
    const std::string head = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(refused("a.off", head + face + "\n").code, ErrorCode::malformed_file) << face;
  }
  EXPECT_EQ(refused("a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n").code, ErrorCode::malformed_file);
}

TEST_F(Errors, broken_ply_files_are_malformed) {
  const std::string ascii = tetrahedron_ply_ascii();
  const auto with = [&](const std::string& part, const std::string& instead) {
    std::string bytes = ascii;
    EXPECT_NE(bytes.find(part), bytes.npos) << part;
    return bytes.replace(bytes.find(part), part.size(), instead);
  };
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"ply\n", "plx\n"},
      {"format ascii 1.0\n", ""},
      {"ascii", "utf8"},
      {"element vertex 4\n", ""},
      {"vertex 4", "vertex 4294967295"},
      {"vertex 4", "vertex 99999999999999999999"},
      {"vertex 4", "vertex -4"},
      {"face 4", "face 4294967295"},
      {"face 4", "face 5"},
      {"property double x\n", ""},
      {"property double x", "property half x"},
      {"property double x", "property list uchar double x"},
      {"property double y", "property double x"},
      {"uchar int", "float int"},
      {"uchar int", "uchar float"},
      {"uchar int", "uchar int64"},
      {"vertex_indices", "corners"},
      {"end_header\n", ""},
      {"\n0 0 0.5\n", "\n0 0 0,5\n"},
      {"3 1 2 3\n", "3 1 2\n"},
      {"3 1 2 3\n", "4000000000 1 2 3\n"},
      {"3 1 2 3\n", "-3 1 2 3\n"},
      {"3 1 2 3\n", "3 1 2 x\n"}};
  for (const auto& [part, instead] : changes) {
    EXPECT_EQ(refused("a.ply", with(part, instead)).code, ErrorCode::malformed_file) << part << " -> " << instead;
  }
}

TEST_F(Errors, ply_vertices_with_two_coordinates_of_one_name_are_malformed) {
  std::string bytes = tetrahedron_ply_ascii();
  bytes.insert(bytes.find("element face"), "property double z\n");
  EXPECT_NE(refused("a.ply", bytes).text.find("coordinate z"), std::string::npos);
}

TEST_F(Errors, ply_headers_that_promise_billions_are_refused_at_once) {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
  for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string head = std::string("ply\nformat ") + encoding + " 1.0\n";
    for (const std::string& bytes :
         {head + "element vertex 4000000000\n" + vertices + "end_header\n" + std::string(50, '7'),
          head + "element vertex 0\n" + vertices +
              "element face 4000000000\nproperty list uint int vertex_indices\nend_header\n" + std::string(50, '7'),
          head + "element vertex 0\n" + vertices +
              "element face 1\nproperty list int int vertex_indices\nend_header\n2000000000 " + std::string(50, '\xff'),
          head + "element other 4000000000\nelement vertex 0\n" + vertices +
              "element face 4000000000\nproperty list int int vertex_indices\nend_header\n"}) {
      EXPECT_EQ(refused("a.ply", bytes).code, ErrorCode::malformed_file) << bytes;
    }
  }
}

TEST_F(Errors, broken_stl_files_are_malformed) {
  const std::string text = tetrahedron_stl_text();
  for (const std::string part : {"solid four corners\n", "facet", "normal", "normal 0", "outer", "loop", "vertex",
                                 "endloop", "endfacet", "endsolid"}) {
    std::string bytes = text;
    bytes.erase(bytes.rfind(part), part.size());
    if (part == "solid four corners\n") bytes = text.substr(part.size());
    EXPECT_EQ(refused("a.stl", bytes).code, ErrorCode::malformed_file) << part;
  }
  const std::string binary = tetrahedron_stl_binary();
  EXPECT_EQ(refused("a.stl", binary.substr(0, binary.size() - 50)).code, ErrorCode::malformed_file);
  std::string lying = binary;
  lying[83] = '\x7f';
  EXPECT_EQ(refused("a.stl", lying).code, ErrorCode::malformed_file);
  std::string wrapped = binary;  // 4 + 2^31 facets are as many bytes in 32-bit arithmetic
  wrapped[83] = '\x80';
  EXPECT_EQ(refused("a.stl", wrapped).code, ErrorCode::malformed_file);
}

TEST_F(Errors, glb_chunks_that_promise_gigabytes_are_refused_at_once) {
  const std::string sound = GltfParts().glb();
  const std::size_t second_chunk =
      20 + static_cast<unsigned char>(sound[12]) + 256U * static_cast<unsigned char>(sound[13]);
  for (const std::size_t length_at : {std::size_t{8}, std::size_t{12}, second_chunk}) {
    std::string lying = sound;
    lying.replace(length_at, 4, "\xf0\xff\xff\xff");
    const Error error = refused("a.glb", lying);
    EXPECT_EQ(error.code, ErrorCode::malformed_file);
    EXPECT_NE(error.text.find("promises"), std::string::npos) << error.text;
  }
}

}  // namespace
}  // namespace limber
