# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What exceptions say: their class, code, place and text."""

from __future__ import annotations

import copy
import os
import pickle
from collections.abc import Callable
from pathlib import Path

import limber3d
import numpy
import pytest
import shapes
from limber3d import ErrorCode
from shapes import TETRA_FACES, TETRA_VERTICES


def mesh_with(row: int, value: float) -> limber3d.Model:
    vertices = TETRA_VERTICES.copy()
    vertices[row, 1] = value
    return limber3d.Model(vertices, TETRA_FACES)


def model() -> limber3d.Model:
    return limber3d.Model(TETRA_VERTICES, TETRA_FACES)


def open_model() -> limber3d.Model:
    return limber3d.Model(TETRA_VERTICES, TETRA_FACES[1:])


def poses_with_a_mirror() -> numpy.typing.NDArray[numpy.float64]:
    poses = numpy.tile(numpy.eye(4), (3, 1, 1))
    poses[2, 0, 0] = -1
    return poses


MISTAKES: list[tuple[Callable[[], object], type[Exception], ErrorCode, int | None]] = [
    (lambda: limber3d.Model(TETRA_VERTICES, []), ValueError, ErrorCode.empty_mesh, None),
    (lambda: mesh_with(2, float("nan")), ValueError, ErrorCode.non_finite, 2),
    (lambda: mesh_with(3, 1e90), ValueError, ErrorCode.too_large, 3),
    (lambda: limber3d.Model(TETRA_VERTICES[:3], TETRA_FACES), IndexError, ErrorCode.index_out_of_range, 1),
    (lambda: model().move_vertices([1, 7], [[0, 0, 0]] * 2), IndexError, ErrorCode.index_out_of_range, 1),
    (lambda: model().move_vertices([1, 2, -1], [[0, 0, 0]] * 3), IndexError, ErrorCode.index_out_of_range, 2),
    (lambda: model().move_all(TETRA_VERTICES[:3]), ValueError, ErrorCode.size_mismatch, None),
    (lambda: limber3d.distance(model(), model(), numpy.eye(4) * 2), ValueError, ErrorCode.not_rigid, None),
    (lambda: limber3d.collide_many(model(), model(), poses_with_a_mirror()), ValueError, ErrorCode.not_rigid, 2),
    (lambda: limber3d.ClosedSurface(open_model()), ValueError, ErrorCode.not_closed, 0),
    (lambda: limber3d.load("/nowhere/mesh.obj"), OSError, ErrorCode.unreadable_file, None),
    (lambda: limber3d.load(__file__), ValueError, ErrorCode.unsupported_format, None),
]


@pytest.mark.parametrize(("mistake", "kind", "code", "where"), MISTAKES)
def test_errors_know_what_was_wrong_and_where(
    mistake: Callable[[], object], kind: type[Exception], code: ErrorCode, where: int | None
) -> None:
    with pytest.raises(limber3d.Error) as raised:
        mistake()
    error = raised.value
    assert isinstance(error, kind) and (error.code, error.where) == (code, where)
    assert len(str(error).splitlines()) == 1 and error.args == (str(error),)
    for twin in (*(pickle.loads(pickle.dumps(error, p)) for p in range(6)), copy.copy(error), copy.deepcopy(error)):
        assert type(twin) is type(error) and str(twin) == str(error)
        assert (twin.code, twin.where, twin.args) == (code, where, error.args)


def test_interruptions_are_pickled_with_their_results() -> None:
    results = limber3d.distance_many(model(), model())
    twin = pickle.loads(pickle.dumps(limber3d.BatchInterrupted(results, 1)))
    assert twin.count == 1 and (twin.results == results).all() and str(twin) == "interrupted after 1 results"


REFUSED: list[tuple[Callable[[], object], str]] = [
    (lambda: limber3d.contacts(model(), model(), -1.0), "limber3d.contacts: margin must be finite and at least 0"),
    (lambda: limber3d.Scene().remove(1), "limber3d.Scene.remove: id names no object of the scene"),
    (lambda: limber3d.Model(TETRA_VERTICES, TETRA_FACES, motion_margin=-1.0), "limber3d.*motion_margin.*"),
    (lambda: limber3d.Model(TETRA_VERTICES, []), "the mesh has no triangle.*"),
    (lambda: mesh_with(2, float("nan")), "vertex 2 .*"),
]


@pytest.mark.parametrize(("mistake", "text"), REFUSED)
def test_refused_calls_are_named_as_in_python(mistake: Callable[[], object], text: str) -> None:
    with pytest.raises(ValueError, match=f"^{text}$"):
        mistake()


def test_names_of_files_need_not_be_utf_8(tmp_path: Path) -> None:
    folder = os.fsencode(tmp_path)
    shapes.write_obj(tmp_path / "mesh.obj", TETRA_VERTICES, TETRA_FACES)
    os.rename(folder + b"/mesh.obj", folder + b"/\xff.obj")
    assert len(limber3d.load(os.fsdecode(folder + b"/\xff.obj")).faces) == 4
    missing = os.fsdecode(folder + b"/\xfe.obj")
    with pytest.raises(OSError) as raised:
        limber3d.load(missing)
    assert missing in str(raised.value)


class Forgetful(limber3d.Model):
    def __init__(self) -> None:
        pass


@pytest.mark.filterwarnings("ignore:nanobind")
def test_a_model_that_was_not_initialized_is_a_type_error() -> None:
    forgetful = Forgetful()
    for use in (
        lambda: limber3d.distance(forgetful, forgetful),
        lambda: limber3d.distance_many(forgetful, forgetful),
        lambda: limber3d.ClosedSurface(forgetful),
        lambda: limber3d.Scene().add(forgetful),
        lambda: pickle.dumps(forgetful),
        lambda: forgetful.vertices,
    ):
        with pytest.raises(TypeError):
            use()


def test_contacts_to_reduce_are_checked() -> None:
    contacts = limber3d.contacts(model(), model(), 0.1).records
    kept = limber3d.reduce_contacts(contacts, radius=0.5)
    # NumPy packs what it concatenates: the same fields at other places.
    packed = numpy.concatenate([contacts[:1], contacts[1:]])
    assert packed.dtype != limber3d.contact_dtype
    assert (limber3d.reduce_contacts(packed, radius=0.5).records == kept.records).all()
    for bad in (numpy.zeros(3), "contacts", contacts[None], numpy.zeros(2, limber3d.distance_dtype)):
        with pytest.raises(ValueError, match="^contacts: expected shape"):
            limber3d.reduce_contacts(bad, radius=0.5)  # type: ignore[arg-type]
