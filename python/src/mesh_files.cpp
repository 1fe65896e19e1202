// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>

#include <filesystem>
#include <span>

#include "bindings.h"
#include "docstrings.h"
#include "errors.h"
#include "limber/io.h"
#include "query_arguments.h"
#include "records.h"

namespace limber::python {
namespace {

nb::tuple mesh_file(const std::filesystem::path& path) {
  const MeshFile file = value_or_raise(without_gil([&] { return read_mesh_file(path); }));
  return nb::make_tuple(array_of(std::span<const Vec3>(file.mesh.positions())),
                        array_of(std::span<const Corners>(file.mesh.triangles())),
                        array_of(std::span<const std::uint32_t>(file.face_of_triangle)));
}

/// A sequence of files. Reading does not change it.
MeshSequence opened(const std::filesystem::path& first) {
  return value_or_raise(without_gil([&] { return MeshSequence::open(first); }));
}

nb::object positions_in(const MeshSequence& self, const std::filesystem::path& path, std::size_t frame) {
  const std::vector<Vec3> positions = value_or_raise(without_gil([&] { return self.read_positions(path, frame); }));
  return array_of(std::span<const Vec3>(positions));
}

}  // namespace

void bind_mesh_files(nb::module_& m) {
  m.def(
      "read_mesh_file", &mesh_file, "path"_a,
      nb::sig("def read_mesh_file(path: str | os.PathLike[str]) -> tuple[FloatArray, IdArray, IdArray]"),
      (std::string(docs::read_mesh_file) +
       "\n\nReturns  Vertices (v, 3), triangles (n, 3), and the file's own face, counted from 0, behind each triangle.")
          .c_str());
  nb::class_<MeshSequence>(m, "MeshSequence", docs::MeshSequence)
      .def(
          "__init__",
          [](MeshSequence* self, const std::filesystem::path& first) { new (self) MeshSequence(opened(first)); },
          "first_frame"_a, nb::sig("def __init__(self, first_frame: str | os.PathLike[str]) -> None"),
          docs::MeshSequence_open)
      .def_prop_ro(
          "vertices",
          [](const MeshSequence& self) { return array_of(std::span<const Vec3>(self.first().mesh.positions())); },
          nb::sig("def vertices(self) -> FloatArray"), "Vertices of the first frame.")
      .def_prop_ro(
          "faces",
          [](const MeshSequence& self) { return array_of(std::span<const Corners>(self.first().mesh.triangles())); },
          nb::sig("def faces(self) -> IdArray"), "Triangles of every frame.")
      .def("read_positions", &positions_in, "path"_a, "frame"_a,
           nb::sig("def read_positions(self, path: str | os.PathLike[str], frame: int) -> FloatArray"),
           docs::MeshSequence_read_positions);
}

}  // namespace limber::python
