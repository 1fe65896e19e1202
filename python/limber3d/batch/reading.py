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
from .tables import read_parquet
from .work import label_of


def read(out: str | os.PathLike[str], begin: int = 0, end: int | None = None) -> RecordArray:
    """The answers in a folder, in the order of what was asked; with begin and end, those of that part.

    Shape    Records as those of distance_many(), collide_many() or within_many(), to the bit.
    Raises   OSError if the folder is that of no batch; ValueError if partitions are missing or damaged: the same call
             that has begun the batch makes them; IndexError for a part that is none.
    """
    folder = Path(out)
    manifest = read_manifest(folder)
    count, name, dtype = int(manifest["count"]), batch_name(manifest), dtype_of(str(manifest["query"]))
    end = count if end is None else end
    if not 0 <= begin <= end <= count:
        raise IndexError(f"begin and end: expected 0 <= begin <= end <= {count}, got {begin} and {end}")
    parts = ranges(count, int(manifest["partition_size"]))
    wanted = [i for i, (first, last) in enumerate(parts) if first < end and begin < last]
    records, missing = numpy.zeros(end - begin, dtype), list[int]()
    for i in wanted:
        first, last = parts[i]
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
