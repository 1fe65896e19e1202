# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The types of arguments and results, for annotations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, TypedDict, Union

import numpy
import numpy.typing

if TYPE_CHECKING:
    from . import _core, results

ArrayLike = numpy.typing.ArrayLike
"""An array, or a list that becomes one. Arrays are read where they are; see the guide for shapes and element types."""

FloatArray = numpy.typing.NDArray[numpy.float64]
IdArray = numpy.typing.NDArray[numpy.uint32]
RecordArray = numpy.typing.NDArray[numpy.void]
"""An array of records; its element type is one of the module's, such as limber3d.contact_dtype."""

ContactsLike = Union["results.Contacts", "results.ReducedContacts", RecordArray, numpy.void]
"""Contacts, an array of limber3d.contact_dtype, or one of its records."""

PoseLike = Union[ArrayLike, tuple[ArrayLike, ArrayLike], None]
"""world_from_model: None for the identity; a 4 x 4 matrix; (rotation, translation), where the rotation is a 3 x 3
matrix; (quaternion, translation), where the quaternion is w, x, y, z."""

PosesLike = PoseLike
"""Many poses: the forms of PoseLike with an axis of poses before the others, or one pose for all."""

TriangleFilter = Union["_core.NeighborRings", Callable[[int, int], object], None]
"""Which pairs of triangles count: rings of neighbors, or a function of two ids, which makes a query hold the GIL."""

ObjectFilter = Union["_core.ObjectPairMatrix", Callable[[int, int], object], None]
"""Which pairs of objects of a scene count: a matrix, or a function of two ids, which makes a query hold the GIL."""

SingleObjectFilter = Union[Callable[[int], object], None]
"""Which objects of a scene count next to a model: a function of an id, which makes a query hold the GIL."""


class MeshWithFaces(Protocol):
    """A mesh such as trimesh.Trimesh."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


class MeshWithTriangles(Protocol):
    """A mesh such as Open3D's TriangleMesh."""

    @property
    def vertices(self) -> Any: ...
    @property
    def triangles(self) -> Any: ...


MeshLike = Union[MeshWithFaces, MeshWithTriangles]


class ModelOptions(TypedDict):
    """The options that a model was made with."""

    motion_margin: float
    rebuild_policy: _core.RebuildPolicy
    rebuild_budget_us: float | None
    preallocate: bool


__all__ = [
    "ArrayLike",
    "ContactsLike",
    "FloatArray",
    "IdArray",
    "MeshLike",
    "ModelOptions",
    "ObjectFilter",
    "PoseLike",
    "PosesLike",
    "RecordArray",
    "SingleObjectFilter",
    "TriangleFilter",
]
