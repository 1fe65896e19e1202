# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""From the call of a batch to a folder that is complete: threads, processes or Dask run the partitions."""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Literal

from .. import _core
from ..many import progress_bar
from . import folder
from .inputs import Query, dtype_of
from .work import Batch, Task, run, unchanged

_FORMAT = 1  # of the folder
_PER_THREAD = 3  # partitions that are under way for each thread of the workers: one runs, the others are on their way
_CHECK_SECONDS = 2.0  # without an answer, after which the pool is looked at
_CHANGE_SECONDS = 2.0  # after which Dask is asked how many workers there are: they come and go, and asking is a message
_LOST = "the scheduler is lost; the same call goes on once there is one"


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

    kind: Literal["sweep", "track", "pairs"]
    query: Query
    count: int
    described: dict[str, Any]
    meshes: Callable[[], bytes]
    part: Callable[[int, int], Any]
    usual_size: int  # of a partition


class Pool:
    """Runs tasks on an executor as those of concurrent.futures. Its processes read the meshes from a file."""

    def __init__(self, executor: Any, meshes: Path) -> None:
        self._executor = executor
        self._meshes = str(meshes)

    def width(self) -> int:
        """How many tasks run at a time, now."""
        return int(getattr(self._executor, "_max_workers", None) or _processor_count())

    def submit(self, task: Task) -> Any:
        """A future, of concurrent.futures or of Dask."""
        return self._executor.submit(run, task, self._meshes)

    def check(self) -> None:
        """Raises ConnectionError if nothing will come any more."""

    def explain(self, error: Exception) -> None:
        """Raises ConnectionError if that is what an error means."""


class DaskPool(Pool):
    """A client of Dask. The meshes are the result of a task: workers hand it on to each other, and the scheduler has
    the task run again when all of them are lost."""

    def __init__(self, client: Any, meshes: bytes) -> None:
        self._client = client
        self._config = folder.imported("dask.config")
        self._sent = self._submit(unchanged, meshes)
        self._width, self._looked_at = 0, -math.inf

    def width(self) -> int:
        if time.monotonic() > self._looked_at + _CHANGE_SECONDS:
            self._width, self._looked_at = sum(self._client.nthreads().values()), time.monotonic()
        return self._width

    def submit(self, task: Task) -> Any:
        return self._submit(run, task, self._sent)

    def check(self) -> None:
        if self._client.status not in ("running", "connecting"):
            raise ConnectionError(_LOST)

    def explain(self, error: Exception) -> None:
        # Futures of a lost scheduler are cancelled; whoever asks it something finds the connection closed.
        if isinstance(error, (CancelledError, folder.imported("distributed.comm").CommClosedError)):
            raise ConnectionError(_LOST) from error

    def _submit(self, *call: Any) -> Any:
        # Dask warns of large arguments, which meshes and frames are on purpose.
        with self._config.set({"distributed.admin.large-graph-warning-threshold": sys.maxsize}):
            return self._client.submit(*call, pure=False)


def _processor_count() -> int:
    """Of those that this process may use."""
    return len(os.sched_getaffinity(0))


def _check_executor(executor: Any) -> None:
    """Raises TypeError or ValueError if it cannot run batches."""
    if _is_dask_client(executor):
        if executor.asynchronous:
            raise ValueError("executor: expected a Client that is not asynchronous")
    elif executor is not None and not hasattr(executor, "submit"):
        raise TypeError("executor: expected None, a distributed.Client or an object with submit()")


def _is_dask_client(executor: Any) -> bool:
    """Never imports Dask: who has a client has imported it."""
    distributed = sys.modules.get("distributed")
    return distributed is not None and isinstance(executor, distributed.Client)


def answer(request: Request, out: Path, executor: Any, partition_size: int | None, progress: bool) -> Report:
    """Answers what is missing in a folder. The errors of workers are raised; what was done stays done."""
    folder.imported("pyarrow")
    _check_executor(executor)
    identity = {"format": _FORMAT, "version": _core.version, "batch": request.kind}
    manifest = identity | request.query.described() | request.described | {"count": request.count}
    out = out.absolute()
    token, size = folder.open_folder(out, manifest, partition_size, request.usual_size)
    name = folder.batch_name(manifest | {"partition_size": size})
    batch = Batch(name, request.kind, request.query, _core.version, str(out), token)
    dtype = dtype_of(request.query.name)
    parts = [(begin, min(begin + size, request.count)) for begin in range(0, request.count, size)]
    missing = [
        i for i, (begin, end) in enumerate(parts)
        if folder.read_parquet(out / folder.part_name(i), dtype, end - begin, folder.label_of(name, i)) is None
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
    if _is_dask_client(executor):
        return DaskPool(executor, meshes)
    if executor is None:
        executor = owned.enter_context(ThreadPoolExecutor(_processor_count()))
    folder.write_whole(out / folder.MESHES, meshes)
    return Pool(executor, out / folder.MESHES)


def _run_all(pool: Pool, tasks: Iterator[Task], out: Path, done: Callable[[Task], object]) -> None:
    running: dict[Any, Task] = {}
    finished: SimpleQueue[Any] = SimpleQueue()
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
