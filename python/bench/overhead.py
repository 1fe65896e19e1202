# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a call of Python costs above the same query in a batch, whose loop is C++.

Workload  Distance and collision of two tetrahedra at 20 000 poses, call by call and batched, on one thread; a million
          calls, for what memory they leave behind.
Metric    Microseconds a pose; the fastest of some rounds counts. Kilobytes.
Expected  At most 1 us above the batch; flat memory.
"""

from __future__ import annotations

import argparse
import resource
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
    """Microseconds of a pose."""
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best * 1e6 / CALLS


def row(rounds: int, name: str) -> str:
    """A row of the table for distance or collide."""
    a, b = limber3d.Model(VERTICES, FACES), limber3d.Model(VERTICES, FACES)
    poses = numpy.tile(numpy.eye(4), (CALLS, 1, 1))
    poses[:, 0, 3] = 3 + numpy.arange(CALLS) / CALLS
    each = list(poses)
    query: Any = getattr(limber3d, name)
    query_many: Any = getattr(limber3d, f"{name}_many")

    def call_by_call() -> None:
        for pose in each:
            query(a, b, None, pose)

    single = fastest_us(rounds, call_by_call)
    batched = fastest_us(rounds, lambda: query_many(a, b, poses_b=poses, threads=1))
    return f"| `{name}` | {batched:.3f} | {single:.3f} | {single - batched:.3f} |"


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
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--out", type=Path, help="folder for python_overhead.md")
    arguments = parser.parse_args()
    lines = ["| call | in a batch, us | by itself, us | above, us |", "|:--|--:|--:|--:|"]
    lines += [row(arguments.rounds, name) for name in ("distance", "collide")]
    lines += ["", f"A million calls of five kinds grow the peak of memory by {leaked_kb(1_000_000)} kB."]
    text = "\n".join(lines) + "\n"
    print(text)
    if arguments.out is not None:
        (arguments.out / "python_overhead.md").write_text("# Calls of Python next to a batch\n\n" + text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
