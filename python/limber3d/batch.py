# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many poses or frames on many processes or machines.

    batch.sweep(a, b, poses_b=poses, out="answers", executor=distributed.Client("tcp://10.0.0.1:8786"))
    records = batch.read("answers")

1. sweep() and track() say what is asked, a _BatchJob, and how it is cut into partitions: some poses or frames each.
2. Its run() finds the partitions that the folder has, and has workers answer the others, a few at a time.
3. The answers of each become one file of a Parquet data set, which gets its name only once it is whole. So the same
   call goes on where an earlier one was stopped, however it was stopped.
4. read() puts the files together.

Executors  None: threads of this process. A distributed.Client of Dask, which runs partitions of lost workers again.
Promise    The same bits whatever the executor, its workers, their number and their failures.
Needs      pip install limber3d[cluster], here and where the workers are.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import json
import operator
import os
import sys
import uuid
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ThreadPoolExecutor, wait
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import numpy
from numpy.typing import NDArray

from . import _core
from .many import collide_many, distance_many, progress_bar, records_of, within_many
from .many import track as track_here
from .typing import ArrayLike, FloatArray, IdArray, PosesLike, RecordArray

__all__ = ["Report", "read", "sweep", "track"]

_QueryName = Literal["distance", "collide", "within"]
_AnyArray = NDArray[Any]

_QUERIES = dict[str, Callable[..., RecordArray]](distance=distance_many, collide=collide_many, within=within_many)
_USUAL_PARTITIONS = 100  # of poses, so that workers finish at nearly the same time
_LEAST_POSES = 1000  # of a usual partition: it must be worth a message
_MOST_POSES = 10_000  # of a usual partition: it is lost with its worker
_MOST_FRAMES = 64  # of a usual partition: it is lost with its worker
_MOST_FRAME_BYTES = 32 << 20  # of the frames of a usual partition: it travels as one message
_PER_THREAD = 3  # partitions that are under way for each thread: one runs, the others are on their way
_CHECK_SECONDS = 2.0  # how long answers are waited for before the executor is asked again how many threads it has
_HASHED_ROWS = 4096  # rows that are hashed at a time: arrays may be larger than memory
_LABEL, _DIGEST = b"limber3d", b"limber3d.sha256"  # keys of a file's schema: what was asked, and a hash of the file


@dataclass(frozen=True)
class Report:
    """What a batch has done."""

    count: int
    """How many poses or frames were asked about."""
    partitions: int
    """How many partitions these were cut into."""
    found: int
    """How many of the partitions earlier calls had finished."""


def sweep(
    a: _core.Model,
    b: _core.Model,
    poses_a: PosesLike = None,
    poses_b: PosesLike = None,
    *,
    out: str | os.PathLike[str],
    query: _QueryName = "distance",
    executor: Any = None,
    partition_size: int | None = None,
    progress: bool = False,
    **options: float,
) -> Report:
    """distance_many(), collide_many() or within_many() on many processes or machines.

    Folder    out is made, or gone on with: partitions that are there, and are not damaged, are not asked again.
              read(out) gives the answers. A call that was killed may leave a file named _ and 32 digits, which nothing
              reads: delete it when no call is running.
    Options   Those of the query, such as relative_error or max_distance. partition_size is a number of poses.
    Promise   The bits of distance_many() and its like, for models just made of the vertices and faces that a and b
              have. (A model that was moved may name another of several equally close pairs of triangles.)
    Raises    ValueError as distance_many(), and if out has answers of another batch, before anything is asked; OSError
              where it cannot be written; ConnectionError if Dask's scheduler is lost; ImportError without pyarrow.
    """
    size = _core.Batch(a, b, poses_a, poses_b).size
    count = 1 if size is None else size
    usual_size = max(_LEAST_POSES, min(_MOST_POSES, count // _USUAL_PARTITIONS))
    job = _BatchJob(query, options, [a, b], [_arrays(poses_a), _arrays(poses_b)], count, usual_size)
    return job.run(Path(out), executor, partition_size, progress)


def track(
    model: _core.Model,
    frames: ArrayLike | Iterable[ArrayLike],
    other: _core.Model,
    poses: PosesLike = None,
    poses_other: PosesLike = None,
    *,
    out: str | os.PathLike[str],
    executor: Any = None,
    partition_size: int | None = None,
    progress: bool = False,
    **options: float,
) -> Report:
    """limber3d.track() on many processes or machines. The model itself is left as it is.

    Shape     frames is an array (n, v, 3), which may be larger than memory, or a sequence of n arrays (v, 3), or
              another iterable of them, which is read into memory.
    Promise   Each partition starts with a model just made of the mesh that `model` has, and has the bits of
              limber3d.track() from there. So where several pairs of triangles are equally close up to rounding, and
              within an error that is allowed, answers depend on partition_size as well.
    Folder, Options, Raises   As sweep(); ValueError if there are not as many poses as frames.
    """
    listed: Any = frames
    if not hasattr(listed, "__getitem__"):
        # Copies, since an iterator may fill one array again and again.
        listed = numpy.asarray(listed) if hasattr(listed, "__array__") else [_array(frame).copy() for frame in listed]
    size = _core.Batch(model, other, poses, poses_other).size
    if size is not None and size != len(listed):
        raise ValueError(f"frames: there are {len(listed)}, and {size} poses; expected as many, or one pose")
    usual_size = max(1, min(_MOST_FRAMES, _MOST_FRAME_BYTES // model.vertices.nbytes))
    both = [_arrays(poses), _arrays(poses_other)]
    job = _BatchJob("distance", options, [model, other], both, len(listed), usual_size, listed)
    return job.run(Path(out), executor, partition_size, progress)


def read(out: str | os.PathLike[str]) -> RecordArray:
    """The answers in a folder, in the order of what was asked. Whatever reads Parquet data sets reads parts of it.

    Shape    Records as those of distance_many(), collide_many() or within_many(), to the bit. A file that has not the
             name of its partition, such as a copy, is not read.
    Raises   FileNotFoundError if there are none; ValueError if partitions are missing or damaged: the same call that
             has begun the batch makes them.
    """
    files = sorted(Path(out).glob("part-*.parquet"))
    if not files:
        raise FileNotFoundError(f"out: there are no answers in {out}")
    found = [part for part in map(_load, files) if part is not None]
    if not found:
        raise ValueError(f"out: all partitions in {out} are damaged")
    label = found[0][0]
    count = max(1, -(-label["count"] // label["partition_size"]))
    if [theirs for theirs, _ in found] != [label | {"partition": i} for i in range(count)]:
        raise ValueError(f"out: of {count} partitions in {out}, some are missing or damaged, or of another batch")
    return records_of([records for _, records in found], found[0][1].dtype)


@dataclass(frozen=True)
class _BatchJob:
    """What was asked about poses of two models, or about frames of the first."""

    query: str
    options: dict[str, float]
    models: Sequence[_core.Model]
    poses: Sequence[list[_AnyArray]]  # of each model, as _arrays() has them
    count: int  # of poses or frames
    usual_size: int  # of a partition
    frames: Any = None  # a sequence

    def part(self, begin: int, end: int) -> tuple[Any, ...]:
        """The frames, if there are any, and the poses of a partition."""
        frames = () if self.frames is None else ([_array(self.frames[i]) for i in range(begin, end)],)
        return *frames, *(_at(arrays, slice(begin, end)) for arrays in self.poses)

    def run(self, out: Path, executor: Any, partition_size: int | None, progress: bool) -> Report:
        """Answers what is missing in a folder. The errors of workers are raised; what was done stays done."""
        importlib.import_module("pyarrow")  # raises before anything is asked, and not after
        size = self.usual_size if partition_size is None else operator.index(partition_size)
        if size < 1:
            raise ValueError(f"partition_size: expected at least 1, got {size}")
        if self.query not in _QUERIES:
            raise ValueError(f"query: expected one of {', '.join(_QUERIES)}; got {self.query!r}")
        # Asked without poses, for the errors alone that wrong options or models have.
        _QUERIES[self.query](*self.models, threads=1, **self.options)
        is_swept = self.frames is None
        call: Callable[..., RecordArray] = _swept if is_swept else _tracked
        given: list[Any] = [*self.poses] if is_swept else [self.frames, *self.poses]
        meshes = [(model.vertices, model.faces) for model in self.models]
        kind = "swept" if is_swept else "tracked"
        # The label names all that the answers depend on, so answers of another batch are told from those of this one.
        # No option is named version, batch, query, models, given, count or partition_size.
        label: dict[str, Any] = {"version": _core.version, "batch": kind, "query": self.query}
        label |= {name: float(self.options[name]) for name in sorted(self.options)}
        label |= {"models": list(map(_digest, meshes)), "given": list(map(_digest, given))}
        label |= {"count": self.count, "partition_size": size}
        parts = [(begin, min(begin + size, self.count)) for begin in range(0, max(1, self.count), size)]
        with _pool(executor) as (pool, width, build), progress_bar(self.count, progress) as advance:
            out.mkdir(parents=True, exist_ok=True)
            found = _found(out, label)
            advance(sum(parts[i][1] - parts[i][0] for i in found))
            head = _core.version, call, build(meshes), self.query, self.options
            tasks = ((i, (*head, *self.part(*part))) for i, part in enumerate(parts) if i not in found)
            with closing(_answers(pool, width, tasks)) as answers:
                for i, records in answers:
                    _save(out, label, i, parts[i][0], records)
                    advance(len(records))
        return Report(self.count, len(parts), len(found))


def _array(value: Any) -> _AnyArray:
    """An array as it is; lists become numbers, and what is like SciPy's rotations matrices."""
    value = value.as_matrix() if hasattr(value, "as_matrix") else value
    return numpy.asarray(value, None if hasattr(value, "__array__") else float)


def _arrays(poses: PosesLike) -> list[_AnyArray]:
    """What poses are made of: nothing, matrices, or rotations and translations."""
    parts = [] if poses is None else list(map(_array, poses if isinstance(poses, tuple) else (poses,)))
    if len(parts) == 1 and parts[0].shape[-1] == 3:  # rotations about the origin
        parts.append(numpy.zeros(parts[0].shape[:-1]))
    return parts


def _at(arrays: list[_AnyArray], where: Any) -> Any:
    """Some of the poses, or the one that holds for all."""
    single_ndim = 1 if len(arrays) == 2 else 2  # of one translation, the last of two arrays, or of one matrix
    is_list = bool(arrays) and arrays[-1].ndim > single_ndim
    found = tuple(array[where] if is_list else array for array in arrays)
    return found if len(found) == 2 else found[0] if found else None


def _digest(arrays: Iterable[ArrayLike]) -> str:
    """A name for content: SHA-256 of arrays, their element types and shapes."""
    digest = hashlib.sha256()
    for array in map(_array, arrays):
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        rows = numpy.atleast_1d(array)
        for begin in range(0, len(rows), _HASHED_ROWS):
            digest.update(numpy.ascontiguousarray(rows[begin : begin + _HASHED_ROWS]).data)
    return digest.hexdigest()


def _build(meshes: list[tuple[FloatArray, IdArray]]) -> list[_core.Model]:
    """Models of those meshes, never of a model's tree, whose history has a say in what it answers."""
    return [_core.Model(*mesh) for mesh in meshes]


def _swept(models: list[_core.Model], query: str, options: Any, poses_a: PosesLike, poses_b: PosesLike) -> RecordArray:
    return _QUERIES[query](*models, poses_a=poses_a, poses_b=poses_b, threads=1, **options)


def _tracked(models: list[_core.Model], _: str, options: Any, frames: Any, *poses: PosesLike) -> RecordArray:
    model = _core.Model(models[0].vertices, models[0].faces)  # of its own: a partition must not depend on others
    return track_here(model, frames, models[1], *poses, **options)


def _answer(version: str, call: Callable[..., RecordArray], *arguments: Any) -> RecordArray:
    """What runs on workers: one partition. They must have the version of limber3d that the batch was asked with."""
    if version != _core.version:
        raise RuntimeError(f"this worker has limber3d {_core.version}, the batch was asked for by {version}")
    return call(*arguments)


@contextmanager
def _pool(executor: Any) -> Generator[tuple[Executor, Callable[[], int], Callable[..., Any]], None, None]:
    """What runs partitions, how many threads it has, and what builds the models that they take."""
    if executor is None:
        width = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        with ThreadPoolExecutor(width) as threads:
            yield threads, lambda: width, _build
        return
    config, comm = importlib.import_module("dask.config"), importlib.import_module("distributed.comm")
    # Models are the result of a task: workers hand it on to each other, and the scheduler has the task run again when
    # all of them are lost. Dask warns of large arguments, which meshes and frames are on purpose.
    with config.set({"distributed.admin.large-graph-warning-threshold": sys.maxsize}):
        build = functools.partial(executor.submit, _build, pure=False)
        try:
            yield executor.get_executor(pure=False), lambda: sum(executor.nthreads().values()), build
        except Exception as error:  # of any kind where the client is closing: Dask raises what it stumbles on first
            if isinstance(error, (CancelledError, comm.CommClosedError)) or executor.status != "running":
                raise ConnectionError("the scheduler is lost; the same call goes on once there is one") from error
            raise


def _answers(
    pool: Executor, width: Callable[[], int], tasks: Iterator[tuple[int, tuple[Any, ...]]]
) -> Generator[tuple[int, RecordArray], None, None]:
    """The numbers of partitions and their answers, in any order. Few are under way at a time: they are in memory. Who
    closes this before the end cancels those under way."""
    running: dict[Future[RecordArray], int] = {}
    try:
        while True:
            for i, arguments in islice(tasks, max(0, _PER_THREAD * max(1, width()) - len(running))):
                running[pool.submit(_answer, *arguments)] = i
            if not running:
                return
            for future in wait(running, _CHECK_SECONDS, FIRST_COMPLETED).done:
                yield running.pop(future), future.result()
    finally:
        for future in running:
            future.cancel()


def _columns(records: RecordArray) -> Iterator[tuple[str, _AnyArray]]:
    """Name and numbers of each column; points become three. Who writes to the numbers writes to the records."""
    for name in records.dtype.names or ():
        if records.dtype[name].shape == ():
            yield name, records[name]
        else:
            yield from ((f"{name}_{axis}", records[name][:, i]) for i, axis in enumerate("xyz"))


def _save(folder: Path, label: dict[str, Any], index: int, first_row: int, records: RecordArray) -> None:
    """Writes a partition, one column for each number. Values are stored plainly: an encoding by values would take all
    not-a-numbers for the same, and answers hardly repeat."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    columns: dict[str, _AnyArray] = {"row": numpy.arange(first_row, first_row + len(records))}
    columns |= {name: numpy.ascontiguousarray(column) for name, column in _columns(records)}
    text = json.dumps(label | {"partition": index}).encode()
    metadata = {_LABEL: text, _DIGEST: _digest([*columns.values(), numpy.frombuffer(text, numpy.uint8)]).encode()}
    temporary = folder / f"_{uuid.uuid4().hex}"  # readers of Parquet data sets skip names with _
    try:
        table = arrow.table(columns).replace_schema_metadata(metadata)
        parquet.write_table(table, temporary, compression="none", use_dictionary=False)
        os.replace(temporary, folder / _file_name(index))
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _file_name(partition: int) -> str:
    return f"part-{partition:08}.parquet"


def _load(path: Path) -> tuple[dict[str, Any], RecordArray] | None:
    """The label of a file and its records; None if it is damaged, something else, or named as another partition."""
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    try:
        table = parquet.read_table(path, use_threads=False, partitioning=None)
        metadata: dict[bytes, bytes] = table.schema.metadata or {}
        columns: dict[str, _AnyArray] = {name: table.column(name).to_numpy() for name in table.column_names}
        digest = _digest([*columns.values(), numpy.frombuffer(metadata[_LABEL], numpy.uint8)])
        if metadata[_DIGEST] != digest.encode():
            return None
        label: dict[str, Any] = json.loads(metadata[_LABEL])
        if path.name != _file_name(label["partition"]):
            return None
        records = numpy.zeros(len(table), _core.distance_dtype if label["query"] == "distance" else _core.collide_dtype)
        for name, column in _columns(records):
            column[:] = columns[name]
        return label, records
    except (OSError, arrow.ArrowException, ValueError, KeyError):
        return None


def _found(folder: Path, label: dict[str, Any]) -> set[int]:
    """Partitions that are there and whole. Raises ValueError where there are those of another batch."""
    found = set[int]()
    for path in folder.glob("part-*.parquet"):
        if (part := _load(path)) is None:
            continue
        theirs = part[0]
        names = [name for name in [*label, *theirs] if name != "partition" and theirs.get(name) != label.get(name)]
        if names:
            raise ValueError(f"out: {folder} is the folder of another batch, which has another {names[0]}")
        found.add(theirs["partition"])
    return found
