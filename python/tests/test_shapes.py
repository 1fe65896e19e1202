# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shapes next to formulas."""

from __future__ import annotations

import gc
import math

import limber3d
import numpy
import pytest


def at(x: float, y: float, z: float) -> tuple[list[float], list[float]]:
    return [1, 0, 0, 0], [x, y, z]


def test_spheres_and_capsules_are_as_far_apart_as_formulas_say() -> None:
    ball, rod = limber3d.Shape.sphere(0.5), limber3d.Shape.capsule([0, 0, -1], [0, 0, 1], 0.25)
    assert ball.radius == 0.5 and not ball.is_solid and ball.deviation == 0
    near = limber3d.distance(ball, rod, pose_b=at(2, 0, 0.5))
    assert near.upper == near.lower == 1.25
    assert near.witness is not None and near.witness.point_a.tolist() == [0.5, 0, 0]
    assert limber3d.collide(ball, rod, pose_b=at(0.75, 0, 0)).answer is limber3d.Answer.yes
    assert limber3d.within(ball, rod, 1.25, pose_b=at(2, 0, 0)).answer is limber3d.Answer.yes
    assert limber3d.within(ball, rod, 1.24, pose_b=at(2, 0, 0)).answer is limber3d.Answer.no


def test_shapes_meet_models(ball: limber3d.Model) -> None:
    box, inner = limber3d.Shape.box([2, 2, 2]), limber3d.Shape.sphere(0.25)
    assert box.is_solid and limber3d.collide(ball, box).answer is limber3d.Answer.yes
    assert limber3d.collide(ball, inner).answer is limber3d.Answer.no
    floor = limber3d.Shape.half_space([0, 0, 2], -1.5, 100)
    assert limber3d.distance(ball, floor).upper == pytest.approx(0.5)
    found = limber3d.contacts(ball, limber3d.Shape.sphere(0.5), 0.0, pose_b=at(0, 0, 1.25))
    assert len(found) > 0 and (found["distance"] == 0).all() and (found["depth"] > 0).all()
    assert len(limber3d.intersections(ball, limber3d.Shape.sphere(0.5), pose_b=at(0, 0, 1.25))) == len(found)
    closest = limber3d.closest_pairs(ball, limber3d.Shape.sphere(0.5), 3, pose_b=at(0, 0, 2))
    assert closest["distance"][0] == 0.5


def test_points_make_hulls_and_clouds() -> None:
    points = numpy.random.default_rng(1).uniform(-1, 1, size=(100, 3))
    hull, cloud = limber3d.Shape.convex_hull(points), limber3d.Shape.point_cloud(points, 0.125)
    assert hull.is_solid and not cloud.is_solid
    probe = limber3d.Shape.sphere(0.5)
    expected = numpy.linalg.norm(points - [3, 0, 0], axis=1).min() - 0.625
    found = limber3d.distance(cloud, probe, pose_b=at(3, 0, 0))
    assert found.upper == pytest.approx(expected)
    assert found.witness is not None
    assert found.witness.triangle_a == numpy.linalg.norm(points - [3, 0, 0], axis=1).argmin()
    assert limber3d.collide(hull, limber3d.Shape.sphere(0)).answer is limber3d.Answer.yes


def test_heights_are_rows_and_columns() -> None:
    field = limber3d.Shape.height_field([[0, 1, 2], [3, 4, 5]], 0.5, 2)
    for row in range(2):
        for column in range(3):
            above = limber3d.distance(
                field, limber3d.Shape.sphere(0), pose_b=at(0.5 * column, 2 * row, 3 * row + column)
            )
            assert above.upper == 0
    with pytest.raises(ValueError, match=r"heights: expected shape \(rows, columns\)"):
        limber3d.Shape.height_field([1, 2], 1, 1)


def test_cylinders_say_how_far_off_they_may_be() -> None:
    cylinder = limber3d.Shape.cylinder([0, 0, 0], [0, 0, 1], 1, 0.01)
    assert 0 < cylinder.deviation <= 0.01
    near = limber3d.distance(cylinder, limber3d.Shape.sphere(0.5), pose_b=at(3, 0, 0.5))
    assert near.lower <= 1.5 <= near.upper + cylinder.deviation


def test_scenes_and_batches_and_motions_take_shapes(ball: limber3d.Model) -> None:
    probe = limber3d.Shape.sphere(0.5)
    scene = limber3d.Scene()
    first = scene.add(ball)
    second = scene.add(probe, at(0, 0, 3))
    scene.commit()
    assert scene.model(second) is probe
    closest = scene.closest_objects()
    assert closest.objects is not None and set(closest.objects) == {first, second}
    assert closest.result.upper == pytest.approx(1.5)
    assert scene.closest_object(probe, at(0, 0, 9)).object == second
    poses = numpy.tile(numpy.eye(4), (3, 1, 1))
    poses[:, 2, 3] = [2, 3, 4]
    found = limber3d.distance_many(ball, probe, poses_b=poses)
    assert found["upper"] == pytest.approx([0.5, 1.5, 2.5])
    path = limber3d.RigidMotion(at(0, 0, 5), at(0, 0, 0))
    impact = limber3d.time_of_impact(ball, limber3d.RigidMotion(), probe, path)
    assert impact.time == pytest.approx(0.7, abs=1e-4)


def test_models_have_a_radius_and_follow_their_model(ball: limber3d.Model) -> None:
    model, probe = limber3d.Model(ball.vertices, ball.faces), limber3d.Shape.sphere(0.5)
    padded = limber3d.Body(model, 0.25)
    assert isinstance(padded, limber3d.Body) and not isinstance(padded, limber3d.Model)
    assert padded.radius == 0.25 and not padded.is_solid and model.radius == 0 and not model.is_solid
    far = at(0, 0, 3)
    assert limber3d.distance(padded, probe, pose_b=far).upper == limber3d.distance(model, probe, pose_b=far).upper - 0.25
    assert limber3d.distance_many(padded, padded, poses_b=[numpy.eye(4)])["upper"][0] == 0
    scene = limber3d.Scene()
    one, two = scene.add(padded), scene.add(probe, far)
    scene.commit()
    assert scene.model(one) is padded and scene.closest_objects().result.upper == pytest.approx(1.25)
    (contacts,) = scene.contacts([[one, two]], 1.25 + 1e-9)
    assert len(contacts) > 0 and contacts["distance"].min() == pytest.approx(1.25)
    model.move_all(2 * ball.vertices)
    with pytest.raises(ValueError, match="commit"):
        limber3d.distance(padded, probe, pose_b=far)
    model.commit()
    scene.commit()
    assert limber3d.distance(padded, probe, pose_b=far).upper == pytest.approx(0.25)
    assert scene.closest_objects().result.upper == pytest.approx(0.25)
    del model
    gc.collect()
    assert limber3d.distance(padded, probe, pose_b=far).upper == pytest.approx(0.25)
    for radius in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match=r"limber3d\.Body: the radius must be finite"):
            limber3d.Body(ball, radius)
    with pytest.raises(TypeError):
        limber3d.Body(probe, 1.0)  # type: ignore[arg-type]


def test_closed_surfaces_are_solids(ball: limber3d.Model) -> None:
    inner = limber3d.Shape.sphere(0.25)
    model = limber3d.Model(ball.vertices, ball.faces)
    solid = limber3d.ClosedSurface(model).solid()
    gc.collect()
    assert solid.is_solid and solid.radius == 0
    assert limber3d.collide(model, inner).answer is limber3d.Answer.no
    assert limber3d.collide(solid, inner).answer is limber3d.Answer.yes
    assert limber3d.distance(solid, inner).upper == 0 and limber3d.distance(solid, inner, pose_b=at(0, 0, 2)).upper > 0
    scene = limber3d.Scene()
    scene.add(solid), scene.add(inner)
    scene.commit()
    assert scene.any_within(0.0).result.answer is limber3d.Answer.yes
    model.reset(model.vertices, model.faces[:-1])
    for refused in (
        lambda: limber3d.collide(solid, inner),
        scene.commit,
        lambda: scene.add(solid),
        lambda: limber3d.collide_many(solid, inner, poses_b=[numpy.eye(4)]),
    ):
        with pytest.raises(ValueError, match="has been reset"):
            refused()
    scene.remove(0)
    scene.commit()
    assert scene.closest_object(model).object == 1


def test_bodies_are_used_as_their_models_are(ball: limber3d.Model) -> None:
    model = limber3d.Model(ball.vertices, ball.faces)
    padded, solid = limber3d.Body(model, 0.1), limber3d.ClosedSurface(model).solid()

    def moves(_a: int, _b: int) -> bool:
        model.move_all(ball.vertices)
        return True

    for body in (padded, solid):
        with pytest.raises(limber3d.BusyError):
            limber3d.contacts(body, ball, 0.1, filter=moves)
    assert model.is_committed


def test_bad_shapes_are_refused(ball: limber3d.Model) -> None:
    with pytest.raises(ValueError, match=r"limber3d\.Shape\.sphere: radius must be at least 0"):
        limber3d.Shape.sphere(-1)
    with pytest.raises(ValueError, match="point 1 has a coordinate"):
        limber3d.Shape.point_cloud([[0.0, 0.0, 0.0], [0.0, math.nan, 0.0]], 1)
    with pytest.raises(TypeError):
        limber3d.closest_point(limber3d.Shape.sphere(1), [0, 0, 0])  # type: ignore[arg-type]
    for arguments in ((), (ball, 0.5)):
        with pytest.raises(TypeError, match=r"Shape\.sphere"):
            limber3d.Shape(*arguments)
