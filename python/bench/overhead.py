# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a call of Python costs above the same call of C++.

Workload  Distance and collision of two tetrahedra at 20 000 poses, call by call and batched on one thread; move_all()
          and commit() of a sheet of 199 712 triangles from float32; a million calls, for what memory they leave behind.
Metric    Microseconds above C++ by cpp_calls.cpp, which runs in turn with Python; the fastest of some rounds counts.
Expected  At most 1 us a call, at most 0.1 us a pose batched; at most 1.2 times C++ for the sheet; flat memory.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import limber3d
import numpy

CALLS = 20_000
VERTICES = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
FACES = numpy.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], numpy.uint32)


def fastest_us(rounds: int, call: Callable[[], object]) -> float:
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best * 1e6


def sheet(count: int) -> tuple[Any, Any]:
    x, y = numpy.meshgrid(numpy.arange(count + 1) / count, numpy.arange(count + 1) / count)
    vertices = numpy.stack([x.ravel(), y.ravel(), numpy.zeros(x.size)], axis=1)
    row, column = numpy.divmod(numpy.arange(count * count), count)
    a = row * (count + 1) + column
    return vertices, numpy.stack([a, a + 1, a + count + 2, a, a + count + 2, a + count + 1], axis=1).reshape(-1, 3)


def python_times() -> dict[str, float]:
    a, b = limber3d.Model(VERTICES, FACES), limber3d.Model(VERTICES, FACES)
    poses = numpy.tile(numpy.eye(4), (CALLS, 1, 1))
    poses[:, 0, 3] = 3 + numpy.arange(CALLS) / CALLS
    each = list(poses)
    distance, collide = limber3d.distance, limber3d.collide

    def loop() -> None:
        for _ in each:
            pass

    def distances() -> None:
        for pose in each:
            distance(a, b, None, pose)

    def collisions() -> None:
        for pose in each:
            collide(a, b, None, pose)

    limber3d.set_thread_limit(1)
    empty = fastest_us(10, loop) / CALLS
    times = {
        "distance_us": fastest_us(10, distances) / CALLS - empty,
        "collide_us": fastest_us(10, collisions) / CALLS - empty,
        "distance_many_us": fastest_us(20, lambda: limber3d.distance_many(a, b, poses_b=poses)) / CALLS,
        "collide_many_us": fastest_us(20, lambda: limber3d.collide_many(a, b, poses_b=poses)) / CALLS,
    }
    limber3d.set_thread_limit(None)
    vertices, faces = sheet(316)
    cloth = limber3d.Model(vertices, faces)
    frames = []
    for height in (0.1, 0.2):
        frame = vertices.astype(numpy.float32)
        frame[:, 2] = height * vertices[:, 0] * vertices[:, 1]
        frames.append(frame)
    turn = 0

    def next_frame() -> None:
        nonlocal turn
        turn += 1
        cloth.move_all(frames[turn % 2])
        cloth.commit()

    times["frame_us"] = fastest_us(60, next_frame)
    return times


def leaked_kb(calls: int) -> int:
    """How much the peak of memory grows from the first tenth of the calls to the last."""
    a, b = limber3d.Model(VERTICES, FACES), limber3d.Model(VERTICES, FACES)
    pose, cache = numpy.eye(4), limber3d.QueryCache()
    pose[0, 3] = 1.5

    def some(count: int) -> None:
        for _ in range(count // 5):
            result = limber3d.distance(a, b, pose_b=pose, cache=cache)
            assert result.witness is not None and result.witness.point_a is not None
            limber3d.collide(a, b, (pose[:3, :3], pose[:3, 3]))
            limber3d.contacts(a, b, 1.0, pose_b=pose)
            a.move_vertices([0], VERTICES[:1])
            a.commit()
            try:
                limber3d.distance(a, b, pose[:3])
            except ValueError:
                pass

    some(calls // 10)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    some(calls - calls // 10)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cpp_calls", type=Path, help="the program that times C++")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, help="folder for python_overhead.md")
    arguments = parser.parse_args()
    cpp: dict[str, float] = {}
    python: dict[str, float] = {}
    for _ in range(arguments.rounds):
        theirs = json.loads(subprocess.run([arguments.cpp_calls], capture_output=True, text=True, check=True).stdout)
        for best, found in ((cpp, theirs), (python, python_times())):
            for name, us in found.items():
                best[name] = min(us, best.get(name, us))
    rows = ["| call | C++, us | Python, us | above C++, us | wanted |", "|:--|--:|--:|--:|:--|"]
    for name, label, limit in (
        ("distance", "`distance`", 1.0),
        ("collide", "`collide`", 1.0),
        ("distance_many", "`distance_many`, a pose", 0.1),
        ("collide_many", "`collide_many`, a pose", 0.1),
    ):
        theirs, ours = cpp[name.removesuffix("_many") + "_us"], python[name + "_us"]
        rows.append(f"| {label} | {theirs:.3f} | {ours:.3f} | {ours - theirs:.3f} | at most {limit} |")
    ratio = python["frame_us"] / cpp["frame_us"]
    rows.append(
        f"| `move_all` and `commit`, 199 712 triangles | {cpp['frame_us']:.0f} | {python['frame_us']:.0f} "
        f"| {ratio:.2f} times | at most 1.2 times |"
    )
    rows += ["", f"A million calls of five kinds grow the peak of memory by {leaked_kb(1_000_000)} kB."]
    text = "\n".join(rows) + "\n"
    print(text)
    if arguments.out is not None:
        (arguments.out / "python_overhead.md").write_text("# Calls of Python next to C++\n\n" + text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
