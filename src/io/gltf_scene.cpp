// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_scene.h"

#include <cmath>
#include <string>
#include <utility>

namespace limber::io {
namespace {

AffineMap operator*(const AffineMap& a_from_b, const AffineMap& b_from_c) {
  return {a_from_b.linear * b_from_c.linear, a_from_b(b_from_c.translation)};
}

/// A rotation by a quaternion x, y, z, w of any length but zero.
Mat3 rotation(const std::array<double, 4>& q, const JsonItem& node) {
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(norm > 0) || !std::isfinite(norm)) node.refuse("its rotation is not a quaternion of finite length above 0");
  const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

AffineMap parent_from_node(const JsonItem& node) {
  if (const auto m = node.numbers<16>("matrix")) {  // by columns
    if (node.has("translation") || node.has("rotation") || node.has("scale")) {
      node.refuse("has both a matrix and a translation, rotation or scale");
    }
    const auto& n = *m;
    if (n[3] != 0 || n[7] != 0 || n[11] != 0 || n[15] != 1) node.refuse("the last row of its matrix is not 0 0 0 1");
    return {{{n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]}}, {n[12], n[13], n[14]}};
  }
  const auto t = node.numbers<3>("translation").value_or(std::array<double, 3>{0, 0, 0});
  const auto q = node.numbers<4>("rotation").value_or(std::array<double, 4>{0, 0, 0, 1});
  const auto s = node.numbers<3>("scale").value_or(std::array<double, 3>{1, 1, 1});
  const Mat3 turn = rotation(q, node);
  const auto scaled = [&](const Vec3& row) { return Vec3{row.x * s[0], row.y * s[1], row.z * s[2]}; };
  return {{scaled(turn.row0), scaled(turn.row1), scaled(turn.row2)}, {t[0], t[1], t[2]}};
}

/// The nodes of a file and their parents.
class Nodes {
 public:
  explicit Nodes(const JsonItem& description)
      : description_(description), parents_(description.list("nodes").size(), none) {
    for (std::size_t n = 0; n < parents_.size(); ++n) {
      for (const std::size_t child : indices(node(n, description), "children")) {
        if (parents_[child] != none) {
          node(child, description)
              .refuse("is a child of node " + std::to_string(parents_[child]) + " and again of node " +
                      std::to_string(n) + ", but nodes must form trees");
        }
        parents_[child] = n;
      }
    }
  }

  JsonItem node(std::uint64_t index, const JsonItem& user) const {
    return description_.item("nodes", index, "node", user);
  }

  /// A property that lists nodes.
  std::vector<std::size_t> indices(const JsonItem& user, const char* key) const {
    std::vector<std::size_t> found;
    for (const Json& entry : user.list(key)) {
      const std::uint64_t index = whole_entry(entry, user, key);
      node(index, user);  // refuses what does not exist
      found.push_back(static_cast<std::size_t>(index));
    }
    return found;
  }

  /// The roots of a scene.
  std::vector<std::size_t> roots(const JsonItem& scene) const {
    std::vector<std::size_t> found = indices(scene, "nodes");
    std::vector<bool> is_listed(parents_.size());
    for (const std::size_t root : found) {
      if (parents_[root] != none) {
        scene.refuse("lists node " + std::to_string(root) + ", a child of node " + std::to_string(parents_[root]));
      }
      if (is_listed[root]) scene.refuse("lists node " + std::to_string(root) + " twice");
      is_listed[root] = true;
    }
    return found;
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  const JsonItem& description_;
  std::vector<std::size_t> parents_;
};

}  // namespace

std::vector<MeshInstance> mesh_instances(const JsonItem& description) {
  if (description.list("scenes").empty()) description.refuse("has no scene", ErrorCode::empty_mesh);
  const JsonItem scene = description.item("scenes", description.whole("scene", 0), "scene", description);
  const Nodes nodes(description);

  // One parent each and roots without any: the walk below meets every node at most once, so it ends.
  struct Visit {
    std::size_t node;
    AffineMap world_from_parent;
  };
  std::vector<Visit> open;
  const auto push = [&](const std::vector<std::size_t>& found, const AffineMap& world_from_parent) {
    for (std::size_t i = found.size(); i-- > 0;) open.push_back({found[i], world_from_parent});
  };
  std::vector<MeshInstance> instances;
  push(nodes.roots(scene), {});
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const JsonItem node = nodes.node(visit.node, scene);
    const AffineMap world_from_node = visit.world_from_parent * parent_from_node(node);
    if (node.has("mesh")) instances.push_back({node.whole("mesh"), world_from_node, node});
    push(nodes.indices(node, "children"), world_from_node);
  }
  return instances;
}

}  // namespace limber::io
