# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question        How long does it take to find how far moving meshes can go, next to the IPC Toolkit?
Workload        Two consecutive frames of a cloth on a ball (92 230 triangles) and of a soft body between rollers
                (24 242): each mesh with itself, vertices on straight lines.
Metric          Milliseconds of calls from Python, medians on one core: all vertices to the first frame and a commit,
                the motion to the second, the first impact; then all impacts. The IPC Toolkit: candidates by its fastest
                broad phase, and the step by ACCD and by Tight-Inclusion.
Expected shape  20 times as fast as the IPC Toolkit with ACCD. All impacts at most 7 times the first one.
Checked         The first impact is the earliest of all impacts. Steps of the IPC Toolkit end before it: those that do
                not are told.

Writes motion.md."""

from __future__ import annotations

import sys

import measure

measure.one_core()
# ruff: noqa: E402
import ipctk
import limber3d
import numpy
from measure import Mesh

FRAMES = {"cloth_ball": ("cloth_ball_92.ply", "cloth_ball_93.ply"),
          "armadillo_rollers": ("armadillo_rollers_326.ply", "armadillo_rollers_327.ply")}
PHASES = ("LBVH", "HashGrid", "SpatialHash", "SweepAndPrune")
STEPS = {"ACCD": ipctk.AdditiveCCD, "TightInclusion": ipctk.TightInclusionCCD}


def rows_of(name: str, first: Mesh, second: numpy.ndarray, rounds: int) -> list[str]:
    """The table of one pair of frames, whose answers have been checked."""
    model = limber3d.Model(*first)
    moving = limber3d.MovingModel(model)
    ids, corners = numpy.unique(first[1], return_inverse=True)  # the toolkit has no vertices without triangles
    faces = numpy.asfortranarray(corners.reshape(-1, 3).astype(numpy.int32))
    start, end = numpy.asfortranarray(first[0][ids]), numpy.asfortranarray(second[ids])
    mesh = ipctk.CollisionMesh(start, numpy.asfortranarray(ipctk.edges(faces)), faces)
    candidates = ipctk.Candidates()

    def find_candidates(phase: str) -> None:
        candidates.build(mesh, start, end, 0, getattr(ipctk, phase)())

    def step(kind: str) -> float:
        return candidates.compute_collision_free_stepsize(mesh, start, end, 0, STEPS[kind]())

    def move() -> None:
        model.move_all(first[0])
        model.commit()

    move()
    moving.set_motion(second)
    found = limber3d.self_time_of_impact(moving, ignore_crossings=True)
    impacts = limber3d.self_impacts(moving)
    if not found.lower <= impacts["upper"].min() <= found.upper:
        sys.exit(f"{name}: the first impact is not the earliest")
    ours = {"all vertices moved, commit": move,
            "motion set": lambda: moving.set_motion(second),
            "first impact": lambda: limber3d.self_time_of_impact(moving, ignore_crossings=True),
            "all impacts, times within 1e-6": lambda: limber3d.self_impacts(moving, time_error=1e-6),
            "all impacts": lambda: limber3d.self_impacts(moving)}
    phases = {phase: lambda p=phase: find_candidates(p) for phase in PHASES}
    steps = {kind: lambda k=kind: step(k) for kind in STEPS}
    find_candidates(PHASES[0])
    ms = {what: taken[0] for what, taken in measure.in_turn(ours | phases | steps, rounds).items()}
    whole = sum(ms[what] for what in list(ours)[:3])
    lines = [f"\n## {name}\n", f"The first impact is at {found.upper:.17g}; {len(impacts)} pairs of elements touch.\n",
             "| what | ms | over the first impact with commit and motion |", "|:--|--:|--:|"]
    for what in ours:
        lines.append(f"| {what} | {ms[what]:.1f} | {'' if what in list(ours)[:2] else f'{ms[what] / whole:.2f}'} |")
    for kind in STEPS:
        theirs, safe = min(ms[phase] for phase in PHASES) + ms[kind], step(kind)
        late = " (late)" if safe > found.upper else ""
        lines.append(f"| IPC Toolkit, candidates and step {kind}: {safe:.6g}{late} | {theirs:.0f} "
                     f"| {theirs / whole:.1f} |")
    return lines


def main() -> None:
    options = measure.options_of(__doc__)
    ipctk.set_num_threads(1)
    lines = ["# How far moving meshes can go, as printed by `./dev bench motion`"]
    for name, files in FRAMES.items():
        if all((options.meshes / file).exists() for file in files):
            first, second = (measure.read(options.meshes / file) for file in files)
            lines += rows_of(name, first, second[0], 1 if options.quick else 15)
    measure.write(options, "motion.md", lines)


if __name__ == "__main__":
    main()
