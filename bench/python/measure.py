# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks in Python share: their command line, files, times, and tables."""

from __future__ import annotations

import argparse
import gc
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy

Mesh = tuple[numpy.ndarray, numpy.ndarray]  # positions and triangles
Call = Callable[[], Any]


def one_core() -> None:
    """For all libraries that are imported later: TBB, OpenMP and thread pools start one thread then."""
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def options_of(question: str | None, needs_meshes: bool = True) -> argparse.Namespace:
    """The command line of a benchmark; its docstring is the question."""
    parser = argparse.ArgumentParser(description=question, formatter_class=argparse.RawDescriptionHelpFormatter)
    if needs_meshes:
        parser.add_argument("meshes", type=Path, help="the folder of mesh files")
    parser.add_argument("--out", type=Path, help="the folder for the table")
    parser.add_argument("--quick", action="store_true", help="a few rounds, to see that everything works")
    return parser.parse_args()


def read(path: Path) -> Mesh:
    """A mesh file, with the vertices that it has."""
    import limber3d

    file = limber3d.read_mesh_file(path, weld=False)
    return file.vertices, file.faces


def in_turn(calls: dict[str, Call | tuple[Call, Call]], rounds: int, seconds: float = 20) -> dict[str, numpy.ndarray]:
    """Milliseconds of each call, and of processors: medians over rounds in which all are made in turn. After so many
    seconds there are no more than three rounds. A pair of calls is one that prepares, untimed, and the timed one."""
    samples: dict[str, list[numpy.ndarray]] = {name: [] for name in calls}
    start = time.perf_counter()
    for i in range(rounds):
        if i >= 3 and time.perf_counter() - start > seconds:
            break
        for name, call in calls.items():
            prepare, ask = call if isinstance(call, tuple) else (None, call)
            if prepare:
                prepare()
            gc.collect()
            gc.disable()
            begin = numpy.array([time.perf_counter(), time.process_time()])
            result = ask()
            end = numpy.array([time.perf_counter(), time.process_time()])
            gc.enable()
            del result  # outside the time
            samples[name].append(1e3 * (end - begin))
    return {name: numpy.median(taken, axis=0) for name, taken in samples.items()}


def write(options: argparse.Namespace, name: str, lines: list[str]) -> None:
    """Shows a table and keeps it, if there is a folder for results."""
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
        (options.out / name).write_text(text, encoding="utf-8")
