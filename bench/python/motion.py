# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question        How long does it take to find how far moving meshes can go, next to the IPC Toolkit?
Workload        Two consecutive frames of a cloth on a ball (92 230 triangles) and of a soft body between rollers
                (24 242); and of two that are made here, in which little moves: twisted rods (79 680 triangles, by 0.026
                of their size) and a cloth that a funnel folds (18 432, by 0.003). Each mesh with itself, vertices on
                straight lines.
Metric          Milliseconds of calls from Python, medians on one core: all vertices to the first frame and a commit,
                the motion to the second, the first impact; then all impacts. The IPC Toolkit: candidates by its fastest
                broad phase, and the step by ACCD and by Tight-Inclusion.
Expected shape  20 times as fast as the IPC Toolkit with ACCD; 5 times on the cloth in the funnel, which hardly touches
                itself. All impacts at most 7 times the first one.
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


def strip(rows: int, columns: int, closes: bool) -> numpy.ndarray:
    """The triangles between rows of points. Where it closes, the last column is beside the first one."""
    row, column = numpy.mgrid[: rows - 1, : columns if closes else columns - 1].reshape(2, -1)
    a, b = row * columns + column, row * columns + (column + 1) % columns
    return numpy.stack((a, b, a + columns, b, b + columns, a + columns), 1).reshape(-1, 3)


def unit(p: numpy.ndarray) -> numpy.ndarray:
    return p / numpy.linalg.norm(p, axis=1, keepdims=True)


def beside(line: numpy.ndarray, turn: numpy.ndarray, towards: numpy.ndarray) -> numpy.ndarray:
    """Directions across a line of points, turned about it from the one towards something."""
    forward = unit(numpy.gradient(line, axis=0))
    across = unit(numpy.cross(forward, towards))
    return numpy.cos(turn) * numpy.cross(across, forward) + numpy.sin(turn) * across


def twisted_rods(time: float) -> Mesh:
    """Four rods that are twisted about a line, itself a helix."""
    rows, columns = 250, 40
    s = numpy.linspace(-1, 1, rows)[:, None]
    bend, out = (2.2 + 0.04 * time) * numpy.pi * s, 0.09 * (1 - s**4)
    middle = numpy.hstack((out * numpy.cos(bend), out * numpy.sin(bend), 0.5 * s))
    positions, triangles = [], []
    for rod in range(4):
        away = beside(middle, (4 + 0.17 * time) * numpy.pi * s + rod * numpy.pi / 2, numpy.array([1, 0, 0]))
        line = middle + (0.034 - 0.0004 * time) * away
        around = [line + 0.0215 * beside(line, 2 * numpy.pi * k / columns + 5 * s, away) for k in range(columns)]
        positions.append(numpy.stack(around, 1).reshape(-1, 3))
        triangles.append(strip(rows, columns, True) + rod * rows * columns)
    return numpy.concatenate(positions), numpy.concatenate(triangles)


def cloth_in_funnel(time: float) -> Mesh:
    """A square cloth whose middle is drawn into a funnel. Its folds are curves whose direction swings."""
    n, folds = 97, 10
    x, y = numpy.mgrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j].reshape(2, -1, 1)
    rho, turns = numpy.hypot(x, y), folds * numpy.arctan2(y, x) / (2 * numpy.pi)
    height = rho - 1.05 - 0.0048 * time  # along the wall, from the neck on
    wall = 0.14 + 0.55 * numpy.logaddexp(0, 12 * height) / 12  # its radius there
    samples = (numpy.arange(64) + 0.5) / 64

    def on_fold(swing: numpy.ndarray, part: numpy.ndarray | float) -> list[numpy.ndarray]:
        """A point of a fold of length 1: along the wall, and across."""
        direction = swing * numpy.sin(2 * numpy.pi * part * samples)
        return [part * f(direction).mean(1, keepdims=True) for f in (numpy.cos, numpy.sin)]

    swings = numpy.linspace(2.2, 0, 100)[:, None]  # the more, the less wall a fold takes
    swing = numpy.interp(wall / numpy.maximum(rho, wall), on_fold(swings, 1)[0][:, 0], swings[:, 0])
    along, across = on_fold(swing, turns % 1)
    angle = (numpy.floor(turns) + along / on_fold(swing, 1)[0]) * 2 * numpy.pi / folds
    radius = numpy.minimum(wall, rho) + (across - on_fold(swing, 0.5)[1] / 2) * 2 * numpy.pi * rho / folds
    up = numpy.where(height > 0, 0.835, 1) * height
    return numpy.hstack((radius * numpy.cos(angle), radius * numpy.sin(angle), up)), strip(n, n, False)


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
    for scene in (twisted_rods, cloth_in_funnel):
        lines += rows_of(scene.__name__, scene(0), scene(1)[0], 1 if options.quick else 15)
    measure.write(options, "motion.md", lines)


if __name__ == "__main__":
    main()
