# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Batches of rigid motions: the bits of single calls, arguments."""

from __future__ import annotations

import math
from typing import Any

import limber3d
import numpy
import pytest
from limber3d import RigidMotion
from shapes import random_poses

COUNT = 300
STARTS_A, ENDS_A = random_poses(1, COUNT), random_poses(2, COUNT)
STARTS_B, ENDS_B = random_poses(3, COUNT), random_poses(4, COUNT)
CENTER_A, CENTER_B = [0.5, 0, 0.25], numpy.array([0, -0.5, 0])
OPTIONS = {"max_time": 0.75, "distance_error": 0.01}

MANY: list[Any] = [limber3d.time_of_impact_many, limber3d.min_distance_many]
SINGLE_AND_MANY: list[Any] = [
    (limber3d.time_of_impact, limber3d.time_of_impact_many, {}),
    (limber3d.time_of_impact, limber3d.time_of_impact_many, {**OPTIONS, "min_separation": 0.25}),
    (limber3d.min_distance, limber3d.min_distance_many, OPTIONS),
]


def check(records: Any, results: list[Any]) -> None:
    """Records hold the results, to the bit."""
    assert records.shape == (len(results),)
    for record, result in zip(records, results):
        for name in ("status", "lower", "upper", "time", "distances"):
            if name in records.dtype.names:
                assert record[name] == getattr(result, name)
        if result.witness is None:
            assert numpy.isnan(record["point_a"]).all() and numpy.isnan(record["point_b"]).all()
            assert record["triangle_a"] == record["triangle_b"] == 2**32 - 1
            continue
        for name in ("point_a", "point_b", "triangle_a", "triangle_b"):
            assert numpy.array_equal(record[name], getattr(result.witness, name))


@pytest.mark.parametrize("threads", [1, None])
@pytest.mark.parametrize(("single", "many", "options"), SINGLE_AND_MANY)
def test_answers_of_many_motions_are_those_of_single_calls(
    ball: limber3d.Model, tetra: limber3d.Model, single: Any, many: Any, options: Any, threads: int | None
) -> None:
    centers: dict[str, Any] = {"center_a": CENTER_A, "center_b": CENTER_B}
    records = many(ball, tetra, STARTS_A, ENDS_A, STARTS_B, ENDS_B, **centers, **options, threads=threads)
    motions_a = [RigidMotion(*poses, CENTER_A) for poses in zip(STARTS_A, ENDS_A)]
    motions_b = [RigidMotion(*poses, CENTER_B) for poses in zip(STARTS_B, ENDS_B)]
    check(records, [single(ball, a, tetra, b, **options) for a, b in zip(motions_a, motions_b)])
    if single is limber3d.time_of_impact:
        assert records.dtype == limber3d.path_impact_dtype and set(records["status"].tolist()) == {0, 1, 2}
    else:
        assert records.dtype == limber3d.path_distance_dtype
        assert (records["upper"] == 0).any() and (records["upper"] > 0).any()


@pytest.mark.parametrize(("single", "many", "options"), SINGLE_AND_MANY[::2])
def test_bodies_may_have_one_pose_for_all_or_stand_still(
    ball: limber3d.Model, tetra: limber3d.Model, single: Any, many: Any, options: Any
) -> None:
    starts, ends, pose = STARTS_A[:40], ENDS_A[:40], STARTS_B[0]
    parts = ends[:, :3, :3], ends[:, :3, 3]
    origin, still = RigidMotion(), RigidMotion(pose)
    moving = [RigidMotion(*poses) for poses in zip(starts, ends)]

    def check_many(motions_a: list[RigidMotion], motion_b: RigidMotion, *poses: Any, **named: Any) -> None:
        results = [single(ball, motion, tetra, motion_b, **options) for motion in motions_a]
        check(many(ball, tetra, *poses, **named, **options), results)

    check_many(moving, still, starts, ends, pose)
    check_many(moving, origin, starts, ends)
    check_many([RigidMotion(start) for start in starts], still, starts, starts_b=pose)
    check_many([RigidMotion(None, end) for end in ends], origin, None, ends)
    check_many([RigidMotion(pose, end) for end in ends], origin, pose, parts)
    check_many([RigidMotion(pose, ends[0])], origin, pose, ends[0])
    check_many([origin], origin)
    check_many([], origin, starts[:0], ends[:0])


@pytest.mark.parametrize("many", MANY)
def test_bad_motions_are_named(ball: limber3d.Model, many: Any) -> None:
    mirrored = STARTS_A.copy()
    mirrored[7, :3, 0] *= -1
    for name in ("starts_a", "ends_a", "starts_b", "ends_b"):
        with pytest.raises(ValueError, match=rf"^{name}\[7\]: the matrix is not rigid"):
            many(ball, ball, **{name: mirrored})
        with pytest.raises(ValueError, match=rf"^{name}: .* got shape \(300, 3, 4\)"):
            many(ball, ball, **{name: STARTS_A[:, :3]})
    for names in (("starts_a", "starts_b"), ("starts_a", "ends_a"), ("starts_b", "ends_b"), ("ends_a", "ends_b")):
        with pytest.raises(ValueError, match=f"^{names[0]} and {names[1]}: 300 and 3 poses; expected as many of both"):
            many(ball, ball, **{names[0]: STARTS_A, names[1]: STARTS_A[:3]})
    for name in ("center_a", "center_b"):
        with pytest.raises(ValueError, match=rf"^{name}: expected shape \(3,\)"):
            many(ball, ball, **{name: numpy.zeros((1, 3))})
        with pytest.raises(ValueError, match="^limber3d.RigidMotion: a coordinate of the center"):
            many(ball, ball, **{name: [0, 0, math.nan]})
    with pytest.raises(ValueError, match="max_time is not in"):
        many(ball, ball, STARTS_A, ENDS_A, max_time=1.5)
    with pytest.raises(ValueError, match="threads: expected 1 to 4096, or None"):
        many(ball, ball, threads=0)
    ball.move_all(ball.vertices)
    with pytest.raises(ValueError, match="commit"):
        many(ball, ball, STARTS_A, ENDS_A)
