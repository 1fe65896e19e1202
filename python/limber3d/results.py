# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results that hold arrays. Later versions may add members."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy
import numpy.typing

from ._core import QueryStats, StoppedBy
from .typing import FloatArray, IdArray, RecordArray


@dataclass(frozen=True, eq=False, kw_only=True)
class _Records:
    records: numpy.typing.NDArray[Any]

    def __len__(self) -> int:
        return len(self.records)

    def __getitem__(self, key: Any) -> Any:
        return self.records[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.records)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> numpy.typing.NDArray[Any]:
        array = numpy.asarray(self.records, dtype)
        if copy is False and array is not self.records:
            raise ValueError("records of another type are a copy")
        return array.copy() if copy and array is self.records else array


@dataclass(frozen=True, eq=False, kw_only=True)
class _Search:
    is_complete: bool
    """False if max_count or the budget has ended the search: there may be more."""
    stopped_by: StoppedBy
    """Which limit of the budget, if it was that."""
    stats: QueryStats
    """Work done."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Contacts(_Search, _Records):
    """Contacts: `records` is an array of limber3d.contact_dtype. Length, iteration, [] and numpy.asarray() are those of
    the array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TrianglePairs(_Search, _Records):
    """Pairs of triangles that intersect: `records` are their ids, shape (k, 2), uint32. Length, iteration, [] and
    numpy.asarray() are those of the array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Impacts(_Search, _Records):
    """Elements that touch: `records` is an array of limber3d.impact_dtype. Length, iteration, [] and numpy.asarray()
    are those of the array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ImpactCandidates(_Search, _Records):
    """Elements that may touch: `records` is an array of limber3d.element_pair_dtype. Length, iteration, [] and
    numpy.asarray() are those of the array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedContacts(_Records):
    """The contacts that reduce_contacts() keeps: `records` is an array of limber3d.contact_dtype. Length, iteration, []
    and numpy.asarray() are those of the array."""

    patch_ids: IdArray
    """The number of the patch of each."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementPairs(_Search):
    """Elements that are close."""

    vertex_face: RecordArray
    """Vertices with faces, limber3d.vertex_face_dtype."""
    edge_edge: RecordArray
    """Edges with edges, limber3d.edge_edge_dtype."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FeaturePairs(_Search, _Records):
    """Features that are close, each pair once: `records` is an array of limber3d.feature_pair_dtype. Length, iteration,
    [] and numpy.asarray() are those of the array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ManyContacts:
    """The contacts of many poses, or of many pairs of objects: [i] and iteration give those of each."""

    contacts: RecordArray
    """Of all, one pose or pair after the other, limber3d.contact_dtype."""
    offsets: numpy.typing.NDArray[numpy.int64]
    """Pose or pair i has contacts[offsets[i]:offsets[i + 1]]; one more than there are."""

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, i: int) -> RecordArray:
        i = range(len(self))[i]
        return self.contacts[self.offsets[i] : self.offsets[i + 1]]

    def __iter__(self) -> Iterator[RecordArray]:
        return (self[i] for i in range(len(self)))


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshFile:
    """A mesh as a file describes it. Model() takes it as it is."""

    vertices: FloatArray
    """Welded, in order of first appearance: shape (v, 3)."""
    faces: IdArray
    """Triangles, shape (n, 3)."""
    face_of_triangle: IdArray
    """The file's own face, counted from 0, behind each triangle."""
    face_count: int
    """Faces in the file."""
    vertex_of_file_vertex: IdArray
    """The vertex that each vertex of the file has become."""
    parts: list[str]
    """Names of the parts with faces, in order of appearance; one without a name if the file has no parts."""
    part_of_triangle: IdArray
    """In parts."""
    files: list[Path]
    """Every file that was read, the mesh file first."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WeldedMesh:
    """A mesh whose vertices at equal positions are one. Model() takes it as it is."""

    vertices: FloatArray
    """Shape (v, 3)."""
    faces: IdArray
    """Shape (n, 3)."""
    welded_of: IdArray
    """For each vertex that was given, the one that it has become."""
    first_of: IdArray
    """For each vertex, the first that was given there."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PoseGradient:
    """The derivatives of distances by a rigid motion of one model, for each contact."""

    force: FloatArray
    """By a translation; of length 1."""
    moment: FloatArray
    """By a rotation about the center that was given, in radians about each axis."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DisplacementLimits:
    """How far the vertices of two models may go."""

    of_a: FloatArray
    of_b: FloatArray | None
    """None if b stands still."""


def restored(kind: Any, arguments: tuple[Any, ...], state: tuple[Any, ...] | None) -> Any:
    """An object of a pickle, which holds the arguments of its class and a state."""
    made = kind(*arguments)
    if state is not None:
        made._restore(state)
    return made
