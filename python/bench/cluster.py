# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a batch on Dask costs next to one process.

Workload  Distances of stanford-bunny.obj and armadillo.obj at a million poses, as in peers.py. A scheduler, and for
          each core a worker of one thread, are processes of this machine. For the cost of a partition alone: a
          triangle with itself, far away.
Metric    Seconds from the call to the last file, in turn with those of distance_many() with as many threads; poses
          differ from round to round, so that workers know nothing from the one before. Processor time of client,
          scheduler and workers.
Expected  At most 10 % above one process. All answers equal to the bit.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import distributed
import limber3d
import numpy
import psutil  # type: ignore[import-untyped]
from limber3d import batch
from peers import random_poses, scaled

DaskClient: Any = distributed.Client  # has no types
Models = tuple[limber3d.Model, limber3d.Model]
Poses = tuple[Any, Any]
CORES = len(os.sched_getaffinity(0))
SIZE = 10_000  # poses of a partition
PAGE = """\
# {count:,} poses on Dask next to one process

Distances of bunny and armadillo, which overlap at {percent:.0f} % of the poses; {cores} cores; partitions of {size:,}
poses. All answers are equal to the bit.

| call | least, s | median, s | most, s | above one process |
|:--|--:|--:|--:|--:|
{rows}

Scheduler, workers and client share these cores, and need {startup_s:.1f} s to start. Models are new to the workers in
each of {rounds} rounds.

Processor time of a partition whose queries take next to nothing:

| poses of a partition | client, ms | scheduler, ms | worker, ms |
|--:|--:|--:|--:|
| 1 | {small} |
| {size:,} | {usual} |
"""


def models(folder: Path) -> Models:
    a, b = (limber3d.Model(*scaled(folder / name)) for name in ("stanford-bunny.obj", "armadillo.obj"))
    return a, b


class Cluster:
    """A scheduler and workers of one thread, each a process."""

    def __init__(self, folder: Path) -> None:
        self._folder = Path(tempfile.mkdtemp(dir=folder))
        self.file = self._folder / "scheduler.json"
        self.scheduler = self._start("dask_scheduler", "--port", "0")
        options = ("--nthreads", "1", "--no-nanny", "--local-directory", str(self._folder))
        self.workers = [self._start("dask_worker", *options) for _ in range(CORES)]
        self.client = DaskClient(scheduler_file=str(self.file))
        self.client.wait_for_workers(CORES)

    def close(self) -> None:
        self.client.close()
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()

    def _start(self, program: str, *options: str) -> psutil.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--no-dashboard"]
        with (self._folder / "log").open("ab") as log:
            return psutil.Popen(
                [*command, "--scheduler-file", str(self.file), *options],
                stdout=log, stderr=log,
            )  # fmt: skip


def seconds(call: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


def same_bits(a: Any, b: Any) -> bool:
    return a.dtype == b.dtype and all(a[name].tobytes() == b[name].tobytes() for name in a.dtype.names)


def processor_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def sweep(pair: Models, poses: Poses, out: Path, executor: Any, size: int = SIZE, query: Any = "distance") -> float:
    """Seconds of a batch."""
    call = lambda: batch.sweep(*pair, poses_b=poses, out=out, executor=executor, partition_size=size, query=query)
    return seconds(call)[0]


def compare(folder: Path, pair: Models, poses: Poses, rounds: int) -> tuple[list[str], float]:
    """Rows of a table: one process without files, one with files, and Dask. Seconds of Dask's start."""
    startup_s, cluster = seconds(lambda: Cluster(folder))
    one = f"`distance_many`, {CORES} threads"
    executors = {
        f"`batch.sweep`, {CORES} threads of one process": None,
        f"`batch.sweep`, Dask, {CORES} workers of one thread": cluster.client,
    }
    times: dict[str, list[float]] = {name: [] for name in (one, *executors)}

    def take_turns(asked: Poses, first: int) -> dict[str, float]:
        took, names = dict[str, float](), list(times)
        for name in names[first:] + names[:first]:
            if name == one:
                took[one], answers = seconds(lambda: limber3d.distance_many(*pair, poses_b=asked))
            else:
                took[name] = sweep(pair, asked, folder / name, executors[name])
        for name in executors:
            if not same_bits(batch.read(folder / name), answers):
                raise SystemExit(f"{name}: other answers than one process")
            shutil.rmtree(folder / name)
        return took

    take_turns((poses[0][: 2 * CORES * SIZE], poses[1][: 2 * CORES * SIZE]), 0)  # warms up and does not count
    for i in range(rounds):
        for name, took_s in take_turns((numpy.roll(poses[0], i, 0), numpy.roll(poses[1], i, 0)), i % 3).items():
            times[name].append(took_s)
    cluster.close()
    rows = []
    for name, took in times.items():
        above = statistics.median(ours / theirs for ours, theirs in zip(took, times[one])) - 1
        rows.append(
            f"| {name} | {min(took):.2f} | {statistics.median(took):.2f} | {max(took):.2f} | {100 * above:+.1f} % |"
        )
    return rows, startup_s


def costs(folder: Path, count: int, size: int) -> str:
    """Milliseconds of processor time that partitions of that size take of client, scheduler and workers."""
    triangle = limber3d.Model(numpy.eye(3), numpy.array([[0, 1, 2]], numpy.uint32))
    turns, shifts = random_poses(count * size)
    cluster = Cluster(folder)
    processes = [psutil.Process(), cluster.scheduler, *cluster.workers]
    before = [processor_s(process) for process in processes]
    sweep((triangle, triangle), (turns, shifts + 9), folder / f"light {size}", cluster.client, size, "collide")
    client, scheduler, *workers = (
        1000 * (processor_s(process) - then) / count for process, then in zip(processes, before)
    )
    cluster.close()
    return f"{client:.1f} | {scheduler:.1f} | {sum(workers):.1f}"


def report(folder: Path, meshes: Path, poses: Poses, rounds: int) -> str:
    pair = models(meshes)
    rows, startup_s = compare(folder, pair, poses, rounds)
    return PAGE.format(
        count=len(poses[0]),
        percent=100 * limber3d.collide_many(*pair, poses_b=poses)["is_yes"].mean(),
        cores=CORES,
        size=SIZE,
        rows="\n".join(rows),
        rounds=rounds,
        startup_s=startup_s,
        small=costs(folder, 2000, 1),
        usual=costs(folder, 200, SIZE),
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=Path, help="folder with stanford-bunny.obj and armadillo.obj")
    parser.add_argument("--poses", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, help="folder for python_cluster.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        page = report(Path(folder), arguments.meshes, random_poses(arguments.poses), arguments.rounds)
    print(page)
    if arguments.out is not None:
        (arguments.out / "python_cluster.md").write_text(page)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
