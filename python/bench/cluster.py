# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question: what a batch on Dask costs next to one process, what it survives, and how far it would scale.

Workload  Distances of two bumpy balls of some 80 000 triangles at a million poses, a quarter of which overlap. Scheduler,
          workers and clients are processes of this machine. Two triangles far apart, for the cost of a task alone.
Metric    Seconds of distance_many() on all cores, in turn with those of sweep() on workers with as many threads, from the
          call to the last file; processor time of client and scheduler for each partition.
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
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import distributed
import limber3d
import numpy
import psutil  # type: ignore[import-untyped]
from limber3d import batch

DaskClient: Any = distributed.Client  # has no types
CORES = len(os.sched_getaffinity(0))
SIZE = 10_000  # poses of a partition
SMALL_TASKS, LIGHT_PARTITIONS = 2000, 200


def bumpy_ball(slices: int, stacks: int) -> limber3d.Model:
    turn = numpy.linspace(0, 2 * numpy.pi, slices, endpoint=False)
    rise = numpy.linspace(-numpy.pi / 2, numpy.pi / 2, stacks + 2)[1:-1]
    grid = numpy.stack(
        [numpy.outer(numpy.cos(rise), numpy.cos(turn)), numpy.outer(numpy.cos(rise), numpy.sin(turn)),
         numpy.outer(numpy.sin(rise), numpy.ones(slices))], 2).reshape(-1, 3)  # fmt: skip
    bumps = 0.1 * numpy.sin(9 * grid[:, 1]) * numpy.cos(7 * grid[:, 0]) + 0.05 * numpy.sin(17 * grid[:, 2])
    row, column = numpy.divmod(numpy.arange((stacks - 1) * slices), slices)
    here, right = row * slices + column, row * slices + (column + 1) % slices
    faces = numpy.concatenate(
        [numpy.stack([here, right, right + slices], 1), numpy.stack([here, right + slices, here + slices], 1)]
    )
    return limber3d.Model(grid * (1 + bumps[:, None]), faces)


def models() -> tuple[limber3d.Model, limber3d.Model]:
    return bumpy_ball(256, 160), bumpy_ball(300, 140)


def matrices(count: int, nearest: float, farthest: float) -> Any:
    """Random turns, at distances between the two."""
    rng = numpy.random.default_rng(41)
    w, x, y, z = (q := rng.normal(size=(4, count))) / numpy.sqrt((q * q).sum(0))
    poses = numpy.zeros((count, 4, 4))
    poses[:, 0, :3] = numpy.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1)
    poses[:, 1, :3] = numpy.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1)
    poses[:, 2, :3] = numpy.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1)
    toward = rng.normal(size=(count, 3))
    poses[:, :3, 3] = toward * (rng.uniform(nearest, farthest, count) / numpy.sqrt((toward**2).sum(1)))[:, None]
    poses[:, 3, 3] = 1
    return poses


class Cluster:
    """A scheduler and workers of one thread or more, each a process."""

    def __init__(self, folder: Path, workers: int, threads: int) -> None:
        self._folder = Path(tempfile.mkdtemp(dir=folder))
        self._threads = threads
        self.file = self._folder / "scheduler.json"
        self.scheduler = self._start("dask_scheduler", "--port", "0", "--no-dashboard")
        self.workers = [self.worker() for _ in range(workers)]
        self.client = DaskClient(scheduler_file=str(self.file))
        self.client.wait_for_workers(workers)

    def worker(self) -> psutil.Popen:
        options = ("--no-nanny", "--no-dashboard", "--local-directory", str(self._folder))
        return self._start("dask_worker", "--nthreads", str(self._threads), *options)

    def close(self) -> None:
        self.client.close()
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()

    def _start(self, program: str, *options: str) -> psutil.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--scheduler-file", str(self.file), *options]
        with (self._folder / "log").open("ab") as log:
            return psutil.Popen(command, stdout=log, stderr=log)


def processor_s(process: Any) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def seconds(call: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


def same_bits(a: Any, b: Any) -> bool:
    return a.dtype == b.dtype and all(a[name].tobytes() == b[name].tobytes() for name in a.dtype.names)


def overhead(folder: Path, poses: Any, rounds: int, expected: Any) -> list[str]:
    """Rows of a table: one process, and clusters with as many threads, in turn."""
    a, b = models()
    layouts = {"1 worker": (1, CORES), f"{CORES} workers": (CORES, 1)}
    clusters = {name: Cluster(folder, *layout) for name, layout in layouts.items()}
    found: dict[str, list[float]] = {name: [] for name in ("one process", "this process, to Parquet", *layouts)}
    for i in range(-1, rounds):  # the first round warms up and does not count
        part = poses if i >= 0 else poses[:50_000]
        took, _ = seconds(lambda: limber3d.distance_many(a, b, poses_b=part))
        found["one process"] += [took] if i >= 0 else []
        for name in list(found)[1:]:
            client = clusters[name].client if name in clusters else None
            out = folder / f"{name} {i}"
            took, _ = seconds(lambda: batch.sweep(a, b, poses_b=part, out=out, executor=client, partition_size=SIZE))
            found[name] += [took] if i >= 0 else []
            if i >= 0 and not same_bits(batch.read(out), expected):
                raise SystemExit(f"{name}: other answers than one process")
            shutil.rmtree(out)
    for cluster in clusters.values():
        cluster.close()
    rows = []
    for name, times in found.items():
        ratios = [ours / theirs for ours, theirs in zip(times, found["one process"])]
        threads = f" of {layouts[name][1]} threads" if name in layouts else ""
        rows.append(
            f"| {name}{threads} | {min(times):.2f} | {statistics.median(times):.2f} | {max(times):.2f} "
            f"| {100 * (statistics.median(ratios) - 1):+.1f} % |"
        )
    return rows


def killed(folder: Path, poses: Any, expected: Any) -> str:
    """A worker is killed at a quarter of the partitions, the client at half. Both are started again."""
    cluster = Cluster(folder, CORES, 1)
    out, file = folder / "killed", folder / "poses.npy"
    numpy.save(file, poses)
    count = -(-len(poses) // SIZE)
    command = [sys.executable, __file__, "--client", str(cluster.file), str(file), str(out)]

    def finished() -> int:
        return len(list(out.glob("part-*")))

    client = subprocess.Popen(command)
    while finished() < count // 4:
        time.sleep(0.01)
    cluster.workers[0].send_signal(signal.SIGKILL)
    at_worker = finished()
    cluster.workers.append(cluster.worker())
    while finished() < count // 2:
        time.sleep(0.01)
    client.send_signal(signal.SIGKILL)
    at_client = finished()
    took, ended = seconds(lambda: subprocess.run(command, check=True, capture_output=True, text=True))
    cluster.close()
    if not same_bits(batch.read(out), expected):
        raise SystemExit("killed: other answers than one process")
    return (
        f"A worker was killed when {at_worker} of {count} partitions were done, the client when {at_client} were. The next "
        f"client found {ended.stdout.strip()} partitions, finished in {took:.1f} s, and all answers are equal to the bit."
    )


def run_client(scheduler: str, poses: str, out: str) -> None:
    a, b = models()
    with DaskClient(scheduler_file=scheduler) as client:
        report = batch.sweep(a, b, poses_b=numpy.load(poses), out=out, executor=client, partition_size=SIZE)
    print(report.found)


def costs(folder: Path) -> list[tuple[str, float, float, float]]:
    """For tasks of one pose, and of SIZE poses: milliseconds of client, scheduler and workers for each partition, where
    queries cost almost nothing. What the client does once for all poses is left out."""
    vertices, faces = numpy.eye(3), numpy.array([[0, 1, 2]], numpy.uint32)
    a = limber3d.Model(vertices, faces)
    cluster = Cluster(folder, CORES, 1)
    found: list[tuple[str, float, float, float]] = []
    for name, count, size in (("1", SMALL_TASKS, 1), (f"{SIZE:,}", LIGHT_PARTITIONS, SIZE)):
        poses = matrices(count * size, 3, 9)
        out = folder / f"light {size}"
        processes = [psutil.Process(), cluster.scheduler, *cluster.workers]
        for attempt in range(2):  # the second finds everything: what is left is what the client does once
            before = [processor_s(process) for process in processes]
            batch.sweep(a, a, poses_b=poses, out=out, executor=cluster.client, partition_size=size, query="collide")
            now = [1000 * (processor_s(process) - then) / count for process, then in zip(processes, before)]
            if attempt == 0:
                spent = now
            else:
                found.append((name, spent[0] - now[0], spent[1], sum(spent[2:])))
        shutil.rmtree(out)
    cluster.close()
    return found


def once_s(folder: Path, poses: Any) -> float:
    """Seconds that a client spends once for all poses: they are checked, named by their content, and found done."""
    a, b = models()
    batch.sweep(a, b, poses_b=poses, out=folder / "once", partition_size=SIZE)
    return seconds(lambda: batch.sweep(a, b, poses_b=poses, out=folder / "once", partition_size=SIZE))[0]


def scaling(pose_us: float, client_ms: float, scheduler_ms: float) -> list[str]:
    """Rows of a table: workers answer partitions, and neither client nor scheduler is faster than it was measured."""
    task_ms, serial_ms = SIZE * pose_us / 1000, max(client_ms, scheduler_ms)
    rows = []
    for threads in (2, 8, 32, 128, 512):
        each_ms = max(task_ms / threads, serial_ms)
        rows.append(f"| {threads} | {1e9 / SIZE * each_ms / 1000:,.0f} | {100 * task_ms / threads / each_ms:.0f} % |")
    rows += ["", f"Client or scheduler are busy all the time from {task_ms / serial_ms:.0f} threads on."]
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=Path, help="folder for python_cluster.md")
    parser.add_argument("--client", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.client:
        run_client(*arguments.client)
        return 0
    with ExitStack() as owned:
        folder = Path(owned.enter_context(tempfile.TemporaryDirectory(dir=arguments.out)))
        poses = matrices(arguments.poses, 1.5, 4)
        one_s, expected = seconds(lambda: limber3d.distance_many(*models(), poses_b=poses))
        pose_us = 1e6 * one_s * CORES / len(poses)
        text = [
            f"# {len(poses):,} poses on Dask next to one process",
            "",
            f"{CORES} cores, {100 * (expected['upper'] == 0).mean():.0f} % of the poses overlap, partitions of {SIZE:,} "
            f"poses. All answers are equal to the bit.",
            "",
            "| | least, s | median, s | most, s | next to one process |",
            "|:--|--:|--:|--:|--:|",
            *overhead(folder, poses, arguments.rounds, expected),
            "",
            killed(folder, poses, expected),
            "",
            "Processor time for each partition, queries left out:",
            "",
            "| poses of a partition | client, ms | scheduler, ms | worker, ms |",
            "|--:|--:|--:|--:|",
        ]
        measured = costs(folder)
        text += [f"| {name} | {a:.1f} | {b:.1f} | {c:.1f} |" for name, a, b, c in measured]
        part = poses[: min(len(poses), 200_000)]
        text += [
            "",
            f"The client spends {once_s(folder, part) / len(part) * 1e6:.2f} s a million poses once, before the first "
            f"partition. A pose takes {pose_us:.0f} us of one thread, a partition {SIZE * pose_us / 1000:.0f} ms.",
            "",
            "So a billion poses would take, if workers stay as fast and the network is no limit:",
            "",
            "| threads of workers | s | efficiency |",
            "|--:|--:|--:|",
            *scaling(pose_us, *measured[1][1:3]),
        ]
    page = "\n".join(text) + "\n"
    print(page)
    if arguments.out is not None:
        (arguments.out / "python_cluster.md").write_text(page)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
