# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Closest points, inside and outside."""

from __future__ import annotations

import math

import limber3d
import numpy
import pytest


def test_the_closest_point_says_where_it_lies(tetra: limber3d.Model) -> None:
    found = limber3d.closest_point(tetra, [0.2, 0.3, -1]).closest
    assert found is not None
    assert found.distance == 1 and found.position.tolist() == [0.2, 0.3, 0] and found.triangle == 0
    assert found.feature.kind is limber3d.FeatureKind.face
    corners = tetra.vertices[tetra.faces[found.triangle]]
    assert numpy.allclose(found.weights @ corners, found.position)
    assert limber3d.closest_point(tetra, [9, 9, 9], max_distance=1.0).closest is None
    assert limber3d.closest_point(tetra, [5, 0, 0], ([1, 0, 0, 0], [5, 0, 0])).closest is not None
    with pytest.raises(ValueError, match=r"point: expected shape \(3,\)"):
        limber3d.closest_point(tetra, [[1, 2, 3]])


def test_many_points_give_the_bits_of_one(ball: limber3d.Model) -> None:
    pose = ([1, 0.2, 0.4, 0], [0.3, 0, 0])
    points = numpy.random.default_rng(4).normal(size=(500, 3))
    found = limber3d.closest_point_many(ball, points, pose, max_distance=0.7)
    assert found.dtype == limber3d.surface_point_dtype and numpy.isinf(found["distance"]).any()
    for point, record in zip(points, found):
        one = limber3d.closest_point(ball, point, pose, max_distance=0.7).closest
        if one is None:
            assert math.isinf(record["distance"]) and record["triangle"] == 2**32 - 1
        else:
            found_here = record["distance"], record["triangle"], record["feature"]["index"]
            assert (one.distance, one.triangle, one.feature.index) == found_here
            assert (one.position == record["position"]).all() and (one.weights == record["weights"]).all()


def test_closed_surfaces_tell_inside_from_outside(ball: limber3d.Model) -> None:
    surface = limber3d.ClosedSurface(ball)
    points = numpy.random.default_rng(5).normal(size=(300, 3)).astype(numpy.float32)
    inside = surface.contains_many(points)
    signed = surface.signed_distance_many(points)
    assert inside.dtype == bool and inside.any() and not inside.all()
    for point, is_inside, record in zip(points, inside, signed):
        assert surface.contains(point) == is_inside == record["is_inside"] == (record["distance"] <= 0)
        one = surface.signed_distance(point)
        assert one.distance == record["distance"] and one.is_inside == is_inside
        assert surface.winding_number(point) == (1 if is_inside else 0)
    assert surface.winding_number([0, 0, 1]) is None
    on_it = surface.signed_distance_many(ball.vertices)["distance"]
    assert (on_it == 0).all() and not numpy.signbit(on_it).any()
    assert math.copysign(1, surface.signed_distance([0, 0, 1]).distance) == 1
    beyond = surface.signed_distance([9, 0, 0], max_distance=1.0)
    assert beyond.distance == math.inf and beyond.closest is None and not beyond.is_inside
    assert surface.signed_distance([0, 0, 0], max_distance=0.5).distance == math.inf
    assert surface.contains([5, 0, 0], ([1, 0, 0, 0], [5, 0, 0])) and surface.model is ball


def test_open_surfaces_have_a_winding_number_and_no_inside(ball: limber3d.Model) -> None:
    vertices, faces = ball.vertices, ball.faces[:-3]
    opened = limber3d.Model(vertices, faces)
    with pytest.raises(ValueError, match="edge"):
        limber3d.ClosedSurface(opened)
    assert 0.9 < limber3d.generalized_winding_number(opened, [0, 0, 0]) < 1
    for point, number in (([0, 0, 0], 1), ([3, 0, 0], 0)):
        assert limber3d.generalized_winding_number(ball, point) == pytest.approx(number)


def test_a_surface_whose_model_was_reset_is_refused(ball: limber3d.Model) -> None:
    surface = limber3d.ClosedSurface(ball)
    ball.reset(ball.vertices, ball.faces)
    with pytest.raises(ValueError, match="reset"):
        surface.contains([0, 0, 0])
    with pytest.raises(ValueError, match="reset"):
        surface.contains_many(numpy.zeros((100, 3)))
