// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "limber/mesh.h"

/// Deterministic meshes, poses and deformations, the same for tests and benchmarks.
///
/// Every number comes from IEEE + - * / sqrt and a seeded generator, so a scene is equal to the bit on every machine.
namespace limber::scenes {

/// splitmix64: tiny, seedable, the same everywhere.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform();                          ///< in [0, 1), 53 bits
  double uniform(double low, double high);   ///< low + (high - low) * uniform()
  std::uint64_t below(std::uint64_t bound);  ///< in [0, bound), bound >= 1

 private:
  std::uint64_t state_;
};

/// Reproducible sine and cosine; within 1e-15 of the true value for arguments of moderate size.
double sine(double x);
double cosine(double x);

/// Uniformly distributed rotation; consumes three numbers.
Mat3 random_rotation(Rng& rng);

/// A flat grid of nx * ny squares in the plane z = 0, two triangles each.
///
/// Vertex j * (nx + 1) + i is at (x0 + i dx, y0 + j dy, 0). Square (i, j) with corners a = (i, j), b = (i+1, j),
/// c = (i+1, j+1), d = (i, j+1) gives (a, b, c), (a, c, d); j is the outer loop.
/// Pre      nx >= 1, ny >= 1.
Mesh grid(std::uint32_t nx, std::uint32_t ny, double x0, double y0, double dx, double dy);

/// A unit ball around the origin: `slices` meridians, `stacks` bands, poles on the z axis.
///
/// Pre      slices >= 3, stacks >= 2.
Mesh ball(std::uint32_t slices, std::uint32_t stacks);

/// A ring around the z axis: a tube of radius `tube` along the unit circle in the plane z = 0, `around` by `across`
/// squares of two triangles each.
///
/// Pre      around >= 3, across >= 3, around * across < 2^32; 0 < tube < 1.
Mesh ring(std::uint32_t around, std::uint32_t across, double tube);

Mesh thesis_square();  ///< 8 x 8 units around the origin, 8192 triangles
Mesh thesis_ball();    ///< diameter 2, 1024 triangles
Mesh thesis_sheet();   ///< 100 x 100 units, 100 x 100 squares, 20 000 triangles

/// Frame `frame` of a sheet that waves: nx * ny squares over [0, 4] x [0, 4 ny / nx],
/// z = 0.1 sin(4 x + 0.37 frame) cos(5 y - 0.7 * 0.37 frame). All frames share their triangles.
Mesh wave_sheet(std::uint32_t nx, std::uint32_t ny, double frame);

/// Triangles without common vertices, everywhere in the cube [-1, 1]^3: around a random place each, the corners
/// anywhere in a cube of edge `size`. A small size gives confetti, a size of 2 a thicket in which everything meets.
///
/// Pre      triangles >= 1; size is finite and >= 0.
Mesh random_soup(Rng& rng, std::uint32_t triangles, double size);

/// Triangles without common vertices, all coordinates integers in [0, side): for a small side everything degenerate
/// happens, points and segments among the triangles, touching, coplanar and identical ones.
///
/// Pre      triangles >= 1; side >= 1.
Mesh lattice_soup(Rng& rng, std::uint32_t triangles, std::uint32_t side);

/// Pose number `index` of the ball over the square: the lowest vertex is `separation` above the plane z = 0, so the
/// exact distance is the separation, and the models meet exactly when it is <= 0 up to the rounding of the placement.
///
/// Pose 0 stands at (0.1 sqrt 2, 0.1 sqrt 3); the others at random places within a unit of the center along x and y.
/// All are turned by a random rotation of their own.
Transform ball_over_square(const Mesh& ball, double separation, std::uint32_t index);

/// Pose number `index` of a ring that is linked with another one, which stays at the origin: about a radius beside it
/// along x, and about upright. Rings with tubes up to 0.1 do not meet.
Transform linked_ring(std::uint32_t index);

/// A dent: all vertices within `radius` of a vertical line move along z in proportion to their distance from it.
struct Dent {
  double x = 0, y = 0;
  double radius = 1;
  double slope = 0.1;  ///< displacement per unit of distance from the line
};

/// The next dent of the deformation experiment on the 100 x 100 sheet: center anywhere, radius in [1, 10), slope +-0.1.
///
/// Draws x, y, the radius, then the sign, from the lowest bit: 1 is up.
Dent random_dent(Rng& rng);

/// The moves of a dent: vertices in ascending order, and their new positions.
struct VertexMoves {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
};
VertexMoves dent_moves(const Dent& dent, std::span<const Vec3> positions);

/// FNV-1a of all position bits, then of all corners as 32-bit integers, least significant byte first, from a start of
/// its own: names a mesh to the bit.
std::uint64_t hash(MeshView mesh);

// Scenes as motion planners have them: few large triangles beside many small ones, long thin ones, narrow passages.

/// A mesh that stands still, and a rigid body around its own origin, whose poses place it there.
///
/// Promise  Both meshes are closed, and equal to the bit on every machine. Parts of an environment may meet.
struct PlanningScene {
  Mesh environment, robot;
};

/// Each function has numbers of triangles beside it. `detail` multiplies them, roughly: round things become finer, or
/// there are more rooms. Robots of beams, boxes and plates stay as they are.
///
/// Pre      1 <= detail <= 1000.
PlanningScene sculptures(double detail = 1);      ///< bodies of many kinds in a closed cube, 1400; four beams, 48
PlanningScene house(double detail = 1);           ///< rooms with doors and windows, 700; an L-shaped table, 120
PlanningScene twisty_wall(double detail = 1);     ///< a wall with a slot that twists, 176; a bent rod, 56
PlanningScene cubicles(double detail = 1);        ///< partitions and desks, 624; two L-shaped prisms, 40
PlanningScene alpha_puzzle(double detail = 1);    ///< two equal bent tubes of long thin triangles, 2012 each
PlanningScene bug_trap(double detail = 1);        ///< a shell whose only way out is a funnel, 5184; a peanut, 264
PlanningScene spiral_tunnel(double detail = 1);   ///< a hollow spiral, 42 752; a corkscrew, 5756
PlanningScene furnished_flat(double detail = 1);  ///< rooms of coarse and fine furniture, 37 000; a piano, 3400
PlanningScene assembly(double detail = 1);        ///< plates with holes, bolts, shafts, 8000; plates and a bolt, 500

// One number for the answers to very many queries: whether two builds, processors, instruction sets, numbers of threads
// or revisions answer alike.

/// The answers to all queries of one kind.
struct AnswerHash {
  std::string kind;
  std::uint64_t queries = 0;
  std::uint64_t hash = 0;  ///< of every bit of the answers, in their order; statistics and times do not count
};

/// Asks queries of every kind that the library has, about scenes where bodies are apart, cross, touch, deform and lie
/// in common planes: some 4 000 for each unit of `scale`, which takes a second.
std::vector<AnswerHash> answer_hashes(std::uint32_t scale);

/// One hash of them all.
std::uint64_t total(const std::vector<AnswerHash>& hashes);

}  // namespace limber::scenes
