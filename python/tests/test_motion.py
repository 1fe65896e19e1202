# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Moving models, limits of displacements and rigid bodies on a path."""

from __future__ import annotations

import gc
import pickle

import limber3d
import numpy
import pytest
from shapes import ball as ball_arrays

PLATE = numpy.array([[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0.0]]), numpy.array([[0, 1, 2], [0, 2, 3]])
Kind, Status = limber3d.ElementPairKind, limber3d.ImpactStatus


@pytest.fixture(name="plate")
def plate_fixture() -> limber3d.Model:
    return limber3d.Model(*PLATE)


def still(model: limber3d.Model) -> limber3d.MovingModel:
    moving = limber3d.MovingModel(model)
    moving.set_motion(model.vertices)
    return moving


def falling(model: limber3d.Model, start: float, end: float) -> limber3d.MovingModel:
    """By its poses, not quite over the middle."""
    moving = limber3d.MovingModel(model)
    moving.set_motion(model.vertices, ([1, 0, 0, 0], [0.1, 0.2, start]), ([1, 0, 0, 0], [0.1, 0.2, end]))
    return moving


def test_a_ball_falls_on_a_plate(ball: limber3d.Model, plate: limber3d.Model) -> None:
    lowest = ball.vertices[:, 2].min()
    found = limber3d.time_of_impact(falling(ball, 3, -1), still(plate))
    assert found.status == Status.contact and found.upper - found.lower <= 2**-53
    assert found.upper == pytest.approx((3 + lowest) / 4, abs=1e-15)
    assert found.elements is not None and found.elements.kind in (Kind.vertex_face, Kind.edge_edge)
    assert found.witness is not None and found.witness.point_b[2] == 0
    assert found.normal.tolist() == pytest.approx([0, 0, -1])
    assert pickle.loads(pickle.dumps(found)) == found
    assert limber3d.time_of_impact(falling(ball, 3, 2), still(plate)).status == Status.clear
    assert limber3d.time_of_impact(falling(ball, 0, 2), still(plate)).status == Status.initial_contact
    apart = limber3d.time_of_impact(falling(ball, 3, -1), still(plate), min_separation=1, max_time=0.9)
    assert apart.upper == pytest.approx((2 + lowest) / 4, abs=1e-12)
    none = limber3d.time_of_impact(falling(ball, 3, -1), still(plate), budget=limber3d.QueryBudget(max_steps=0))
    assert none.status == Status.undecided and none.stopped_by == limber3d.StoppedBy.max_steps


def test_threads_give_the_same_answers(ball: limber3d.Model, plate: limber3d.Model) -> None:
    moving, floor = falling(ball, 3, -1), still(plate)
    one, several = (limber3d.time_of_impact(moving, floor, parallel=parallel) for parallel in (False, True))
    assert (several.lower, several.upper, several.elements) == (one.lower, one.upper, one.elements)
    assert several.witness == one.witness and several.status == one.status == Status.contact
    assert limber3d.self_time_of_impact(moving, parallel=True).status == limber3d.self_time_of_impact(moving).status
    with_filter = limber3d.time_of_impact(moving, floor, filter=lambda *_: False, parallel=True)
    assert with_filter.status == Status.clear
    for impacts in (limber3d.impacts, limber3d.impact_candidates):
        assert impacts(moving, floor, parallel=True).records.tolist() == impacts(moving, floor).records.tolist() != []
    for self_impacts in (limber3d.self_impacts, limber3d.self_impact_candidates):
        assert self_impacts(moving, parallel=True).records.tolist() == self_impacts(moving).records.tolist()


def test_filters_get_pairs_of_elements(ball: limber3d.Model, plate: limber3d.Model) -> None:
    asked = []

    def not_a_vertex(pair: limber3d.ElementPair) -> bool:
        asked.append(pair)
        return pair.kind == Kind.edge_edge

    with_filter = limber3d.time_of_impact(falling(ball, 3, -1), still(plate), filter=not_a_vertex)
    assert with_filter.elements is None or with_filter.elements.kind == Kind.edge_edge
    assert {pair.kind for pair in asked} >= {Kind.vertex_face}
    with pytest.raises(TypeError, match="filter"):
        limber3d.time_of_impact(falling(ball, 3, -1), still(plate), filter=3)


def test_impacts_are_records(ball: limber3d.Model, plate: limber3d.Model) -> None:
    moving, floor = falling(ball, 3, -1), still(plate)
    impacts = limber3d.impacts(moving, floor)
    assert impacts.records.dtype == limber3d.impact_dtype and (impacts["lower"] <= impacts["upper"]).all()
    first = limber3d.time_of_impact(moving, floor)
    assert impacts["lower"].min() <= first.upper and impacts["upper"].min() >= first.lower
    # Each vertex of the ball goes through the plate once.
    assert len(impacts[impacts["kind"] == Kind.vertex_face]) >= len(ball.vertices)
    candidates = limber3d.impact_candidates(moving, floor)
    assert candidates.records.dtype == limber3d.element_pair_dtype
    pairs = {tuple(pair) for pair in candidates.records.tolist()}
    assert {tuple(pair) for pair in impacts[["kind", "a", "b"]].tolist()} <= pairs
    assert impacts.is_complete and candidates.is_complete and candidates.stats.node_tests > 0
    spent = limber3d.QueryBudget(max_steps=0)
    for stopped in (
        limber3d.impacts(moving, floor, budget=spent),
        limber3d.impact_candidates(moving, floor, budget=spent),
        limber3d.self_impacts(moving, budget=spent),
        limber3d.self_impact_candidates(moving, budget=spent),
    ):
        assert len(stopped) == 0 and not stopped.is_complete and stopped.stopped_by is limber3d.StoppedBy.max_steps


def test_a_state_says_how_elements_lie(ball: limber3d.Model, plate: limber3d.Model) -> None:
    moving, floor = falling(ball, 3, -1), still(plate)
    found = limber3d.time_of_impact(moving, floor)
    assert found.elements is not None and found.witness is not None
    state = limber3d.state_of(moving, floor, found.elements, found.upper)
    assert state.normal == pytest.approx(found.normal) and state.point_a == pytest.approx(found.witness.point_a)
    part_a, part_b = state.vertices[: state.count_of_a], state.vertices[state.count_of_a :]
    now = ball.vertices + [0.1, 0.2, 3 - 4 * found.upper]
    assert state.weights[: state.count_of_a] @ now[part_a] == pytest.approx(state.point_a)
    assert state.weights[state.count_of_a :] @ plate.vertices[part_b] == pytest.approx(state.point_b, abs=1e-15)
    with pytest.raises(ValueError, match="id"):
        limber3d.self_state_of(floor, limber3d.ElementPair(Kind.edge_edge, 0, 99), 0.0)


def test_a_model_may_start_nearer_than_the_separation(ball: limber3d.Model, plate: limber3d.Model) -> None:
    rises = falling(ball, 1.1, 3)
    assert limber3d.time_of_impact(rises, still(plate), min_separation=0.5).status == Status.initial_contact
    assert limber3d.time_of_impact(rises, still(plate), min_separation=0.5, separation_fraction=0.5).status == Status.clear
    assert len(limber3d.impacts(rises, still(plate), min_separation=0.5, separation_fraction=0.5)) == 0


def test_a_model_folds_onto_itself() -> None:
    vertices = numpy.array([[0, 0, 0], [0, 1, 0], [1, 0.25, 0], [-1, 0.25, 0]])
    book = limber3d.Model(vertices, numpy.array([[0, 1, 2], [1, 0, 3]]))
    moving = limber3d.MovingModel(book)
    end = book.vertices.copy()
    end[3] = [0.5, 0.25, 0]
    moving.set_motion(end)
    found = limber3d.self_time_of_impact(moving)
    assert found.status == Status.contact and found.upper == pytest.approx(2 / 3)
    assert found.elements is not None and (found.elements.a, found.elements.b) == (3, 0)
    assert len(limber3d.self_impacts(moving)) >= 1 and len(limber3d.self_impact_candidates(moving)) >= 1


def test_a_motion_ends_when_the_model_changes(ball: limber3d.Model) -> None:
    moving = limber3d.MovingModel(ball)
    with pytest.raises(ValueError, match="motion"):
        limber3d.self_time_of_impact(moving)
    moving.set_motion(ball.vertices)
    assert limber3d.self_time_of_impact(moving).status == Status.clear
    ball.move_all(2 * ball.vertices)
    with pytest.raises(ValueError, match="motion"):
        limber3d.self_time_of_impact(moving)
    ball.commit()
    with pytest.raises(limber3d.InputError) as error:
        moving.set_motion(ball.vertices[:-1])
    assert error.value.code == limber3d.ErrorCode.size_mismatch
    with pytest.raises(ValueError, match="start_pose"):
        moving.set_motion(ball.vertices, 2 * numpy.eye(4))
    ball.reset(*PLATE)  # its edges are others
    moving.set_motion(ball.vertices)
    assert limber3d.self_time_of_impact(moving).status == Status.clear


def test_a_moving_model_keeps_its_model() -> None:
    moving = limber3d.MovingModel(limber3d.Model(*ball_arrays(8, 6)))
    gc.collect()
    with pytest.raises(limber3d.InputError):
        moving.set_motion(numpy.zeros((3, 3)))


def test_displacements_are_limited(plate: limber3d.Model) -> None:
    above = ([1, 0, 0, 0], [0, 0, 1])
    both = limber3d.limit_displacements(plate, plate, 0.5, [2.0] * 4, [0.125] * 4, pose_b=above)
    assert both.of_a == pytest.approx(0.375) and both.of_b == pytest.approx(0.125)
    alone = limber3d.limit_displacements(plate, plate, 0.5, numpy.full(4, 2, numpy.float32), pose_b=above)
    assert alone.of_a == pytest.approx(0.5) and alone.of_b is None
    assert limber3d.limit_self_displacements(plate, 0.0, [0.5] * 4) == pytest.approx(0.5)
    for wrong in ([1.0] * 3, [-1.0] * 4, [[1.0] * 4], [float("nan")] * 4):
        with pytest.raises(ValueError):
            limber3d.limit_self_displacements(plate, 0.0, wrong)


def test_moves_away_and_sideways_are_free(plate: limber3d.Model) -> None:
    high = limber3d.Model(plate.vertices + [0, 0, 0.5], plate.faces)
    moving, still = limber3d.MovingModel(high), limber3d.MovingModel(plate)
    still.set_motion(plate.vertices)
    for move, allowed in (([0, 0, 1], 1), ([0.25, 0, 0], 1), ([0, 0, -1], 0.25)):
        moving.set_motion(high.vertices + move)
        wishes = limber3d.limit_self_motions(moving, 0.25, [1.0] * 4)
        assert limber3d.limit_motions(moving, still, 0.25, wishes).of_a == pytest.approx(allowed)


def test_rigid_bodies_go_along_a_path(ball: limber3d.Model, plate: limber3d.Model) -> None:
    falls = limber3d.RigidMotion(([1, 0, 0, 0], [0, 0, 3]), ([1, 0, 0, 0], [0, 0, -1]))
    stands = limber3d.RigidMotion()
    found = limber3d.time_of_impact(ball, falls, plate, stands)
    lowest = ball.vertices[:, 2].min()
    assert found.status == Status.contact and found.time == pytest.approx((3 + lowest) / 4, abs=1e-5)
    assert found.time <= (3 + lowest) / 4 and found.witness is not None and found.distance_count < 40
    cache = limber3d.QueryCache()
    nearest = limber3d.min_distance(ball, falls, plate, stands, max_time=0.25, cache=cache)
    assert nearest.time == 0.25 and nearest.upper == pytest.approx(2 + lowest) and nearest.lower <= nearest.upper
    assert pickle.loads(pickle.dumps(nearest)) == nearest
    turns = limber3d.RigidMotion(([1, 0, 0, 0], [0, 0, 3]), ([0.8, 0, 0, 0.6], [0, 0, 1.5]))
    usual, exact = (limber3d.min_distance(ball, turns, plate, stands, distance_error=e) for e in (None, 0))
    assert exact.upper - exact.lower < 1e-11 < usual.upper - usual.lower
    few = limber3d.time_of_impact(ball, falls, plate, stands, budget=limber3d.QueryBudget(max_steps=1))
    assert few.status == Status.undecided and 0 < few.time < found.time


def test_rigid_motions_are_poses() -> None:
    quarter = ([2**-0.5, 0, 0, 2**-0.5], [2, 0, 0])
    turns = limber3d.RigidMotion(None, quarter, [0, 0, 0])
    assert turns.at(0) == pytest.approx(numpy.eye(4)) and turns.at(1)[:3, 3].tolist() == [2, 0, 0]
    assert turns.at(0.5)[:2, 0] == pytest.approx([2**-0.5, 2**-0.5])
    assert turns.speed(0) == pytest.approx(2, abs=1e-5)
    assert turns.speed(1) == pytest.approx(2 + numpy.pi / 2, abs=1e-5)
    screw = limber3d.RigidMotion.screw(None, quarter)
    assert screw.at(0.5)[:2, 3] == pytest.approx([1, 1 - 2**0.5])  # about the vertical line through (1, 1)
    for wrong in (-0.5, 1.5, float("nan")):
        with pytest.raises(ValueError, match="time"):
            turns.at(wrong)
