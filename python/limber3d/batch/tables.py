# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Records as Parquet files, and back, to the bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy

from ..typing import RecordArray
from .extras import imported
from .inputs import AnyArray, Digest

_ROW = "row"  # the column that counts the records of all partitions
_LABEL, _DIGEST = b"limber3d", b"limber3d.sha256"  # keys of a file's schema


def _columns(records: RecordArray) -> Iterator[tuple[str, AnyArray]]:
    """Name and numbers of each column; points become three. Who writes to the numbers writes to the records."""
    for name in records.dtype.names or ():
        if records.dtype[name].shape == ():
            yield name, records[name]
        else:
            yield from ((f"{name}_{axis}", records[name][:, i]) for i, axis in enumerate("xyz"))


def _digest(columns: dict[str, AnyArray]) -> bytes:
    digest = Digest()
    for column in columns.values():
        digest.add(column)
    return digest.text().encode()


def to_parquet(records: RecordArray, first_row: int, label: str) -> bytes:
    """A Parquet file of records, one column for each number, with a hash of them all. Values are stored plainly: an
    encoding by values would take all not-a-numbers for the same, and answers hardly repeat."""
    arrow, parquet = imported("pyarrow"), imported("pyarrow.parquet")
    columns: dict[str, AnyArray] = {_ROW: numpy.arange(first_row, first_row + len(records))}
    columns |= {name: numpy.ascontiguousarray(column) for name, column in _columns(records)}
    out = arrow.BufferOutputStream()
    parquet.write_table(
        arrow.table(columns).replace_schema_metadata({_LABEL: label.encode(), _DIGEST: _digest(columns)}),
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
        if written.get(_DIGEST) != _digest(columns):
            return None
        records = numpy.zeros(count, dtype)
        for name, column in _columns(records):
            column[:] = columns[name]
        return records
    except (OSError, arrow.ArrowException, ValueError, KeyError):
        return None
