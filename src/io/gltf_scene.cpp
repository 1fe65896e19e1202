// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_scene.h"

#include <cmath>
#include <string>
#include <utility>

#include "limber/geometry.h"

namespace limber::io {
namespace {

AffineMap parent_from_node(const JsonItem& node) {
  if (!node.has("matrix")) {
    return map_of_parts(node.numbers("translation", 3, {0, 0, 0}), node.numbers("rotation", 4, {0, 0, 0, 1}),
                        node.numbers("scale", 3, {1, 1, 1}), node);
  }
  if (node.has("translation") || node.has("rotation") || node.has("scale")) {
    node.refuse("has both a matrix and a translation, rotation or scale");
  }
  return map_of_matrix(node.numbers("matrix", 16), node);
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

AffineMap operator*(const AffineMap& a_from_b, const AffineMap& b_from_c) {
  return {a_from_b.linear * b_from_c.linear, a_from_b(b_from_c.translation),
          a_from_b.orientation * b_from_c.orientation};
}

AffineMap map_of_matrix(std::span<const double> m, const JsonItem& user) {
  const Mat3 linear = {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}};
  if (!is_finite(linear.row0) || !is_finite(linear.row1) || !is_finite(linear.row2)) {
    user.refuse("has a matrix that is not finite");
  }
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) user.refuse("the last row of its matrix is not 0 0 0 1");
  return {linear, {m[12], m[13], m[14]}, orient3d({}, linear.row0, linear.row1, linear.row2)};
}

AffineMap map_of_parts(std::span<const double> t, std::span<const double> q, std::span<const double> s,
                       const JsonItem& user) {
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(norm > 0) || !std::isfinite(norm)) user.refuse("its rotation is not a quaternion of finite length above 0");
  const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
  int orientation = 1;
  for (const double along_axis : s) orientation *= (along_axis > 0 ? 1 : 0) - (along_axis < 0 ? 1 : 0);
  return {{{s[0] * (1 - 2 * (y * y + z * z)), s[1] * (2 * (x * y - w * z)), s[2] * (2 * (x * z + w * y))},
           {s[0] * (2 * (x * y + w * z)), s[1] * (1 - 2 * (x * x + z * z)), s[2] * (2 * (y * z - w * x))},
           {s[0] * (2 * (x * z - w * y)), s[1] * (2 * (y * z + w * x)), s[2] * (1 - 2 * (x * x + y * y))}},
          {t[0], t[1], t[2]},
          orientation};
}

GltfScene read_scene(const JsonItem& description) {
  if (description.list("scenes").empty()) description.refuse("has no scene", ErrorCode::empty_mesh);
  const JsonItem scene = description.item("scenes", description.whole("scene", 0), "scene", description);
  const Nodes nodes(description);

  // One parent each and roots without any: the walk below meets every node at most once, so it ends.
  struct Visit {
    std::size_t node;
    AffineMap world_from_parent;
    bool is_visible;
  };
  std::vector<Visit> open;
  const auto push = [&](const std::vector<std::size_t>& found, const AffineMap& world_from_parent, bool is_visible) {
    for (std::size_t i = found.size(); i-- > 0;) open.push_back({found[i], world_from_parent, is_visible});
  };
  GltfScene result;
  if (description.has("skins")) result.world_from_node.resize(description.list("nodes").size());
  push(nodes.roots(scene), {}, true);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const JsonItem node = nodes.node(visit.node, scene);
    const AffineMap world_from_node = visit.world_from_parent * parent_from_node(node);
    const std::optional<JsonItem> visibility = node.extension("KHR_node_visibility");
    const bool is_visible = visit.is_visible && (!visibility || visibility->flag("visible", true));
    if (is_visible && node.has("mesh")) result.instances.push_back({node.whole("mesh"), world_from_node, node});
    if (!result.world_from_node.empty()) result.world_from_node[visit.node] = world_from_node;
    push(nodes.indices(node, "children"), world_from_node, is_visible);
  }
  return result;
}

}  // namespace limber::io
