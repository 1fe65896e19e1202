# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches: the bits of one process, executors, errors of workers, and bad arguments."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes
import shared_batches
from limber3d import batch
from limber3d.batch import inputs, work
from limber3d.typing import RecordArray
from shared_batches import COUNT, PARTS, SIZE, same_bits


@pytest.mark.parametrize(
    ("query", "options"),
    [("distance", {"relative_error": 0.1, "max_distance": 2.0}), ("collide", {}), ("within", {"max_distance": 0.5})],
)
def test_a_folder_has_the_bits_of_one_call(
    tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model, query: Any, options: dict[str, Any]
) -> None:
    poses: dict[str, Any] = {"poses_a": shapes.random_poses(1, 530), "poses_b": shapes.random_poses(2, 530)}
    many = getattr(limber3d, f"{query}_many")(ball, tetra, **poses, **options)
    for size, partitions in ((100, 6), (1000, 1)):
        out = tmp_path / f"{size}"
        report = batch.sweep(ball, tetra, **poses, out=out, query=query, partition_size=size, **options)
        assert report == batch.Report(count=530, partitions=partitions, found=0)
        assert same_bits(batch.read(out), many)
    assert len(set(many["status" if query == "distance" else "is_yes"])) == (3 if query == "distance" else 2)


def test_parts_of_the_answers_can_be_read(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(3, 95)
    batch.sweep(ball, tetra, poses, out=tmp_path, partition_size=10)
    many = limber3d.distance_many(ball, tetra, poses)
    for begin, end in ((0, 95), (0, 1), (9, 11), (10, 20), (37, 93), (94, 95), (50, 50)):
        assert same_bits(batch.read(tmp_path, begin, end), many[begin:end])
    assert same_bits(batch.read(tmp_path, 90), many[90:])
    with pytest.raises(IndexError, match="got 0 and 96"):
        batch.read(tmp_path, 0, 96)


def test_all_forms_of_poses_are_taken(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(5, 60)
    turns, shifts = shapes.random_quaternions(5, 60, 2.0)
    forms: list[Any] = [poses, numpy.asfortranarray(poses), poses.tolist(), (poses[:, :3, :3], poses[:, :3, 3]),
                        (turns, shifts), (turns.tolist(), shifts.tolist()), poses[0], (turns[0], shifts[0]),
                        (poses[0, :3, :3], poses[0, :3, 3]), None, poses[:0]]  # fmt: skip
    for i, form in enumerate(forms):
        batch.sweep(ball, tetra, form, out=tmp_path / f"{i}", partition_size=7)
        assert same_bits(batch.read(tmp_path / f"{i}"), limber3d.distance_many(ball, tetra, form))
        batch.sweep(ball, tetra, form, poses[0], out=tmp_path / f"one {i}", partition_size=7)
        assert same_bits(batch.read(tmp_path / f"one {i}"), limber3d.distance_many(ball, tetra, form, poses[0]))


def test_models_that_have_moved_are_asked_as_they_are(
    tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model
) -> None:
    ball.move_all(ball.vertices * [1, 1, 2])
    with pytest.raises(ValueError, match="commit"):
        batch.sweep(ball, tetra, out=tmp_path)
    ball.commit()
    poses = shapes.random_poses(4, 50)
    batch.sweep(ball, tetra, poses, out=tmp_path)
    fresh = limber3d.Model(ball.vertices, ball.faces)
    assert same_bits(batch.read(tmp_path), limber3d.distance_many(fresh, tetra, poses))


def test_frames_are_tracked_in_partitions(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(8, 40)
    stretched = [ball.vertices * [1, 1 + 0.05 * i, 1] for i in range(40)]
    frames = numpy.stack(stretched).astype(numpy.float32)
    forms: list[Any] = [frames, list(frames)]
    for i, form in enumerate(forms):
        report = batch.track(ball, form, tetra, None, poses, out=tmp_path / f"{i}", partition_size=9, max_distance=2.0)
        assert report == batch.Report(count=40, partitions=5, found=0)
    answers = batch.read(tmp_path / "0")
    assert same_bits(answers, batch.read(tmp_path / "1"))
    for begin in range(0, 40, 9):
        part = slice(begin, min(begin + 9, 40))
        model = limber3d.Model(ball.vertices, ball.faces)
        tracked = limber3d.track(model, frames[part], tetra, None, poses[part], max_distance=2.0)
        assert same_bits(answers[part], tracked)
    whole = limber3d.track(ball, frames, tetra, None, poses, max_distance=2.0)
    # Trees of another history may find another of several pairs that are equally close up to rounding.
    for bound in ("lower", "upper"):
        numpy.testing.assert_allclose(answers[bound], whole[bound], rtol=1e-13)
    with pytest.raises(ValueError, match="there are 39, and 40 poses"):
        batch.track(ball, frames[1:], tetra, poses, out=tmp_path / "2")


def test_pairs_of_an_assembly(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    models = [ball, tetra, limber3d.Model(*shapes.ball(9, 7)), limber3d.Model(ball.vertices, ball.faces), tetra]
    turns, shifts = shapes.random_quaternions(6, 5, 1.5)
    poses: list[Any] = [(turns, shifts), shapes.random_poses(6, 5), None]
    for i, form in enumerate(poses):
        batch.pairs(models, form, out=tmp_path / f"{i}", partition_size=3)
        records = batch.read(tmp_path / f"{i}")
        ids = [(j, k) for j in range(5) for k in range(j + 1, 5)]
        assert len(records) == len(ids)
        for record, (j, k) in zip(records, ids):
            placed = [None if form is None else (turns[m], shifts[m]) if i == 0 else form[m] for m in (j, k)]
            single = limber3d.distance_many(models[j], models[k], *placed)
            assert same_bits(numpy.array([record], record.dtype), single)
    sent, _ = inputs.unpacked(inputs.Meshes(models).packed())
    assert len(sent) == 5 and len(set(map(id, sent))) == 3
    few = [[3, 0], [1, 2], [4, 4]]
    batch.pairs(models, poses[1], few, out=tmp_path / "few", query="collide")
    for record, (j, k) in zip(batch.read(tmp_path / "few"), few):
        assert record["is_yes"] == bool(limber3d.collide(models[j], models[k], poses[1][j], poses[1][k]))
    with pytest.raises(IndexError, match="ids of 5 models"):
        batch.pairs(models, None, [[0, 5]], out=tmp_path / "bad")
    with pytest.raises(ValueError, match="integers"):
        batch.pairs(models, None, [[0.0, 1.0]], out=tmp_path / "bad")
    with pytest.raises(ValueError, match="each of 5 models"):
        batch.pairs(models, shapes.random_poses(6, 4), out=tmp_path / "bad")
    sphere: Any = limber3d.Shape.sphere(1)
    with pytest.raises(TypeError, match="^b: a batch of files takes a Model; got Shape"):
        batch.sweep(ball, sphere, out=tmp_path / "bad")
    with pytest.raises(TypeError, match=r"^models\[1\]: a batch of files takes a Model"):
        batch.pairs([ball, sphere], out=tmp_path / "bad")


def test_content_is_told_apart() -> None:
    rows = numpy.arange(10_000.0).reshape(5000, 2)
    contents = [rows, rows.T, rows.reshape(2, 5000), rows.view(numpy.int64), rows[:4999], rows[:0], rows[0, 0]]
    for place in (0, 4095, 4096, 4999):
        contents.append(rows.copy())
        contents[-1][place, 1] += 1
    assert len({inputs.digest_of([array]) for array in contents}) == len(contents)
    assert inputs.digest_of([rows]) == inputs.digest_of([numpy.asfortranarray(rows)])


def test_bad_arguments_leave_no_folder(tmp_path: Path, ball: limber3d.Model) -> None:
    poses = shapes.random_poses(1, 20)
    skewed = poses.copy()
    skewed[7, 3, 3] = 2
    calls: list[tuple[str, dict[str, Any]]] = [
        (r"poses_b\[7\]: the last row", {"poses_b": skewed}),
        ("3 and 20 poses", {"poses_a": poses[:3], "poses_b": poses}),
        ("query: expected one of distance, collide, within; got 'near'", {"query": "near"}),
        ("relative_error: collide has no such option", {"query": "collide", "relative_error": 0.1}),
        ("max_distance: within needs it", {"query": "within"}),
        ("relative_error", {"relative_error": -1.0}),
        ("partition_size: expected at least 1, got 0", {"partition_size": 0}),
    ]
    for text, arguments in calls:
        with pytest.raises(ValueError, match=text):
            batch.sweep(ball, ball, out=tmp_path / "out", **arguments)
        assert not (tmp_path / "out").exists()
    with pytest.raises(TypeError, match="executor: expected None"):
        batch.sweep(ball, ball, out=tmp_path / "out", executor=3)
    assert not (tmp_path / "out").exists()


def test_threads_and_processes(tmp_path: Path, expected: RecordArray) -> None:
    with ThreadPoolExecutor(3) as threads:
        shared_batches.sweep(tmp_path / "threads", threads)
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as processes:
        shared_batches.sweep(tmp_path / "processes", processes)
        twin = processes.submit(copy.copy, shared_batches.models()[0]).result()  # models can be sent, too
        assert (twin.vertices == shared_batches.models()[0].vertices).all()
        # Another batch on the same processes: they must not take its models for those of the first.
        batch.sweep(
            *shared_batches.models()[::-1], shared_batches.poses(500), out=tmp_path / "swapped", executor=processes
        )
    assert same_bits(batch.read(tmp_path / "threads"), expected)
    assert same_bits(batch.read(tmp_path / "processes"), expected)
    swapped = limber3d.distance_many(*shared_batches.models()[::-1], shared_batches.poses(500))
    assert same_bits(batch.read(tmp_path / "swapped"), swapped)


def test_a_broken_pool_raises_and_the_next_call_goes_on(
    tmp_path: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    shared_batches.set_gate(out, 3)
    with monkeypatch.context() as patched, ThreadPoolExecutor(1) as aside:
        patched.setattr("limber3d.batch.running.run", shared_batches.gated_run)
        with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as processes:
            call = aside.submit(shared_batches.sweep, out, processes)
            shared_batches.wait_for(lambda: shared_batches.done(out) >= 3)
            multiprocessing.active_children()[0].kill()
            with pytest.raises(BrokenProcessPool):
                call.result()
    done = shared_batches.done(out)
    assert 3 <= done <= 4 and shared_batches.sweep(out).found == done
    assert same_bits(batch.read(out), expected)


class Counting:
    """An executor that is none of concurrent.futures; counts what is under way."""

    def __init__(self) -> None:
        self._inner = ThreadPoolExecutor(2)
        self._max_workers = 2
        self._lock = threading.Lock()
        self.most = self.count = self.begun = self.bytes = 0

    def submit(self, call: Callable[..., Any], *arguments: Any) -> Future[Any]:
        self._count(1)
        self.begun += 1
        self.bytes += len(pickle.dumps(arguments))
        self.most = max(self.most, self.count)
        future = self._inner.submit(call, *arguments)
        future.add_done_callback(self._ended)
        return future

    def _ended(self, _: Future[Any]) -> None:
        self._count(-1)

    def _count(self, change: int) -> None:
        with self._lock:
            self.count += change


def test_few_partitions_are_under_way_and_models_are_not_sent_with_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    counting, unpacked = Counting(), list[int]()

    def unpack(data: bytes) -> work.Prepared:
        unpacked.append(len(data))
        return inputs.unpacked(data)

    monkeypatch.setattr("limber3d.batch.work.unpacked", unpack)
    shared_batches.sweep(tmp_path, counting, COUNT - 1)
    assert counting.most <= 6 and counting.begun == PARTS
    assert len(unpacked) == 1 and counting.bytes / PARTS < 20_000 < unpacked[0]
    assert same_bits(batch.read(tmp_path), shared_batches.expected(COUNT - 1))


def test_workers_that_do_not_see_the_folder_send_their_files(
    tmp_path: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "elsewhere"
    sent: list[int] = []

    def run(task: work.Task, meshes: bytes | str) -> bytes | None:
        moved = work.Batch(**(vars(task.batch) | {"folder": str(elsewhere)}))
        data = work.run(work.Task(moved, task.index, task.first_row, task.part), meshes)
        assert data is not None
        sent.append(task.index)
        return data

    # The same path elsewhere, with a folder of the same batch that another client has opened.
    shared_batches.sweep(elsewhere)
    for path in elsewhere.glob("part-*"):
        path.unlink()
    monkeypatch.setattr("limber3d.batch.running.run", run)
    shared_batches.sweep(tmp_path / "here")
    assert len(sent) == PARTS and shared_batches.done(elsewhere) == 0
    assert same_bits(batch.read(tmp_path / "here"), expected)


def test_errors_of_workers_are_raised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(task: work.Task, meshes: bytes | str) -> bytes | None:
        if task.index == 5:
            raise OSError("disk full")
        return work.run(task, meshes)

    with monkeypatch.context() as patched:
        patched.setattr("limber3d.batch.running.run", run)
        with pytest.raises(OSError, match="disk full"):
            shared_batches.sweep(tmp_path)
    assert shared_batches.done(tmp_path) < PARTS
    task = work.Task(work.Batch("", "sweep", None, "0.0.1", str(tmp_path), ""), 0, 0, None)  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="asked for by 0.0.1"):
        work.run(task, b"")


def test_ctrl_c_ends_a_batch_which_goes_on(
    tmp_path: Path, expected: RecordArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_: float) -> None:
        if shared_batches.done(tmp_path) >= 3:
            raise KeyboardInterrupt

    totals = list[Any]()
    shapes.tell_progress(monkeypatch, totals, interrupt)
    # Two threads: many could have answered all parts before the bar is told of three.
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    a, b = shared_batches.models()
    with pytest.raises(KeyboardInterrupt):
        batch.sweep(a, b, poses_b=shared_batches.poses(), out=tmp_path, partition_size=SIZE, progress=True)
    done = shared_batches.done(tmp_path)
    assert totals == [COUNT] and 3 <= done < PARTS and shared_batches.sweep(tmp_path).found == done
    assert same_bits(batch.read(tmp_path), expected)


def test_pyarrow_is_asked_for_by_name(tmp_path: Path, ball: limber3d.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"limber3d.batch needs pyarrow: pip install limber3d\[cluster\]"):
        batch.sweep(ball, ball, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_importing_the_package_imports_no_optional_one() -> None:
    code = "import sys, limber3d.batch; print({'pyarrow', 'dask', 'distributed'} & set(sys.modules))"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "set()"
