# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results as values: what they are written as, equality, hashes, copies and pickles."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import limber3d
import numpy
import pytest
from shapes import TETRA_FACES, TETRA_VERTICES

FAR = ([1, 0, 0, 0], [3, 0, 0])


def results() -> list[Any]:
    """Values of all classes, no two of which are equal."""
    tetra = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    surface = limber3d.ClosedSurface(tetra)
    scene = limber3d.Scene()
    scene.add(tetra)
    scene.add(tetra, FAR)
    scene.commit()
    budget = limber3d.QueryBudget(max_steps=0)
    far, near = limber3d.distance(tetra, tetra, pose_b=FAR), limber3d.distance(tetra, tetra)
    closest = limber3d.closest_point(tetra, [3, 0, 0])
    beyond = limber3d.closest_point(tetra, [3, 0, 0], max_distance=1.0)
    assert closest.closest is not None and beyond.closest is None
    moving, goes = limber3d.MovingModel(tetra), limber3d.RigidMotion(FAR, None)
    moving.set_motion(TETRA_VERTICES)
    other = limber3d.MovingModel(tetra)
    other.set_motion(TETRA_VERTICES, FAR, ([1, 0, 0, 0], [0.5, 0.25, 0.25]))
    hit, stands = limber3d.time_of_impact(moving, other), limber3d.RigidMotion()
    solids = (None, ([1, 0, 0, 0], [0.125, 0.125, 0.125]), FAR)
    out = [1, 1, 0]
    return [
        *(limber3d.solid_relation(surface, surface, pose_b=pose) for pose in solids),
        *(limber3d.separating_translation(surface, surface, out, pose_b=pose) for pose in solids),
        *(limber3d.deepest_vertices(surface, surface, pose_b=pose) for pose in solids),
        *(limber3d.deepest_vertices(surface, surface, solids[1]).of_a,),
        *(limber3d.signed_distance(surface, surface, pose_b=pose) for pose in solids[1:]),
        *(far, near, far.witness, near.witness, far.stats),
        *(limber3d.collide(tetra, tetra), limber3d.collide(tetra, tetra, FAR)),
        *(limber3d.within(tetra, tetra, 2.5, FAR), limber3d.within(tetra, tetra, 1.0, FAR)),
        *(limber3d.collide(tetra, tetra, p, budget=budget) for p in (None, FAR)),
        *(closest, beyond, closest.closest, closest.closest.feature),
        *(surface.signed_distance(point) for point in ([0.1, 0.1, 0.1], [3, 0, 0])),
        *(scene.closest_objects(), scene.closest_objects(max_distance=0.5)),
        *(scene.any_within(2.5), scene.any_within(0.5), scene.closest_object(tetra)),
        *(scene.closest_object(tetra, FAR, max_distance=0.5), scene.time_of_impact(tetra, goes)),
        *(scene.time_of_impact(tetra, stands),),
        *(hit, hit.elements, limber3d.time_of_impact(moving, moving)),
        *(limber3d.time_of_impact(tetra, stands, tetra, goes), limber3d.min_distance(tetra, stands, tetra, goes)),
        *(tetra.tree_stats, tetra.maintenance_stats, tetra.bounding_box(), tetra.bounding_sphere()),
        limber3d.signed_distance(surface, surface, pose_b=solids[1]).deepest,
    ]


def fields_of(value: Any) -> list[str]:
    return [name for name in dir(type(value)) if not name.startswith("_")]


VALUES = results()
CLASSES = {type(value) for value in VALUES}


def test_all_classes_of_results_are_here() -> None:
    classes = [member for name in limber3d.__all__ if isinstance(member := getattr(limber3d, name), type)]
    assert CLASSES == {c for c in classes if "__setstate__" in vars(c)} - {limber3d.Model} and len(CLASSES) == 26


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_copies_and_pickles_are_equal(value: Any) -> None:
    pickles = [pickle.loads(pickle.dumps(value, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
    for twin in (*pickles, copy.copy(value), copy.deepcopy(value)):
        assert twin is not value and type(twin) is type(value)
        assert twin == value and not twin != value and hash(twin) == hash(value) and repr(twin) == repr(value)
        for name in fields_of(value):
            assert numpy.array_equal(getattr(twin, name), getattr(value, name))
    assert [value == other for other in VALUES] == [repr(value) == repr(other) for other in VALUES]
    assert value != 1 and value != None and (value == "value") is False  # noqa: E711


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_cannot_be_changed(value: Any) -> None:
    before = repr(value)
    for name in fields_of(value):
        field = getattr(value, name)
        with pytest.raises(AttributeError):
            setattr(value, name, field)
        if isinstance(field, numpy.ndarray):
            field += 1
        assert repr(value) == before
    with pytest.raises(AttributeError):
        value.something = 1


def test_values_are_written_with_all_fields(tetra: limber3d.Model) -> None:
    assert repr(limber3d.distance(tetra, tetra, pose_b=FAR)) == (
        "DistanceResult(lower=2.0, upper=2.0, status=DistanceStatus.exact, witness=Witness(point_a=(1.0, 0.0, 0.0), "
        "point_b=(3.0, 0.0, 0.0), triangle_a=0, triangle_b=1), stopped_by=StoppedBy.nothing, "
        "stats=QueryStats(node_tests=1, primitive_tests=1))"
    )
    assert repr(tetra.bounding_box()).startswith("Box(low=(")
    assert "feature=Feature(kind=FeatureKind.vertex, index=" in repr(VALUES)


@pytest.mark.filterwarnings("ignore:nanobind")
@pytest.mark.parametrize("state", [(), (1, 2, 3), ("a",) * 6, (0.0,) * 9])
def test_damaged_pickles_are_refused(state: Any) -> None:
    fresh = limber3d.DistanceResult.__new__(limber3d.DistanceResult)
    with pytest.raises((TypeError, ValueError, RuntimeError)):
        fresh.__setstate__(state)
    with pytest.raises(TypeError):
        repr(fresh)


def test_pairs_without_a_witness_have_no_objects() -> None:
    pair, none = (value for value in VALUES if isinstance(value, limber3d.ClosestObjectsResult))
    assert pair.objects == (0, 1) and none.objects is None and pickle.loads(pickle.dumps(none)).objects is None
