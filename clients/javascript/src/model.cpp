// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bindings.h"
#include "limber/io.h"

namespace limber::web {
namespace {

// Stands for ModelOptions::automatic.
constexpr double automatic = -1;

void put_sphere(double*& to, const Sphere& sphere) { put(to, sphere.center), *to++ = sphere.radius; }

std::vector<double> spheres;  // of the last call of node_spheres()
std::optional<MeshFile> last_file;
std::optional<WeldedMesh> last_welded;

}  // namespace

/// A model of vertices and faces in input(). Returns null on failure.
LIMBER_EXPORT(newModel)
OwnedModel* new_model(std::size_t vertex_count, bool is_float32, std::size_t triangle_count, double motion_margin,
                      bool rebuilds, double rebuild_budget_us, bool preallocate) {
  OwnedModel* model = nullptr;
  guarded([&] {
    Mesh mesh = mesh_from(vertex_count, is_float32, triangle_count);
    const ModelOptions options{
        .motion_margin = motion_margin,
        .rebuild_policy = rebuilds ? RebuildPolicy::in_commit : RebuildPolicy::off,
        .rebuild_budget_us = rebuild_budget_us == automatic ? std::nullopt : std::optional(rebuild_budget_us),
        .preallocate = preallocate};
    model = new OwnedModel(std::move(mesh), options);
  });
  return model;
}

LIMBER_EXPORT(deleteBody) void delete_body(BodyOwner* body) { delete body; }

/// Positions in input(), then ids.
LIMBER_EXPORT(moveVertices) bool move_vertices(OwnedModel* model, std::size_t count, bool is_float32) {
  return guarded([&] {
    const std::byte* const after_positions = input() + 3 * count * (is_float32 ? sizeof(float) : sizeof(double));
    const std::span ids(reinterpret_cast<const VertexId*>(after_positions), count);
    model->move_vertices(ids, positions_from(count, is_float32)).value();
  });
}

LIMBER_EXPORT(moveAll) bool move_all(OwnedModel* model, std::size_t count, bool is_float32) {
  return guarded([&] { model->move_all(positions_from(count, is_float32)).value(); });
}

LIMBER_EXPORT(commit) bool commit(OwnedModel* model) {
  return guarded([&] { model->commit(); });
}

LIMBER_EXPORT(isCommitted) bool is_committed(const OwnedModel* model) { return model->is_committed(); }

LIMBER_EXPORT(rebuild) bool rebuild(OwnedModel* model) {
  return guarded([&] { model->rebuild(); });
}

LIMBER_EXPORT(setMotionMargin) bool set_motion_margin(OwnedModel* model, double motion_margin) {
  return guarded([&] { model->set_motion_margin(motion_margin); });
}

LIMBER_EXPORT(validate) bool validate(const OwnedModel* model) {
  return guarded([&] { model->validate().value(); });
}

LIMBER_EXPORT(meshOf) void mesh_of(const OwnedModel* model) { give_mesh(model->mesh()); }

/// The two vertices of each edge.
LIMBER_EXPORT(edgesOf) bool edges_of(const OwnedModel* model) {
  return guarded([&] {
    const auto vertices = model->edges().vertices();
    give_bytes(vertices.data(), vertices.size_bytes());
  });
}

LIMBER_EXPORT(boundingBox) bool bounding_box(const OwnedModel* model) {
  return guarded([&] {
    const Box box = model->bounding_box();
    double* to = exchange.numbers;
    put(to, box.low), put(to, box.high);
  });
}

LIMBER_EXPORT(boundingSphere) bool bounding_sphere(const OwnedModel* model) {
  return guarded([&] {
    double* to = exchange.numbers;
    put_sphere(to, model->bounding_sphere());
  });
}

LIMBER_EXPORT(nodeSpheres) bool node_spheres(const OwnedModel* model, double level) {
  return guarded([&] {
    const bool is_level = level >= 0 && level < model->tree_stats().levels;
    const std::vector<Sphere> of_level = model->node_spheres(is_level ? static_cast<std::uint32_t>(level) : no_id);
    spheres.resize(4 * of_level.size());
    double* to = spheres.data();
    for (const Sphere& sphere : of_level) put_sphere(to, sphere);
    give_bytes(spheres.data(), spheres.size() * sizeof(double));
  });
}

LIMBER_EXPORT(treeStats) void tree_stats(const OwnedModel* model) {
  const TreeStats stats = model->tree_stats();
  exchange.numbers[0] = stats.levels, exchange.numbers[1] = stats.nodes;
  exchange.numbers[2] = stats.leaves, exchange.numbers[3] = stats.bytes;
}

LIMBER_EXPORT(maintenanceStats) void maintenance_stats(const OwnedModel* model) {
  const MaintenanceStats stats = model->maintenance_stats();
  const double numbers[7] = {static_cast<double>(stats.moved_vertices),
                             static_cast<double>(stats.refits),
                             static_cast<double>(stats.whole_passes),
                             static_cast<double>(stats.absorbed),
                             stats.motion_margin,
                             static_cast<double>(stats.rebuilt_triangles),
                             stats.rebuild_us};
  std::memcpy(exchange.numbers, numbers, sizeof(numbers));
}

/// Welds the mesh in input(). Gives places and counts of vertices and triangles, and the place of the welded vertex of
/// each; they stay until forgetWelded().
LIMBER_EXPORT(weld)
bool exported_weld(std::size_t vertex_count, bool is_float32, std::size_t triangle_count) {
  return guarded([&] {
    last_welded = weld(mesh_from(vertex_count, is_float32, triangle_count));
    give_mesh(last_welded->mesh);
    exchange.words[4] = address_of(last_welded->vertices.welded_of.data());
  });
}

LIMBER_EXPORT(forgetWelded) void forget_welded() { last_welded.reset(); }

/// Reads the mesh file in input(), whose name follows its bytes. Gives places and counts of vertices, triangles and
/// faces; they stay until forgetMeshFile().
LIMBER_EXPORT(readMeshBytes) bool exported_read_mesh_bytes(std::size_t bytes, std::size_t name_size) {
  return guarded([&] {
    const std::string name(reinterpret_cast<const char*>(input()) + bytes, name_size);
    last_file = read_mesh_bytes({input(), bytes}, name).value();
    give_mesh(last_file->mesh);
    exchange.words[4] = address_of(last_file->face_of_triangle.data());
    exchange.words[5] = static_cast<std::uint32_t>(last_file->face_count);
  });
}

LIMBER_EXPORT(forgetMeshFile) void forget_mesh_file() { last_file.reset(); }

}  // namespace limber::web
