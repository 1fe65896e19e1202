# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Those who run partitions: threads, processes, Dask."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, ThreadPoolExecutor
from typing import Any, Protocol

from .extras import imported
from .work import Task, run, unchanged

_LOST = "the scheduler is lost; the same call goes on once there is one"
_LARGE_GRAPH = "distributed.admin.large-graph-warning-threshold"


class Future(Protocol):
    """A promised result, of concurrent.futures or of Dask."""

    def add_done_callback(self, call: Callable[[Any], object], /) -> Any: ...
    def result(self) -> Any: ...
    def cancel(self) -> Any: ...


class Pool(Protocol):
    """Runs tasks."""

    def width(self) -> int:
        """How many it runs at a time, now."""
        ...

    def submit(self, task: Task) -> Future: ...

    def check(self) -> None:
        """Raises ConnectionError if nothing will come any more."""
        ...

    def explain(self, error: Exception) -> None:
        """Raises ConnectionError if that is what an error means."""
        ...


class PlainPool:
    """An executor as those of concurrent.futures. Its processes read the meshes from a file."""

    def __init__(self, executor: Any, meshes: str) -> None:
        self._executor = executor
        self._meshes = meshes

    def width(self) -> int:
        return int(getattr(self._executor, "_max_workers", None) or os.cpu_count() or 1)

    def submit(self, task: Task) -> Future:
        future: Future = self._executor.submit(run, task, self._meshes)
        return future

    def check(self) -> None:
        pass

    def explain(self, error: Exception) -> None:
        pass


class DaskPool:
    """A client of Dask. The meshes are a task: workers hand its result on to each other, and once lost it is run again."""

    def __init__(self, client: Any, meshes: bytes) -> None:
        self._client = client
        self._dask_config = imported("dask.config")
        with self._dask_config.set({_LARGE_GRAPH: sys.maxsize}):
            self._meshes = client.submit(unchanged, meshes, pure=False)
        self._width, self._looked_at = 0, -1.0

    def width(self) -> int:
        if time.monotonic() > self._looked_at + 2:  # workers come and go; asking costs a message
            self._width, self._looked_at = sum(self._client.nthreads().values()), time.monotonic()
        return self._width

    def submit(self, task: Task) -> Future:
        with self._dask_config.set({_LARGE_GRAPH: sys.maxsize}):
            future: Future = self._client.submit(run, task, self._meshes, pure=False)
        return future

    def check(self) -> None:
        if self._client.status not in ("running", "connecting"):
            raise ConnectionError(_LOST)

    def explain(self, error: Exception) -> None:
        # Futures of a lost scheduler are cancelled; whoever asks it something finds the connection closed.
        if isinstance(error, (CancelledError, imported("distributed.comm").CommClosedError)):
            raise ConnectionError(_LOST) from error


def processor_count() -> int:
    """Of those that this process may use."""
    return len(os.sched_getaffinity(0))


def own_threads() -> Executor:
    """Threads of this process, one for each processor."""
    return ThreadPoolExecutor(processor_count())


def check_executor(executor: Any) -> None:
    """Raises TypeError or ValueError if it cannot run batches."""
    if is_dask_client(executor):
        if executor.asynchronous:
            raise ValueError("executor: expected a Client that is not asynchronous")
    elif executor is not None and not hasattr(executor, "submit"):
        raise TypeError("executor: expected None, a distributed.Client or an object with submit()")


def is_dask_client(executor: Any) -> bool:
    """Never imports Dask: who has a client has imported it."""
    distributed = sys.modules.get("distributed")
    return distributed is not None and isinstance(executor, distributed.Client)
