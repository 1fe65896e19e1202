# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The calls of batches: poses, frames, pairs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy

from .. import _core
from ..typing import ArrayLike, PosesLike
from .inputs import Frames, Meshes, Poses, Query, QueryName, digest_of
from .running import Report, Request, answer

_LEAST_POSES, _MOST_POSES, _USUAL_PARTITIONS = 1000, 10_000, 100
_MOST_FRAMES, _MOST_FRAME_BYTES = 64, 32 << 20  # of a partition: it travels as one message


def sweep(
    a: _core.Model,
    b: _core.Model,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    out: str | os.PathLike[str],
    query: QueryName = "distance",
    relative_error: float | None = None,
    absolute_error: float | None = None,
    max_distance: float | None = None,
    executor: Any = None,
    partition_size: int | None = None,
    progress: bool = False,
) -> Report:
    """distance_many(), collide_many() or within_many() on many processes or machines.

    Folder    out is made, or gone on with: partitions that are there, and are not damaged, are not asked again.
              read(out) gives the answers.
    Options   Those of the query. partition_size is a number of poses; None: a folder's own, or one that suits most.
    Promise   The bits of distance_many() and its like, for models just made of the vertices and faces that a and b
              have. (A model that was moved may name another of several equally close pairs of triangles.)
    Failures  Dask runs partitions of lost workers again. Other executors raise, such as BrokenProcessPool; then, or
              after Ctrl-C, or the end of this process, the same call goes on.
    Raises    ValueError as distance_many(), and if out is the folder of another batch, before anything is asked;
              OSError where it cannot be written; ConnectionError if Dask's scheduler is lost; ImportError without
              pyarrow.
    Threads   Each partition takes one thread of one worker.
    """
    asked = Query.of(
        query, relative_error=relative_error, absolute_error=absolute_error, max_distance=max_distance
    )
    size = _core.Batch(a, b, poses_a, poses_b).size
    count = 1 if size is None else size
    asked.check(a, b)
    meshes, placed_a, placed_b = Meshes([a, b], "a", "b"), Poses(poses_a), Poses(poses_b)
    request = Request(
        kind="sweep",
        query=asked,
        count=count,
        described={
            "model_a": meshes.digests[0],
            "model_b": meshes.digests[1],
            "poses_a": placed_a.digest(),
            "poses_b": placed_b.digest(),
        },
        meshes=meshes.packed,
        part=lambda begin, end: (placed_a.part(begin, end), placed_b.part(begin, end), end - begin),
        usual_size=_usual_size(count),
    )
    return answer(request, Path(out), executor, partition_size, progress)


def track(
    model: _core.Model,
    frames: ArrayLike | Sequence[ArrayLike],
    other: _core.Model,
    poses: PosesLike = None,
    poses_other: PosesLike = None,
    *,
    out: str | os.PathLike[str],
    relative_error: float | None = None,
    absolute_error: float | None = None,
    max_distance: float | None = None,
    executor: Any = None,
    partition_size: int | None = None,
    progress: bool = False,
) -> Report:
    """limber3d.track() on many processes or machines. The model itself is left as it is.

    Shape     frames is an array (n, v, 3), which may be larger than memory, or a sequence of n arrays (v, 3).
    Promise   Each partition starts with a model just made of the mesh that `model` has, and has the bits of
              limber3d.track() from there. So where several pairs of triangles are equally close up to rounding, and
              within an error that is allowed, answers depend on partition_size as well.
    Folder, Options, Failures, Raises, Threads   As sweep(); ValueError if there are not as many poses as frames.
    """
    asked = Query.of(
        "distance", relative_error=relative_error, absolute_error=absolute_error, max_distance=max_distance
    )
    listed = Frames(frames)
    size = _core.Batch(model, other, poses, poses_other).size
    if size is not None and size != len(listed):
        raise ValueError(f"frames: there are {len(listed)}, and {size} poses; expected as many, or one pose")
    asked.check(model, other)
    meshes, placed, placed_other = Meshes([model, other], "model", "other"), Poses(poses), Poses(poses_other)
    request = Request(
        kind="track",
        query=asked,
        count=len(listed),
        described={
            "model": meshes.digests[0],
            "other": meshes.digests[1],
            "frames": listed.digest(),
            "poses": placed.digest(),
            "poses_other": placed_other.digest(),
        },
        meshes=meshes.packed,
        part=lambda begin, end: (listed.part(begin, end), placed.part(begin, end), placed_other.part(begin, end)),
        usual_size=max(1, min(_MOST_FRAMES, _MOST_FRAME_BYTES // model.vertices.nbytes)),
    )
    return answer(request, Path(out), executor, partition_size, progress)


def pairs(
    models: Sequence[_core.Model],
    poses: PosesLike = None,
    pairs: ArrayLike | None = None,
    *,
    out: str | os.PathLike[str],
    query: QueryName = "distance",
    relative_error: float | None = None,
    absolute_error: float | None = None,
    max_distance: float | None = None,
    executor: Any = None,
    partition_size: int | None = None,
    progress: bool = False,
) -> Report:
    """Queries between the models of an assembly. A mesh that several models have is sent and built once.

    Shape     models are n, poses as many, or None. pairs is an array (m, 2) of ids; None: all (i, j) with i < j,
              ordered by i, then by j. Answer k is that of pair k.
    Promise   The bits of distance() and its like, for models just made of the vertices and faces that these have.
    Folder, Options, Failures, Raises, Threads   As sweep(); IndexError if pairs name models that do not exist.
    """
    if not models:
        raise ValueError("models: expected at least one")
    asked = Query.of(
        query, relative_error=relative_error, absolute_error=absolute_error, max_distance=max_distance
    )
    if _core.Batch(models[0], models[0], poses, None).size not in ({None} if poses is None else {len(models)}):
        raise ValueError(f"poses: expected one for each of {len(models)} models")
    listed = _pair_ids(pairs, len(models))
    for model in models:
        asked.check(model, model)
    meshes, placed = Meshes(models), Poses(poses)
    request = Request(
        kind="pairs",
        query=asked,
        count=len(listed),
        described={
            "models": meshes.digests,
            "poses": placed.digest(),
            "pairs": digest_of([listed]),
        },
        meshes=lambda: meshes.packed(placed),
        part=lambda begin, end: listed[begin:end],
        usual_size=_usual_size(len(listed)),
    )
    return answer(request, Path(out), executor, partition_size, progress)


def _usual_size(count: int) -> int:
    """Long enough to be worth a message, and short enough that workers finish together."""
    return max(_LEAST_POSES, min(_MOST_POSES, count // _USUAL_PARTITIONS))


def _pair_ids(pairs: ArrayLike | None, model_count: int) -> numpy.typing.NDArray[numpy.uint32]:
    if pairs is None:
        return numpy.stack(numpy.triu_indices(model_count, 1), 1).astype(numpy.uint32)
    ids = numpy.asarray(pairs)
    if ids.ndim != 2 or ids.shape[1] != 2 or ids.dtype.kind not in "iu":
        raise ValueError(f"pairs: expected an array (m, 2) of integers, got shape {ids.shape} and dtype {ids.dtype}")
    if ids.size and not (0 <= ids.min() and ids.max() < model_count):
        raise IndexError(f"pairs: expected ids of {model_count} models, got {ids.min()} to {ids.max()}")
    return ids.astype(numpy.uint32)
