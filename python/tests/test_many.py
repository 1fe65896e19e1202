# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches: the bits of single calls, shapes, interruption, progress."""

from __future__ import annotations

import _thread
import functools
import os
import signal
import sys
import time
from collections.abc import Iterator
from typing import Any

import limber3d
import numpy
import pytest
from shapes import TETRA_FACES, TETRA_VERTICES, random_poses, random_quaternions, tell_progress


SINGLE_AND_MANY: list[tuple[Any, Any, list[float], dict[str, float]]] = [
    (limber3d.distance, limber3d.distance_many, [], {"relative_error": 0.1, "max_distance": 2.0}),
    (limber3d.collide, limber3d.collide_many, [], {}),
    (limber3d.within, limber3d.within_many, [0.5], {}),
]


@pytest.mark.parametrize(("single", "many", "arguments", "options"), SINGLE_AND_MANY)
def test_answers_of_many_poses_are_those_of_single_calls(
    ball: limber3d.Model, tetra: limber3d.Model, single: Any, many: Any, arguments: list[float], options: Any
) -> None:
    poses_a, poses_b = random_poses(1, 700), random_poses(2, 700)
    records = many(ball, tetra, *arguments, poses_a, poses_b, **options)
    kinds = set[object]()
    for record, pose_a, pose_b in zip(records, poses_a, poses_b):
        result = single(ball, tetra, *arguments, pose_a, pose_b, **options)
        if single is limber3d.distance:
            assert (record["lower"], record["upper"]) == (result.lower, result.upper)
            assert (record["status"], record["stopped_by"]) == (result.status, result.stopped_by)
            kinds.add(result.status)
        else:
            assert record["is_yes"] == bool(result)
            kinds.add(bool(result))
        witness = result.witness
        if witness is None:
            assert numpy.isnan(record["point_a"]).all() and record["triangle_a"] == record["triangle_b"] == 2**32 - 1
            continue
        assert (record["point_a"] == witness.point_a).all() and (record["point_b"] == witness.point_b).all()
        assert (record["triangle_a"], record["triangle_b"]) == (witness.triangle_a, witness.triangle_b)
    assert len(kinds) == (3 if single is limber3d.distance else 2) and records.shape == (700,)
    assert records.dtype == (limber3d.distance_dtype if single is limber3d.distance else limber3d.collide_dtype)


def test_contacts_of_many_poses_are_those_of_single_calls(ball: limber3d.Model) -> None:
    poses = random_poses(4, 200)
    rings = limber3d.NeighborRings(ball, 1)
    for filter in (None, rings):
        found = limber3d.contacts_many(ball, ball, 0.1, poses, filter=filter)
        assert found.contacts.dtype == limber3d.contact_dtype and found.offsets.dtype == numpy.int64
        assert found.offsets.shape == (201,) and found.offsets[-1] == len(found.contacts) > 0
        for contacts, pose in zip(found, poses, strict=True):
            single = limber3d.contacts(ball, ball, 0.1, pose, filter=filter)
            assert (contacts == single.records).all() and len(contacts) == len(single)
        assert (found[-1] == found[199]).all()
        with pytest.raises(IndexError):
            found[200]


def test_all_forms_of_poses_are_taken(ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = random_poses(5, 60)
    expected = limber3d.distance_many(ball, tetra, poses)
    forms: list[Any] = [
        poses[::-1].copy()[::-1],
        numpy.asfortranarray(poses),
        poses.tolist(),
        (poses[:, :3, :3], poses[:, :3, 3]),
    ]
    for form in forms:
        assert (limber3d.distance_many(ball, tetra, form) == expected).all()
    whole = numpy.tile(numpy.eye(4, dtype=int), (3, 1, 1))
    whole[:, 0, 3] = [2, 3, 4]
    upper = limber3d.distance_many(ball, tetra, whole.astype(float))["upper"]
    for dtype in ("i4", "i8", "u4", "u8"):
        parts = whole[:, :3, :3].astype(dtype), whole[:, :3, 3].astype(dtype)
        assert (limber3d.distance_many(ball, tetra, whole.astype(dtype))["upper"] == upper).all()
        assert (limber3d.distance_many(ball, tetra, parts)["upper"] == upper).all()
    turns, shifts = random_quaternions(5, 60, 2.0)
    assert numpy.allclose(limber3d.distance_many(ball, tetra, (turns, shifts))["upper"], expected["upper"])
    one = limber3d.distance_many(ball, tetra, poses[3], numpy.tile(numpy.eye(4), (5, 1, 1)))
    assert (one["upper"] == expected["upper"][3]).all() and one.shape == (5,)
    assert limber3d.distance_many(ball, tetra, (turns[0], shifts[0])).shape == (1,)
    assert limber3d.distance_many(ball, tetra).shape == (1,)
    assert limber3d.distance_many(ball, tetra, poses[:0]).shape == (0,)
    none = limber3d.contacts_many(ball, tetra, 0.1, poses[:0])
    assert len(none) == len(none.contacts) == 0 and none.offsets.tolist() == [0]


def test_bad_poses_are_named_by_their_index(ball: limber3d.Model) -> None:
    poses = random_poses(6, 10)
    poses[7, 3, 3] = 2
    with pytest.raises(ValueError, match=r"poses_b\[7\]: the last row"):
        limber3d.distance_many(ball, ball, poses_b=poses)
    with pytest.raises(ValueError, match="poses_a and poses_b: 10 and 3 poses"):
        limber3d.collide_many(ball, ball, random_poses(1, 10), poses[:3])
    with pytest.raises(ValueError, match=r"poses_a: .* got shape \(10, 3, 4\)"):
        limber3d.collide_many(ball, ball, random_poses(1, 10)[:, :3])
    with pytest.raises(ValueError, match=r"poses_a\[0\]: the matrix is not rigid"):
        limber3d.collide_many(ball, ball, (numpy.ones((2, 3, 3)), numpy.zeros((2, 3))))


def test_tracking_gives_the_answers_of_single_calls(tetra: limber3d.Model, ball: limber3d.Model) -> None:
    frames = TETRA_VERTICES + random_poses(7, 40, 4.0)[:, None, :3, 3]
    poses = random_poses(8, 40)
    answers = limber3d.track(tetra, iter(frames.astype(numpy.float32)), ball, poses, max_distance=9.0)
    assert answers.shape == (40,) and answers.dtype == limber3d.distance_dtype
    assert (tetra.vertices == frames[-1].astype(numpy.float32)).all()
    for frame, pose, record in zip(frames.astype(numpy.float32), poses, answers):
        moved = limber3d.Model(frame, TETRA_FACES)
        assert record["upper"] == limber3d.distance(moved, ball, pose, max_distance=9.0).upper
    assert limber3d.track(tetra, [], ball).shape == (0,)
    with pytest.raises(ValueError, match="only 2 poses"):
        limber3d.track(tetra, frames, ball, poses[:2])


def test_budgets_end_batches(ball: limber3d.Model) -> None:
    cancel, poses = limber3d.CancelFlag(), random_poses(5, 300, 0.5)
    cancel.set()
    few, late = limber3d.QueryBudget(max_steps=1), limber3d.QueryBudget(deadline=0.0)
    for budget in (few, late, limber3d.QueryBudget(cancel=cancel)):
        assert limber3d.collide_many(ball, ball, poses, budget=budget)["stopped_by"].any()
        assert limber3d.within_many(ball, ball, 0.1, poses, budget=budget)["stopped_by"].any()
        cut = limber3d.distance_many(ball, ball, poses, budget=budget)
        assert (cut["lower"] <= limber3d.distance_many(ball, ball, poses)["upper"]).all() and cut["stopped_by"].any()
        assert len(limber3d.contacts_many(ball, ball, 0.1, poses, budget=budget)) < 300
        for many in (limber3d.time_of_impact_many, limber3d.min_distance_many):
            assert many(ball, ball, poses[:9], poses[9:18], budget=budget)["distance_count"].max() <= 1
    assert len(limber3d.track(ball, [ball.vertices] * 9, ball, budget=few)) == 9
    assert len(limber3d.track(ball, [ball.vertices] * 9, ball, poses_other=poses[0], budget=late)) <= 1


def test_points_that_a_budget_leaves_out_are_the_last(ball: limber3d.Model) -> None:
    points, surface = numpy.random.default_rng(6).normal(size=(5000, 3)), limber3d.ClosedSurface(ball)
    for many in (functools.partial(limber3d.closest_point_many, ball), surface.contains_many, surface.signed_distance_many):
        whole, cut = many(points), many(points, budget=limber3d.QueryBudget(deadline=0.0))
        assert len(whole) == len(many(points, budget=limber3d.QueryBudget())) == 5000
        assert 0 < len(cut) < 5000 and (cut == whole[: len(cut)]).all()


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt, also where the shell has told its background jobs to ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_interruption_keeps_what_is_done(
    ball: limber3d.Model, interruptible: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = numpy.tile(random_poses(9, 1000), (300, 1, 1))
    expected = limber3d.distance_many(ball, ball, poses[:1000])
    original = limber3d.many._parts

    def interrupted_parts(count: int, is_shown: bool) -> Iterator[tuple[int, int]]:
        for i, part in enumerate(original(count, is_shown)):
            if i == 3:
                _thread.interrupt_main()  # Ctrl-C
            yield part

    monkeypatch.setattr(limber3d.many, "_parts", interrupted_parts)
    start = time.monotonic()
    with pytest.raises(limber3d.BatchInterrupted) as interrupted:
        limber3d.distance_many(ball, ball, poses)
    assert time.monotonic() - start < 5
    partial = interrupted.value
    assert isinstance(partial, KeyboardInterrupt) and 0 < partial.count < 300_000
    assert len(partial.results) == partial.count
    assert (partial.results[:1000] == expected[: partial.count]).all()


def test_interruption_keeps_contacts_and_frames(ball: limber3d.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupting() -> Iterator[Any]:
        for i in range(100):
            if i == 5:
                raise KeyboardInterrupt
            yield ball.vertices

    with pytest.raises(limber3d.BatchInterrupted) as interrupted:
        limber3d.track(ball, interrupting(), ball)
    assert interrupted.value.count == 5 and interrupted.value.results.shape == (5,)

    original = limber3d.many._parts

    def first_part_only(count: int, is_shown: bool) -> Iterator[tuple[int, int]]:
        yield next(original(count, is_shown))
        raise KeyboardInterrupt

    monkeypatch.setattr(limber3d.many, "_parts", first_part_only)
    with pytest.raises(limber3d.BatchInterrupted) as interrupted:
        limber3d.contacts_many(ball, ball, 0.1, random_poses(4, 200))
    found = interrupted.value.results
    assert interrupted.value.count == len(found) == 16 and found.offsets[-1] == len(found.contacts)


def test_progress_is_told_to_tqdm_if_there_is_one(ball: limber3d.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    totals, told, poses = list[Any](), list[int](), random_poses(9, 100)
    tell_progress(monkeypatch, totals, told.append)
    limber3d.distance_many(ball, ball, poses, progress=True)
    assert sum(told) == 100
    told.clear()
    limber3d.track(ball, [ball.vertices] * 3, ball, progress=True)
    assert told == [1, 1, 1] and totals == [100, 3]
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    assert len(limber3d.collide_many(ball, ball, poses, progress=True)) == 100


def test_answers_do_not_depend_on_the_number_of_threads(ball: limber3d.Model) -> None:
    poses = random_poses(10, 300)
    expected = limber3d.distance_many(ball, ball, poses)
    threads: Any
    for threads in (1, 2, numpy.int64(5), 4096):
        assert (limber3d.distance_many(ball, ball, poses, threads=threads) == expected).all()
    try:
        limber3d.set_thread_limit(1)
        assert (limber3d.distance_many(ball, ball, poses) == expected).all()
    finally:
        limber3d.set_thread_limit(None)


@pytest.mark.parametrize("count", [0, -1, 4097, 10**7, 10**9, 2**31 - 1, 2**31, 2**63, -(2**200)])
def test_numbers_of_threads_have_a_limit(ball: limber3d.Model, count: int) -> None:
    for _, many, arguments, _ in [*SINGLE_AND_MANY, (None, limber3d.contacts_many, [1.0], {})]:
        with pytest.raises(ValueError, match="threads: expected 1 to 4096, or None"):
            many(ball, ball, *arguments, threads=count)
    with pytest.raises(ValueError, match="count: expected 1 to 4096, or None"):
        limber3d.set_thread_limit(count)


def test_numbers_of_threads_are_whole(ball: limber3d.Model) -> None:
    wrong: Any
    for wrong in (1.5, "2", [1]):
        with pytest.raises(TypeError, match="cannot be interpreted as an integer"):
            limber3d.distance_many(ball, ball, threads=wrong)
        with pytest.raises(TypeError, match="cannot be interpreted as an integer"):
            limber3d.set_thread_limit(wrong)


@pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="one processor")
def test_with_one_thread_the_caller_does_all_the_work(ball: limber3d.Model) -> None:
    poses = random_poses(10, 20_000)
    start, own = time.process_time(), time.thread_time()
    limber3d.distance_many(ball, ball, poses, threads=1)
    start, own = time.process_time() - start, time.thread_time() - own
    assert own > 0.9 * start
