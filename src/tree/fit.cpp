// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Slab cut balls [LarssonAkenineMoller2009]: a ball cut by the slab that its content keeps to.
// Differs   A box shares the centre. The two lowest levels are fitted to corners, the levels above to the bounds below.
//           Everything is computed in float64 about a local origin and rounded outward once, on storing.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"
#include "core/rounding.h"
#include "tree/node.h"

namespace limber::tree {
namespace {

/// The bounds of a node, up to float64 rounding of lengths as large as its box. Positions are in the model frame,
/// lengths in units.
struct Bound {
  Vec3 low, high;  // corners of the box
  Vec3 center;     // its middle
  double radius = 0;
  Vec3 normal;  // of the slab; entries are float32 numbers
  double slab_low = 0, slab_high = 0;
  Vec3 area;  // sum of the normals' vectors, each turned to one side, twice the triangles' areas long

  Vec3 half(double per_unit) const { return max(high - center, center - low) * per_unit; }
};

/// Covers the float64 rounding of everything below; lengths are relative to local origins, so 2^-40 is plenty.
constexpr double outward = 1 + 0x1p-40;

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 to_24_bits(const Vec3& v) { return {core::to_24_bits(v.x), core::to_24_bits(v.y), core::to_24_bits(v.z)}; }

/// The mean normal, or the direction in which the box is thinnest where there is none.
Vec3 slab_normal(const Bound& bound) {
  const double size = length(bound.area);
  if (size > 0x1p-100) return to_24_bits(bound.area * (1 / size));
  const Vec3 side = bound.high - bound.low;
  if (side.x <= side.y && side.x <= side.z) return {1, 0, 0};
  return side.y <= side.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

void add_area(Vec3& sum, const Vec3& area) { sum += dot(sum, area) < 0 ? -area : area; }

/// Box, centre and mean normal of a range of leaves' triangles.
class Contents {
 public:
  Contents(const Leaf* leaves, std::uint32_t count, MeshView mesh, double per_unit)
      : leaves_(leaves), count_(count), mesh_(mesh), per_unit_(per_unit) {}

  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (const Leaf* leaf = leaves_; leaf != leaves_ + count_; ++leaf) {
      for (const TriangleId t : leaf->triangle) visit(mesh_.triangle(t));
    }
  }

  Bound bound() const {
    Bound b;
    b.low = b.high = mesh_.triangle(leaves_->triangle[0]).v0;
    for_each([&](const Triangle& t) {
      b.low = min(b.low, min(min(t.v0, t.v1), t.v2));
      b.high = max(b.high, max(max(t.v0, t.v1), t.v2));
      add_area(b.area, cross((t.v1 - t.v0) * per_unit_, (t.v2 - t.v0) * per_unit_));
    });
    b.center = b.low * 0.5 + b.high * 0.5;
    b.normal = slab_normal(b);
    b.slab_low = infinity, b.slab_high = -infinity;
    for_each([&](const Triangle& t) {
      for (const Vec3& v : {t.v0, t.v1, t.v2}) {
        const Vec3 d = (v - b.center) * per_unit_;
        const double h = dot(b.normal, d);
        b.radius = std::max(b.radius, length(d));
        b.slab_low = std::min(b.slab_low, h), b.slab_high = std::max(b.slab_high, h);
      }
    });
    return b;
  }

 private:
  const Leaf* leaves_;
  std::uint32_t count_;
  MeshView mesh_;
  double per_unit_;
};

/// How far a bound reaches from its centre in direction `u`, of length about 1.
double reach(const Bound& b, const Vec3& u, double per_unit) {
  const double cosine = dot(b.normal, u);
  const double height = cosine >= 0 ? b.slab_high : -b.slab_low, c = std::abs(cosine);
  double ball = b.radius;
  if (b.radius * c > height) {
    const double sine = length(cross(b.normal, u)), rim_sq = b.radius * b.radius - height * height;
    ball = height * c + sine * std::sqrt(std::max(0.0, rim_sq));
  }
  // Normals stored as float32 are off by 2^-23 of their length.
  return std::min(ball * (1 + 0x1p-20), dot(abs(u), b.half(per_unit)) * outward);
}

/// The bound around bounds.
Bound enclose(const Bound* children, std::uint32_t count, double per_unit) {
  Bound b = children[0];
  b.area = {};
  for (const Bound* child = children; child != children + count; ++child) {
    b.low = min(b.low, child->low), b.high = max(b.high, child->high);
    add_area(b.area, child->area);
  }
  b.center = b.low * 0.5 + b.high * 0.5;
  b.normal = slab_normal(b);
  b.radius = 0, b.slab_low = infinity, b.slab_high = -infinity;
  for (const Bound* child = children; child != children + count; ++child) {
    const Vec3 d = (child->center - b.center) * per_unit;
    const double h = dot(b.normal, d);
    b.radius = std::max(b.radius, length(d) + child->radius);
    b.slab_low = std::min(b.slab_low, h - reach(*child, -b.normal, per_unit));
    b.slab_high = std::max(b.slab_high, h + reach(*child, b.normal, per_unit));
  }
  b.radius = std::min(b.radius, length(b.half(per_unit)) * outward);
  return b;
}

/// Stores a bound in a lane, rounded outward.
void store(Block& block, std::uint32_t lane, const Bound& b, double per_unit) {
  const Vec3 offset = (b.center - block.origin) * per_unit;
  const Vec3 stored = to_24_bits(offset);
  const double shift = length(offset - stored) * outward;  // the stored centre is that far from the bound's
  const auto grown = [&](double x) { return core::float_up(x + shift + std::abs(x) * (outward - 1)); };
  simd::NodeBounds& n = block.bounds;
  n.center_x[lane] = static_cast<float>(stored.x);
  n.center_y[lane] = static_cast<float>(stored.y);
  n.center_z[lane] = static_cast<float>(stored.z);
  n.radius[lane] = grown(b.radius);
  const Vec3 half = b.half(per_unit);
  n.half_x[lane] = grown(half.x), n.half_y[lane] = grown(half.y), n.half_z[lane] = grown(half.z);
  n.normal_x[lane] = static_cast<float>(b.normal.x);
  n.normal_y[lane] = static_cast<float>(b.normal.y);
  n.normal_z[lane] = static_cast<float>(b.normal.z);
  // The slab's heights are rounded relative to the ball, not to themselves.
  const double doubt = b.radius * 0x1p-40;
  n.low[lane] = -grown(doubt - b.slab_low), n.high[lane] = grown(doubt + b.slab_high);
}

void set_origin(Block& block, const Bound* lanes, double per_unit) {
  Vec3 low = lanes[0].low, high = lanes[0].high;
  for (std::uint32_t k = 1; k < block.count; ++k) low = min(low, lanes[k].low), high = max(high, lanes[k].high);
  block.origin = low * 0.5 + high * 0.5;
  double reach = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    store(block, k, lanes[k], per_unit);
    reach = std::max(reach, length(local_center(block, k)) + static_cast<double>(block.bounds.radius[k]));
  }
  block.reach = core::float_up(reach * outward);
}

void quantise(const Block& block, std::uint32_t lane, Leaf& leaf, MeshView mesh, double per_unit) {
  const Vec3 center = local_center(block, lane);
  const double radius = static_cast<double>(block.bounds.radius[lane]);
  const double scale = radius > 0 ? static_cast<double>(simd::quantum) / radius : 0;
  for (std::uint32_t k = 0; k < width; ++k) {
    const Triangle t = mesh.triangle(leaf.triangle[k]);
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const Vec3 d = ((t[corner] - block.origin) * per_unit - center) * scale;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        leaf.corners.corner[3 * corner + axis][k] = static_cast<std::int16_t>(std::lrint(d[axis]));
      }
    }
  }
}

/// Fits the lanes of a block on the lowest level and their leaves; returns the bound of the block.
Bound fit_lowest(Tree& tree, Block& block, MeshView mesh) {
  Leaf* const leaves = tree.leaves.data() + block.first_child;
  const double per_unit = 1 / tree.unit;
  Bound lanes[width];
  for (std::uint32_t k = 0; k < block.count; ++k) lanes[k] = Contents(leaves + k, 1, mesh, per_unit).bound();
  set_origin(block, lanes, per_unit);
  for (std::uint32_t k = 0; k < block.count; ++k) quantise(block, k, leaves[k], mesh, per_unit);
  return Contents(leaves, block.count, mesh, per_unit).bound();
}

}  // namespace

void fit(Tree& tree, MeshView mesh) {
  static std::atomic<std::uint64_t> last_id{0};
  tree.id = ++last_id;
  LIMBER_ASSERT(tree.level_begin.size() >= 2);
  const std::size_t lowest = tree.level_begin.size() - 2;
  std::vector<Bound> bounds(tree.blocks.size());
  for (std::size_t level = lowest + 1; level-- > 0;) {
    const std::uint32_t begin = tree.level_begin[level], end = tree.level_begin[level + 1];
    core::parallel_for(end - begin, 64, [&](std::size_t i) {
      Block& block = tree.blocks[begin + i];
      if (level == lowest) {
        bounds[begin + i] = fit_lowest(tree, block, mesh);
      } else {
        const Bound* const children = bounds.data() + block.first_child;
        set_origin(block, children, 1 / tree.unit);
        bounds[begin + i] = enclose(children, block.count, 1 / tree.unit);
      }
    });
  }
  LIMBER_ASSERT(std::isfinite(bounds[0].radius));
}

}  // namespace limber::tree
