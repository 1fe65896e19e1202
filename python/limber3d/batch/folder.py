# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a batch: what was asked, the meshes, and one Parquet file for each partition that is done."""

from __future__ import annotations

import hashlib
import importlib
import json
import operator
import os
import uuid
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy

from ..typing import RecordArray
from .inputs import QUERY_NAMES, AnyArray, digest_of, dtype_of

MANIFEST, TOKEN, MESHES = "_manifest.json", "_token", "_meshes.npz"  # readers of Parquet folders skip names with _
_TEMPORARY = "_temporary-"
_ROW = "row"  # the column that counts the records of all partitions
_LABEL, _DIGEST = b"limber3d", b"limber3d.sha256"  # keys of a file's schema


def imported(module: str) -> Any:
    """A module of an optional package. Raises ImportError that says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"limber3d.batch needs {package}: pip install limber3d[cluster] ({error})") from error


def part_name(index: int) -> str:
    """The file of a partition. Names sort as partitions do."""
    return f"part-{index:08}.parquet"


def batch_name(manifest: dict[str, Any]) -> str:
    """A name for what a manifest says."""
    return hashlib.sha256(json.dumps(manifest, sort_keys=True).encode()).hexdigest()


def label_of(batch: str, index: int) -> str:
    """What the file of a partition says that it is."""
    return f"{batch} {index}"


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file that has its name only once it is whole."""
    temporary = path.with_name(f"{_TEMPORARY}{uuid.uuid4().hex}")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    except FileNotFoundError:
        if not path.exists():  # else another client of this folder has written the same, and removed what was left
            raise
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, IsADirectoryError):
            raise IsADirectoryError(f"out: {path} is a folder, where a file is to be written") from None
        raise


def is_shared(folder: str, token: str) -> bool:
    """Whether this process sees the folder that the client has opened under that token, not one of the same name."""
    try:
        return Path(folder, TOKEN).read_text() == token
    except OSError:
        return False


def read_manifest(folder: Path) -> dict[str, Any]:
    """Raises OSError if there is none, ValueError if it is none."""
    try:
        manifest: Any = json.loads((folder / MANIFEST).read_text())
    except (ValueError, RecursionError) as error:
        raise ValueError(f"out: {folder / MANIFEST} is not JSON: {error}") from None
    if not _is_manifest(manifest):
        raise ValueError(f"out: {folder / MANIFEST} is not the manifest of a batch")
    return cast("dict[str, Any]", manifest)


def _is_manifest(value: Any) -> bool:
    """Whether this has what readers need, and nothing deeper than a list."""
    if not isinstance(value, dict):
        return False
    values = cast("dict[str, Any]", value)
    items: list[Any] = []
    for entry in values.values():
        items += cast("Sequence[Any]", entry) if isinstance(entry, list) else [entry]
    count, size = values.get("count"), values.get("partition_size")
    return (
        not any(isinstance(item, (dict, list)) for item in items)
        and type(count) is int and count >= 0
        and type(size) is int and size >= 1
        and values.get("query") in QUERY_NAMES
    )  # fmt: skip


def open_folder(folder: Path, manifest: dict[str, Any], partition_size: int | None, usual_size: int) -> tuple[str, int]:
    """Makes the folder of a batch, or goes on with one that is there.

    Returns  A token, by which processes elsewhere tell that they see this very folder, and the partition size.
    Raises   ValueError if it is the folder of another batch, or holds something else.
    """
    if partition_size is not None:
        partition_size = operator.index(partition_size)
        if partition_size < 1:
            raise ValueError(f"partition_size: expected at least 1, got {partition_size}")
    folder.mkdir(parents=True, exist_ok=True)
    names = os.listdir(folder)  # before the manifest is looked for: another client may write it and more meanwhile
    if (folder / MANIFEST).exists():
        theirs = read_manifest(folder)
        size: int = theirs["partition_size"] if partition_size is None else partition_size
        ours = manifest | {"partition_size": size}
        for name in [*ours, *theirs]:
            if ours.get(name) != theirs.get(name):
                raise ValueError(
                    f"out: {folder} is the folder of another batch: {name} is {_text(theirs.get(name))} there, "
                    f"{_text(ours.get(name))} here"
                )
    elif any(name != TOKEN and not name.startswith(_TEMPORARY) for name in names):
        raise ValueError(f"out: {folder} is not empty, and has no {MANIFEST}")
    else:
        size = usual_size if partition_size is None else partition_size
        ours = manifest | {"partition_size": size}
        write_whole(folder / MANIFEST, (json.dumps(ours, indent=2) + "\n").encode())
    token = uuid.uuid4().hex
    write_whole(folder / TOKEN, token.encode())
    return token, size


def remove_leftovers(folder: Path) -> None:
    """Removes what writers that were killed have left, and the meshes, which nobody needs any more."""
    for path in [*folder.glob(f"{_TEMPORARY}*"), folder / MESHES]:
        if not path.is_dir():
            path.unlink(missing_ok=True)


def _text(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 24 else text[:20] + "…"


def _columns(records: RecordArray) -> Iterator[tuple[str, AnyArray]]:
    """Name and numbers of each column; points become three. Who writes to the numbers writes to the records."""
    for name in records.dtype.names or ():
        if records.dtype[name].shape == ():
            yield name, records[name]
        else:
            yield from ((f"{name}_{axis}", records[name][:, i]) for i, axis in enumerate("xyz"))


def to_parquet(records: RecordArray, first_row: int, label: str) -> bytes:
    """A Parquet file of records, one column for each number, with a hash of them all. Values are stored plainly: an
    encoding by values would take all not-a-numbers for the same, and answers hardly repeat."""
    arrow, parquet = imported("pyarrow"), imported("pyarrow.parquet")
    columns: dict[str, AnyArray] = {_ROW: numpy.arange(first_row, first_row + len(records))}
    columns |= {name: numpy.ascontiguousarray(column) for name, column in _columns(records)}
    out = arrow.BufferOutputStream()
    parquet.write_table(
        arrow.table(columns).replace_schema_metadata({_LABEL: label.encode(), _DIGEST: digest_of(columns.values()).encode()}),
        out,
        compression="none",
        use_dictionary=False,
        column_encoding={_ROW: "DELTA_BINARY_PACKED"},
        write_statistics=[_ROW],
    )
    data: bytes = out.getvalue().to_pybytes()
    return data


def read_parquet(path: Path, dtype: numpy.dtype[numpy.void], count: int, label: str) -> RecordArray | None:
    """The records of the partition with that label; None if the file is not there, not whole, damaged or another's."""
    arrow, parquet = imported("pyarrow"), imported("pyarrow.parquet")
    try:
        table = parquet.read_table(path, use_threads=False, partitioning=None)
        written: dict[bytes, bytes] = table.schema.metadata or {}
        if len(table) != count or written.get(_LABEL) != label.encode():
            return None
        columns: dict[str, AnyArray] = {name: table.column(name).to_numpy() for name in table.column_names}
        if written.get(_DIGEST) != digest_of(columns.values()).encode():
            return None
        records = numpy.zeros(count, dtype)
        for name, column in _columns(records):
            column[:] = columns[name]
        return records
    except (OSError, arrow.ArrowException, ValueError, KeyError):
        return None


def read(out: str | os.PathLike[str], begin: int = 0, end: int | None = None) -> RecordArray:
    """The answers in a folder, in the order of what was asked; with begin and end, those of that part.

    Shape    Records as those of distance_many(), collide_many() or within_many(), to the bit.
    Raises   OSError if there is no manifest; ValueError if it is none, and if partitions are missing or damaged: the
             same call that has begun the batch makes them; IndexError for a part that is none; MemoryError.
    """
    folder = Path(out)
    manifest = read_manifest(folder)
    name, dtype = batch_name(manifest), dtype_of(manifest["query"])
    count: int = manifest["count"]
    size: int = manifest["partition_size"]
    end = count if end is None else end
    if not 0 <= begin <= end <= count:
        raise IndexError(f"begin and end: expected 0 <= begin <= end <= {count}, got {begin} and {end}")
    try:
        records = numpy.zeros(end - begin, dtype)
    except (MemoryError, ValueError):
        raise MemoryError(f"out: no memory for {end - begin} answers of {folder}; begin and end give a part") from None
    wanted, missing = range(begin // size, -(-end // size)), list[int]()
    for i in wanted:
        first, last = i * size, min((i + 1) * size, count)
        part = read_parquet(folder / part_name(i), dtype, last - first, label_of(name, i))
        if part is None:
            missing.append(i)
        else:
            start, stop = max(begin, first), min(end, last)
            records[start - begin : stop - begin] = part[start - first : stop - first]
    if missing:
        raise ValueError(
            f"out: of {len(wanted)} partitions in {folder}, {len(missing)} are missing or damaged, "
            f"{part_name(missing[0])} among them"
        )
    return records
