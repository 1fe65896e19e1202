# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files of poses: CSV as the program limber reads it, Parquet, and arrays of NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy

from .batch.folder import imported
from .typing import FloatArray

NAMES = ("tx", "ty", "tz", "qw", "qx", "qy", "qz")  # translation, quaternion
SUFFIXES = (".csv", ".npy", ".parquet")

Poses = FloatArray | tuple[FloatArray, FloatArray]


def read_poses(path: Path) -> Poses:
    """Poses as a query of many poses takes them: matrices, or quaternions and translations.

    Raises   OSError if the file cannot be read, ValueError with its name if it holds no poses.
    """
    if path.suffix not in SUFFIXES:
        raise ValueError(f"{path}: expected a file of poses: {', '.join(SUFFIXES)}")
    try:
        poses = {".csv": _of_csv, ".npy": _of_npy, ".parquet": _of_parquet}[path.suffix](path)
    except (ValueError, EOFError) as error:
        text = str(error)
        raise ValueError(text if text.startswith(f"{path}:") else f"{path}: {text}") from None
    if len(poses[0] if isinstance(poses, tuple) else poses) == 0:
        raise ValueError(f"{path}: has no pose")
    return poses


def _of_rows(rows: FloatArray) -> Poses:
    return numpy.ascontiguousarray(rows[:, 3:]), numpy.ascontiguousarray(rows[:, :3])


def _of_npy(path: Path) -> Poses:
    array: Any = numpy.load(path, mmap_mode="r", allow_pickle=False)
    if isinstance(array, numpy.lib.npyio.NpzFile):
        raise ValueError(f"{path}: is an archive of arrays, not an array")
    if array.dtype not in (numpy.float32, numpy.float64) or array.shape[1:] not in ((4, 4), (7,)):
        raise ValueError(
            f"{path}: expected shape (n, 4, 4), or (n, 7) with {','.join(NAMES)}, of float64 or float32; "
            f"got {array.shape} of {array.dtype}"
        )
    return _of_rows(array) if array.ndim == 2 else array


def _of_parquet(path: Path) -> Poses:
    file = imported("pyarrow.parquet").ParquetFile(path)
    for name in NAMES:
        if name not in file.schema_arrow.names:
            raise ValueError(f"{path}: there is no column {name}; poses are {','.join(NAMES)}")
    table = file.read(columns=list(NAMES))
    columns: list[Any] = [numpy.asarray(table.column(name).to_numpy(), float) for name in NAMES]
    return _of_rows(numpy.stack(columns, 1))


def _of_csv(path: Path) -> Poses:
    rows: list[list[float]] = []
    order: Sequence[int] | None = None  # of the columns that make a pose
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        fields = [field.strip() for field in line.split(",")]
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if order is None:
            order = range(len(NAMES))
            if not _is_number(fields[0]):
                order = [_place(path, number, fields, name) for name in NAMES]
                continue
        if len(fields) <= max(order) or (isinstance(order, range) and len(fields) != len(NAMES)):
            raise ValueError(f"{path}:{number}: a pose is {len(NAMES)} numbers {','.join(NAMES)}, not {len(fields)}")
        for k in order:
            if not _is_number(fields[k]):
                raise ValueError(f"{path}:{number}: '{fields[k]}' is not a number")
        rows.append([float(fields[k]) for k in order])
    return _of_rows(numpy.array(rows, float).reshape(-1, len(NAMES)))


def _place(path: Path, number: int, header: list[str], name: str) -> int:
    if name not in header:
        raise ValueError(f"{path}:{number}: there is no column {name}; poses are {','.join(NAMES)}")
    return header.index(name)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
