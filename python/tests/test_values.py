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
            with pytest.raises(ValueError, match="read-only"):
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


def keepers() -> tuple[Any, ...]:
    """A body of each kind, a closed surface, a moving model, motions, and a scene of the bodies with unused ids."""
    tetra = limber3d.Model(TETRA_VERTICES, TETRA_FACES)
    surface = limber3d.ClosedSurface(tetra)
    shape, points = limber3d.Shape, numpy.random.default_rng(1).normal(size=(30, 3))
    bodies = [
        *(tetra, limber3d.Body(tetra, 0.1), surface.solid(), shape.sphere(0.3), shape.box([1, 2, 3], 0.1)),
        *(shape.capsule([0, 0, 0], [1, 2, 3], 0.2), shape.cylinder([0, 0, 0], [1, 1, 1], 0.3, 0.01)),
        *(shape.half_space([1, 2, 3], 0.2, 50.0), shape.convex_hull(points, 0.1), shape.point_cloud(points, 0.05)),
        shape.height_field(points[:, :2], 0.1, 0.2, 0.01),
    ]
    moving, still = limber3d.MovingModel(tetra), limber3d.MovingModel(tetra)
    moving.set_motion(TETRA_VERTICES - [0, 0, 3], ([1, 0, 0, 0], [0, 0, 2]), ([1, 0, 0.1, 0], [0.1, 0, 2]))
    still.set_motion(TETRA_VERTICES)
    turn = ([1, 0.2, 0.3, 0.1], [0.4, -1, 0.2])
    motions = [limber3d.RigidMotion(FAR, turn, [0.1, 0.2, 0.3]), limber3d.RigidMotion.screw(FAR, turn)]
    scene = limber3d.Scene()
    ids = [scene.add(body, ([1, 0.1 * i, 0, 0], [3 * i, 0, 0])) for i, body in enumerate([tetra, *bodies, tetra])]
    scene.remove(ids[2])
    scene.remove(ids[0])
    scene.commit()
    return tetra, surface, bodies, moving, still, motions, scene


def answers(kept: tuple[Any, ...]) -> str:
    tetra, surface, bodies, moving, still, motions, scene = kept
    assert surface.model is tetra and scene.model(len(bodies) + 1) is tetra
    return repr(
        [
            *(limber3d.distance(body, tetra, pose_b=pose) for body in bodies for pose in (None, FAR)),
            *(surface.signed_distance([0.1, 0.2, 0.1]), limber3d.time_of_impact(moving, still)),
            *(motion.at(t).tolist() for motion in motions for t in (0, 0.3, 1)),
            *(scene.closest_objects(), scene.candidate_pairs(1.0).tolist(), scene.id_bound, 0 in scene, 2 in scene),
            *(scene.distance(scene.candidate_pairs(5.0)).tolist(), scene.is_committed),
        ]
    )


def test_bodies_scenes_and_motions_are_copied_and_pickled_with_their_answers() -> None:
    kept = keepers()
    expected = answers(kept)
    pickles = [pickle.loads(pickle.dumps(kept, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
    for twin in (*pickles, copy.deepcopy(kept), (*kept[:-1], copy.copy(kept[-1]))):
        assert answers(twin) == expected
    with pytest.raises(ValueError, match="has no motion"):
        limber3d.time_of_impact(pickle.loads(pickle.dumps(limber3d.MovingModel(kept[0]))), kept[4])
