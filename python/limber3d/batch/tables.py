# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Records as Parquet files, and back, to the bit."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any, Union

import numpy

from ..typing import RecordArray
from .extras import imported

ROW = "row"  # the column that counts the records of all partitions
_METADATA = b"limber3d"  # the key of the job and the partition in a file's schema


def _columns(dtype: numpy.dtype[numpy.void]) -> Iterator[tuple[str, str, Union[int, None]]]:
    """Column, field and coordinate: points become three columns."""
    for name in dtype.names or ():
        if dtype[name].shape == ():
            yield name, name, None
        else:
            yield from ((f"{name}_{axis}", name, i) for i, axis in enumerate("xyz"))


def _column_of(records: RecordArray, field: str, coordinate: Union[int, None]) -> Any:
    return records[field] if coordinate is None else records[field][:, coordinate]


def to_parquet(records: RecordArray, first_row: int, label: str) -> bytes:
    """A Parquet file of records, one column for each number. Values are stored plainly: an encoding by values would take
    all not-a-numbers for the same, and answers hardly repeat."""
    arrow, parquet = imported("pyarrow"), imported("pyarrow.parquet")
    columns = {ROW: arrow.array(numpy.arange(first_row, first_row + len(records)))}
    for name, field, coordinate in _columns(records.dtype):
        columns[name] = arrow.array(numpy.ascontiguousarray(_column_of(records, field, coordinate)))
    table = arrow.table(columns).replace_schema_metadata({_METADATA: label.encode()})
    out = arrow.BufferOutputStream()
    parquet.write_table(
        table,
        out,
        compression="none",
        use_dictionary=False,
        column_encoding={ROW: "DELTA_BINARY_PACKED"},
        write_statistics=[ROW],
        write_page_checksum=True,
    )
    data: bytes = out.getvalue().to_pybytes()
    return data


def is_whole(path: Union[str, os.PathLike[str]], count: int, label: str) -> bool:
    """Whether a file is there, complete, and the partition with that label."""
    arrow, parquet = imported("pyarrow"), imported("pyarrow.parquet")
    try:
        metadata = parquet.read_metadata(path)
    except (OSError, arrow.ArrowInvalid):
        return False
    labels: dict[bytes, bytes] = metadata.metadata or {}
    return bool(metadata.num_rows == count and labels.get(_METADATA) == label.encode())


def read_parquet(path: Union[str, os.PathLike[str]], records: RecordArray) -> None:
    """Reads a file of as many records. Raises OSError where its checksums tell that it was damaged."""
    table = imported("pyarrow.parquet").read_table(
        path, use_threads=False, partitioning=None, page_checksum_verification=True
    )
    for name, field, coordinate in _columns(records.dtype):
        _column_of(records, field, coordinate)[:] = table.column(name).to_numpy()
