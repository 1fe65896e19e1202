# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results that hold arrays."""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes
from shapes import TETRA_FACES, TETRA_VERTICES

NEAR = ([1, 0.2, 0.1, 0], [0.5, 0, 0])


def results(folder: Path) -> list[Any]:
    """One of each class."""
    tetra = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    moving = limber3d.MovingModel(tetra)
    moving.set_motion(TETRA_VERTICES)
    contacts = limber3d.contacts(tetra, tetra, 0.1, pose_b=NEAR)
    path = shapes.write_obj(folder / "tetra.obj", TETRA_VERTICES, TETRA_FACES)
    return [
        *(contacts, limber3d.intersections(tetra, tetra, pose_b=NEAR), limber3d.reduce_contacts(contacts, 0.5)),
        *(limber3d.impacts(moving, moving), limber3d.impact_candidates(moving, moving)),
        *(limber3d.element_pairs(tetra, tetra, 0.1), limber3d.feature_pairs(tetra, tetra, 0.1)),
        limber3d.contacts_many(tetra, tetra, 0.1, NEAR),
        *(limber3d.weld(tetra), limber3d.read_mesh_file(path)),
        *(limber3d.pose_gradient_a(contacts, [0, 0, 0]), limber3d.limit_displacements(tetra, tetra, 0.1, [1.0] * 4)),
    ]


def test_results_are_no_tuples_and_survive_pickles(tmp_path: Path) -> None:
    all_results = results(tmp_path)
    classes = {c for name in limber3d.__all__ if dataclasses.is_dataclass(c := getattr(limber3d, name))}
    assert {type(result) for result in all_results} == classes and len(classes) == len(all_results)
    for result in all_results:
        assert not isinstance(result, tuple) and type(result).__module__ == "limber3d" and type(result).__doc__
        twin = pickle.loads(pickle.dumps(result))
        assert type(twin) is type(result) and repr(twin) == repr(result)
        for field in dataclasses.fields(result):
            member = getattr(result, field.name)
            assert numpy.array_equal(getattr(twin, field.name), member)
            with pytest.raises(AttributeError):
                setattr(result, field.name, member)


def test_results_are_used_as_their_records(tmp_path: Path) -> None:
    used = 0
    for result in results(tmp_path):
        if not hasattr(result, "records"):
            continue
        records = result.records
        assert len(result) == len(records) > 0 and (result[1:] == records[1:]).all()
        assert all(numpy.array_equal(one, other) for one, other in zip(result, records, strict=True))
        assert numpy.asarray(result) is records and (numpy.array(result) == records).all()
        assert not numpy.shares_memory(numpy.array(result), records)
        used += 1
    assert used == 6
    pairs = next(result for result in results(tmp_path) if isinstance(result, limber3d.TrianglePairs))
    assert numpy.asarray(pairs, float).dtype == float


def test_a_mesh_file_tells_of_its_faces(tmp_path: Path) -> None:
    path = tmp_path / "square.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2\nf 1 2 3 4\n")
    file = limber3d.read_mesh_file(path)
    assert file.vertices.shape == (4, 3) and file.faces.shape == (2, 3)
    assert file.face_of_triangle.tolist() == [1, 1] and file.face_count == 2
    assert (limber3d.Model(file).faces == file.faces).all()
    assert file.vertex_of_file_vertex.tolist() == [0, 1, 2, 3] and file.files == [path]
    assert file.parts == [""] and file.part_of_triangle.tolist() == [0, 0]
