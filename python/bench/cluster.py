# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a batch on Dask costs next to one process, what it survives, and how far it would scale.

Workload  Distances of stanford-bunny.obj and armadillo.obj at a million poses, as in peers.py. A scheduler, and for
          each core a worker of one thread, are processes of this machine. For the cost of a partition alone: a
          triangle with itself, far away.
Metric    Seconds from the call to the last file, in turn with those of distance_many() with as many threads; poses
          differ from round to round, so that workers know nothing from the one before. Processor time of client,
          scheduler and workers.
Expected  At most 10 % above one process. All answers equal to the bit, also after a worker and the client were killed.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import statistics
import subprocess
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
from limber3d.batch.folder import to_parquet, write_whole
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

Scheduler, workers and client share these cores. Models are new to the workers in each of {rounds} rounds. Within these
times, {once_s:.2f} s pass before the first partition, while poses are checked and hashed, and {file_ms:.1f} ms of each
partition go to its file. Before them, scheduler, workers and client need {startup_s:.1f} s to start.

{survived}

Processor time of a partition, its queries left out:

| poses of a partition | client, ms | scheduler, ms | worker, ms |
|--:|--:|--:|--:|
| 1 | {small} |
| {size:,} | {usual} |

A pose takes {pose_us:.0f} us of one thread, a partition {partition_ms:.0f} ms; its poses are {megabytes:.1f} MB, which
go through the scheduler. Client or scheduler would be busy all the time from {threads:.0f} threads of workers on. A
billion poses would take, if the network is no limit:

| threads of workers | s | efficiency |
|--:|--:|--:|
{scaling}
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
        self.workers = [self.add_worker() for _ in range(CORES)]
        self.client = DaskClient(scheduler_file=str(self.file))
        self.client.wait_for_workers(CORES)

    def add_worker(self) -> psutil.Popen:
        return self._start("dask_worker", "--nthreads", "1", "--no-nanny", "--local-directory", str(self._folder))

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


def require_same(what: str, out: Path, expected: Any) -> None:
    if not same_bits(batch.read(out), expected):
        raise SystemExit(f"{what}: other answers than one process")


class Stopped(Exception):
    """The first partition is asked for."""


class Stopping:
    """An executor that runs nothing: what a call does before its first partition is measured with it."""

    def submit(self, *_: object) -> None:
        raise Stopped


def sweep(pair: Models, poses: Poses, out: Path, executor: Any, size: int = SIZE, query: Any = "distance") -> float:
    """Seconds of a batch."""
    start = time.perf_counter()
    try:
        batch.sweep(*pair, poses_b=poses, out=out, executor=executor, partition_size=size, query=query)
    except Stopped:
        pass
    return time.perf_counter() - start


def compare(folder: Path, pair: Models, poses: Poses, rounds: int) -> tuple[list[str], float, float]:
    """Rows of a table: one process without files, one with files, and Dask. Seconds of the first; of Dask's start."""
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
            require_same(name, folder / name, answers)
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
    return rows, statistics.median(times[one]), startup_s


def parquet_ms(folder: Path, answers: Any) -> float:
    """Milliseconds of making and writing the file of a partition."""
    records = answers[:SIZE].copy()
    return 1000 * statistics.median(
        seconds(lambda: write_whole(folder / "part", to_parquet(records, 0, "a partition")))[0] for _ in range(21)
    )


def killed(folder: Path, meshes: Path, poses: Poses, expected: Any) -> str:
    """A worker is killed at a quarter of the partitions, the client at half. Both are started again."""
    cluster = Cluster(folder)
    out, file = folder / "killed", folder / "poses.npz"
    numpy.savez(file, turns=poses[0], shifts=poses[1])
    count = -(-len(poses[0]) // SIZE)
    command = [sys.executable, __file__, str(meshes), "--client", str(cluster.file), str(file), str(out)]

    def wait_for(wanted: int) -> int:
        while (done := len(list(out.glob("part-*")))) < wanted:
            time.sleep(0.01)
        return done

    client = subprocess.Popen(command)
    at_worker = wait_for(count // 4)
    cluster.workers[0].send_signal(signal.SIGKILL)
    cluster.workers.append(cluster.add_worker())
    at_client = wait_for(count // 2)
    client.send_signal(signal.SIGKILL)
    client.wait()
    took, ended = seconds(lambda: subprocess.run(command, check=True, capture_output=True, text=True))
    cluster.close()
    require_same("killed", out, expected)
    return (
        f"A worker got SIGKILL when {at_worker} of {count} partitions were done, and another took its place. The\n"
        f"client got SIGKILL when {at_client} were done. The next one found {ended.stdout.strip()} of them, and took "
        f"{took:.1f} s with its own start.\nAll answers are equal to the bit."
    )


def run_client(meshes: Path, scheduler: str, poses: str, out: str) -> None:
    """The client that is killed, and the one after it."""
    with DaskClient(scheduler_file=scheduler) as client, numpy.load(poses) as file:
        placed = file["turns"], file["shifts"]
        report = batch.sweep(*models(meshes), poses_b=placed, out=out, executor=client, partition_size=SIZE)
    print(report.found)


def costs(folder: Path, count: int, size: int) -> tuple[float, float, float]:
    """Milliseconds of processor time that partitions of that size take of client, scheduler and workers where queries
    take next to nothing. What the client does before the first is left out."""
    triangle = limber3d.Model(numpy.eye(3), numpy.array([[0, 1, 2]], numpy.uint32))
    turns, shifts = random_poses(count * size)
    cluster = Cluster(folder)
    processes = [psutil.Process(), cluster.scheduler, *cluster.workers]

    def spent(executor: Any, out: Path) -> list[float]:
        before = [processor_s(process) for process in processes]
        sweep((triangle, triangle), (turns, shifts + 9), out, executor, size, "collide")
        return [1000 * (processor_s(process) - then) / count for process, then in zip(processes, before)]

    once = spent(Stopping(), folder / f"once {size}")
    client, scheduler, *workers = spent(cluster.client, folder / f"light {size}")
    cluster.close()
    return client - once[0], scheduler, sum(workers)


def scaling(pose_us: float, serial_ms: float) -> list[str]:
    """Rows of a table: client and scheduler are not faster than they were measured, and nothing else is in the way."""
    partition_ms = SIZE * pose_us / 1000
    rows = []
    for threads in (2, 8, 32, 128, 512):
        each_ms = max(partition_ms / threads, serial_ms)
        rows.append(
            f"| {threads} | {1e9 / SIZE * each_ms / 1000:,.0f} | {100 * partition_ms / threads / each_ms:.0f} % |"
        )
    return rows


def report(folder: Path, meshes: Path, poses: Poses, rounds: int) -> str:
    pair, count = models(meshes), len(poses[0])
    expected = limber3d.distance_many(*pair, poses_b=poses)
    rows, one_s, startup_s = compare(folder, pair, poses, rounds)
    small, usual = costs(folder, 2000, 1), costs(folder, 200, SIZE)
    pose_us, serial_ms = 1e6 * one_s * CORES / count, max(usual[:2])
    return PAGE.format(
        count=count,
        percent=100 * (expected["upper"] == 0).mean(),
        cores=CORES,
        size=SIZE,
        rows="\n".join(rows),
        rounds=rounds,
        once_s=sweep(pair, poses, folder / "once", Stopping()),
        file_ms=parquet_ms(folder, expected),
        startup_s=startup_s,
        survived=killed(folder, meshes, poses, expected),
        small="{:.1f} | {:.1f} | {:.1f}".format(*small),
        usual="{:.1f} | {:.1f} | {:.1f}".format(*usual),
        pose_us=pose_us,
        partition_ms=SIZE * pose_us / 1000,
        threads=SIZE * pose_us / 1000 / serial_ms,
        megabytes=sum(array[:SIZE].nbytes for array in poses) / 1e6,
        scaling="\n".join(scaling(pose_us, serial_ms)),
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=Path, help="folder with stanford-bunny.obj and armadillo.obj")
    parser.add_argument("--poses", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, help="folder for python_cluster.md")
    parser.add_argument("--client", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.client:
        run_client(arguments.meshes, *arguments.client)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        page = report(Path(folder), arguments.meshes, random_poses(arguments.poses), arguments.rounds)
    print(page)
    if arguments.out is not None:
        (arguments.out / "python_cluster.md").write_text(page)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
