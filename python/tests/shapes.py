# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Meshes and poses for tests."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy

Arrays = tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.uint32]]

TETRA_VERTICES = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], numpy.float64)
TETRA_FACES = numpy.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], numpy.uint32)


def ball(slices: int = 24, stacks: int = 16) -> Arrays:
    """A closed unit ball with poles on the z axis; normals point outward."""
    angle = numpy.linspace(0, 2 * numpy.pi, slices, endpoint=False)
    height = numpy.linspace(-numpy.pi / 2, numpy.pi / 2, stacks + 1)[1:-1]
    rings = [
        numpy.stack([numpy.cos(h) * numpy.cos(angle), numpy.cos(h) * numpy.sin(angle), 0 * angle + numpy.sin(h)], 1)
        for h in height
    ]
    vertices = numpy.concatenate([[[0, 0, -1]], *rings, [[0, 0, 1]]])
    i, j = numpy.arange(slices), (numpy.arange(slices) + 1) % slices
    faces = [numpy.stack([0 * i, 1 + j, 1 + i], 1)]
    for k in range(stacks - 2):
        low, high = 1 + k * slices, 1 + (k + 1) * slices
        faces += [numpy.stack([low + i, low + j, high + j], 1), numpy.stack([low + i, high + j, high + i], 1)]
    top = 1 + (stacks - 2) * slices
    faces.append(numpy.stack([top + i, top + j, 0 * i + len(vertices) - 1], 1))
    return vertices, numpy.concatenate(faces).astype(numpy.uint32)


def rotation(q: Any) -> numpy.typing.NDArray[numpy.float64]:
    """The rotation of a quaternion w, x, y, z."""
    w, x, y, z = numpy.asarray(q, float) / numpy.linalg.norm(q)
    return numpy.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def random_quaternions(seed: int, count: int, spread: float) -> tuple[Any, Any]:
    """Random turns, and shifts of that spread."""
    rng = numpy.random.default_rng(seed)
    return rng.normal(size=(count, 4)), rng.normal(size=(count, 3)) * spread


def random_poses(seed: int, count: int, spread: float = 2.0) -> numpy.typing.NDArray[numpy.float64]:
    """Random poses as 4 x 4 matrices."""
    turns, shifts = random_quaternions(seed, count, spread)
    poses = numpy.tile(numpy.eye(4), (count, 1, 1))
    for pose, turn, shift in zip(poses, turns, shifts):
        pose[:3, :3], pose[:3, 3] = rotation(turn), shift
    return poses


def tell_progress(monkeypatch: Any, totals: list[Any], update: Any) -> None:
    """Stands in for tqdm: notes what there is in all, and calls update(done)."""

    @contextmanager
    def bar(total: int | None) -> Iterator[Any]:
        totals.append(total)
        yield SimpleNamespace(update=update)

    monkeypatch.setitem(sys.modules, "tqdm.auto", SimpleNamespace(tqdm=bar))


def write_obj(path: Path, vertices: Any, faces: Any) -> Path:
    """Writes a mesh with all digits."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in numpy.asarray(vertices).tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in numpy.asarray(faces).tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def same_bits(a: Any, b: Any) -> bool:
    """Records that are equal in all fields to the bit, what is not a number included."""
    names = a.dtype.names or ()
    return bool(a.dtype == b.dtype and all(a[name].tobytes() == b[name].tobytes() for name in names))
