# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches: the bits of one process, on threads and on Dask; kills, Ctrl-C, damage, and bad arguments."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import dask.config
import distributed
import limber3d
import numpy
import pyarrow.parquet  # type: ignore[import-untyped]
import pytest
import shapes
from limber3d import batch
from limber3d.typing import RecordArray
from shapes import same_bits

COUNT, SIZE, PARTS = 2400, 100, 24  # poses, those of a partition, partitions
DaskClient: Any = distributed.Client  # has no types
LocalCluster: Any = distributed.LocalCluster
original_answer = batch._answer


def models() -> tuple[limber3d.Model, limber3d.Model]:
    return limber3d.Model(*shapes.ball(40, 30)), limber3d.Model(*shapes.ball(64, 48))


def sweep(out: Path | str, executor: Any = None, **options: Any) -> batch.Report:
    poses = shapes.random_poses(20, COUNT, 1.0)
    return batch.sweep(*models(), poses_b=poses, out=out, executor=executor, partition_size=SIZE, **options)


@pytest.fixture(scope="module")
def expected() -> RecordArray:
    """What one process answers to sweep()."""
    return limber3d.distance_many(*models(), poses_b=shapes.random_poses(20, COUNT, 1.0))


def done(out: Path) -> int:
    """Partitions that are finished."""
    return len(list(out.glob("part-*.parquet")))


def wait_for(condition: Callable[[], bool]) -> None:
    """Waits for what another process is to do."""
    deadline = time.monotonic() + 60
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError("waited in vain")
        time.sleep(0.005)


def gated_answer(*arguments: Any) -> RecordArray:
    """A partition. Workers wait while there are as many as the file GATE says."""
    if gate := os.environ.get("GATE"):
        wait_for(lambda: done(Path(gate).parent) < int(Path(gate).read_text()))
    return original_answer(*arguments)


@pytest.fixture
def gated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder whose batch is held when three partitions are done."""
    (tmp_path / "out").mkdir()
    monkeypatch.setenv("GATE", str(tmp_path / "out" / "gate"))
    monkeypatch.setattr(batch, "_answer", gated_answer)
    set_gate(tmp_path / "out", 3)
    return tmp_path / "out"


def set_gate(out: Path, count: int) -> None:
    (out / "_gate").write_text(str(count))
    (out / "_gate").replace(out / "gate")


@pytest.fixture
def cluster(gated: Path) -> Iterator[Any]:
    """Two workers that are processes. When one is killed another is started."""
    timeout = {"distributed.comm.timeouts.connect": "5s"}  # how long Dask looks for one that is lost
    with dask.config.set(timeout), LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        yield cluster


def test_rotations_of_scipy_are_poses(tmp_path: Path) -> None:
    rotations = pytest.importorskip("scipy.spatial.transform").Rotation.from_rotvec([[0, 0, 0.5], [0.1, 0.2, 0.3]])
    shifts = numpy.array([[3.0, 0, 0], [0, 4.0, 0]])
    for n, poses in enumerate([(rotations, shifts), rotations]):
        batch.sweep(*models(), poses_b=poses, out=tmp_path / str(n))
        assert same_bits(batch.read(tmp_path / str(n)), limber3d.distance_many(*models(), poses_b=poses))


def test_a_client_that_was_killed_goes_on_where_it_was(
    gated: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = f"import test_batch as t; t.batch._answer = t.gated_answer; t.sweep({str(gated)!r})"
    paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    client = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": paths})
    wait_for(lambda: done(gated) >= 3)
    client.kill()
    client.wait()
    with pytest.raises(ValueError, match=f"of {PARTS} partitions in .*, some are missing"):
        batch.read(gated)
    times = {path: path.stat().st_mtime_ns for path in gated.glob("part-*")}
    monkeypatch.undo()
    assert sweep(gated) == batch.Report(COUNT, PARTS, len(times)) and same_bits(batch.read(gated), expected)
    assert len(times) < PARTS and all(path.stat().st_mtime_ns == then for path, then in times.items())


def test_workers_that_were_killed_lose_nothing(gated: Path, cluster: Any, expected: RecordArray) -> None:
    with DaskClient(cluster) as client:

        def kill_workers() -> None:
            for count, victims in ((3, 1), (8, 2)):
                set_gate(gated, count)
                wait_for(lambda: done(gated) >= count)
                for process in list(client.run(os.getpid).values())[:victims]:
                    os.kill(process, signal.SIGKILL)
            assert done(gated) < PARTS
            set_gate(gated, PARTS)

        with ThreadPoolExecutor(1) as thread:
            killing = thread.submit(kill_workers)
            assert sweep(gated, client) == batch.Report(COUNT, PARTS, 0)
            killing.result()
    assert same_bits(batch.read(gated), expected)


def test_a_lost_scheduler_is_told_and_the_next_call_goes_on(
    gated: Path, cluster: Any, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    with DaskClient(cluster) as client, ThreadPoolExecutor(1) as thread:
        asked = thread.submit(sweep, gated, client)
        wait_for(lambda: done(gated) >= 3)
        cluster.close()
        with pytest.raises(ConnectionError, match="the same call goes on"):
            asked.result()
        with pytest.raises(ConnectionError, match="the same call goes on"):
            sweep(gated, client)
    monkeypatch.undo()
    found = done(gated)
    assert 3 <= found < PARTS and sweep(gated).found == found and same_bits(batch.read(gated), expected)


def test_frames_are_tracked_on_dask(cluster: Any, tmp_path: Path) -> None:
    a, b = models()
    frames = [a.vertices * (1 + 0.001 * i) for i in range(400)]
    assert sum(frame.nbytes for frame in frames) > 10e6  # which Dask finds large, and warns of
    with DaskClient(cluster) as client:
        for name, executor in (("here", None), ("there", client)):
            batch.track(a, frames, b, out=tmp_path / name, executor=executor, partition_size=400, max_distance=1.0)
    assert same_bits(batch.read(tmp_path / "here"), batch.read(tmp_path / "there"))


def test_ctrl_c_ends_a_batch_which_goes_on(
    tmp_path: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_: float) -> None:
        if done(tmp_path) >= 3:
            raise KeyboardInterrupt

    totals = list[Any]()
    shapes.tell_progress(monkeypatch, totals, interrupt)
    # Two threads: many could have answered all parts before the bar is told of three.
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    with pytest.raises(KeyboardInterrupt):
        sweep(tmp_path, progress=True)
    found = done(tmp_path)
    assert totals == [COUNT] and 3 <= found < PARTS and sweep(tmp_path).found == found
    assert same_bits(batch.read(tmp_path), expected)


def test_errors_are_raised_and_leave_no_half_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = pyarrow.parquet.write_table

    def full(table: Any, path: Path, **options: Any) -> None:
        write(table, path, **options)
        raise OSError("disk full")

    monkeypatch.setattr(pyarrow.parquet, "write_table", full)
    with pytest.raises(OSError, match="disk full"):
        sweep(tmp_path)
    assert not list(tmp_path.iterdir())
    with pytest.raises(RuntimeError, match="asked for by 0.0.1"):
        original_answer("0.0.1", batch._swept, [])


def test_few_partitions_are_under_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, most = list[Any](), list[int]()

    class Counting(ThreadPoolExecutor):
        def submit(self, *call: Any) -> Any:  # type: ignore[override]
            begun.append(call)
            most.append(len(begun) - done(tmp_path))
            return super().submit(*call)

    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(batch, "ThreadPoolExecutor", Counting)
    sweep(tmp_path)
    assert len(begun) == PARTS and max(most) <= 6
    assert len({id(models) for _, _, _, models, *_ in begun}) == 1


@pytest.mark.parametrize(
    ("query", "options"),
    [("distance", {"relative_error": 0.1, "max_distance": 2.0}), ("collide", {}), ("within", {"max_distance": 0.5})],
)
def test_a_folder_has_the_bits_of_one_call(
    tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model, query: Any, options: dict[str, Any]
) -> None:
    poses: dict[str, Any] = {"poses_a": shapes.random_poses(1, 530), "poses_b": shapes.random_poses(2, 530)}
    many = getattr(limber3d, f"{query}_many")(ball, tetra, **poses, **options)
    for size, partitions in ((100, 6), (None, 1)):
        out = tmp_path / f"{size}"
        report = batch.sweep(ball, tetra, **poses, out=out, query=query, partition_size=size, **options)
        assert report == batch.Report(count=530, partitions=partitions, found=0)
        assert same_bits(batch.read(out), many)
    assert len(set(many["status" if query == "distance" else "is_yes"])) == (3 if query == "distance" else 2)
    table: Any = pyarrow.parquet.read_table(tmp_path / "100")
    assert table.column("row").to_pylist() == list(range(530))
    assert table.column("point_a_y").to_numpy().tobytes() == many["point_a"][:, 1].tobytes()


def test_all_forms_of_poses_are_taken(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(5, 60)
    turns, shifts = shapes.random_quaternions(5, 60, 2.0)
    forms: list[Any] = [poses, numpy.asfortranarray(poses), poses.tolist(), (poses[:, :3, :3], poses[:, :3, 3]),
                        (turns, shifts), (turns.tolist(), shifts.tolist()), poses[0], (turns[0], shifts[0]),
                        (poses[0, :3, :3], poses[0, :3, 3]), None, poses[:0]]  # fmt: skip
    for i, form in enumerate(forms):
        for name, other in (("none", None), ("one", poses[0])):
            out = tmp_path / f"{name} {i}"
            batch.sweep(ball, tetra, form, other, out=out, partition_size=7)
            assert same_bits(batch.read(out), limber3d.distance_many(ball, tetra, form, other))


def test_frames_are_tracked_in_partitions(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    ball.move_all(ball.vertices * [1, 1, 2])
    with pytest.raises(ValueError, match="commit"):
        batch.sweep(ball, tetra, out=tmp_path)
    ball.commit()
    poses = shapes.random_poses(8, 40)
    frames = numpy.stack([ball.vertices * [1, 1 + 0.05 * i, 1] for i in range(40)]).astype(numpy.float32)
    buffer = numpy.empty_like(frames[0])
    refilled = (numpy.positive(frame, out=buffer) for frame in frames)

    class OnlyIterable:
        def __iter__(self) -> Iterator[Any]:
            return iter(frames)

    forms: list[Any] = [frames, list(frames), refilled, dict(enumerate(frames)).values(), OnlyIterable()]
    for found, form in zip((0, 5, 5, 5, 5), forms, strict=True):  # all are the same batch
        report = batch.track(ball, form, tetra, None, poses, out=tmp_path / "0", partition_size=9, max_distance=2.0)
        assert report == batch.Report(40, 5, found)
    answers = batch.read(tmp_path / "0")
    for begin in range(0, 40, 9):
        part = slice(begin, min(begin + 9, 40))
        fresh = limber3d.Model(ball.vertices, ball.faces)
        assert same_bits(answers[part], limber3d.track(fresh, frames[part], tetra, None, poses[part], max_distance=2.0))
    with pytest.raises(ValueError, match="there are 39, and 40 poses"):
        batch.track(ball, frames[1:], tetra, poses, out=tmp_path / "2")


def test_bad_arguments_leave_no_folder(
    tmp_path: Path, ball: limber3d.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = shapes.random_poses(1, 20)
    skewed = poses.copy()
    skewed[7, 3, 3] = 2
    calls: list[tuple[str, dict[str, Any]]] = [
        (r"poses_b\[7\]: the last row", {"poses_b": skewed}),
        ("3 and 20 poses", {"poses_a": poses[:3], "poses_b": poses}),
        ("query: expected one of distance, collide, within; got 'near'", {"query": "near"}),
        ("unexpected keyword argument 'relative_error'", {"query": "collide", "relative_error": 0.1}),
        ("relative_error", {"relative_error": -1.0}),
        ("partition_size: expected at least 1, got 0", {"partition_size": 0}),
        ("has no attribute", {"executor": 3}),
    ]
    for text, arguments in calls:
        with pytest.raises((ValueError, TypeError, AttributeError), match=text):
            batch.sweep(ball, ball, out=tmp_path / "out", **arguments)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match="pyarrow"):
        batch.sweep(ball, ball, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
    code = "import sys, limber3d.batch; print({'pyarrow', 'dask', 'distributed'} & set(sys.modules))"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout == "set()\n"


def test_the_folder_of_another_batch_is_refused(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(1, 20)
    batch.sweep(ball, tetra, poses, out=tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    other = poses.copy()
    other[19, 0, 3] = numpy.nextafter(other[19, 0, 3], 9)
    moved = limber3d.Model(numpy.nextafter(ball.vertices, 9), ball.faces)
    others: list[tuple[str, Any, Any, Any, dict[str, Any]]] = [
        ("given", ball, tetra, other, {}),
        ("models", moved, tetra, poses, {}),
        ("models", ball, ball, poses, {}),
        ("query", ball, tetra, poses, {"query": "collide"}),
        ("max_distance", ball, tetra, poses, {"max_distance": 1.0}),
        ("partition_size", ball, tetra, poses, {"partition_size": 7}),
    ]
    for name, a, b, placed, options in others:
        with pytest.raises(ValueError, match=f"out: .* is the folder of another batch, which has another {name}"):
            batch.sweep(a, b, placed, out=tmp_path, **options)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert batch.sweep(ball, tetra, poses, out=tmp_path).found == 1


def test_no_damage_goes_unnoticed(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    def ask() -> batch.Report:
        return batch.sweep(ball, tetra, shapes.random_poses(1, 200), out=tmp_path / "a", partition_size=100)

    with pytest.raises(FileNotFoundError):
        batch.read(tmp_path)
    ask()
    answers, path = batch.read(tmp_path / "a"), tmp_path / "a" / "part-00000001.parquet"
    whole, random, noticed = path.read_bytes(), numpy.random.default_rng(7), 0
    flips = [(place, 1 << random.integers(8)) for place in random.integers(len(whole), size=200).tolist()]
    changed = [bytes([*whole[:at], whole[at] ^ bit, *whole[at + 1 :]]) for at, bit in flips]
    others = [b"", whole[: len(whole) // 2], path.with_name("part-00000000.parquet").read_bytes()]
    for i, data in enumerate([*changed, *others]):
        path.write_bytes(data)
        try:
            assert same_bits(batch.read(tmp_path / "a"), answers)  # the damage is where nothing is read
        except ValueError as error:
            assert "of 2 partitions" in str(error)
            noticed += 1
            assert i % 20 or (ask().found == 1 and path.read_bytes() == whole)
    assert noticed > 150
    path.unlink()
    with pytest.raises(ValueError, match="missing or damaged"):
        batch.read(tmp_path / "a")
    (path.parent / "_left by a writer that was killed").write_bytes(b"PAR1")
    path.with_name("part-00000000 (1).parquet").write_bytes(path.with_name("part-00000000.parquet").read_bytes())
    assert ask().found == 1 and same_bits(batch.read(tmp_path / "a"), answers)
