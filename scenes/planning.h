// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/mesh.h"

/// Scenes as motion planners have them: few large triangles beside many small ones, long thin ones, narrow passages.
namespace limber::scenes {

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

}  // namespace limber::scenes
