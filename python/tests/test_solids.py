# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""How closed surfaces lie to each other, how deep they are in each other, and how they come apart."""

from __future__ import annotations

import math
from typing import Any

import limber3d
import numpy
import pytest
from limber3d import SolidRelation
from shapes import ball as ball_arrays
from shapes import random_poses

BOX_FACES = [
    *([0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]),
    *([2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]),
]


def box(low: float, high: float) -> limber3d.ClosedSurface:
    corners = [[high if i >> axis & 1 else low for axis in range(3)] for i in range(8)]
    return limber3d.ClosedSurface(limber3d.Model(numpy.array(corners, float), numpy.array(BOX_FACES)))


def at(x: float, y: float = 0, z: float = 0) -> Any:
    return [1, 0, 0, 0], [x, y, z]


def relation(a: limber3d.ClosedSurface, b: limber3d.ClosedSurface, pose_b: Any = None) -> SolidRelation:
    return limber3d.solid_relation(a, b, pose_b=pose_b).relation


def test_boxes_have_every_relation() -> None:
    unit, small = box(0, 1), box(0.25, 0.75)
    assert relation(unit, unit, at(3)) is SolidRelation.apart
    assert relation(unit, unit, at(1)) is SolidRelation.touching
    assert relation(unit, unit, at(0.5)) is SolidRelation.overlapping
    assert relation(unit, small) is SolidRelation.b_inside_a and relation(small, unit) is SolidRelation.a_inside_b
    assert relation(unit, unit) is SolidRelation.equal
    assert limber3d.solid_relation(unit, small).witness is None
    flush = limber3d.solid_relation(unit, small, None, at(0.25))
    assert flush.relation is SolidRelation.b_inside_a and flush.witness is not None and flush.witness.point_a[0] == 1
    both_move = limber3d.solid_relation(unit, unit, at(5), at(6))
    assert both_move.relation is SolidRelation.touching and both_move.witness is not None
    assert both_move.witness.point_b[0] == 6


def test_many_relations_are_those_of_single_calls() -> None:
    surfaces = [box(0, 1), None, limber3d.ClosedSurface(limber3d.Model(*ball_arrays(12, 8))), box(-0.3, 0.3)]
    poses = random_poses(3, 4, 0.5)
    pairs = numpy.array([(a, b) for a in (0, 2, 3) for b in (0, 2, 3) if a != b])
    found = limber3d.solid_relation_many(surfaces, pairs, poses)
    assert found.dtype == limber3d.solid_relation_dtype and len(set(found["relation"])) > 1
    for (a, b), record in zip(pairs, found):
        first, second = surfaces[a], surfaces[b]
        assert first is not None and second is not None
        single = limber3d.solid_relation(first, second, poses[a], poses[b])
        assert SolidRelation(int(record["relation"])) is single.relation
        if single.witness is None:
            assert numpy.isnan(record["point_a"]).all() and record["triangle_b"] == 2**32 - 1
        else:
            assert (record["point_a"] == single.witness.point_a).all()
            assert record["triangle_b"] == single.witness.triangle_b
    assert limber3d.solid_relation_many(iter(surfaces), [[0, 3]])["relation"].tolist() == [SolidRelation.overlapping]
    assert limber3d.solid_relation_many([], numpy.zeros((0, 2), int)).shape == (0,)


def test_deepest_vertices_are_those_of_a_loop() -> None:
    surface = limber3d.ClosedSurface(limber3d.Model(*ball_arrays(14, 9)))
    for pose in random_poses(5, 6, 0.6):
        found = limber3d.deepest_vertices(surface, surface, pose_b=pose)
        placed = surface.model.vertices @ pose[:3, :3].T + pose[:3, 3]
        for deepest, points, other in (
            (found.of_a, surface.model.vertices, pose),
            (found.of_b, placed, None),
        ):
            distances = surface.signed_distance_many(points, other)["distance"]
            assert (deepest is None) == (distances.min() > 0)
            if deepest is not None:
                assert deepest.depth == pytest.approx(-distances.min(), abs=1e-12)
                assert distances[deepest.vertex] == pytest.approx(-deepest.depth, abs=1e-12)
                out = deepest.closest.position - deepest.position
                assert numpy.linalg.norm(deepest.direction) == pytest.approx(1)
                assert numpy.allclose(deepest.direction * deepest.depth, out, atol=1e-9)
        assert found.max_depth == max(deepest.depth if deepest else 0.0 for deepest in (found.of_a, found.of_b))
    apart = limber3d.deepest_vertices(surface, surface, pose_b=at(5))
    assert apart.of_a is None and apart.of_b is None and apart.max_depth == 0
    stopped = limber3d.deepest_vertices(surface, surface, pose_b=at(0.5), budget=limber3d.QueryBudget(max_steps=0))
    assert stopped.stopped_by is limber3d.StoppedBy.max_steps and stopped.max_depth > 0


def test_a_translation_separates_and_less_does_not() -> None:
    unit = box(0, 1)
    for direction, expected in (([2, 0, 0], 0.75), ([-1, 0, 0], 1.25), ([0, 3, 0], 1.0), ([1, 1, 0], 0.75 * 2**0.5)):
        found = limber3d.separating_translation(unit, unit, direction, pose_b=at(0.25))
        assert found.lower <= expected * (1 + 1e-11) and found.upper >= expected * (1 - 1e-15)
        assert found.upper - found.lower < 1e-10 and numpy.linalg.norm(found.direction) == pytest.approx(1)
        for part, meets in ((1.0, False), (0.999, True)):
            moved = numpy.eye(4)
            moved[:3, 3] = [0.25, 0, 0] + part * found.upper * found.direction
            assert bool(limber3d.collide(unit.model, unit.model, pose_b=moved)) == meets
    apart = limber3d.separating_translation(unit, unit, [1, 0, 0], pose_b=at(2))
    assert apart.lower == apart.upper == 0 and apart.witness is None
    budget = limber3d.QueryBudget(max_steps=1)
    stopped = limber3d.separating_translation(unit, unit, [1, 1, 1], pose_b=at(0.25), budget=budget)
    assert stopped.lower <= 0.75 * 3**0.5 <= stopped.upper * (1 + 1e-12)


def test_signed_distances_are_intervals() -> None:
    unit = box(0, 1)
    apart = limber3d.signed_distance(unit, unit, pose_b=at(3))
    assert apart.are_apart and apart.lower == apart.upper == 2 and apart.witness is not None
    assert apart.translation.tolist() == [0, 0, 0] and apart.deepest.of_a is None
    deep = limber3d.signed_distance(unit, unit, pose_b=at(0.875, 0.25, 0.5))
    assert not deep.are_apart and deep.witness is None and deep.upper == pytest.approx(-0.125, abs=1e-9)
    assert -deep.lower == pytest.approx(0.125, abs=1e-9)
    assert numpy.allclose(deep.translation, [0.125, 0, 0], atol=1e-9)
    nested = limber3d.signed_distance(unit, box(0.25, 0.5), relative_error=0.5)
    assert nested.lower <= -0.5 <= nested.upper + 1e-9
    stopped = limber3d.signed_distance(unit, unit, pose_b=at(0.5), budget=limber3d.QueryBudget(max_steps=3))
    assert stopped.lower <= -0.5 * (1 - 1e-12) and stopped.upper >= -0.5 and math.isfinite(stopped.lower)
    for pose in random_poses(9, 5, 0.5):
        found = limber3d.signed_distance(unit, unit, pose_b=pose)
        pose[:3, 3] += found.translation
        assert not limber3d.collide(unit.model, unit.model, pose_b=pose)
        assert numpy.linalg.norm(found.translation) <= -found.lower * (1 + 1e-12) or found.are_apart


def test_mistakes_are_errors() -> None:
    unit = box(0, 1)
    for mistake in (
        lambda: limber3d.solid_relation(unit, unit, numpy.eye(4) * 2),
        lambda: limber3d.solid_relation_many([unit, unit], [[0, 2]]),
        lambda: limber3d.solid_relation_many([unit, None], [[0, 1]]),
        lambda: limber3d.solid_relation_many([unit, unit], [[0, 1]], random_poses(1, 3)),
        lambda: limber3d.solid_relation_many([unit, unit], [0, 1]),
        lambda: limber3d.separating_translation(unit, unit, [0, 0, 0]),
        lambda: limber3d.separating_translation(unit, unit, [math.nan, 0, 0]),
        lambda: limber3d.signed_distance(unit, unit, relative_error=-1.0),
    ):
        with pytest.raises(ValueError):
            mistake()
    with pytest.raises(TypeError):
        limber3d.solid_relation_many([unit, 3], [[0, 1]])  # type: ignore[list-item]
    with pytest.raises(TypeError):
        limber3d.solid_relation(unit, unit.model)  # type: ignore[arg-type]
    unit.model.move_vertices([0], [[-1, 0, 0]])
    with pytest.raises(ValueError, match="committed"):
        limber3d.deepest_vertices(unit, box(0, 1))
    unit.model.reset(unit.model.vertices, unit.model.faces)
    for stale in (
        lambda: limber3d.solid_relation(unit, unit),
        lambda: limber3d.solid_relation_many([unit, unit], [[0, 1]]),
        lambda: limber3d.deepest_vertices(unit, unit),
        lambda: limber3d.signed_distance(unit, unit),
    ):
        with pytest.raises(ValueError, match="reset"):
            stale()
