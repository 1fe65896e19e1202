// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "limber/mesh.h"

/// Mesh files: OBJ, PLY, STL, OFF, glTF 2.0 (.gltf, .glb). Target limber::io. Files may come from anywhere.
///
/// The extension decides the format, in capitals or not. Coordinates keep float64 precision where the file has it
/// (text, PLY of doubles); binary STL and glTF hold float32. A glTF scene becomes one mesh, every node's primitives
/// placed by its transform; skins and morphs stay at rest. Faces keep the file's order; a face of k corners becomes
/// k - 2 triangles, so triangle ids index the triangulated list in the file's own order. They are the fan around the
/// first corner if all of it is seen from there, and otherwise those that stay in the face. Vertices at equal positions
/// are shared (welded) afterwards, see ReadOptions. Faces of fewer than three corners are skipped but
/// counted, so that face ids stay the file's own. Messages count vertices and faces from 0, also in OBJ files.
namespace limber {

/// What mesh files may ask for; whatever asks for more is refused with `too_large` before memory is taken for it.
namespace mesh_file_limits {

/// Bytes of a file, together with the buffer files that a glTF file names.
inline constexpr std::uint64_t bytes = std::uint64_t{1} << 32U;

/// Lists and objects inside each other in the JSON description of a glTF file.
inline constexpr std::size_t gltf_json_depth = 64;

/// Numbers, strings, lists and objects in the JSON description of a glTF file.
inline constexpr std::size_t gltf_json_values = std::size_t{1} << 22U;

/// Vertices and triangles of a glTF scene, whose nodes may show a mesh many times: at most this number, or
/// `gltf_elements_per_byte` for each byte of its files where that is more. A scene that shows each mesh once is below.
inline constexpr std::uint64_t gltf_elements = std::uint64_t{1} << 21U;
inline constexpr std::uint64_t gltf_elements_per_byte = 2;

/// How often corners of a file's faces are looked at to split those into triangles that are not seen as a whole from
/// their first corner: for a face of k corners at most k^2 as a rule.
inline constexpr std::uint64_t corner_tests = std::uint64_t{1} << 28U;

}  // namespace mesh_file_limits

/// Which vertices of a file become one vertex of the mesh.
struct ReadOptions {
  /// Vertices at equal positions become one. Without it the mesh has the file's own vertices, in the file's order.
  bool weld = true;

  /// Vertices this far apart become one, too: in the file's order, each vertex joins the first mesh vertex that is not
  /// farther away, and otherwise becomes a mesh vertex itself. So none moves farther than this. Triangles whose corners
  /// become one stay, without area.
  double weld_tolerance = 0;

  /// Vertices of different parts stay apart. A vertex belongs to the part of the first face that names it; vertices
  /// that parts share in the file itself, as groups of an OBJ file may, stay shared.
  bool parts = false;
};

/// A mesh as a file describes it.
struct MeshFile {
  Mesh mesh;                                    ///< triangulated and welded; positions in order of first appearance
  std::vector<std::uint32_t> face_of_triangle;  ///< the file's own face, counted from 0, behind each triangle
  std::size_t face_count = 0;                   ///< faces in the file

  /// The mesh vertex that each vertex of the file has become. An STL file has three vertices a facet, a glTF file those
  /// of each node's mesh, node by node.
  std::vector<VertexId> vertex_of_file_vertex;

  /// Names of the parts with faces, in order of appearance: objects of an OBJ file, or its groups where all faces
  /// belong to one object; solids of an STL text; nodes of a glTF scene. Names may be empty and need
  /// not differ. A file without parts, or one of another format, is one part without a name.
  std::vector<std::string> parts;
  std::vector<std::uint32_t> part_of_triangle;  ///< in `parts`

  /// Every file that was read: the mesh file, then the buffer files that a glTF file names. Empty for bytes in memory.
  std::vector<std::filesystem::path> files;
};

/// Reads a file.
///
/// Errors   One line naming file and reason: `unreadable_file` (missing, no regular file, no permission),
///          `unsupported_format` (the extension, or a glTF extension), `malformed_file` (truncated, not a mesh),
///          `empty_mesh` (no face of three corners), `too_large` (beyond `mesh_file_limits`), `non_finite`, `too_large`
///          or `index_out_of_range` with the file's vertex or face.
/// Throws   std::invalid_argument if the tolerance is not finite, below 0, or given without welding.
/// Cost     O(size of the file), for glTF O(size of its files + vertices and triangles shown). With a
///          tolerance t also O(v^2 t / extent) of v vertices.
LIMBER_API Result<MeshFile> read_mesh_file(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a file that is in memory. `name` tells the format by its extension, and is what messages call the file.
///
/// Errors   As read_mesh_file(). glTF files that name buffer files are malformed.
LIMBER_API Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::filesystem::path& name,
                                            const ReadOptions& options = {});

/// The mesh of a file alone.
LIMBER_API Result<Mesh> load_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Frames of one deforming mesh: files with the same vertex count and the same faces, positions differing.
///
/// Vertex and triangle ids mean the same in every frame: all frames are welded alike, and split into the triangles of
/// the first. Vertices are welded only if they are together in every frame, so those that meet stay two and those that
/// part are two from the start.
class MeshSequence {
 public:
  /// Reads all frames, one at a time, and welds the vertices that are together in each of them. Where nothing is welded
  /// in the first frame, it alone is read.
  ///
  /// Errors   As read_positions().
  /// Throws   std::invalid_argument if there is no frame; as read_mesh_file().
  LIMBER_API static Result<MeshSequence> open(std::span<const std::filesystem::path> frames,
                                              const ReadOptions& options = {});

  /// Reads the first frame, and welds the vertices that are together in it. Frames in which they part are refused when
  /// they are read.
  ///
  /// Errors, Throws   As read_mesh_file().
  LIMBER_API static Result<MeshSequence> open(const std::filesystem::path& first_frame,
                                              const ReadOptions& options = {});

  const MeshFile& first() const { return first_; }

  /// Reads frame number `frame` (only used in messages) and returns the positions of the welded vertices.
  ///
  /// Errors   As read_mesh_file(), and `changed_connectivity` naming the frame number with both vertex counts and both
  ///          face counts, or, where counts agree, the first face that differs, or two vertices that are welded but
  ///          apart in this frame. `where` is the frame number.
  LIMBER_API Result<std::vector<Vec3>> read_positions(const std::filesystem::path& path, std::size_t frame) const;

 private:
  explicit MeshSequence(MeshFile first) : first_(std::move(first)) {}

  MeshFile first_;
  double weld_tolerance_ = 0;
  std::vector<std::uint32_t> file_corners_;  // of all faces one after the other, as in the file, before welding
  std::vector<std::size_t> file_face_ends_;  // where each face ends in `file_corners_`
  std::vector<VertexId> file_vertex_of_;     // the first file vertex for each welded vertex
};

}  // namespace limber
