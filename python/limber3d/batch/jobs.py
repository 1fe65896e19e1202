# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What partitions are made of, and how one is answered. Workers import this module."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy

from .. import _core
from ..many import track
from ..typing import IdArray, PosesLike, RecordArray
from .inputs import AnyArray, Poses, Unpacked
from .queries import Query, dtype_of


class Job(Protocol):
    """A kind of batch. Objects are small and are sent with every partition."""

    @property
    def query(self) -> Query: ...

    def prepared(self, unpacked: Unpacked) -> Any:
        """What all partitions need, made of the meshes. A process makes it once; its threads share it."""
        ...

    def answered(self, prepared: Any, part: Any) -> RecordArray:
        """The answers of one partition, on the calling thread."""
        ...


@dataclass(frozen=True)
class SweepJob:
    """Two models at many poses. A part is the poses of both."""

    query: Query

    def prepared(self, unpacked: Unpacked) -> list[_core.Model]:
        return unpacked.models()

    def answered(self, prepared: list[_core.Model], part: tuple[PosesLike, PosesLike, int]) -> RecordArray:
        (a, b), (poses_a, poses_b, count) = prepared, part
        records = numpy.zeros(count, dtype_of(self.query.name))
        self.query.ask(_core.Batch(a, b, poses_a, poses_b, 1), records, 0, count)
        return records


@dataclass(frozen=True)
class TrackJob:
    """A model that deforms, and another. A part is frames and the poses of both."""

    query: Query

    def prepared(self, unpacked: Unpacked) -> tuple[Unpacked, _core.Model]:
        return unpacked, unpacked.models()[1]

    def answered(
        self, prepared: tuple[Unpacked, _core.Model], part: tuple[list[AnyArray], PosesLike, PosesLike]
    ) -> RecordArray:
        unpacked, other = prepared
        frames, poses, poses_other = part
        # Of its own: a partition must not depend on what was asked before it.
        model = _core.Model(*unpacked.mesh(0))
        options: Any = self.query.options
        return track(model, frames, other, poses, poses_other, **options)


@dataclass(frozen=True)
class PairsJob:
    """Pairs of many placed models. A part is their ids, two in a row."""

    query: Query
    poses_are_two_arrays: bool

    def prepared(self, unpacked: Unpacked) -> tuple[list[_core.Model], Poses]:
        parts = [unpacked.arrays[name] for name in ("poses_0", "poses_1") if name in unpacked.arrays]
        poses: Any = tuple(parts) if self.poses_are_two_arrays else parts[0] if parts else None
        return unpacked.models(), Poses(poses)

    def answered(self, prepared: tuple[list[_core.Model], Poses], part: IdArray) -> RecordArray:
        models, poses = prepared
        records = numpy.zeros(len(part), dtype_of(self.query.name))
        ids: list[tuple[int, int]] = part.tolist()
        for k, (i, j) in enumerate(ids):
            batch = _core.Batch(models[i], models[j], poses.one(i), poses.one(j), 1)
            self.query.ask(batch, records[k:], 0, 1)
        return records
