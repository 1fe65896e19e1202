# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What runs on workers: one partition."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import _core
from . import folder
from .inputs import Unpacked
from .jobs import Job
from .tables import to_parquet

_KEPT = 2  # batches of which a process keeps the models


@dataclass(frozen=True)
class Batch:
    """What all partitions have in common. It is small, and sent with each."""

    name: str  # of its content
    job: Job
    version: str
    folder: str
    token: str


@dataclass(frozen=True)
class Task:
    """One partition."""

    batch: Batch
    index: int
    first_row: int
    part: Any

    @property
    def label(self) -> str:
        return label_of(self.batch.name, self.index)


def label_of(batch: str, index: int) -> str:
    """What the file of a partition says that it is."""
    return f"{batch} {index}"


_prepared: dict[str, Any] = {}
_prepared_lock = threading.Lock()


def _prepare(batch: Batch, meshes: bytes | str) -> Any:
    with _prepared_lock:
        if batch.name not in _prepared:
            data = meshes if isinstance(meshes, bytes) else Path(meshes).read_bytes()
            made = batch.job.prepared(Unpacked(data))
            while len(_prepared) >= _KEPT:
                del _prepared[next(iter(_prepared))]
            _prepared[batch.name] = made
        return _prepared[batch.name]


def run(task: Task, meshes: bytes | str) -> bytes | None:
    """Answers a partition.

    Meshes   Packed, or the file that has them; looked at once in a process.
    Returns  None if this process sees the folder, and has written the partition there; elsewhere the bytes of the file.
    Raises   RuntimeError if limber3d has another version here than where the batch was asked for.
    """
    batch = task.batch
    if batch.version != _core.version:
        raise RuntimeError(f"this worker has limber3d {_core.version}, the batch was asked for by {batch.version}")
    records = batch.job.answered(_prepare(batch, meshes), task.part)
    data = to_parquet(records, task.first_row, task.label)
    if not folder.is_shared(batch.folder, batch.token):
        return data
    folder.write_whole(Path(batch.folder, folder.part_name(task.index)), data)
    return None


def unchanged(meshes: bytes) -> bytes:
    """A task of Dask's whose result is what it was sent: made again if all workers that had it are lost."""
    return meshes
