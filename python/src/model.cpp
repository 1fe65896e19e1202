// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/io.h"
#include "limber/limber.h"
#include "records.h"
#include "value_class.h"

namespace limber::python {
namespace {

/// Makes a mesh of arrays, and returns use(mesh), which owns what it uses, as aside() has it.
template <typename Use>
auto with_mesh(nb::handle vertices, nb::handle faces, Use use) {
  std::vector<Vec3> positions = points_from(vertices, "vertices");
  std::vector<Corners> triangles = faces_from(faces, "faces");
  const std::size_t size = triangles.size();
  auto make = [positions = std::move(positions), triangles = std::move(triangles), use = std::move(use)]() mutable {
    Result<Mesh> mesh = Mesh::create(std::move(positions), std::move(triangles));
    using Made = Result<std::invoke_result_t<Use&, Mesh>>;
    return mesh ? Made(use(std::move(mesh).value())) : Made(mesh.error());
  };
  return value_or_raise(aside(size, std::move(make)));
}

using MeshArgument = Named<"ArrayLike | MeshLike">;

/// The vertices and faces that the arguments of a function stand for: two arrays, or an object that has both.
std::pair<nb::object, nb::object> mesh_arrays(const nb::object& vertices, const nb::object& faces,
                                              const char* function = "Model") {
  if (!faces.is_none()) return {vertices, faces};
  for (const char* const name : {"faces", "triangles"}) {
    if (nb::hasattr(vertices, "vertices") && nb::hasattr(vertices, name)) {
      return {vertices.attr("vertices"), vertices.attr(name)};
    }
  }
  constexpr const char* expected =
      ": expected vertices and faces, or a mesh that has them: vertices and faces or triangles";
  throw nb::type_error((std::string(function) + expected).c_str());
}

void construct(ModelObject* self, const MeshArgument& vertices, const ArrayLike& faces, double motion_margin,
               RebuildPolicy rebuild_policy, std::optional<double> rebuild_budget_us, bool preallocate) {
  const ModelOptions options{.motion_margin = motion_margin,
                             .rebuild_policy = rebuild_policy,
                             .rebuild_budget_us = rebuild_budget_us,
                             .preallocate = preallocate};
  const auto [positions, triangles] = mesh_arrays(vertices, faces);
  new (self)
      ModelObject(with_mesh(positions, triangles, [options](Mesh mesh) { return Model(std::move(mesh), options); }));
}

void reset(ModelObject& self, const MeshArgument& vertices, const ArrayLike& faces) {
  const auto [positions, triangles] = mesh_arrays(vertices, faces);
  with_mesh(positions, triangles, [&model = self.model, owner = nb::find(self), guard = changing(self)](Mesh mesh) {
    return model.reset(std::move(mesh)), true;
  });
}

/// Returns change(model), done as aside() has it. Raises BusyError if another thread uses the model.
template <typename Change>
auto changed(ModelObject& self, Change change) {
  const Mesh& mesh = self.model.mesh();
  return aside(std::max(mesh.positions().size(), mesh.triangles().size()),
               [&model = self.model, change = std::move(change), owner = nb::find(self), guard = changing(self)] {
                 return change(model);
               });
}

void move_vertices(ModelObject& self, const ArrayLike& ids, const ArrayLike& positions) {
  value_or_raise(changed(self, [vertices = ids_from(ids, "ids"), moved = points_from(positions, "positions")](
                                   Model& model) { return model.move_vertices(vertices, moved); }));
}

void move_all(ModelObject& self, const ArrayLike& positions) {
  value_or_raise(
      changed(self, [moved = points_from(positions, "positions")](Model& model) { return model.move_all(moved); }));
}

/// Calls read_model(model) with the GIL, as it is short. Raises BusyError if another thread changes the model.
template <typename Read>
auto read(ModelObject& self, const Read& read_model) {
  const Reading guard = reading(self);
  return read_model(static_cast<const Model&>(self.model));
}

FloatArray vertices_of(ModelObject& self) {
  return read(self, [](const Model& m) { return read_only(array_of(std::span<const Vec3>(m.mesh().positions()))); });
}

Named<"ModelOptions"> options_of(ModelObject& self) {
  const ModelOptions o = read(self, [](const Model& m) { return m.options(); });
  nb::dict options;
  options["motion_margin"] = o.motion_margin;
  options["rebuild_policy"] = o.rebuild_policy;
  options["rebuild_budget_us"] = o.rebuild_budget_us;
  options["preallocate"] = o.preallocate;
  return options;
}

/// A copy, which outlives the model.
MeshEdges edges_of(ModelObject& self) {
  return aside(self.model.mesh().triangles().size(),
               [&model = self.model, use = InUse(self)]() -> MeshEdges { return model.edges(); });
}

IdArray faces_of(ModelObject& self) {
  return read(self, [](const Model& m) { return read_only(array_of(std::span<const Corners>(m.mesh().triangles()))); });
}

/// What a pickle keeps: mesh, options, and the attributes that a subclass in Python has added.
nb::tuple state_of(nb::handle_t<ModelObject> self) {
  auto& object = nb::cast<ModelObject&>(self);
  return nb::make_tuple(vertices_of(object), faces_of(object), options_of(object),
                        nb::getattr(self, "__dict__", nb::none()));
}

/// Builds a model from what state_of() returned.
void restore(nb::pointer_and_handle<ModelObject> self, const nb::tuple& state) {
  if (state.size() != 4) throw nb::value_error("the state is not that of a model");
  const nb::dict options = nb::cast<nb::dict>(state[2]);
  construct(self.p, nb::object(state[0]), nb::object(state[1]), nb::cast<double>(options["motion_margin"]),
            nb::cast<RebuildPolicy>(options["rebuild_policy"]),
            nb::cast<std::optional<double>>(options["rebuild_budget_us"]), nb::cast<bool>(options["preallocate"]));
  if (!state[3].is_none()) nb::getattr(self.h, "__dict__").attr("update")(state[3]);
}

void bind_stats(nb::module_& m) {
  ValueClass<TreeStats>(m, "TreeStats", "The size of a tree.")
      .field("levels", &TreeStats::levels, "Levels of nodes, the root's included.")
      .field("nodes", &TreeStats::nodes, "Of up to 8 children each.")
      .field("leaves", &TreeStats::leaves, docs::TreeStats_leaves)
      .field("bytes", &TreeStats::bytes, docs::TreeStats_bytes);
  ValueClass<MaintenanceStats>(m, "MaintenanceStats", docs::MaintenanceStats)
      .field("moved_vertices", &MaintenanceStats::moved_vertices, docs::MaintenanceStats_moved_vertices)
      .field("refits", &MaintenanceStats::refits, docs::MaintenanceStats_refits)
      .field("whole_passes", &MaintenanceStats::whole_passes, docs::MaintenanceStats_whole_passes)
      .field("absorbed", &MaintenanceStats::absorbed, docs::MaintenanceStats_absorbed)
      .field("motion_margin", &MaintenanceStats::motion_margin, docs::MaintenanceStats_motion_margin)
      .field("rebuilt_triangles", &MaintenanceStats::rebuilt_triangles, docs::MaintenanceStats_rebuilt_triangles)
      .field("rebuild_us", &MaintenanceStats::rebuild_us, docs::MaintenanceStats_rebuild_us);
}

Named<"MeshFile"> mesh_file(const std::filesystem::path& path, bool weld, double weld_tolerance, bool parts) {
  const MeshFile file = value_or_raise(aside(any_size, [path, weld, weld_tolerance, parts] {
    return read_mesh_file(path, {weld, weld_tolerance, parts});
  }));
  return result("MeshFile", "vertices"_a = array_of(std::span<const Vec3>(file.mesh.positions())),
                "faces"_a = array_of(std::span<const Corners>(file.mesh.triangles())),
                "face_of_triangle"_a = array_of(std::span<const std::uint32_t>(file.face_of_triangle)),
                "face_count"_a = file.face_count,
                "vertex_of_file_vertex"_a = array_of(std::span<const VertexId>(file.vertex_of_file_vertex)),
                "parts"_a = file.parts,
                "part_of_triangle"_a = array_of(std::span<const std::uint32_t>(file.part_of_triangle)),
                "files"_a = file.files);
}

void open_sequence(MeshSequence* self,
                   const std::variant<std::filesystem::path, std::vector<std::filesystem::path>>& frames, bool weld,
                   double weld_tolerance, bool parts) {
  const auto open = [=](const auto& paths) {
    return MeshSequence::open(paths, ReadOptions{weld, weld_tolerance, parts});
  };
  new (self) MeshSequence(value_or_raise(aside(any_size, [open, frames] { return std::visit(open, frames); })));
}

FloatArray positions_in(const MeshSequence& self, const std::filesystem::path& path, std::size_t frame) {
  const std::vector<Vec3> positions = value_or_raise(
      aside(any_size, [&self, path, frame, owner = nb::find(self)] { return self.read_positions(path, frame); }));
  return array_of(std::span<const Vec3>(positions));
}

Named<"WeldedMesh"> weld_of(const MeshArgument& vertices, const ArrayLike& faces) {
  const auto [positions, triangles] = mesh_arrays(vertices, faces, "weld");
  const WeldedMesh welded = with_mesh(positions, triangles, [](const Mesh& mesh) { return weld(mesh); });
  return result("WeldedMesh", "vertices"_a = array_of(std::span<const Vec3>(welded.mesh.positions())),
                "faces"_a = array_of(std::span<const Corners>(welded.mesh.triangles())),
                "welded_of"_a = array_of(std::span<const std::uint32_t>(welded.vertices.welded_of)),
                "first_of"_a = array_of(std::span<const std::uint32_t>(welded.vertices.first_of)));
}

constexpr const char* open_sequence_doc =
    R"(Reads all frames, one at a time, and welds the vertices that are together in each of them. Where nothing is
welded in the first frame, it alone is read. Of a single frame, later ones in which welded vertices part are
refused when they are read. Options are those of read_mesh_file().

Raises   As read_positions(); ValueError if there is no frame.)";

void bind_mesh_files(nb::module_& m) {
  m.def("read_mesh_file", &mesh_file, "path"_a, nb::kw_only(), "weld"_a = true, "weld_tolerance"_a = 0.0,
        "parts"_a = false,
        nb::sig("def read_mesh_file(path: str | os.PathLike[str], *, weld: bool = True, weld_tolerance: float = 0.0, "
                "parts: bool = False) -> MeshFile"),
        docs::read_mesh_file);
  nb::class_<MeshSequence>(m, "MeshSequence", docs::MeshSequence)
      .def("__init__", &open_sequence, "frames"_a, nb::kw_only(), "weld"_a = true, "weld_tolerance"_a = 0.0,
           "parts"_a = false,
           nb::sig("def __init__(self, frames: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], *, "
                   "weld: bool = True, weld_tolerance: float = 0.0, parts: bool = False) -> None"),
           open_sequence_doc)
      .def_prop_ro(
          "vertices",
          [](const MeshSequence& self) {
            return read_only(array_of(std::span<const Vec3>(self.first().mesh.positions())));
          },
          "Vertices of the first frame.")
      .def_prop_ro(
          "faces",
          [](const MeshSequence& self) {
            return read_only(array_of(std::span<const Corners>(self.first().mesh.triangles())));
          },
          "Triangles of every frame.")
      .def("read_positions", &positions_in, "path"_a, "frame"_a,
           nb::sig("def read_positions(self, path: str | os.PathLike[str], frame: int) -> FloatArray"),
           docs::MeshSequence_read_positions);
}

constexpr const char* weld_doc =
    R"(Makes one vertex of those at equal positions, as queries need it that go by vertex ids. A soup of triangles whose
corners are vertices of their own becomes a surface.

Mesh     Vertices and faces, or one object that has both, as for a Model.
Shape    Triangles keep their ids and the order of their corners. Those with two corners in one place name a vertex
         twice. Vertices are numbered in order of first appearance; -0 equals 0.
Raises   As Model.)";

constexpr const char* constructor_doc = R"(A model of a mesh.

Mesh     Vertices and faces; or one object that has `vertices` and `faces` or `triangles`, such as a trimesh.Trimesh.
Shape    vertices (v, 3) of floats or integers, faces (n, 3) of integers. Both are copied.
Options  Where None is allowed it stands for: automatic.
Raises   ValueError for arrays of other shapes or types, no triangle, coordinates that are not finite or too large, and
         for options that are not what their texts say; IndexError for faces that name vertices that do not exist.
Cost     O(n log n), on all threads.)";

void bind_edges(nb::module_& m) {
  nb::class_<MeshEdges>(m, "MeshEdges", docs::MeshEdges)
      .def("__len__", &MeshEdges::size)
      .def_prop_ro(
          "vertices", [](const MeshEdges& self) { return read_only(array_of(self.vertices())); },
          docs::MeshEdges_vertices)
      .def_prop_ro(
          "of_triangles", [](const MeshEdges& self) { return read_only(array_of(self.of_triangles())); },
          docs::MeshEdges_of_triangles)
      .def_prop_ro(
          "representatives", [](const MeshEdges& self) { return read_only(array_of(self.representatives())); },
          docs::MeshEdges_representatives)
      .def_prop_ro(
          "vertex_representatives",
          [](const MeshEdges& self) { return read_only(array_of(self.vertex_representatives())); },
          docs::MeshEdges_vertex_representatives);
}

std::string constructor_documentation() {
  return std::string(constructor_doc) + "\n\nmotion_margin: " + docs::ModelOptions_motion_margin +
         "\n\nrebuild_policy: " + docs::RebuildPolicy +
         "\n\nrebuild_budget_us: " + docs::ModelOptions_rebuild_budget_us +
         "\n\npreallocate: " + docs::ModelOptions_preallocate;
}

}  // namespace

void bind_model(nb::module_& m) {
  bind_stats(m);
  bind_edges(m);
  bind_mesh_files(m);
  m.def("weld", &weld_of, "vertices"_a, "faces"_a = nb::none(), weld_doc);
  nb::enum_<RebuildPolicy>(m, "RebuildPolicy", docs::RebuildPolicy)
      .value("off", RebuildPolicy::off, docs::RebuildPolicy_off)
      .value("in_commit", RebuildPolicy::in_commit, docs::RebuildPolicy_in_commit)
      .value("on_worker", RebuildPolicy::on_worker, docs::RebuildPolicy_on_worker);

  nb::class_<BodyObject, ModelWithRadius>(m, "Body", docs::Body)
      .def(nb::init<ModelObject&, double>(), "model"_a, "radius"_a, nb::keep_alive<1, 2>(), docs::Body_init)
      .def_prop_ro(
          "radius",
          [](BodyObject& self) {
            const Reading guard = reading(self);
            return self.body().radius();
          },
          "How far points of the body are from its triangles at most, but for the inside of solids.")
      .def_prop_ro(
          "is_solid",
          [](BodyObject& self) {
            const Reading guard = reading(self);
            return self.body().is_solid();
          },
          "Whether what its triangles enclose belongs to the body.");
  // Of this class alone, as classes derived from it are pickled otherwise.
  nb::module_::import_("copyreg").attr("pickle")(
      nb::type<BodyObject>(), nb::cpp_function([](const BodyObject& self) { return self.reduced(); }));
  nb::class_<ModelObject, BodyObject>(m, "Model",
                                      (std::string(docs::Model) + R"(

Pickle   A pickled model keeps its mesh, with all moves, and its options. It is built anew where it is unpickled: the
         history of its tree and its statistics are not kept, and it is committed.
Busy     A call that would change a model while another thread uses it raises BusyError, and so does a query of a model
         that is being changed, unless the other one ends within a second: for so long a call waits, and queries that
         begin meanwhile let a change go first. A thread that is in a call already, as a filter is, does not wait.)")
                                          .c_str())
      .def("__init__", &construct, "vertices"_a, "faces"_a = nb::none(), nb::kw_only(), "motion_margin"_a = 0.0,
           "rebuild_policy"_a = RebuildPolicy::in_commit, "rebuild_budget_us"_a.none() = nb::none(),
           "preallocate"_a = false, constructor_documentation().c_str())
      .def("move_vertices", &move_vertices, "ids"_a, "positions"_a, docs::Model_move_vertices)
      .def("move_all", &move_all, "positions"_a, docs::Model_move_all)
      .def(
          "commit", [](ModelObject& self) { changed(self, [](Model& model) { return model.commit(), true; }); },
          docs::Model_commit)
      .def(
          "rebuild", [](ModelObject& self) { changed(self, [](Model& model) { return model.rebuild(), true; }); },
          docs::Model_rebuild)
      .def(
          "set_motion_margin",
          [](ModelObject& self, double margin) {
            changed(self, [margin](Model& model) { return model.set_motion_margin(margin), true; });
          },
          "motion_margin"_a, docs::Model_set_motion_margin)
      .def("reset", &reset, "vertices"_a, "faces"_a = nb::none(), docs::Model_reset)
      .def(
          "validate",
          [](ModelObject& self) {
            value_or_raise(aside(self.model.mesh().triangles().size(),
                                 [&model = self.model, use = InUse(self)] { return model.validate(); }));
          },
          docs::Model_validate)
      .def_prop_ro(
          "is_committed",
          [](ModelObject& self) { return read(self, [](const Model& model) { return model.is_committed(); }); },
          docs::Model_is_committed)
      .def_prop_ro("vertices", &vertices_of,
                   "A read-only copy of the positions, moves included: shape (v, 3), float64. See move_all().")
      .def_prop_ro("faces", &faces_of, "A read-only copy of the triangles: shape (n, 3), uint32.")
      .def_prop_ro("edges", &edges_of, (std::string(docs::Model_edges) + "\n\nReturns  A copy.").c_str())
      .def_prop_ro("options", &options_of, "The options that the model has, by name.")
      .def_prop_ro(
          "tree_stats",
          [](ModelObject& self) { return read(self, [](const Model& model) { return model.tree_stats(); }); },
          "The size of the tree.")
      .def_prop_ro(
          "maintenance_stats",
          [](ModelObject& self) { return read(self, [](const Model& model) { return model.maintenance_stats(); }); },
          docs::MaintenanceStats)
      .def(
          "bounding_box",
          [](ModelObject& self) { return read(self, [](const Model& model) { return model.bounding_box(); }); },
          docs::Model_bounding_box)
      .def(
          "bounding_sphere",
          [](ModelObject& self) { return read(self, [](const Model& model) { return model.bounding_sphere(); }); },
          docs::Model_bounding_box)  // one text for both
      .def("__repr__",
           [](ModelObject& self) {
             return read(self, [](const Model& model) {
               return nb::str("Model({} vertices, {} faces)")
                   .format(model.mesh().positions().size(), model.mesh().triangles().size());
             });
           })
      .def("__getstate__", &state_of, nb::sig("def __getstate__(self) -> tuple[Any, ...]"))
      .def("__setstate__", &restore, nb::sig("def __setstate__(self, state: tuple[Any, ...], /) -> None"));
}

}  // namespace limber::python
