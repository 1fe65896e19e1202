# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches on Dask: a scheduler and workers that are processes of their own, and some of which are killed."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import distributed
import limber3d
import pytest
import shared_batches
from limber3d import batch
from limber3d.typing import RecordArray
from test_batch import same_bits

DaskClient: Any = distributed.Client  # has no types
WORKER = ("dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard")
CLIENT = """
import sys
import distributed
import shared_batches
shared_batches.sweep(sys.argv[1], distributed.Client(scheduler_file=sys.argv[2]), int(sys.argv[3]))
"""


class Cluster:
    """A scheduler and its workers."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "scheduler.json"
        self._folder = folder
        self._processes = [self._start("dask_scheduler", "--port", "0", "--no-dashboard", "--no-show")]
        self.workers: list[subprocess.Popen[bytes]] = []
        shared_batches.wait_for(self.file.exists)

    def add_worker(self) -> subprocess.Popen[bytes]:
        self.workers.append(self._start(*WORKER, "--local-directory", str(self._folder)))
        return self.workers[-1]

    def client(self) -> Any:
        return DaskClient(scheduler_file=str(self.file))

    def close(self) -> None:
        for process in [*self.workers, *self._processes]:
            shared_batches.kill(process)

    def kill_scheduler(self) -> None:
        shared_batches.kill(self._processes[0])

    def _start(self, program: str, *options: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--scheduler-file", str(self.file), *options]
        with (self._folder / "log").open("ab") as log:
            return subprocess.Popen(command, stdout=log, stderr=log)


@pytest.fixture
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    started = Cluster(tmp_path_factory.mktemp("dask"))
    yield started
    started.close()


@pytest.fixture(scope="module")
def expected() -> RecordArray:
    return shared_batches.expected()


def test_a_worker_and_the_client_are_killed(tmp_path: Path, cluster: Cluster, expected: RecordArray) -> None:
    first = cluster.add_worker()
    cluster.add_worker()
    client = shared_batches.start(CLIENT, tmp_path, cluster.file, shared_batches.COUNT)
    shared_batches.wait_for(lambda: shared_batches.done(tmp_path) >= 2, client)
    shared_batches.kill(client)
    done = shared_batches.done(tmp_path)
    assert 2 <= done < shared_batches.PARTS - 8
    with cluster.client() as other:
        killer = threading.Thread(target=_kill_later, args=(first, tmp_path, done + 6))
        killer.start()
        report = shared_batches.sweep(tmp_path, other)
        killer.join()
    assert done <= report.found < shared_batches.PARTS and first.poll() is not None
    assert same_bits(batch.read(tmp_path), expected)


def _kill_later(worker: subprocess.Popen[bytes], out: Path, done: int) -> None:
    shared_batches.wait_for(lambda: shared_batches.done(out) >= done)
    shared_batches.kill(worker)
    assert shared_batches.done(out) < shared_batches.PARTS


def test_all_workers_may_be_lost_and_others_come(tmp_path: Path, cluster: Cluster, expected: RecordArray) -> None:
    first = cluster.add_worker()

    def replace() -> None:
        _kill_later(first, tmp_path, 5)
        cluster.add_worker()

    replacer = threading.Thread(target=replace)
    replacer.start()
    with cluster.client() as client:
        report = shared_batches.sweep(tmp_path, client)
    replacer.join()
    assert report.found == 0 and same_bits(batch.read(tmp_path), expected)


def test_frames_and_pairs(tmp_path: Path, cluster: Cluster) -> None:
    cluster.add_worker()
    a, b = shared_batches.models()
    frames = [a.vertices * (1 + 0.01 * i) for i in range(20)]
    with cluster.client() as client:
        for name, executor in (("here", None), ("there", client)):
            batch.track(a, frames, b, out=tmp_path / f"track {name}", executor=executor, partition_size=3)
            models, poses = [a, b, a, b], shared_batches.poses(4)
            batch.pairs(models, poses, out=tmp_path / f"pairs {name}", executor=executor, partition_size=2)
    for kind, count in (("track", 20), ("pairs", 6)):
        answers = batch.read(tmp_path / f"{kind} there")
        assert len(answers) == count and same_bits(answers, batch.read(tmp_path / f"{kind} here"))


def test_a_lost_scheduler_is_told_and_the_next_call_goes_on(
    tmp_path: Path, cluster: Cluster, expected: RecordArray
) -> None:
    cluster.add_worker()

    def end() -> None:
        shared_batches.wait_for(lambda: shared_batches.done(tmp_path) >= 3)
        cluster.kill_scheduler()

    ender = threading.Thread(target=end)
    ender.start()
    client = cluster.client()
    try:
        with pytest.raises(ConnectionError, match="the same call goes on"):
            shared_batches.sweep(tmp_path, client)
    finally:
        client.close(timeout=1)
    ender.join()
    assert 3 <= shared_batches.sweep(tmp_path, None).found < shared_batches.PARTS
    assert same_bits(batch.read(tmp_path), expected)


def test_an_asynchronous_client_is_refused(tmp_path: Path, cluster: Cluster) -> None:
    async def ask() -> None:
        async with DaskClient(scheduler_file=str(cluster.file), asynchronous=True) as client:
            with pytest.raises(ValueError, match="not asynchronous"):
                shared_batches.sweep(tmp_path / "out", client)

    asyncio.run(ask())
    assert not (tmp_path / "out").exists()


def test_large_meshes_and_partitions_travel_without_warnings(tmp_path: Path, cluster: Cluster) -> None:
    cluster.add_worker()
    a, _ = shared_batches.models()
    frames = [a.vertices.repeat(1, 0)] * 800
    assert sum(frame.nbytes for frame in frames) > 20e6
    with cluster.client() as client:
        batch.track(a, frames, a, out=tmp_path, executor=client, partition_size=800, max_distance=1.0)
    assert (batch.read(tmp_path)["status"] == limber3d.Status.collision).all()
