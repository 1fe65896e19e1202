# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which arrays are taken, and what is said about others."""

from __future__ import annotations

import array
import ctypes
from typing import Any

import limber3d
import numpy
import pytest
from shapes import TETRA_FACES, TETRA_VERTICES


@pytest.mark.parametrize("dtype", ["float32", "float64", "float16", ">f8", ">f4", "int8", "uint8", "int64", ">i2"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_vertices_of_all_numbers_and_orders_are_read(dtype: str, order: Any) -> None:
    vertices = numpy.array(TETRA_VERTICES, dtype, order=order)
    assert (limber3d.Model(vertices, TETRA_FACES).vertices == TETRA_VERTICES).all()


@pytest.mark.parametrize("dtype", ["int32", "int64", "uint32", "uint64", "uint8", "int8", "uint16", ">u4", ">i8"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_faces_of_all_integers_are_read(dtype: str, order: Any) -> None:
    model = limber3d.Model(TETRA_VERTICES, numpy.array(TETRA_FACES, dtype, order=order))
    assert (model.faces == TETRA_FACES).all() and model.faces.dtype == numpy.uint32


def strided(values: Any, kind: str) -> Any:
    """The same numbers with other strides."""
    wide = numpy.zeros((2 * len(values), 5), values.dtype)
    if kind == "every other row":
        rows = wide[::2, 1 : 1 + values.shape[1]]
        rows[:] = values
        return rows
    if kind == "backwards":
        return values[::-1].copy()[::-1]
    if kind == "columns apart":
        apart = numpy.zeros((len(values), 2 * values.shape[1]), values.dtype)
        apart[:, ::2] = values
        return apart[:, ::2]
    unaligned = numpy.zeros(values.nbytes + 1, numpy.uint8)[1:].view(values.dtype).reshape(values.shape)
    unaligned[:] = values
    assert not unaligned.flags.aligned
    return unaligned


@pytest.mark.parametrize("kind", ["every other row", "backwards", "columns apart", "unaligned"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_any_strides_are_read(kind: str, dtype: str) -> None:
    vertices, faces = strided(TETRA_VERTICES.astype(dtype), kind), strided(TETRA_FACES.astype("int64"), kind)
    model = limber3d.Model(vertices, faces)
    assert (model.vertices == TETRA_VERTICES).all() and (model.faces == TETRA_FACES).all()
    model.move_all(strided((TETRA_VERTICES + 1).astype(dtype), kind))
    for i, id_type in enumerate(["int32", "int64", "uint32", "uint64"]):
        ids = strided(numpy.array([[1], [0], [3], [2]], id_type), kind)[:, 0]
        model.move_vertices(ids, strided((TETRA_VERTICES + i).astype(dtype), kind))
        assert (model.vertices == (TETRA_VERTICES + i)[[1, 0, 3, 2]]).all()


def test_read_only_arrays_lists_and_buffers_are_read() -> None:
    vertices = TETRA_VERTICES.copy()
    vertices.flags.writeable = False
    assert (limber3d.Model(vertices, TETRA_FACES.tolist()).vertices == TETRA_VERTICES).all()
    assert (limber3d.Model(TETRA_VERTICES.tolist(), TETRA_FACES).faces == TETRA_FACES).all()
    model = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    model.move_vertices(array.array("I", [1, 2]), [[5, 0, 0], [0, 5, 0]])
    assert (model.vertices[1:3] == [[5, 0, 0], [0, 5, 0]]).all()
    model.move_vertices([], numpy.zeros((0, 3)))
    model.move_vertices(numpy.zeros((0, 3), int)[::-1, 0], numpy.zeros((0, 3))[::-1])
    model.move_vertices([], [])
    assert (model.vertices[1:3] == [[5, 0, 0], [0, 5, 0]]).all()
    model.commit()
    assert limber3d.closest_point_many(model, []).shape == (0,)


def test_buffers_without_strides_and_subclasses_are_read() -> None:
    rows = (ctypes.c_double * 3 * 4)(*((ctypes.c_double * 3)(*row) for row in TETRA_VERTICES))
    faces = (ctypes.c_uint32 * 3 * 4)(*((ctypes.c_uint32 * 3)(*row) for row in TETRA_FACES.tolist()))
    model = limber3d.Model(rows, faces)
    assert (model.vertices == TETRA_VERTICES).all() and (model.faces == TETRA_FACES).all()
    model.move_vertices((ctypes.c_uint32 * 2)(1, 2), (TETRA_VERTICES + 1).data[1:3])
    assert (model.vertices[1:3] == TETRA_VERTICES[1:3] + 1).all()
    assert (limber3d.Model(TETRA_VERTICES.view(numpy.recarray), TETRA_FACES).vertices == TETRA_VERTICES).all()
    unmasked = numpy.ma.masked_array(TETRA_VERTICES, mask=False)
    assert (limber3d.Model(unmasked, TETRA_FACES).vertices == TETRA_VERTICES).all()


BAD_VERTICES: dict[str, Any] = {
    "shape (4, 2) and dtype float64": TETRA_VERTICES[:, :2],
    "shape (12,) and dtype float64": TETRA_VERTICES.ravel(),
    "shape (1, 4, 3) and dtype float64": TETRA_VERTICES[None],
    "shape () and dtype float64": numpy.array(1.0),
    "shape (4, 3) and dtype complex128": TETRA_VERTICES.astype("complex128"),
    "shape (4, 3) and dtype datetime64[s]": TETRA_VERTICES.astype("datetime64[s]"),
    "shape (4, 3) and dtype bool": TETRA_VERTICES.astype(bool),
    "shape (2, 3) and dtype <U1": [["1", "2", "3"], ["4", "5", "6"]],
    "shape (1, 3) and dtype object": [[10**400, 0, 0]],
    "shape (12,) and dtype B": b"twelve bytes",
    "masked elements": numpy.ma.masked_array(TETRA_VERTICES, mask=TETRA_VERTICES > 0),
    "str": "vertices",
    "dict": {"x": [1, 2, 3]},
    "list": [[1, 2, 3], [4]],
}


@pytest.mark.parametrize("found", BAD_VERTICES)
def test_other_vertices_are_refused_by_name_shape_and_dtype(found: str) -> None:
    with pytest.raises(ValueError) as refused:
        limber3d.Model(BAD_VERTICES[found], TETRA_FACES)
    assert str(refused.value) == f"vertices: expected shape (n, 3) of floats or integers; got {found}"


def test_other_faces_and_ids_are_refused_by_name_shape_and_dtype() -> None:
    with pytest.raises(ValueError, match=r"^faces: expected shape \(n, 3\).*; got shape \(4, 3\) and dtype float64$"):
        limber3d.Model(TETRA_VERTICES, TETRA_FACES.astype(float))
    with pytest.raises(ValueError, match=r"^faces: expected .*; got shape \(0, 5\) and dtype int64$"):
        limber3d.Model(TETRA_VERTICES, numpy.zeros((0, 5), int))
    with pytest.raises(ValueError, match="^faces: expected .*; got masked elements$"):
        limber3d.Model(TETRA_VERTICES, numpy.ma.masked_array(TETRA_FACES, mask=TETRA_FACES > 2))
    model = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    with pytest.raises(ValueError, match=r"^ids: expected shape \(n,\).*; got shape \(1, 1\) and dtype int64$"):
        model.move_vertices(numpy.array([[1]]), [[0, 0, 0]])
    with pytest.raises(ValueError, match=r"^positions: expected .*; got shape \(3,\) and dtype float64$"):
        model.move_all(numpy.zeros(3))


def test_ids_that_are_none_are_index_errors_and_change_nothing() -> None:
    model = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    for ids in ([-1], [4], [2**32], numpy.array([2**64 - 1], "uint64"), numpy.array([-1], "int32")):
        with pytest.raises(IndexError):
            model.move_vertices(ids, [[9, 9, 9]])
    with pytest.raises(IndexError, match=r"faces\[0\]: -1 is not an index"):
        limber3d.Model(TETRA_VERTICES, TETRA_FACES.astype("int32") - 1)
    with pytest.raises(IndexError, match="triangle 0 names vertex 9"):
        limber3d.Model(TETRA_VERTICES, TETRA_FACES + 9)
    assert (model.vertices == TETRA_VERTICES).all() and model.is_committed
