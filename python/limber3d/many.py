# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many queries in one call, on all processors."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from contextlib import contextmanager
from typing import Any

import numpy

from . import _core
from .results import ManyContacts
from .typing import ArrayLike, ObjectFilter, PosesLike, RecordArray

_LEAST_SECONDS, _MOST_SECONDS = 0.03, 0.12  # of one part of a batch: how soon Ctrl-C ends it


class BatchInterrupted(KeyboardInterrupt):
    """Ctrl-C during a batch. `results` are those that were done: what the call would have returned for the first
    `count` of its poses or frames."""

    def __init__(self, results: Any, count: int) -> None:
        super().__init__(f"interrupted after {count} results")
        self.results = results
        self.count = count

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.results, self.count)


@contextmanager
def progress_bar(count: int | None, is_wanted: bool) -> Generator[Callable[[int], object], None, None]:
    """What to tell of progress: tqdm, if that is wanted and installed."""
    if is_wanted:
        try:
            tqdm = importlib.import_module("tqdm.auto")
        except ImportError:
            pass
        else:
            with tqdm.tqdm(total=count) as bar:
                yield bar.update
            return
    yield lambda done: None


@contextmanager
def _keeping(results: Callable[[], Any]) -> Generator[None, None, None]:
    """Ctrl-C keeps what is done until then."""
    try:
        yield
    except KeyboardInterrupt:
        done = results()
        raise BatchInterrupted(done, len(done)) from None


def _parts(count: int, is_shown: bool) -> Iterator[tuple[int, int]]:
    """Ranges that make up 0 to count, of a length that takes about a tenth of a second each."""
    with progress_bar(count, is_shown) as advance:
        begin, size = 0, 16
        while begin < count:
            end = min(begin + size, count)
            start = time.perf_counter()
            yield begin, end
            elapsed = time.perf_counter() - start
            advance(end - begin)
            begin = end
            if elapsed < _LEAST_SECONDS:
                size *= 4
            elif elapsed > _MOST_SECONDS:
                size = max(1, size // 2)


def _records(
    batch: _core.Batch | _core.SceneBatch,
    dtype: numpy.dtype[numpy.void],
    is_shown: bool,
    ask: Callable[..., None],
    *options: Any,
) -> RecordArray:
    """The records of all poses: ask(records, begin, end, *options) writes those of a part."""
    count = 1 if batch.size is None else batch.size
    records = numpy.zeros(count, dtype)
    done = 0
    with _keeping(lambda: records[:done]):
        for begin, end in _parts(count, is_shown):
            ask(records[begin:end], begin, end, *options)
            done = end
    return records


def records_of(parts: list[RecordArray], dtype: numpy.dtype[numpy.void]) -> RecordArray:
    """One array of all parts. NumPy by itself would pack them: their element type would be another."""
    records = numpy.zeros(sum(map(len, parts)), dtype)
    return numpy.concatenate(parts, out=records) if parts else records


def distance_many(
    a: _core.Body,
    b: _core.Body,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    relative_error: float = 0.0,
    absolute_error: float = 0.0,
    max_distance: float = float("inf"),
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """distance() for many poses.

    Shape    Poses of a or b are n poses, or one for all. The result is an array of n records, limber3d.distance_dtype.
    Promise  Record i holds what distance() answers for poses i, to the bit, on any number of threads. Without a witness
             its triangles are 2^32 - 1 and its points are not numbers.
    Budget   The deadline and the flag are those of the whole call, a number of steps is that of each pose. Poses that
             are asked after the deadline make one step each.
    Raises   ValueError as distance(), before anything is asked where a pose is malformed; BatchInterrupted, a
             KeyboardInterrupt, which holds the records that were done.
    Threads  At most `threads`, 1 to 4096, all if that is None, without the GIL; see set_thread_limit(). One is the caller's: with
             threads=1 it does all the work. With progress, tqdm shows it where that is installed.
    """
    batch = _core.Batch(a, b, poses_a, poses_b, threads)
    options = relative_error, absolute_error, max_distance, budget
    return _records(batch, _core.distance_dtype, progress, batch.distance, *options)


def collide_many(
    a: _core.Body,
    b: _core.Body,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """collide() for many poses: an array of records, limber3d.collide_dtype. Everything else is as distance_many()
    says."""
    batch = _core.Batch(a, b, poses_a, poses_b, threads)
    return _records(batch, _core.collide_dtype, progress, batch.collide, budget)


def within_many(
    a: _core.Body,
    b: _core.Body,
    max_distance: float,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """within() for many poses: an array of records, limber3d.collide_dtype. Everything else is as distance_many()
    says."""
    batch = _core.Batch(a, b, poses_a, poses_b, threads)
    return _records(batch, _core.collide_dtype, progress, batch.within, max_distance, budget)


def contacts_many(
    a: _core.Body,
    b: _core.Body,
    margin: float,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    filter: _core.NeighborRings | None = None,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> ManyContacts:
    """contacts() for many poses.

    Promise  Those of pose i, [i] of the result, are those that contacts() finds, in that order, to the bit.
    Budget   What it leaves out is missing at the end: the contacts are those of the first poses.
    Raises, Threads   As distance_many().
    """
    batch = _core.Batch(a, b, poses_a, poses_b, threads)
    found = numpy.zeros(0, _core.contact_dtype)
    counts: list[Any] = [numpy.zeros(1, numpy.int64)]
    size = 0

    def joined() -> ManyContacts:
        offsets = numpy.cumsum(numpy.concatenate(counts), dtype=numpy.int64)
        found.resize(offsets[-1], refcheck=False)
        return ManyContacts(contacts=found, offsets=offsets)

    with _keeping(joined):
        for begin, end in _parts(1 if batch.size is None else batch.size, progress):
            part, of_each = batch.contacts(begin, end, margin, filter, budget)
            if size + len(part) > len(found):  # moves pages, where a list of parts would be copied at the end
                found.resize(max(size + len(part), len(found) * 5 // 4), refcheck=False)
            found[size : size + len(part)] = part
            counts.append(of_each)
            size += len(part)
            if len(of_each) < end - begin:
                break
    return joined()


def time_of_impact_many(
    a: _core.Body,
    b: _core.Body,
    starts_a: PosesLike = None,
    ends_a: PosesLike = None,
    starts_b: PosesLike = None,
    ends_b: PosesLike = None,
    *,
    center_a: ArrayLike | None = None,
    center_b: ArrayLike | None = None,
    max_time: float = 1.0,
    min_separation: float = 0.0,
    distance_error: float | None = None,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """time_of_impact() of two rigid bodies for many motions: RigidMotion(starts_a[i], ends_a[i], center_a) of a, and
    likewise of b.

    Shape    Starts and ends are n poses each, or one for all; without ends a body stands still. A center is one point
             of the model for all its motions, (3,); its origin if that is None. The result is an array of n records,
             limber3d.path_impact_dtype, whose fields have the names of PathImpact and Witness.
    Promise  Record i holds what time_of_impact() answers for motions i, to the bit, on any number of threads. Without a
             witness its triangles are 2^32 - 1 and its points are not numbers.
    Raises   ValueError as RigidMotion and time_of_impact(), before anything is asked where a pose is malformed;
             BatchInterrupted, which holds the records that were done.
    Threads  As distance_many().
    """
    batch = _core.MotionBatch(a, b, starts_a, ends_a, starts_b, ends_b, center_a, center_b, threads)
    options = max_time, min_separation, distance_error, budget
    return _records(batch, _core.path_impact_dtype, progress, batch.time_of_impact, *options)


def min_distance_many(
    a: _core.Body,
    b: _core.Body,
    starts_a: PosesLike = None,
    ends_a: PosesLike = None,
    starts_b: PosesLike = None,
    ends_b: PosesLike = None,
    *,
    center_a: ArrayLike | None = None,
    center_b: ArrayLike | None = None,
    max_time: float = 1.0,
    distance_error: float | None = None,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """min_distance() for many motions: an array of records, limber3d.path_distance_dtype. Everything else is as
    time_of_impact_many() says."""
    batch = _core.MotionBatch(a, b, starts_a, ends_a, starts_b, ends_b, center_a, center_b, threads)
    return _records(batch, _core.path_distance_dtype, progress, batch.min_distance, max_time, distance_error, budget)


def closest_objects_many(
    scene: _core.Scene,
    ids: ArrayLike,
    poses: PosesLike,
    *,
    filter: ObjectFilter = None,
    relative_error: float = 0.0,
    absolute_error: float = 0.0,
    max_distance: float = float("inf"),
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """Scene.closest_objects() of many configurations, such as those of a robot. The scene does not change.

    Shape    ids are k objects; poses are (n, k, 4, 4), or a tuple of rotations (n, k, 3, 3) or quaternions (n, k, 4)
             and translations (n, k, 3): in configuration i, ids[j] is at poses[i, j], and all other objects are where
             they were at the last commit. The result is an array of n records, limber3d.closest_objects_dtype:
             object_a and object_b, and the fields of distance_dtype.
    Promise  Record i holds what closest_objects() would answer, to the bit, had set_poses() and commit() placed the
             objects so; on any number of threads. Without a witness objects and triangles are 2^32 - 1.
    Budget   Configurations that are left when time is up have status `interrupted`, lower 0 and upper infinity.
    Raises   ValueError as set_poses() and closest_objects(), before anything is asked where a pose is malformed;
             BatchInterrupted, which holds the records that were done.
    Threads  As distance_many(). A filter that is a function is called before, once for every two objects.
    """
    batch = _core.SceneBatch(scene, ids, poses, filter, threads)
    options = relative_error, absolute_error, max_distance, budget
    return _records(batch, _core.closest_objects_dtype, progress, batch.closest_objects, *options)


def any_within_many(
    scene: _core.Scene,
    ids: ArrayLike,
    poses: PosesLike,
    max_distance: float,
    *,
    filter: ObjectFilter = None,
    budget: _core.QueryBudget | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> RecordArray:
    """Scene.any_within() of many configurations: an array of records, limber3d.any_within_dtype. Field `is_yes` is
    true where two objects are within the distance, `answer` an Answer: undecided where the budget was spent. Everything
    else is as closest_objects_many() says."""
    batch = _core.SceneBatch(scene, ids, poses, filter, threads)
    return _records(batch, _core.any_within_dtype, progress, batch.any_within, max_distance, budget)


def track(
    model: _core.Model,
    frames: Iterable[ArrayLike],
    other: _core.Body,
    poses: PosesLike = None,
    poses_other: PosesLike = None,
    *,
    relative_error: float = 0.0,
    absolute_error: float = 0.0,
    max_distance: float = float("inf"),
    budget: _core.QueryBudget | None = None,
    progress: bool = False,
) -> RecordArray:
    """The distance from a model that deforms to another, frame by frame.

    For each frame, which is an array of all positions as move_all() takes it, the model is moved, committed and asked.
    It is left as the last frame has it.

    Shape    frames is any iterable, or an array (n, v, 3). Poses are one for each frame, or one for all. The result is
             an array of n records, limber3d.distance_dtype.
    Promise  Record i holds what distance() answers for frame i, to the bit.
    Budget   A number of steps is that of each frame. After the first answer that time or the flag has cut short, there
             are no more, and the model is left as that frame has it.
    Raises   As move_all() and distance_many(); ValueError if there are more frames than poses.
    """
    batch = _core.Batch(model, other, poses, poses_other)
    records: list[RecordArray] = []
    count = len(frames) if isinstance(frames, Sized) else None

    def joined() -> RecordArray:
        return records_of(records, _core.distance_dtype)

    with _keeping(joined), progress_bar(count, progress) as advance:
        for i, frame in enumerate(frames):
            if batch.size is not None and i >= batch.size:
                raise ValueError(f"frames: there are only {batch.size} poses")
            model.move_all(frame)
            model.commit()
            record = numpy.zeros(1, _core.distance_dtype)
            batch.distance(record, i, i + 1, relative_error, absolute_error, max_distance, budget)
            records.append(record)
            advance(1)
            if record["stopped_by"][0] in (_core.StoppedBy.deadline.value, _core.StoppedBy.cancel.value):
                break
    return joined()
