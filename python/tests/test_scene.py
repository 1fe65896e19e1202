# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of many objects."""

from __future__ import annotations

import limber3d
import numpy
import pytest
from shapes import random_poses


def row_of(ball: limber3d.Model, count: int) -> limber3d.Scene:
    """Balls of diameter 2 at x = 0, 1.5, 3.0, ..."""
    scene = limber3d.Scene()
    for i in range(count):
        assert scene.add(ball, ([1, 0, 0, 0], [1.5 * i, 0, 0])) == i
    scene.commit()
    return scene


def test_candidates_and_queries_of_pairs(ball: limber3d.Model) -> None:
    scene = row_of(ball, 4)
    pairs = scene.candidate_pairs(0.0)
    assert sorted(pairs.tolist()) == [[0, 1], [1, 2], [2, 3]] and pairs.dtype == numpy.uint32
    assert scene.collide(pairs)["is_yes"].all() and scene.collide(pairs).dtype == limber3d.collide_dtype
    far = [[0, 2], [3, 0]]
    assert not scene.collide(far)["is_yes"].any()
    assert scene.within(far, 1.1)["is_yes"].tolist() == [True, False]
    cache = limber3d.SceneCache()
    for _ in range(2):
        distances = scene.distance(far, cache=cache)
        assert numpy.allclose(distances["upper"], [1.0, 2.5]) and distances["status"].tolist() == [0, 0]
    cache.clear()
    assert scene.distance(numpy.zeros((0, 2), int)).shape == (0,)
    for i, pair in enumerate(far):
        single = limber3d.distance(ball, ball, scene.pose(pair[0]), scene.pose(pair[1]))
        assert single.upper == scene.distance(far)["upper"][i]


def test_an_object_is_a_model_at_a_pose(ball: limber3d.Model) -> None:
    scene = row_of(ball, 4)
    model, pose = scene.object(2)
    assert model is ball and (pose == scene.pose(2)).all()
    assert scene.closest_object(*scene.object(2), filter=lambda other: other != 2).object in (1, 3)
    with pytest.raises(ValueError):
        scene.object(9)


def test_budgets_end_queries_of_pairs(ball: limber3d.Model) -> None:
    scene, pairs = row_of(ball, 4), [[0, 2], [0, 1], [1, 3]]
    cancel = limber3d.CancelFlag()
    cancel.set()
    for budget, stopped_by in (
        (limber3d.QueryBudget(max_steps=0), limber3d.StoppedBy.max_steps),
        (limber3d.QueryBudget(cancel=cancel), limber3d.StoppedBy.cancel),
    ):
        for found in (scene.collide(pairs, budget=budget), scene.within(pairs, 1.0, budget=budget)):
            assert not found["is_yes"].any()  # bounds alone may say no
            assert found["answer"][1] == limber3d.Answer.undecided and found["stopped_by"][1] == stopped_by
        distances = scene.distance(pairs, budget=budget)
        assert (distances["status"] == limber3d.DistanceStatus.interrupted).all()
    contacts = scene.contacts(pairs, 0.1, budget=limber3d.QueryBudget(max_steps=1))
    whole = scene.contacts(pairs, 0.1)
    assert len(contacts) == 1 and len(whole) == 3 and (contacts[0] == whole[0]).all()  # the next takes more steps
    assert len(scene.contacts(pairs, 0.1, budget=limber3d.QueryBudget(cancel=cancel))) <= 1
    enough = limber3d.QueryBudget(max_steps=100000)
    found = scene.collide(pairs, budget=enough)
    assert found["answer"].tolist() == [limber3d.Answer.no, limber3d.Answer.yes, limber3d.Answer.no]
    assert found["is_yes"].tolist() == [False, True, False] and not found["stopped_by"].any()
    assert scene.within(pairs, 1.1, budget=enough)["is_yes"].all()


def test_objects_come_move_and_go(ball: limber3d.Model, tetra: limber3d.Model) -> None:
    scene = row_of(ball, 3)
    scene.remove(1)
    assert 1 not in scene and 2 in scene and len(scene) == 2 and scene.id_bound == 3 and not scene.is_committed
    assert scene.add(tetra, ([1, 0, 0, 0], [10, 0, 0])) == 1 and scene.model(1) is tetra
    poses = random_poses(2, 2)
    scene.set_poses([0, 2], poses)
    scene.set_pose(1, None)
    scene.commit()
    assert scene.is_committed and (scene.pose(2) == poses[1]).all() and (scene.pose(1) == numpy.eye(4)).all()
    assert (scene.bounding_box(1).high >= 1).all()
    scene.set_poses(numpy.array([0, 1]), poses[0])
    assert (scene.pose(1) == poses[0]).all()


def test_the_closest_objects_and_filters(ball: limber3d.Model) -> None:
    scene = row_of(ball, 4)
    assert scene.closest_objects().result.status is limber3d.DistanceStatus.collision
    apart = scene.closest_objects(filter=lambda a, b: b - a == 2)
    assert apart.objects in ((0, 2), (1, 3)) and apart.result.upper == pytest.approx(1.0)
    assert scene.candidate_pairs(5.0, filter=lambda a, b: a == 0 and b == 3).tolist() == [[0, 3]]
    assert scene.closest_objects(filter=lambda a, b: False).objects is None
    assert scene.closest_objects(filter=lambda a, b: b - a == 2, max_distance=0.5).objects is None


def test_mistakes_are_errors_and_change_nothing(ball: limber3d.Model) -> None:
    scene = row_of(ball, 2)
    for mistake in (
        lambda: scene.remove(7),
        lambda: scene.set_pose(7, None),
        lambda: scene.pose(7),
        lambda: scene.model(7),
        lambda: scene.bounding_box(7),
        lambda: scene.distance([[0, 7]]),
        lambda: scene.add(ball, numpy.eye(4) * 2),
        lambda: scene.set_poses([0, 1], random_poses(1, 3)),
        lambda: scene.candidate_pairs(-1.0),
        lambda: scene.distance([[0, 1, 2]]),
    ):
        with pytest.raises(ValueError):
            mistake()
    assert len(scene) == 2 and scene.is_committed
    ball.move_vertices([0], [[0, 0, -3]])
    with pytest.raises(ValueError, match="committed"):
        scene.collide([[0, 1]])
    ball.commit()
    assert not scene.is_committed
    with pytest.raises(ValueError, match="commit"):
        scene.candidate_pairs(0.0)
    scene.commit()
    assert scene.bounding_box(0).low[2] < -2.9


def test_a_filter_may_not_change_the_scene(ball: limber3d.Model) -> None:
    scene = row_of(ball, 3)

    def changing(a: int, b: int) -> bool:
        scene.remove(a)
        return True

    def moving(a: int, b: int) -> bool:
        ball.commit()
        return True

    for disturbing in (changing, moving):
        with pytest.raises(limber3d.BusyError):
            scene.candidate_pairs(0.0, filter=disturbing)
    assert len(scene) == 3 and len(scene.candidate_pairs(0.0, filter=lambda a, b: len(scene) == 3)) == 2
