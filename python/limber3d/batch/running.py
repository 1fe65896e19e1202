# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""From the call of a batch to a folder that is complete."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from .. import _core
from ..many import progress_bar
from . import folder
from .extras import imported
from .jobs import Job
from .pools import DaskPool, Future, PlainPool, Pool, check_executor, is_dask_client, own_threads
from .queries import dtype_of
from .tables import read_parquet
from .work import Batch, Task, label_of

_FORMAT = 1  # of the folder
_PER_THREAD = 3  # partitions that are under way for each thread of the workers: one runs, the others are on their way
_CHECK_SECONDS = 2.0  # without an answer, after which the pool is looked at


@dataclass(frozen=True)
class Report:
    """What a batch has done."""

    count: int
    """Poses, frames or pairs."""
    partitions: int
    """Into which they were cut."""
    found: int
    """Partitions that earlier calls had finished."""


@dataclass(frozen=True)
class Request:
    """A batch that was asked for: what identifies it, and how to make its parts."""

    job: Job
    count: int
    described: dict[str, Any]
    meshes: Callable[[], bytes]
    part: Callable[[int, int], Any]
    usual_size: int  # of a partition


def batch_name(manifest: dict[str, Any]) -> str:
    """A name for what a manifest says."""
    return hashlib.sha256(json.dumps(manifest, sort_keys=True).encode()).hexdigest()


def ranges(count: int, size: int) -> list[tuple[int, int]]:
    """Begin and end of each partition."""
    return [(begin, min(begin + size, count)) for begin in range(0, count, size)]


def answer(request: Request, out: Path, executor: Any, partition_size: int | None, progress: bool) -> Report:
    """Answers what is missing in a folder. The errors of workers are raised; what was done stays done."""
    imported("pyarrow")
    check_executor(executor)
    manifest = {"format": _FORMAT, "version": _core.version, **request.described, "count": request.count}
    out = out.absolute()
    token, size = folder.open_folder(out, manifest, partition_size, request.usual_size)
    name = batch_name(manifest | {"partition_size": size})
    batch = Batch(name, request.job, _core.version, str(out), token)
    parts, dtype = ranges(request.count, size), dtype_of(request.job.query.name)
    missing = [
        i for i, (begin, end) in enumerate(parts)
        if read_parquet(out / folder.part_name(i), dtype, end - begin, label_of(name, i)) is None
    ]  # fmt: skip
    tasks = (Task(batch, i, parts[i][0], request.part(*parts[i])) for i in missing)
    with progress_bar(request.count, progress) as advance, ExitStack() as owned:
        advance(request.count - sum(parts[i][1] - parts[i][0] for i in missing))
        if missing:
            pool = _pool(executor, request.meshes(), out, owned)
            _run_all(pool, tasks, out, lambda task: advance(parts[task.index][1] - parts[task.index][0]))
    folder.remove_leftovers(out)
    return Report(request.count, len(parts), len(parts) - len(missing))


def _pool(executor: Any, meshes: bytes, out: Path, owned: ExitStack) -> Pool:
    if is_dask_client(executor):
        return DaskPool(executor, meshes)
    if executor is None:
        executor = owned.enter_context(own_threads())
    folder.write_whole(out / folder.MESHES, meshes)
    return PlainPool(executor, str(out / folder.MESHES))


def _run_all(pool: Pool, tasks: Iterator[Task], out: Path, done: Callable[[Task], object]) -> None:
    running: dict[Future, Task] = {}
    finished: SimpleQueue[Future] = SimpleQueue()
    try:
        while True:
            for task in islice(tasks, max(0, _PER_THREAD * max(1, pool.width()) - len(running))):
                future = pool.submit(task)
                running[future] = task
                future.add_done_callback(finished.put)
            if not running:
                return
            try:
                future = finished.get(timeout=_CHECK_SECONDS)
            except Empty:
                pool.check()
                continue
            task = running.pop(future)
            data = future.result()
            if data is not None:
                folder.write_whole(out / folder.part_name(task.index), data)
            done(task)
    except Exception as error:
        pool.explain(error)
        raise
    finally:
        for future in running:
            future.cancel()
