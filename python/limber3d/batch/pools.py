# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Those who run partitions: threads, processes, Dask."""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, ThreadPoolExecutor
from typing import Any, Protocol

from .extras import imported
from .work import Task, run, unchanged

_LOST = "the scheduler is lost; the same call goes on once there is one"
_CHANGE_SECONDS = 2.0  # after which Dask is asked how many workers there are: they come and go, and asking is a message


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
        return int(getattr(self._executor, "_max_workers", None) or processor_count())

    def submit(self, task: Task) -> Future:
        future: Future = self._executor.submit(run, task, self._meshes)
        return future

    def check(self) -> None:
        pass

    def explain(self, error: Exception) -> None:
        pass


class DaskPool:
    """A client of Dask. The meshes are the result of a task: workers hand it on to each other, and the scheduler has
    the task run again when all of them are lost."""

    def __init__(self, client: Any, meshes: bytes) -> None:
        self._client = client
        self._config = imported("dask.config")
        self._meshes = self._submit(unchanged, meshes)
        self._width, self._looked_at = 0, -math.inf

    def width(self) -> int:
        if time.monotonic() > self._looked_at + _CHANGE_SECONDS:
            self._width, self._looked_at = sum(self._client.nthreads().values()), time.monotonic()
        return self._width

    def submit(self, task: Task) -> Future:
        return self._submit(run, task, self._meshes)

    def check(self) -> None:
        if self._client.status not in ("running", "connecting"):
            raise ConnectionError(_LOST)

    def explain(self, error: Exception) -> None:
        # Futures of a lost scheduler are cancelled; whoever asks it something finds the connection closed.
        if isinstance(error, (CancelledError, imported("distributed.comm").CommClosedError)):
            raise ConnectionError(_LOST) from error

    def _submit(self, *call: Any) -> Future:
        # Dask warns of large arguments, which meshes and frames are on purpose.
        with self._config.set({"distributed.admin.large-graph-warning-threshold": sys.maxsize}):
            future: Future = self._client.submit(*call, pure=False)
        return future


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
