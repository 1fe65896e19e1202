# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a program in Python waits for, next to other libraries' packages from PyPI.

Workload  stanford-bunny.obj and armadillo.obj, each scaled to a diagonal of 1. The armadillo is turned and shifted at
          random, 1 000 times: collision at all poses, exact distance where the two are apart.
Metric    Microseconds a pose, calls and the loop in Python included, median of some rounds that run in turn; ratios to
          limber. Libraries run as they come: calls of limber use one thread, its batches in the last row all.
Expected  Equal answers: collisions at every pose, distances within a tolerance. Who answers otherwise is named.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import importlib.util
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import limber3d
import numpy

PEERS = {"fcl": ("python-fcl", 1e-6), "coal": ("coal", 1e-6)}  # distribution, tolerance
Mesh = tuple[Any, Any]
Ask = Callable[[int], Any]


def scaled(path: Path) -> Mesh:
    vertices, faces, _ = limber3d.read_mesh_file(path)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return (vertices - (low + high) / 2) / numpy.linalg.norm(high - low), faces


def random_poses(count: int) -> tuple[Any, Any]:
    """Rotations, and shifts of a length from 0.2 to 1, of a diagonal."""
    random = numpy.random.default_rng(20)
    q = random.normal(size=(count, 4))
    w, x, y, z = (q / numpy.linalg.norm(q, axis=1, keepdims=True)).T
    zero = 0 * w
    cross = numpy.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    turns = numpy.eye(3) + 2 * w[:, None, None] * cross + 2 * cross @ cross
    ways = random.normal(size=(count, 3))
    return turns, ways / numpy.linalg.norm(ways, axis=1, keepdims=True) * random.uniform(0.2, 1, (count, 1))


def ask_limber(a: Mesh, b: Mesh, turns: Any, shifts: Any) -> tuple[Ask, Ask]:
    one, other = limber3d.Model(*a), limber3d.Model(*b)
    poses = list(zip(turns, shifts))
    return (
        lambda i: limber3d.collide(one, other, None, poses[i]),
        lambda i: limber3d.distance(one, other, None, poses[i]).upper,
    )


def ask_fcl(a: Mesh, b: Mesh, turns: Any, shifts: Any) -> tuple[Ask, Ask]:
    import fcl

    def model(mesh: Mesh) -> Any:
        built = fcl.BVHModel()
        built.beginModel(len(mesh[0]), len(mesh[1]))
        built.addSubModel(mesh[0], mesh[1].astype(numpy.int64))
        built.endModel()
        return built

    one, other = fcl.CollisionObject(model(a), fcl.Transform()), fcl.CollisionObject(model(b), fcl.Transform())

    def collide(i: int) -> bool:
        other.setTransform(fcl.Transform(turns[i], shifts[i]))
        return bool(fcl.collide(one, other, fcl.CollisionRequest(), fcl.CollisionResult()))

    def distance(i: int) -> Any:
        other.setTransform(fcl.Transform(turns[i], shifts[i]))
        return fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult())

    return collide, distance


def ask_coal(a: Mesh, b: Mesh, turns: Any, shifts: Any) -> tuple[Ask, Ask]:
    import coal

    def model(mesh: Mesh) -> Any:
        built = coal.BVHModelOBBRSS()
        built.beginModel(len(mesh[1]), len(mesh[0]))
        built.addVertices(mesh[0])
        built.addTriangles(mesh[1].astype(numpy.int64))
        built.endModel()
        return built

    one, other, here = model(a), model(b), coal.Transform3s.Identity()
    poses = [coal.Transform3s(turn, shift) for turn, shift in zip(turns, shifts)]

    def collide(i: int) -> bool:
        return bool(coal.collide(one, here, other, poses[i], coal.CollisionRequest(), coal.CollisionResult()))

    def distance(i: int) -> Any:
        return coal.distance(one, here, other, poses[i], coal.DistanceRequest(), coal.DistanceResult())

    return collide, distance


def us_each(ask: Ask, indices: Any) -> float:
    start = time.perf_counter()
    for i in indices:
        ask(i)
    return 1e6 * (time.perf_counter() - start) / len(indices)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=Path, help="folder with stanford-bunny.obj and armadillo.obj")
    parser.add_argument("--poses", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, help="folder for python_peers.md")
    arguments = parser.parse_args()
    a, b = (scaled(arguments.meshes / name) for name in ("stanford-bunny.obj", "armadillo.obj"))
    turns, shifts = random_poses(arguments.poses)

    batch = limber3d.Model(*a), limber3d.Model(*b)
    expected_hits = limber3d.collide_many(*batch, poses_b=(turns, shifts))["is_yes"]
    expected = limber3d.distance_many(*batch, poses_b=(turns, shifts))["upper"]
    everywhere, apart = range(arguments.poses), numpy.flatnonzero(~expected_hits).tolist()

    peers = {"limber3d": ask_limber(a, b, turns, shifts)}
    versions = dict[str, str]()
    wrong = 0
    for name, (distribution, tolerance) in PEERS.items():
        if importlib.util.find_spec(name) is None:
            print(f"{distribution} is left out: it is not installed")
            continue
        collide, distance = globals()[f"ask_{name}"](a, b, turns, shifts)
        hits = sum(bool(collide(i)) != bool(expected_hits[i]) for i in everywhere)
        error = max(abs(float(distance(i)) - expected[i]) for i in apart)
        if hits or error > tolerance:
            print(f"{distribution} answers otherwise: {hits} collisions, distances by up to {error:g}")
            wrong += 1
        else:
            peers[distribution] = (collide, distance)
            versions[distribution] = importlib.metadata.version(distribution)

    times: dict[str, list[tuple[float, float]]] = {name: [] for name in peers}
    many: list[tuple[float, float]] = []
    poses_apart = (turns[apart], shifts[apart])
    for _ in range(arguments.rounds):
        for name, (collide, distance) in peers.items():
            times[name].append((us_each(collide, everywhere), us_each(distance, apart)))
        start = time.perf_counter()
        limber3d.collide_many(*batch, poses_b=(turns, shifts))
        between = time.perf_counter()
        limber3d.distance_many(*batch, poses_b=poses_apart)
        end = time.perf_counter()
        many.append((1e6 * (between - start) / arguments.poses, 1e6 * (end - between) / len(apart)))

    medians = {name: tuple(map(statistics.median, zip(*rows))) for name, rows in times.items()}
    medians[f"limber3d, batches on {len(os.sched_getaffinity(0))} processors"] = tuple(
        map(statistics.median, zip(*many))
    )
    base = medians["limber3d"]
    rows = ["| | collision, us | to limber3d | exact distance, us | to limber3d |", "|:--|--:|--:|--:|--:|"]
    for name, (hit_us, distance_us) in medians.items():
        label = f"{name} {versions.get(name, '')}".strip()
        rows.append(
            f"| {label} | {hit_us:.2f} | {hit_us / base[0]:.2f} | {distance_us:.2f} | {distance_us / base[1]:.2f} |"
        )
    text = "\n".join([f"{arguments.poses} poses, {len(apart)} of them apart.", "", *rows]) + "\n"
    print(text)
    if arguments.out is not None:
        (arguments.out / "python_peers.md").write_text("# Python packages, bunny and armadillo\n\n" + text)
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
