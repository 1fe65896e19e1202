# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches on Dask: a scheduler and workers that are processes of their own, and some of which are killed."""

from __future__ import annotations

import asyncio
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import distributed
import limber3d
import numpy
import pytest
import shapes
import shared_batches
from limber3d import batch
from limber3d.command_line import main
from limber3d.typing import RecordArray
from shared_batches import PARTS, done, kill, same_bits, set_gate, wait_for

DaskClient: Any = distributed.Client  # has no types


class Cluster:
    """A scheduler, and workers of one thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.file = folder / "scheduler.json"
        self.workers: list[subprocess.Popen[bytes]] = []
        self.scheduler = self._start("dask_scheduler", "--port", "0", "--no-show")
        wait_for(self.file.exists)

    def add_worker(self) -> subprocess.Popen[bytes]:
        options = ("--nthreads", "1", "--no-nanny", "--local-directory", str(self._folder))
        self.workers.append(self._start("dask_worker", *options))
        return self.workers[-1]

    def client(self) -> Any:
        return DaskClient(scheduler_file=str(self.file))

    def remove_workers(self) -> None:
        while self.workers:
            kill(self.workers.pop())

    def _start(self, program: str, *options: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{program}", "--no-dashboard"]
        with (self._folder / "log").open("ab") as log:
            return subprocess.Popen(
                [*command, "--scheduler-file", str(self.file), *options],
                stdout=log, stderr=log, env=shared_batches.environment(),
            )  # fmt: skip


@contextmanager
def started(folder: Path) -> Iterator[Cluster]:
    cluster = Cluster(folder)
    try:
        yield cluster
    finally:
        cluster.remove_workers()
        kill(cluster.scheduler)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with started(tmp_path_factory.mktemp("dask")) as cluster:
        yield cluster


@pytest.fixture
def cluster(scheduler: Cluster) -> Iterator[Cluster]:
    """The scheduler of all tests, with workers of its own for each."""
    yield scheduler
    scheduler.remove_workers()


@pytest.fixture
def out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder whose batch is held when three partitions are done."""
    monkeypatch.setattr("limber3d.batch.running.run", shared_batches.gated_run)
    set_gate(tmp_path / "out", 3)
    return tmp_path / "out"


@contextmanager
def beside(call: Callable[[], object]) -> Iterator[None]:
    """Has another thread do something meanwhile, which must not fail."""
    with ThreadPoolExecutor(1) as thread:
        doing = thread.submit(call)
        yield
        doing.result()


def test_a_worker_and_the_client_are_killed(out: Path, cluster: Cluster, expected: RecordArray) -> None:
    worker = cluster.add_worker()
    cluster.add_worker()
    client = shared_batches.start_client(out, f"distributed.Client(scheduler_file={str(cluster.file)!r})")
    wait_for(lambda: done(out) >= 3)
    kill(client)

    def kill_worker() -> None:
        set_gate(out, 8)
        wait_for(lambda: done(out) >= 8)
        kill(worker)
        assert done(out) < PARTS
        set_gate(out, PARTS)

    with cluster.client() as other, beside(kill_worker):
        report = shared_batches.sweep(out, other)
    assert 3 <= report.found < PARTS and same_bits(batch.read(out), expected)


def test_all_workers_may_be_lost_and_others_come(out: Path, cluster: Cluster, expected: RecordArray) -> None:
    worker = cluster.add_worker()

    def replace_worker() -> None:
        wait_for(lambda: done(out) == 3)
        kill(worker)
        cluster.add_worker()
        set_gate(out, PARTS)

    with cluster.client() as client, beside(replace_worker):
        report = shared_batches.sweep(out, client)
    assert report.found == 0 and same_bits(batch.read(out), expected)


def test_a_lost_scheduler_is_told_and_the_next_call_goes_on(
    out: Path, tmp_path: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    with started(tmp_path) as cluster:
        cluster.add_worker()
        client = cluster.client()

        def kill_scheduler() -> None:
            wait_for(lambda: done(out) == 3)
            kill(cluster.scheduler)

        with beside(kill_scheduler), pytest.raises(ConnectionError, match="the same call goes on"):
            shared_batches.sweep(out, client)
        client.close(timeout=1)
    monkeypatch.undo()
    assert shared_batches.sweep(out).found == 3 and same_bits(batch.read(out), expected)


def test_the_program_asks_a_scheduler(tmp_path: Path, cluster: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    cluster.add_worker()
    monkeypatch.setattr("limber3d.batch.running.Pool", None)
    mesh, poses = str(shapes.write_obj(tmp_path / "a.obj", *shapes.ball(12, 8))), shapes.random_poses(3, 40)
    numpy.save(tmp_path / "poses.npy", poses)
    with cluster.client() as client:
        where = ["--scheduler", client.scheduler.address, "--out", str(tmp_path / "out")]
    assert main(["sweep", mesh, mesh, "--poses", str(tmp_path / "poses.npy"), "--partition-size", "9", *where]) == 0
    model = limber3d.load(mesh)
    assert same_bits(batch.read(tmp_path / "out"), limber3d.distance_many(model, model, poses_b=poses))


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


def test_models_are_sent_once(
    tmp_path: Path, cluster: Cluster, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    cluster.add_worker()
    sizes: list[int] = []
    with cluster.client() as client:
        submit = client.submit

        def counted(call: object, *arguments: Any, **options: object) -> object:
            sizes.append(sum(len(pickle.dumps(a)) for a in arguments if not isinstance(a, distributed.Future)))
            return submit(call, *arguments, **options)

        monkeypatch.setattr(client, "submit", counted)
        shared_batches.sweep(tmp_path, client)
    assert len(sizes) == 1 + PARTS and sizes[0] > 200_000 and max(sizes[1:]) < 20_000
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
    frames = [a.vertices.copy() for _ in range(800)]  # of one array, Dask would send one
    assert sum(frame.nbytes for frame in frames) > 20e6
    with cluster.client() as client:
        batch.track(a, frames, a, out=tmp_path, executor=client, partition_size=800, max_distance=1.0)
    assert (batch.read(tmp_path)["status"] == limber3d.DistanceStatus.collision).all()
