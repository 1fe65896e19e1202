# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distance, collision, within: poses, options, results, budgets, caches."""

from __future__ import annotations

import math
import sys
import time
from typing import Any

import limber3d
import numpy
import pytest
from shapes import random_poses, random_quaternions, rotation

FAR = numpy.array([[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def test_a_distance_has_its_points_and_triangles(tetra: limber3d.Model) -> None:
    result = limber3d.distance(tetra, tetra, pose_b=FAR)
    assert result.lower == result.upper == 2 and result.status is limber3d.DistanceStatus.exact
    assert result.stopped_by is limber3d.StoppedBy.nothing and result.stats.primitive_tests > 0
    witness = result.witness
    assert witness is not None
    assert witness.point_a.tolist() == [1, 0, 0] and witness.point_b.tolist() == [3, 0, 0]
    assert witness.point_a.dtype == numpy.float64 and 0 <= witness.triangle_a < 4


def test_options_of_a_distance_are_keywords(ball: limber3d.Model) -> None:
    far = limber3d.distance(ball, ball, pose_b=FAR, max_distance=0.5)
    assert far.status is limber3d.DistanceStatus.beyond_limit and far.witness is None and math.isinf(far.upper)
    rough = limber3d.distance(ball, ball, pose_b=FAR, relative_error=10.0)
    assert rough.status is limber3d.DistanceStatus.within_error and rough.lower < rough.upper
    assert limber3d.distance(ball, ball, pose_b=FAR, absolute_error=10.0).lower < 1
    with pytest.raises(TypeError):
        limber3d.distance(ball, ball, None, FAR, 0.5)  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="relative_error"):
        limber3d.distance(ball, ball, relative_error=-1)


def test_collisions_and_pairs_within_are_true_or_false(tetra: limber3d.Model) -> None:
    hit, apart = limber3d.collide(tetra, tetra), limber3d.collide(tetra, tetra, pose_b=FAR)
    assert hit and hit.answer is limber3d.Answer.yes and hit.witness is not None and not apart and apart.witness is None
    assert hit.is_yes and not hit.is_no and apart.is_no and not apart.is_yes
    assert (hit.witness.point_a == hit.witness.point_b).all()
    assert limber3d.within(tetra, tetra, 2.0, pose_b=FAR) and not limber3d.within(tetra, tetra, 1.99, pose_b=FAR)


def test_all_forms_of_a_pose_mean_the_same(ball: limber3d.Model) -> None:
    (turn,), (shift,) = random_quaternions(1, 1, 3.0)
    turn, shift = turn / numpy.linalg.norm(turn), shift * 2
    matrix = numpy.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation(turn), shift
    expected = limber3d.distance(ball, ball, matrix)
    forms: list[Any] = [
        matrix.tolist(),
        numpy.asfortranarray(matrix),
        matrix[:, ::-1][:, ::-1],
        (matrix[:3, :3], matrix[:3, 3]),
        (matrix[:3, :3].tolist(), matrix[:3, 3].tolist()),
    ]
    for form in forms:
        assert limber3d.distance(ball, ball, form).upper == expected.upper
        assert limber3d.distance(ball, ball, form).lower == expected.lower
    for quaternion in (turn, -3 * turn):
        assert limber3d.distance(ball, ball, (quaternion, shift)).upper == pytest.approx(expected.upper, rel=1e-12)
    single = numpy.eye(4, dtype=numpy.float32)
    single[0, 3] = 3
    assert limber3d.distance(ball, ball, single).upper == limber3d.distance(ball, ball, FAR).upper
    whole = single.astype(int)
    for form in (whole, whole.T.copy().T, (whole[:3, :3], whole[:3, 3]), ([1, 0, 0, 0], whole[:3, 3])):
        assert limber3d.distance(ball, ball, form).upper == limber3d.distance(ball, ball, FAR).upper


BAD_POSES: list[tuple[Any, str]] = [
    (numpy.eye(3), r"pose_b: expected None, a 4 x 4 .* got shape \(3, 3\) and dtype float64"),
    (numpy.eye(4, dtype=bool), "pose_b: .* dtype bool"),
    (2 * numpy.eye(4, dtype=int), "pose_b: the last row of the matrix is not 0 0 0 1"),
    (FAR.T, "pose_b: the last row of the matrix is not 0 0 0 1"),
    (FAR * numpy.nan, "pose_b: .*not finite|pose_b: .*finite"),
    (numpy.diag([1.0, 1, -1, 1]), "pose_b: the matrix is not rigid: it mirrors"),
    (numpy.diag([1.0, 1, 1 + 1e-8, 1]), r"pose_b: the matrix is not rigid: its rotation is off by 2e-08"),
    ((numpy.eye(3) * 1.1, [0, 0, 0]), r"pose_b: the matrix is not rigid: it scales by 1\.1; "),
    (([0, 0, 0, 0], [0, 0, 0]), "pose_b: "),
    (([1, 0, 0], [0, 0, 0]), r"pose_b: .* got shape \(3,\)"),
    (([1, 0, 0, 0], [0, 0]), r"pose_b: .* got shape \(2,\)"),
    ("pose", "pose_b: .* got str"),
]


def test_rotations_of_scipy_are_poses(ball: limber3d.Model) -> None:
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation.from_rotvec([[0, 0, 0.5], [0.1, 0.2, 0.3]])
    shifts = numpy.array([[2.5, 0, 0], [0, 2.5, 0]])
    for i, turn in enumerate(rotation):
        expected = limber3d.distance(ball, ball, pose_b=(turn.as_matrix(), shifts[i])).upper
        assert limber3d.distance(ball, ball, pose_b=(turn, shifts[i])).upper == expected
        assert limber3d.distance_many(ball, ball, poses_b=(rotation, shifts))["upper"][i] == expected
    assert limber3d.collide(ball, ball, pose_b=rotation[0])


@pytest.mark.parametrize(("pose", "message"), BAD_POSES)
def test_poses_that_are_none_are_refused(tetra: limber3d.Model, pose: Any, message: str) -> None:
    for ask in (limber3d.distance, limber3d.collide, limber3d.intersections):
        with pytest.raises(ValueError, match=message):
            ask(tetra, tetra, pose_b=pose)


def test_float32_rotations_can_be_made_orthonormal(tetra: limber3d.Model) -> None:
    pose = random_poses(3, 1)[0].astype(numpy.float32).astype(float)
    with pytest.raises(ValueError, match="orthonormalized"):
        limber3d.distance(tetra, tetra, pose)
    turn = limber3d.orthonormalized(pose[:3, :3])
    whole = limber3d.orthonormalized(pose)
    assert (whole[:3, :3] == turn).all() and (whole[:, 3] == pose[:, 3]).all() and (whole[3] == [0, 0, 0, 1]).all()
    with pytest.raises(ValueError, match="the last row of the matrix is not 0 0 0 1"):
        limber3d.orthonormalized(pose + [[0], [0], [0], [1]])
    assert numpy.abs(turn - pose[:3, :3]).max() < 1e-6
    assert limber3d.distance(tetra, tetra, (turn, pose[:3, 3])).lower >= 0
    with pytest.raises(ValueError):
        limber3d.orthonormalized(numpy.zeros((3, 3)))


def test_budgets_end_queries(ball: limber3d.Model) -> None:
    near = ([1, 0.2, 0.1, 0], [2.02, 0, 0])
    short = limber3d.distance(ball, ball, pose_b=near, budget=limber3d.QueryBudget(max_steps=2))
    assert short.status is limber3d.DistanceStatus.interrupted and short.stopped_by is limber3d.StoppedBy.max_steps
    whole = limber3d.distance(ball, ball, pose_b=near)
    assert short.lower <= whole.upper <= short.upper
    cache = limber3d.QueryCache()
    for _ in range(1000):
        resumed = limber3d.distance(ball, ball, pose_b=near, budget=limber3d.QueryBudget(max_steps=2), cache=cache)
        if resumed.status is limber3d.DistanceStatus.exact:
            break
    assert resumed.status is limber3d.DistanceStatus.exact and resumed.upper == pytest.approx(whole.upper, rel=1e-12)
    cache.clear()
    past = limber3d.QueryBudget(deadline=time.monotonic() - 1)
    assert limber3d.distance(ball, ball, pose_b=near, budget=past).stopped_by is limber3d.StoppedBy.deadline
    later = limber3d.QueryBudget(deadline=time.monotonic() + 100)
    assert limber3d.distance(ball, ball, pose_b=near, budget=later).upper == whole.upper
    assert limber3d.collide(ball, ball, pose_b=near, budget=later).answer is limber3d.Answer.no
    assert limber3d.within(ball, ball, 1.0, pose_b=near, budget=later)
    with pytest.raises(ValueError, match="deadline"):
        limber3d.QueryBudget(deadline=math.nan)


def test_a_flag_cancels_queries(ball: limber3d.Model) -> None:
    flag = limber3d.CancelFlag()
    budget = limber3d.QueryBudget(cancel=flag)
    assert limber3d.collide(ball, ball, budget=budget)
    flag.set()
    cancelled = limber3d.collide(ball, ball, pose_b=([1, 0.2, 0.1, 0], [1.9, 0, 0]), budget=budget)
    assert cancelled.answer is limber3d.Answer.undecided and cancelled.stopped_by is limber3d.StoppedBy.cancel
    assert not cancelled.is_yes and not cancelled.is_no
    with pytest.raises(RuntimeError, match="before there was an answer"):
        bool(cancelled)
    holders = sys.getrefcount(flag)
    other = limber3d.QueryBudget(cancel=flag)
    assert sys.getrefcount(flag) == holders + 1
    del other
    assert sys.getrefcount(flag) == holders
    flag.clear()
    assert not flag.is_set() and limber3d.collide(ball, ball, budget=budget)


def test_caches_make_the_next_query_cheaper(ball: limber3d.Model) -> None:
    cache = limber3d.QueryCache()
    first = limber3d.distance(ball, ball, pose_b=FAR, cache=cache)
    second = limber3d.distance(ball, ball, pose_b=FAR, cache=cache)
    assert first.upper == second.upper and second.stats.node_tests < first.stats.node_tests
    assert limber3d.collide(ball, ball, cache=cache) and limber3d.within(ball, ball, 1.5, pose_b=FAR, cache=cache)


def test_arguments_of_other_types_are_type_errors(tetra: limber3d.Model) -> None:
    with pytest.raises(TypeError):
        limber3d.distance(tetra, None)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        limber3d.distance(tetra, tetra, cache=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        limber3d.QueryBudget(cancel=3)  # type: ignore[arg-type]


def test_functions_and_classes_have_the_docstrings_of_the_library() -> None:
    assert (
        limber3d.distance.__doc__ is not None
        and "Promise  lower <= true distance <= upper" in limber3d.distance.__doc__
    )
    for name in limber3d.__all__:
        if not name.endswith("_dtype") and name not in ("typing", "__version__"):
            assert len(getattr(limber3d, name).__doc__) > 15, name
    for scope in (limber3d.Model, limber3d.Scene, limber3d.ClosedSurface, limber3d.MeshEdges):
        for name, member in vars(scope).items():
            if not name.startswith("_"):
                assert member.__doc__, f"{scope.__name__}.{name}"
