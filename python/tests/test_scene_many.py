# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many configurations of a scene, which pairs count, one model next to all objects, contacts of pairs."""

from __future__ import annotations

import time
from typing import Any

import limber3d
import numpy
import pytest
from shapes import random_poses, random_quaternions

IDS = [4, 0, 2]


@pytest.fixture
def scene(ball: limber3d.Model, tetra: limber3d.Model) -> limber3d.Scene:
    """Five objects; id 1 is free."""
    scene = limber3d.Scene()
    for i, pose in enumerate(random_poses(11, 6)):
        scene.add(ball if i % 2 == 0 else tetra, pose)
    scene.remove(1)
    scene.commit()
    return scene


def configurations(count: int) -> numpy.typing.NDArray[numpy.float64]:
    return random_poses(12, count * len(IDS)).reshape(count, len(IDS), 4, 4)


def matrix() -> limber3d.ObjectPairMatrix:
    counts = limber3d.ObjectPairMatrix(6)
    counts.set_among([0, 2], False)
    counts.set_between(numpy.array([3]), [4, 5], False)
    counts.set(0, 3, False)
    return counts


@pytest.mark.parametrize("threads", [None, 1, 3])
def test_many_configurations_have_the_answers_of_single_calls(scene: limber3d.Scene, threads: int | None) -> None:
    poses, counts = configurations(150), matrix()
    options: Any
    for options in ({}, {"filter": counts}):
        closest = limber3d.closest_objects_many(scene, IDS, poses, threads=threads, **options)
        close = limber3d.any_within_many(scene, numpy.array(IDS), poses, 0.2, threads=threads, **options)
        assert closest.dtype == limber3d.closest_objects_dtype and close.dtype == limber3d.any_within_dtype
        assert scene.is_committed and 0 < close["is_yes"].sum() < 150
        moved = limber3d.Scene()
        for id in range(6):
            moved.add(scene.model(id if id != 1 else 0), scene.pose(id if id != 1 else 0))
        moved.remove(1)
        for record, answer, of_objects in zip(closest, close, poses):
            moved.set_poses(IDS, of_objects)
            moved.commit()
            single, any_two = moved.closest_objects(**options), moved.any_within(0.2, **options)
            assert (record["object_a"], record["object_b"]) == single.objects
            assert (record["lower"], record["upper"]) == (single.result.lower, single.result.upper)
            assert record["status"] == single.result.status
            assert answer["is_yes"] == bool(any_two.result) and answer["answer"] == any_two.result.answer
            if any_two.objects is not None:
                assert (answer["object_a"], answer["object_b"]) == any_two.objects
            else:
                assert answer["object_a"] == 2**32 - 1 and numpy.isnan(answer["point_a"]).all()


def test_all_forms_of_configurations_are_taken(scene: limber3d.Scene) -> None:
    poses = configurations(20)
    expected = limber3d.closest_objects_many(scene, IDS, poses)
    forms: list[Any] = [
        numpy.asfortranarray(poses),
        poses.tolist(),
        (poses[..., :3, :3], poses[..., :3, 3]),
        numpy.repeat(poses, 2, axis=1)[:, ::2],
    ]
    for form in forms:
        assert (limber3d.closest_objects_many(scene, IDS, form) == expected).all()
    turns, shifts = random_quaternions(12, 60, 2.0)
    of_quaternions = limber3d.closest_objects_many(scene, IDS, (turns.reshape(20, 3, 4), shifts.reshape(20, 3, 3)))
    assert numpy.allclose(of_quaternions["upper"], expected["upper"])
    assert limber3d.closest_objects_many(scene, IDS, poses[:0]).shape == (0,)
    beyond = limber3d.closest_objects_many(scene, IDS, poses, max_distance=0.0, filter=lambda a, b: False)
    assert (beyond["object_a"] == 2**32 - 1).all() and (beyond["status"] == limber3d.DistanceStatus.beyond_limit).all()


def test_bad_configurations_are_refused_by_place(scene: limber3d.Scene) -> None:
    poses = configurations(10)
    poses[7, 2, 3, 3] = 2
    with pytest.raises(ValueError, match=r"poses\[7, 2\]: the last row"):
        limber3d.closest_objects_many(scene, IDS, poses)
    with pytest.raises(ValueError, match=r"poses: .* got shape \(10, 3, 4, 4\)"):
        limber3d.closest_objects_many(scene, IDS[:2], poses)
    with pytest.raises(ValueError, match="ids: expected at least one"):
        limber3d.any_within_many(scene, [], poses[:, :0], 1.0)
    with pytest.raises(ValueError, match="no object"):
        limber3d.any_within_many(scene, [0, 1, 2], configurations(1), 1.0)
    with pytest.raises(ValueError, match="max_distance"):
        limber3d.any_within_many(scene, IDS, configurations(1), -1.0)
    with pytest.raises(ValueError, match="size"):
        limber3d.any_within_many(scene, IDS, configurations(1), 1.0, filter=limber3d.ObjectPairMatrix(3))
    with pytest.raises(TypeError, match="filter"):
        limber3d.any_within_many(scene, IDS, configurations(1), 1.0, filter=3)  # type: ignore[arg-type]


def test_a_matrix_is_a_filter_everywhere(scene: limber3d.Scene) -> None:
    counts = matrix()
    assert counts.size == 6 and not counts(2, 0) and counts(0, 4) and not counts(5, 3)

    def function(a: int, b: int) -> bool:
        return counts(a, b)

    assert scene.candidate_pairs(9.0, filter=counts).tolist() == scene.candidate_pairs(9.0, filter=function).tolist()
    assert scene.closest_objects(filter=counts) == scene.closest_objects(filter=function)
    assert scene.any_within(1.0, filter=counts) == scene.any_within(1.0, filter=function)
    poses = configurations(30)
    with_matrix = limber3d.closest_objects_many(scene, IDS, poses, filter=counts)
    assert (with_matrix == limber3d.closest_objects_many(scene, IDS, poses, filter=function)).all()
    with pytest.raises(ValueError, match="same"):
        counts.set(1, 1, True)
    with pytest.raises(ValueError, match="size"):
        counts.set_among([0, 6], True)
    assert not limber3d.ObjectPairMatrix(3, counts=False)(0, 1)


def test_a_model_next_to_all_objects(scene: limber3d.Scene, tetra: limber3d.Model) -> None:
    pose = random_poses(13, 1, 1.0)[0]
    ids = [0, 2, 3, 4, 5]
    distances = [limber3d.distance(tetra, scene.model(id), pose, scene.pose(id)).upper for id in ids]
    near = scene.candidates(tetra, 0.5, pose)
    assert near.dtype == numpy.uint32 and {id for id, d in zip(ids, distances) if d <= 0.5} <= set(near.tolist())
    found = scene.closest_object(tetra, pose)
    assert found.object is not None
    assert found.result.upper == min(distances) == distances[ids.index(found.object)]
    others = [d for id, d in zip(ids, distances) if id != found.object]
    assert scene.closest_object(tetra, pose, filter=lambda id: id != found.object).result.upper == min(others)
    none = scene.closest_object(tetra, pose, filter=lambda id: False)
    assert none.object is None and none.result.witness is None
    assert scene.candidates(tetra, 0.5, pose=([1, 0, 0, 0], [500, 0, 0])).shape == (0,)
    assert near[0] not in scene.candidates(tetra, 0.5, pose, filter=lambda object: object != near[0])


def test_the_first_impact_of_a_moving_body(scene: limber3d.Scene, tetra: limber3d.Model) -> None:
    start, end = [-20.0, 0.1, 0.2], [20.0, 0.0, 0.0]
    motion = limber3d.RigidMotion(([1, 0, 0, 0], start), ([1, 0, 0, 0], end))
    singles = {
        id: limber3d.time_of_impact(tetra, motion, scene.model(id), limber3d.RigidMotion(scene.pose(id)))
        for id in (0, 2, 3, 4, 5)
    }
    found = scene.time_of_impact(tetra, motion)
    assert found.object is not None and found.result.status is limber3d.ImpactStatus.contact
    assert found.result.time == pytest.approx(min(single.time for single in singles.values()), abs=1e-5)
    assert numpy.linalg.norm(found.result.normal) == pytest.approx(1)
    later = scene.time_of_impact(tetra, motion, filter=lambda id: id != found.object)
    assert later.object != found.object and later.result.time >= found.result.time
    clear = scene.time_of_impact(tetra, motion, max_time=0.01)
    assert clear.object is None and clear.result.status is limber3d.ImpactStatus.clear
    none = scene.time_of_impact(tetra, motion, budget=limber3d.QueryBudget(max_steps=0))
    assert none.result.status is limber3d.ImpactStatus.undecided and 0 < none.result.time < found.result.time
    with pytest.raises(ValueError, match="max_time"):
        scene.time_of_impact(tetra, motion, max_time=2.0)


def test_contacts_of_pairs_are_those_of_two_models(scene: limber3d.Scene) -> None:
    pairs = scene.candidate_pairs(0.3)
    found = scene.contacts(pairs, 0.3)
    assert found.contacts.dtype == limber3d.contact_dtype and found.offsets.dtype == numpy.int64
    assert found.offsets[-1] == len(found.contacts) > 0 and len(found) == len(pairs)
    for i, (a, b) in enumerate(pairs.tolist()):
        single = limber3d.contacts(scene.model(a), scene.model(b), 0.3, scene.pose(a), scene.pose(b))
        assert (found[i] == single.records).all()
    assert scene.contacts(numpy.zeros((0, 2), int), 0.1).offsets.tolist() == [0]


def test_budgets_leave_answers_open(scene: limber3d.Scene, ball: limber3d.Model) -> None:
    late = limber3d.QueryBudget(deadline=time.monotonic() - 1)
    poses = configurations(40)
    closest = limber3d.closest_objects_many(scene, IDS, poses, budget=late)
    assert (closest["status"] == limber3d.DistanceStatus.interrupted).all() and numpy.isinf(closest["upper"]).all()
    assert (closest["stopped_by"] == limber3d.StoppedBy.deadline).all() and (closest["lower"] == 0).all()
    close = limber3d.any_within_many(scene, IDS, poses, 1.0, budget=late)
    assert not close["is_yes"].any() and (close["answer"] == limber3d.Answer.undecided).all()
    steps = limber3d.QueryBudget(max_steps=0)
    true, rough = scene.closest_objects().result, scene.closest_objects(budget=steps).result
    assert rough.lower <= true.lower <= true.upper <= rough.upper
    pairs = scene.candidate_pairs(9.0)
    assert (scene.distance(pairs, budget=steps)["lower"] <= scene.distance(pairs)["upper"]).all()
    meeting = limber3d.Scene()
    for x in (0.0, 1.99):
        meeting.add(ball, ([1, 0, 0, 0], [x, 0, 0]))
    meeting.commit()
    with pytest.raises(RuntimeError):
        bool(meeting.any_within(0.0, budget=steps).result)
