#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The IPC Toolkit on the questions of `./dev bench motion`: how far a mesh can go towards its next frame. On one core.
Writes motion_peers.csv."""

import os

# One core, before any library counts them.
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

# pylint: disable=wrong-import-position
import argparse
import csv
import pathlib
import statistics
import sys
import time

import ipctk
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "contacts"))
import meshes  # noqa: E402

FRAMES = {"cloth_ball": ("cloth_ball_92.ply", "cloth_ball_93.ply"),
          "armadillo_rollers": ("armadillo_rollers_326.ply", "armadillo_rollers_327.ply")}
PHASES = ("LBVH", "HashGrid", "SpatialHash", "SweepAndPrune")
RUNS = 5


def timed(call):
    """The result of a call and its median time in microseconds: of five runs, fewer of long ones."""
    taken, result = [], None
    while len(taken) < RUNS and sum(taken) < 15:
        begin = time.perf_counter()
        result = call()
        taken.append(time.perf_counter() - begin)
    return result, 1e6 * statistics.median(taken)


def candidates(mesh, start, end, phase):
    """Pairs of elements whose boxes around the whole step overlap."""
    found = ipctk.Candidates()
    found.build(mesh, start, end, 0, getattr(ipctk, phase)())
    return found


def rows_of(name, folder):
    """All rows of one pair of frames."""
    (positions, faces), (moved, _) = (meshes.read(folder / file) for file in FRAMES[name])
    ids, corners = np.unique(faces, return_inverse=True)
    faces = np.asfortranarray(corners.reshape(-1, 3).astype(np.int32))
    start, end = np.asfortranarray(positions[ids]), np.asfortranarray(moved[ids])
    mesh = ipctk.CollisionMesh(start, np.asfortranarray(ipctk.edges(faces)), faces)
    for phase in PHASES:
        found, us = timed(lambda phase=phase: candidates(mesh, start, end, phase))
        yield ("ipctk", name, f"candidates {phase}", f"{us:.0f}", len(found), "")
    found = candidates(mesh, start, end, PHASES[0])
    # Conservative rescaling is a part of these answers: the step is that much shorter than the way to the contact.
    for kind, rescaling in (("ACCD", 0.9), ("TightInclusion", 0.8)):
        ccd = ipctk.AdditiveCCD() if kind == "ACCD" else ipctk.TightInclusionCCD()
        step, us = timed(lambda ccd=ccd: found.compute_collision_free_stepsize(mesh, start, end, 0, ccd))
        yield ("ipctk", name, f"step {kind}", f"{us:.0f}", len(found), f"{step:.17g} with rescaling {rescaling}")


def main():
    """Reads the options, asks, writes the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", type=pathlib.Path, help="folder with the meshes")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for motion_peers.csv")
    options = parser.parse_args()
    ipctk.set_num_threads(1)
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / "motion_peers.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("peer", "mesh", "question", "us_median", "count", "details"))
        for name in FRAMES:
            for row in rows_of(name, options.meshes):
                print(*row, sep=",", flush=True)
                writer.writerow(row)


if __name__ == "__main__":
    main()
