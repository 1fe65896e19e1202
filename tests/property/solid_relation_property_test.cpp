// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Relations of solids against references that know nothing of surfaces: cells of a lattice, mapped to parallelepipeds,
// and convex bodies between lattice points, which exact separating axes compare.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "limber/solids.h"
#include "simd/kernels.h"
#include "support/random_solids.h"
#include "unit/exhaustive_relation.h"

namespace limber::testing {
namespace {

// --- closed surfaces whose relation is known without geometry: they consist of cells of a lattice ---

constexpr int lattice_side = 6;

/// How often a surface winds around each cell of a lattice.
using CellWindings = std::array<int, lattice_side * lattice_side * lattice_side>;

std::size_t cell_index(int x, int y, int z) {
  return static_cast<std::size_t>((z * lattice_side + y) * lattice_side + x);
}

/// An axis-aligned box of cells; with a minus sign, its surface is turned inside out.
struct CellBox {
  std::array<int, 3> low, high;
  int sign;
};

struct CellSolid {
  CellWindings windings{};
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  /// Rectangles of the surface: an axis, a place on it, and a range of the two next axes.
  struct Rectangle {
    std::array<int, 3> low, high;
  };
  std::vector<Rectangle> rectangles;
};

/// Adds a rectangle of n x m squares as triangles, with diagonals drawn at random.
void add_rectangle(Rng& rng, CellSolid& solid, std::size_t axis, int at, const std::array<int, 3>& low,
                   const std::array<int, 3>& high, bool is_upward, int step,
                   std::map<std::array<int, 3>, VertexId>& ids) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto id = [&](int u, int v) {
    std::array<int, 3> p{};
    p[axis] = at, p[i] = u, p[j] = v;
    const auto [found, is_new] = ids.try_emplace(p, static_cast<VertexId>(solid.positions.size()));
    if (is_new) {
      solid.positions.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return found->second;
  };
  const auto next = [&](int x, int end) { return step == 0 ? end : std::min(x + step, end); };
  for (int u = low[i]; u < high[i]; u = next(u, high[i])) {
    for (int v = low[j]; v < high[j]; v = next(v, high[j])) {
      const int u1 = next(u, high[i]), v1 = next(v, high[j]);
      std::array<VertexId, 4> c{id(u, v), id(u1, v), id(u1, v1), id(u, v1)};
      if (!is_upward) std::swap(c[1], c[3]);
      if (rng.below(2) == 0) std::rotate(c.begin(), c.begin() + 1, c.end());
      solid.triangles.push_back({c[0], c[1], c[2]});
      solid.triangles.push_back({c[2], c[3], c[0]});
    }
  }
  CellSolid::Rectangle r{low, high};
  r.low[axis] = r.high[axis] = at;
  solid.rectangles.push_back(r);
}

void add_box(Rng& rng, CellSolid& solid, const CellBox& box, int step) {
  std::map<std::array<int, 3>, VertexId> ids;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add_rectangle(rng, solid, axis, box.low[axis], box.low, box.high, box.sign < 0, step, ids);
    add_rectangle(rng, solid, axis, box.high[axis], box.low, box.high, box.sign > 0, step, ids);
  }
  for (int z = box.low[2]; z < box.high[2]; ++z) {
    for (int y = box.low[1]; y < box.high[1]; ++y) {
      for (int x = box.low[0]; x < box.high[0]; ++x) solid.windings[cell_index(x, y, z)] += box.sign;
    }
  }
}

CellBox random_box(Rng& rng, int side = lattice_side) {
  CellBox box{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = static_cast<int>(rng.below(static_cast<std::uint64_t>(side) + 1));
    auto b = static_cast<int>(rng.below(static_cast<std::uint64_t>(side)));
    if (b >= a) ++b;
    box.low[k] = std::min(a, b), box.high[k] = std::max(a, b);
  }
  box.sign = rng.below(4) == 0 ? -1 : 1;
  return box;
}

/// Adds a rectangle that winds around nothing: two triangles, each with its back, which has the same vertices.
void add_sheet(Rng& rng, CellSolid& solid, int side) {
  const std::size_t axis = rng.below(3), i = (axis + 1) % 3, j = (axis + 2) % 3;
  const CellBox box = random_box(rng, side);
  CellSolid::Rectangle r{box.low, box.high};
  r.high[axis] = r.low[axis];
  const auto corner = [&](bool is_high_i, bool is_high_j) {
    Vec3 p;
    p[axis] = r.low[axis], p[i] = (is_high_i ? r.high : r.low)[i], p[j] = (is_high_j ? r.high : r.low)[j];
    return p;
  };
  for (const bool is_second : {false, true}) {
    const auto first = static_cast<VertexId>(solid.positions.size());
    for (const Vec3& p : {corner(false, false), corner(!is_second, is_second), corner(true, true)}) {
      solid.positions.push_back(p);
    }
    solid.triangles.push_back({first, first + 1, first + 2}), solid.triangles.push_back({first, first + 2, first + 1});
  }
  solid.rectangles.push_back(r);
}

/// Some boxes, each a component, and sheets: they overlap, touch and cancel as they come.
CellSolid boxes_of_cells(Rng& rng, std::size_t most) {
  CellSolid solid;
  const std::uint64_t count = 1 + rng.below(most);
  const int side = 2 + static_cast<int>(rng.below(lattice_side - 1));
  const int step = rng.below(3) == 0 ? 1 + static_cast<int>(rng.below(2)) : 0;
  for (std::uint64_t i = 0; i < count; ++i) add_box(rng, solid, random_box(rng, side), step);
  for (std::uint64_t i = rng.below(3); i > 0; --i) add_sheet(rng, solid, side);
  return solid;
}

/// The boundary of some cells, whose triangles share vertices where they share an edge of one cell. Cells that touch in
/// an edge alone do not share it.
class CellBoundary {
 public:
  explicit CellBoundary(const CellWindings& cells) : cells_(cells) {}

  CellSolid surface(Rng& rng) {
    for (int z = 0; z < lattice_side; ++z) {
      for (int y = 0; y < lattice_side; ++y) {
        for (int x = 0; x < lattice_side; ++x) add_squares({x, y, z});
      }
    }
    parent_.resize(4 * squares_.size());
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    for (const auto& [edge, uses] : edges_) join(uses);
    return triangulated(rng);
  }

 private:
  using Place = std::array<int, 3>;
  struct Square {
    std::array<Place, 4> corners;
    Place cell;
  };
  struct Use {
    std::size_t square, corner;  // the edge from it to the next one
  };

  bool is_full(const Place& p) const {
    for (const int x : p) {
      if (x < 0 || x >= lattice_side) return false;
    }
    return cells_[cell_index(p[0], p[1], p[2])] != 0;
  }
  void add_squares(const Place& cell) {
    if (!is_full(cell)) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int up : {0, 1}) {
        Place beside = cell, at = cell;
        beside[axis] += up == 1 ? 1 : -1, at[axis] += up;
        if (is_full(beside)) continue;
        Square square{{at, at, at, at}, cell};
        const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
        ++square.corners[1][i], ++square.corners[2][i], ++square.corners[2][j], ++square.corners[3][j];
        if (up == 0) std::swap(square.corners[1], square.corners[3]);
        for (std::size_t k = 0; k < 4; ++k) {
          edges_[std::minmax(square.corners[k], square.corners[(k + 1) % 4])].push_back({squares_.size(), k});
        }
        squares_.push_back(square);
      }
    }
  }
  std::size_t find(std::size_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  /// Neighbors run through their edge in opposite directions.
  void join(const Use& p, const Use& q) {
    parent_[find(4 * p.square + p.corner)] = find(4 * q.square + (q.corner + 1) % 4);
    parent_[find(4 * p.square + (p.corner + 1) % 4)] = find(4 * q.square + q.corner);
  }
  void join(const std::vector<Use>& uses) {
    for (std::size_t i = 0; i < uses.size(); ++i) {
      for (std::size_t k = i + 1; k < uses.size(); ++k) {
        if (uses.size() == 2 || squares_[uses[i].square].cell == squares_[uses[k].square].cell) join(uses[i], uses[k]);
      }
    }
  }
  CellSolid triangulated(Rng& rng) const {
    CellSolid solid;
    solid.windings = cells_;
    std::map<std::size_t, VertexId> ids;
    for (std::size_t s = 0; s < squares_.size(); ++s) {
      std::array<VertexId, 4> c{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [found, is_new] = ids.try_emplace(find(4 * s + k), static_cast<VertexId>(solid.positions.size()));
        const Place& p = squares_[s].corners[k];
        if (is_new) {
          solid.positions.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
        }
        c[k] = found->second;
      }
      if (rng.below(2) == 0) std::rotate(c.begin(), c.begin() + 1, c.end());
      solid.triangles.push_back({c[0], c[1], c[2]});
      solid.triangles.push_back({c[2], c[3], c[0]});
      CellSolid::Rectangle r{squares_[s].corners[0], squares_[s].corners[0]};
      for (const Place& p : squares_[s].corners) {
        for (std::size_t k = 0; k < 3; ++k) r.low[k] = std::min(r.low[k], p[k]), r.high[k] = std::max(r.high[k], p[k]);
      }
      solid.rectangles.push_back(r);
    }
    return solid;
  }

  CellWindings cells_;
  std::vector<Square> squares_;
  std::map<std::pair<Place, Place>, std::vector<Use>> edges_;
  std::vector<std::size_t> parent_;
};

/// Cells drawn at random out of a few boxes, and their boundary.
CellSolid random_cells(Rng& rng) {
  CellWindings cells{};
  const int side = 2 + static_cast<int>(rng.below(2));
  const auto at = [&] { return static_cast<int>(rng.below(static_cast<std::uint64_t>(side))); };
  const std::uint64_t full = 1 + rng.below(4);  // of four
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) cells[cell_index(x, y, z)] = rng.below(4) < full ? 1 : 0;
    }
  }
  cells[cell_index(at(), at(), at())] = 1;
  return CellBoundary(cells).surface(rng);
}

/// What is known of two solids of cells.
SolidRelation relation_of_cells(const CellSolid& a, const CellSolid& b, bool& surfaces_meet) {
  bool both = false, a_alone = false, b_alone = false;
  for (std::size_t i = 0; i < a.windings.size(); ++i) {
    const bool in_a = a.windings[i] != 0, in_b = b.windings[i] != 0;
    both = both || (in_a && in_b), a_alone = a_alone || (in_a && !in_b), b_alone = b_alone || (in_b && !in_a);
  }
  surfaces_meet = false;
  for (const auto& r : a.rectangles) {
    for (const auto& s : b.rectangles) {
      bool meet = true;
      for (std::size_t k = 0; k < 3; ++k) meet = meet && r.low[k] <= s.high[k] && s.low[k] <= r.high[k];
      surfaces_meet = surfaces_meet || meet;
    }
  }
  if (!both) return surfaces_meet ? SolidRelation::touching : SolidRelation::apart;
  if (a_alone) return b_alone ? SolidRelation::overlapping : SolidRelation::b_inside_a;
  return b_alone ? SolidRelation::a_inside_b : SolidRelation::equal;
}

// --- comparisons ---

const char* name_of(SolidRelation r) {
  constexpr const char* names[] = {"apart", "touching", "overlapping", "a inside b", "b inside a", "equal"};
  return names[static_cast<std::size_t>(r)];
}

/// Counts how often each relation has come, so that a test shows that it has seen all.
class RelationCounts {
 public:
  void add(SolidRelation r) { ++counts_[static_cast<std::size_t>(r)]; }
  std::uint64_t least() const { return *std::min_element(counts_.begin(), counts_.end()); }

 private:
  std::array<std::uint64_t, 6> counts_{};
};

/// Asks in both orders, with either surface turned inside out now and then, on another instruction set each time.
void expect_relation(Rng& rng, const Mesh& a, const Transform& pose_a, const Mesh& b, const Transform& pose_b,
                     SolidRelation expected, bool surfaces_meet, const std::string& what) {
  const auto turned = [&](const Mesh& mesh) { return rng.below(2) == 0 ? turned_inside_out(mesh) : mesh; };
  const auto sets = simd::all_kernels();
  simd::use_kernels(&sets[rng.below(sets.size())]);
  const Model model_a(turned(a)), model_b(turned(b));
  const ClosedSurface surface_a = ClosedSurface::create(model_a).value();
  const ClosedSurface surface_b = ClosedSurface::create(model_b).value();
  const SolidRelationResult found = solid_relation({surface_a, pose_a}, {surface_b, pose_b});
  const SolidRelationResult back = solid_relation({surface_b, pose_b}, {surface_a, pose_a});
  const SolidRelation by_shells = relation_by_shells({model_a, pose_a}, {model_b, pose_b});
  simd::use_kernels(nullptr);
  ASSERT_EQ(name_of(by_shells), std::string(name_of(expected))) << what << ", by shells";
  ASSERT_EQ(name_of(found.relation), std::string(name_of(expected))) << what;
  ASSERT_EQ(name_of(reversed(back.relation)), std::string(name_of(expected))) << what << ", reversed";
  ASSERT_EQ(found.witness.has_value(), surfaces_meet) << what;
  ASSERT_EQ(back.witness.has_value(), surfaces_meet) << what << ", reversed";
}

/// An invertible matrix of small integers; now and then the identity, or a turn.
Mat3 small_matrix(Rng& rng) {
  if (rng.below(3) == 0) return {};
  for (;;) {
    const auto entry = [&] { return static_cast<double>(rng.below(5)) - 2; };
    Vec3 rows[3];
    for (Vec3& row : rows) row.x = entry(), row.y = entry(), row.z = entry();
    const double volume = dot(rows[0], cross(rows[1], rows[2]));
    // Orientation does not matter.
    if (volume != 0) return {rows[0], rows[1], rows[2]};
  }
}

/// A turn by right angles, and an offset that is exact.
Transform exact_pose(Rng& rng) {
  const Mat3 turns[3] = {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {}};
  const Vec3 offset = lattice_point(rng, 9) - Vec3{4, 4, 4};
  return {turns[rng.below(3)], rng.below(4) == 0 ? 0x1p20 * offset : 0.5 * offset};
}

/// Two solids of cells in one lattice, which are mapped and placed alike.
void check_cells(Rng& rng, const CellSolid& a, const CellSolid& b, RelationCounts& counts, const std::string& what) {
  bool surfaces_meet = false;
  const SolidRelation expected = relation_of_cells(a, b, surfaces_meet);
  const Mat3 map = small_matrix(rng);
  const double scale = rng.below(4) == 0 ? std::ldexp(1, static_cast<int>(rng.below(200)) - 100) : 1;
  Transform pose = rng.below(2) == 0 ? exact_pose(rng) : Transform{};
  pose.translation *= scale;
  const auto mesh_of = [&](const CellSolid& solid) {
    std::vector<Vec3> positions = solid.positions;
    for (Vec3& p : positions) p = scale * (map * p);
    return Mesh::create(std::move(positions), solid.triangles).value();
  };
  counts.add(expected);
  expect_relation(rng, mesh_of(a), pose, mesh_of(b), pose, expected, surfaces_meet, what);
}

bool is_closed_surface(const CellSolid& solid) {
  const Model model(Mesh::create(solid.positions, solid.triangles).value());
  return static_cast<bool>(ClosedSurface::create(model));
}

TEST(SolidRelationProperty, OfBoxesThatMeetThemselvesIsThatOfTheirCells) {
  Rng rng(2601);
  RelationCounts counts;
  const std::uint64_t pairs = count_from("LIMBER_SOLID_PAIRS", 1000);
  for (std::uint64_t i = 0; i < pairs && !HasFatalFailure(); ++i) {
    const std::size_t most = 1 + rng.below(4);
    const CellSolid a = boxes_of_cells(rng, most);
    CellSolid b = boxes_of_cells(rng, most);
    if (rng.below(20) == 0) b = a;
    check_cells(rng, a, b, counts, "pair " + std::to_string(i));
  }
  EXPECT_GT(counts.least(), 0U);
}

TEST(SolidRelationProperty, OfBoundariesOfCellsIsThatOfTheirCells) {
  Rng rng(2602);
  RelationCounts counts;
  std::uint64_t refused = 0;
  const std::uint64_t pairs = count_from("LIMBER_SOLID_PAIRS", 1000);
  for (std::uint64_t i = 0; i < pairs && !HasFatalFailure();) {
    const CellSolid a = random_cells(rng);
    CellWindings other{};
    CellSolid b = random_cells(rng);
    const std::uint64_t kind = rng.below(5), change = rng.below(2) == 0 ? 16 : 1000;
    if (kind == 4) {  // one cell anywhere
      other[rng.below(other.size())] = 1;
      b = CellBoundary(other).surface(rng);
    }
    if (kind < 2) {  // the same cells, or all others, but for some of them
      for (std::size_t k = 0; k < other.size(); ++k) {
        const bool is_in_a = a.windings[k] != 0;
        other[k] = (rng.below(change) == 0 ? rng.below(2) == 0 : kind == 0 ? is_in_a : !is_in_a) ? 1 : 0;
      }
      b = CellBoundary(other).surface(rng);
    }
    // A few share edges between more than two triangles.
    if (b.triangles.empty() || !is_closed_surface(a) || !is_closed_surface(b)) {
      ASSERT_LT(++refused, 10 * pairs + 100);
      continue;
    }
    check_cells(rng, a, b, counts, "pair " + std::to_string(i));
    ++i;
  }
  EXPECT_GT(counts.least(), 0U);
}

// --- convex bodies ---

using Place = std::array<std::int64_t, 3>;

Place operator-(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
std::int64_t inner(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Place across(const Place& a, const Place& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The convex hull of some lattice points, with triangles that see their back from inside.
struct ConvexBody {
  std::vector<Place> corners;
  std::vector<std::array<std::size_t, 3>> faces;

  Place normal(const std::array<std::size_t, 3>& f) const {
    return across(corners[f[1]] - corners[f[0]], corners[f[2]] - corners[f[0]]);
  }
  /// On which side of a face a point is: above 0 outside.
  std::int64_t height(const std::array<std::size_t, 3>& f, const Place& p) const {
    return inner(normal(f), p - corners[f[0]]);
  }
  bool contains(const Place& p) const {
    return std::all_of(faces.begin(), faces.end(), [&](const auto& f) { return height(f, p) <= 0; });
  }
  Mesh mesh() const {
    std::vector<Vec3> positions;
    for (const Place& p : corners) {
      positions.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    std::vector<Corners> triangles;
    for (const auto& f : faces) {
      triangles.push_back({static_cast<VertexId>(f[0]), static_cast<VertexId>(f[1]), static_cast<VertexId>(f[2])});
    }
    return Mesh::create(std::move(positions), std::move(triangles)).value();
  }
};

/// A tetrahedron to which points outside are added one by one: faces that see a point give way to its cone. Points in
/// the plane of a face are outside of it if they are outside of the body.
std::optional<ConvexBody> convex_body(Rng& rng, int side, int points) {
  const auto place = [&] {
    const Vec3 p = lattice_point(rng, static_cast<std::uint64_t>(side));
    return Place{static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
  };
  ConvexBody body;
  for (int i = 0; i < 4; ++i) body.corners.push_back(place());
  body.faces = {{0, 1, 2}};
  const std::int64_t height = body.height(body.faces[0], body.corners[3]);
  if (height == 0) return std::nullopt;
  if (height > 0) std::swap(body.corners[0], body.corners[1]);
  body.faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  for (int i = 0; i < points; ++i) {
    const Place p = place();
    std::vector<std::array<std::size_t, 3>> kept, seen;
    for (const auto& f : body.faces) (body.height(f, p) > 0 ? seen : kept).push_back(f);
    if (seen.empty()) continue;
    const auto has_edge = [&](std::size_t from, std::size_t to) {
      return std::any_of(seen.begin(), seen.end(), [&](const auto& f) {
        return (f[0] == from && f[1] == to) || (f[1] == from && f[2] == to) || (f[2] == from && f[0] == to);
      });
    };
    body.corners.push_back(p);
    bool is_flat = false;
    for (const auto& f : seen) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (has_edge(f[(k + 1) % 3], f[k])) continue;
        kept.push_back({f[k], f[(k + 1) % 3], body.corners.size() - 1});
        is_flat = is_flat || body.normal(kept.back()) == Place{};
      }
    }
    if (is_flat) {  // the point is on the line of an edge
      body.corners.pop_back();
      continue;
    }
    body.faces = kept;
  }
  return body;
}

/// Whether the interiors of two convex bodies have a point in common: no separating axis [exact].
bool interiors_meet(const ConvexBody& a, const ConvexBody& b) {
  const auto is_separating = [&](const Place& axis) {
    if (axis == Place{}) return false;
    const auto range = [&](const ConvexBody& body) {
      std::int64_t low = inner(axis, body.corners[0]), high = low;
      for (const auto& f : body.faces) {
        for (const std::size_t c : f) {
          low = std::min(low, inner(axis, body.corners[c])), high = std::max(high, inner(axis, body.corners[c]));
        }
      }
      return std::pair{low, high};
    };
    const auto ra = range(a), rb = range(b);
    return ra.second <= rb.first || rb.second <= ra.first;
  };
  for (const auto& f : a.faces) {
    if (is_separating(a.normal(f))) return false;
  }
  for (const auto& f : b.faces) {
    if (is_separating(b.normal(f))) return false;
  }
  for (const auto& f : a.faces) {
    for (const auto& g : b.faces) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Place u = a.corners[f[(i + 1) % 3]] - a.corners[f[i]], v = b.corners[g[(k + 1) % 3]] - b.corners[g[k]];
          if (is_separating(across(u, v))) return false;
        }
      }
    }
  }
  return true;
}

bool reaches_out_of(const ConvexBody& a, const ConvexBody& b) {
  return std::any_of(a.faces.begin(), a.faces.end(), [&](const auto& f) {
    return !b.contains(a.corners[f[0]]) || !b.contains(a.corners[f[1]]) || !b.contains(a.corners[f[2]]);
  });
}

bool do_surfaces_meet(const Mesh& a, const Mesh& b) {
  for (TriangleId i = 0; i < a.triangles().size(); ++i) {
    for (TriangleId k = 0; k < b.triangles().size(); ++k) {
      if (intersects(a.triangle(i), b.triangle(k))) return true;
    }
  }
  return false;
}

TEST(SolidRelationProperty, OfConvexBodiesIsThatOfSeparatingAxes) {
  Rng rng(2603);
  RelationCounts counts;
  const std::uint64_t pairs = count_from("LIMBER_SOLID_PAIRS", 1000);
  for (std::uint64_t i = 0; i < pairs && !HasFatalFailure();) {
    const int side = 2 + static_cast<int>(rng.below(5));
    auto a = convex_body(rng, side, static_cast<int>(rng.below(8)));
    auto b = convex_body(rng, side, static_cast<int>(rng.below(8)));
    if (!a || !b) continue;
    if (rng.below(20) == 0) b = a;
    if (rng.below(3) == 0) {  // smaller ones inside of larger ones
      for (Place& p : a->corners) {
        for (std::int64_t& x : p) x = 3 * x - side;
      }
    }
    if (rng.below(2) == 0) {
      const Vec3 offset = lattice_point(rng, static_cast<std::uint64_t>(2 * side));
      for (Place& p : b->corners) {
        for (std::size_t k = 0; k < 3; ++k) p[k] += static_cast<std::int64_t>(offset[k]) - side;
      }
    }
    const bool both = interiors_meet(*a, *b), a_out = reaches_out_of(*a, *b), b_out = reaches_out_of(*b, *a);
    const Mesh mesh_a = a->mesh(), mesh_b = b->mesh();
    const bool surfaces_meet = do_surfaces_meet(mesh_a, mesh_b);
    SolidRelation expected = surfaces_meet ? SolidRelation::touching : SolidRelation::apart;
    if (both) {
      expected = a_out ? (b_out ? SolidRelation::overlapping : SolidRelation::b_inside_a)
                       : (b_out ? SolidRelation::a_inside_b : SolidRelation::equal);
    }
    counts.add(expected);
    const Transform pose = exact_pose(rng);
    expect_relation(rng, mesh_a, pose, mesh_b, pose, expected, surfaces_meet, "pair " + std::to_string(i));
    ++i;
  }
  EXPECT_GT(counts.least(), 0U);
}

}  // namespace
}  // namespace limber::testing
