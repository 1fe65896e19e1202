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
from .running import batch_name, ranges
from .tables import is_whole, read_parquet
from .work import label_of


def read(out: str | os.PathLike[str], begin: int = 0, end: int | None = None) -> RecordArray:
    """The answers in a folder, in the order of what was asked; with begin and end, those of that part.

    Shape    Records as those of distance_many(), collide_many() or within_many(), to the bit.
    Raises   OSError if the folder is that of no batch, or a file was damaged; ValueError if partitions are missing: the
             same call that has begun the batch goes on with it; IndexError for a part that is none.
    """
    folder = Path(out)
    manifest = read_manifest(folder)
    count, name = int(manifest["count"]), batch_name(manifest)
    end = count if end is None else end
    if not 0 <= begin <= end <= count:
        raise IndexError(f"begin and end: expected 0 <= begin <= end <= {count}, got {begin} and {end}")
    parts = ranges(count, int(manifest["partition_size"]))
    wanted = [i for i, (first, last) in enumerate(parts) if first < end and last > begin]
    missing = sum(not is_whole(folder / part_name(i), parts[i][1] - parts[i][0], label_of(name, i)) for i in wanted)
    if missing:
        raise ValueError(f"out: {missing} of {len(wanted)} partitions are missing in {folder}")
    dtype = dtype_of(str(manifest["query"]))
    records = numpy.zeros(end - begin, dtype)
    for i in wanted:
        first, last = parts[i]
        part = numpy.zeros(last - first, dtype)
        read_parquet(folder / part_name(i), part)
        cut = part[max(begin - first, 0) : min(end, last) - first]
        start = max(first - begin, 0)
        records[start : start + len(cut)] = cut
    return records
