# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Answers of a batch that is complete."""

from __future__ import annotations

import os
from pathlib import Path

import numpy

from ..typing import RecordArray
from .folder import part_name, read_manifest
from .queries import dtype_of
from .running import batch_name
from .tables import read_parquet
from .work import label_of


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
