# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The manager that stands in for trimesh's: known scenes with the answers that trimesh documents."""

from __future__ import annotations

import inspect
import math
from typing import Any

import limber3d
import numpy
import pytest
import trimesh
import trimesh.collision


def at(x: float) -> Any:
    pose = numpy.eye(4)
    pose[0, 3] = x
    return pose


def boxes(*places: float) -> limber3d.CollisionManager:
    """Unit cubes named a, b, c, ... at these places of the x axis."""
    manager = limber3d.CollisionManager()
    for name, x in zip("abcdef", places):
        manager.add_object(name, trimesh.creation.box(), at(x))
    return manager


def open_box() -> Any:
    box = trimesh.creation.box()
    return trimesh.Trimesh(box.vertices, box.faces[:-1])


def test_methods_and_arguments_are_those_of_trimesh() -> None:
    theirs, ours = trimesh.collision.CollisionManager, limber3d.CollisionManager
    for name, method in inspect.getmembers(theirs, inspect.isfunction):
        if not name.startswith("_"):
            expected = list(inspect.signature(method).parameters)
            assert list(inspect.signature(getattr(ours, name)).parameters) == expected, name


def test_collisions_inside_a_manager() -> None:
    manager = boxes(0, 0.9, 5)
    assert manager.in_collision_internal()
    hit, names, data = manager.in_collision_internal(return_names=True, return_data=True)
    assert hit and names == {("a", "b")} and all(contact.names == {"a", "b"} for contact in data)
    assert data[0].depth >= 0 and 0 <= data[0].index("a") < 12 and 0.39 < data[0].point[0] < 0.51
    manager.set_transform("b", at(2))
    assert not manager.in_collision_internal() and manager.in_collision_internal(True) == (False, set())
    manager.add_object("b", trimesh.creation.box(), at(0.9))
    assert manager.in_collision_internal()
    manager.remove_object("a")
    assert not manager.in_collision_internal()


def test_collisions_with_a_mesh_and_another_manager() -> None:
    manager = boxes(0, 3, 6)
    box = trimesh.creation.box()
    assert manager.in_collision_single(box, at(3.5), return_names=True) == (True, {"b"})
    hit, data = manager.in_collision_single(box, at(3.5), return_data=True)
    assert hit and data[0].names == {"b", "__external"} and 0 <= data[0].index("__external") < 12
    assert manager.in_collision_single(limber3d.Model(box), at(1.5)) is False
    other = boxes(5.5, 20)
    assert manager.in_collision_other(other, return_names=True) == (True, {("c", "a")})
    assert manager.in_collision_other(boxes(20)) is False
    assert boxes(0, 0.5).in_collision_other(limber3d.CollisionManager()) is False


def test_distances() -> None:
    manager = boxes(0, 3, 7)
    assert manager.min_distance_internal() == 2
    distance, names, data = manager.min_distance_internal(return_names=True, return_data=True)
    assert (distance, names) == (2, ("a", "b")) and data.distance == 2 and data.names == {"a", "b"}
    assert data.point("a")[0] == 0.5 and data.point("b")[0] == 2.5 and 0 <= data.index("b") < 12
    assert manager.min_distance_internal("c", return_names=True) == (3, ("b", "c"))
    box = trimesh.creation.box()
    distance, name, data = manager.min_distance_single(box, at(9), return_name=True, return_data=True)
    assert (distance, name) == (1, "c") and data.point("__external")[0] == 8.5
    distance, names = manager.min_distance_other(boxes(-3, 12), return_names=True)
    assert (distance, names) == (2, ("a", "a"))
    assert manager.min_distance_single(open_box()) == 0
    assert math.isinf(boxes(0).min_distance_internal()) and math.isinf(
        limber3d.CollisionManager().min_distance_single(box)
    )


def test_closed_meshes_that_meet_have_negative_distances() -> None:
    manager = boxes(0, 3, 3.9)
    distance, names, data = manager.min_distance_single(
        trimesh.creation.box(), at(0.75), return_name=True, return_data=True
    )
    assert distance == pytest.approx(-0.25) and names == "a"
    assert data.distance == distance and data.names == {"a", "__external"}
    apart = data.point("__external") - data.point("a")
    assert numpy.linalg.norm(apart) == pytest.approx(0.25) and 0 <= data.index("a") < 12
    assert manager.min_distance_internal(return_names=True) == (pytest.approx(-0.1), ("b", "c"))
    assert manager.min_distance_internal("a", return_names=True) == (2, ("a", "b"))
    # The pair that is deepest counts, of all that meet.
    other = boxes(3.2, 0.95)
    assert manager.min_distance_other(other, return_names=True) == (pytest.approx(-0.8), ("b", "a"))
    # Of meshes that are not closed only the closed pairs have depths.
    manager.add_object("open", open_box(), at(3.9))
    assert manager.min_distance_internal(return_names=True) == (pytest.approx(-0.1), ("b", "c"))
    manager.remove_object("b")
    assert manager.min_distance_internal(return_names=True) == (0, ("c", "open"))


def test_depth_is_that_of_bodies_however_fine_their_meshes_are() -> None:
    for subdivisions in (1, 3):
        ball = trimesh.creation.icosphere(subdivisions=subdivisions)
        manager = limber3d.CollisionManager()
        manager.add_object("ball", ball)
        distance = manager.min_distance_single(ball, at(1.5))
        trimesh_manager: Any = trimesh.collision.CollisionManager
        theirs = trimesh_manager()
        theirs.add_object("ball", ball)
        assert distance == pytest.approx(theirs.min_distance_single(ball, at(1.5)), rel=0.01)


def test_convex_meshes_have_one_contact() -> None:
    manager = boxes(0)
    hit, data = manager.in_collision_single(trimesh.creation.box(), at(0.75), return_data=True)
    (contact,) = data
    assert hit and contact.depth == pytest.approx(0.25) and contact.point[0] == pytest.approx(0.375)
    assert contact.normal == pytest.approx([1, 0, 0]) and contact.names == {"a", "__external"}
    # A model does not say whether it is convex, so its contacts are those of triangles.
    model = limber3d.Model(trimesh.creation.box())
    assert len(manager.in_collision_single(model, at(0.75), return_data=True)[1]) > 1


def test_meshes_are_surfaces() -> None:
    manager = boxes(0)
    manager.add_object("inside", trimesh.creation.box((0.2, 0.2, 0.2)))
    assert not manager.in_collision_internal() and manager.min_distance_internal() == 0.4


def test_any_string_is_a_name() -> None:
    manager = boxes(0)
    manager.add_object("", trimesh.creation.box(), at(0.9))
    assert manager.in_collision_internal(return_names=True) == (True, {("", "a")})
    assert manager.min_distance_internal("", return_names=True)[1] == ("", "a")


def test_mistakes_are_errors() -> None:
    manager = boxes(0)
    for mistake in (
        lambda: manager.remove_object("z"),
        lambda: manager.set_transform("z", at(0)),
        lambda: manager.min_distance_internal("z"),
        lambda: manager.set_transform("a", numpy.eye(4) * 2),
        lambda: manager.add_object("b", trimesh.creation.box(), numpy.eye(3)),
    ):
        with pytest.raises(ValueError):
            mistake()
    assert not manager.in_collision_internal()
