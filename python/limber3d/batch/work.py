# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What runs on workers, which import this module: one partition."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy

from .. import _core
from ..many import track
from ..typing import IdArray, PosesLike, RecordArray
from . import folder
from .inputs import AnyArray, Poses, Query, dtype_of, unpacked

_KEPT = 2  # batches of which a process keeps the models

Prepared = tuple[list[_core.Model], Poses]


@dataclass(frozen=True)
class Batch:
    """What all partitions have in common. It is small, and sent with each."""

    name: str  # of its content
    kind: Literal["sweep", "track", "pairs"]
    query: Query
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
        return folder.label_of(self.batch.name, self.index)


def _swept(query: Query, prepared: Prepared, part: tuple[PosesLike, PosesLike, int]) -> RecordArray:
    """Two models at many poses. A part is the poses of both, and how many they are."""
    (a, b), _ = prepared
    poses_a, poses_b, count = part
    return query.answers(_core.Batch(a, b, poses_a, poses_b, 1), count)


def _tracked(query: Query, prepared: Prepared, part: tuple[list[AnyArray], PosesLike, PosesLike]) -> RecordArray:
    """A model that deforms, and another. A part is frames and the poses of both."""
    (first, other), _ = prepared
    frames, poses, poses_other = part
    model = _core.Model(first.vertices, first.faces)  # of its own: a partition must not depend on others
    options: Any = query.options
    return track(model, frames, other, poses, poses_other, **options)


def _paired(query: Query, prepared: Prepared, part: IdArray) -> RecordArray:
    """Pairs of many placed models. A part is their ids, two in a row."""
    models, poses = prepared
    records = numpy.zeros(len(part), dtype_of(query.name))
    ids: list[tuple[int, int]] = part.tolist()
    for k, (i, j) in enumerate(ids):
        records[k] = query.answers(_core.Batch(models[i], models[j], poses.one(i), poses.one(j), 1), 1)[0]
    return records


_prepared: dict[str, Prepared] = {}
_prepared_lock = threading.Lock()


def _prepare(batch: Batch, meshes: bytes | str) -> Prepared:
    """What all partitions need. A process makes it once; its threads share it."""
    with _prepared_lock:
        if batch.name not in _prepared:
            made = unpacked(meshes if isinstance(meshes, bytes) else Path(meshes).read_bytes())
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
    answered: dict[str, Callable[..., RecordArray]] = {"sweep": _swept, "track": _tracked, "pairs": _paired}
    records = answered[batch.kind](batch.query, _prepare(batch, meshes), task.part)
    data = folder.to_parquet(records, task.first_row, task.label)
    if not folder.is_shared(batch.folder, batch.token):
        return data
    folder.write_whole(Path(batch.folder, folder.part_name(task.index)), data)
    return None


def unchanged(meshes: bytes) -> bytes:
    """A task of Dask's whose result is what it was sent: made again if all workers that had it are lost."""
    return meshes
