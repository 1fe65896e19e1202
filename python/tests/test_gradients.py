# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of distances, next to differences of distances."""

from __future__ import annotations

from typing import Any

import limber3d
import numpy
import pytest
from shapes import random_poses, rotation

STEP = 1e-6


def turned(pose: Any, axis: int, center: Any, angle: float) -> Any:
    """A pose after a rotation about an axis through a point."""
    turn = rotation(numpy.eye(4)[0] * numpy.cos(angle / 2) + numpy.eye(4)[axis + 1] * numpy.sin(angle / 2))
    result = pose.copy()
    result[:3, :3] = turn @ pose[:3, :3]
    result[:3, 3] = turn @ (pose[:3, 3] - center) + center
    return result


def slope(distance: Any) -> float:
    return float((distance(STEP) - distance(-STEP)) / (2 * STEP))


def test_gradients_are_slopes_of_distances(tetra: limber3d.Model, ball: limber3d.Model) -> None:
    checked = 0
    for pose_a, pose_b in zip(random_poses(1, 12), random_poses(2, 12, 3.0)):
        near = limber3d.distance(tetra, ball, pose_a, pose_b)
        if near.upper < 0.5 or near.witness is None:
            continue
        contact = limber3d.contact_of(tetra, ball, near.witness, pose_a, pose_b)
        assert contact.dtype == limber3d.contact_dtype and contact["distance"] == near.upper
        assert contact["triangle_a"] == near.witness.triangle_a and contact["triangle_b"] == near.witness.triangle_b
        center_a, center_b = numpy.array([0.3, -0.2, 0.1]), pose_b[:3, 3]
        by_a = limber3d.pose_gradient_a(contact, center_a)
        by_b = limber3d.pose_gradient_b(contact, center_b)
        assert by_a.force.shape == by_b.moment.shape == (3,) and (by_a.force == -by_b.force).all()
        for axis in range(3):
            by = numpy.zeros((4, 4))
            by[axis, 3] = 1

            def of_a(pose: Any) -> float:
                return limber3d.distance(tetra, ball, pose, pose_b).upper

            def of_b(pose: Any) -> float:
                return limber3d.distance(tetra, ball, pose_a, pose).upper

            assert slope(lambda t: of_a(pose_a + t * by)) == pytest.approx(by_a.force[axis], abs=1e-4)
            assert slope(lambda t: of_b(pose_b + t * by)) == pytest.approx(by_b.force[axis], abs=1e-4)
            of_a_turned = slope(lambda t: of_a(turned(pose_a, axis, center_a, t)))
            of_b_turned = slope(lambda t: of_b(turned(pose_b, axis, center_b, t)))
            assert (of_a_turned, of_b_turned) == pytest.approx((by_a.moment[axis], by_b.moment[axis]), abs=1e-4)
        checked += 1
    assert checked > 5


def test_gradients_by_vertices_are_slopes_too(tetra: limber3d.Model, ball: limber3d.Model) -> None:
    pose = ([1, 0.3, 0.1, 0.2], [2.5, 0.3, 0.2])
    near = limber3d.distance(tetra, ball, pose_b=pose)
    assert near.witness is not None
    contact = limber3d.contact_of(tetra, ball, near.witness, pose_b=pose)
    turn = rotation(pose[0])
    for model, gradients, triangle, to_world in (
        (tetra, limber3d.vertex_gradients_a(contact), near.witness.triangle_a, numpy.eye(3)),
        (ball, limber3d.vertex_gradients_b(contact), near.witness.triangle_b, turn),
    ):
        assert gradients.shape == (3, 3) and abs(gradients).max() > 0.1
        vertices = model.vertices
        for corner, vertex in enumerate(model.faces[triangle]):
            for axis in range(3):

                def moved(t: float) -> float:
                    model.move_vertices([vertex], [vertices[vertex] + t * numpy.eye(3)[axis]])
                    model.commit()
                    return limber3d.distance(tetra, ball, pose_b=pose).upper

                assert slope(moved) == pytest.approx(gradients[corner] @ to_world[:, axis], abs=1e-4)
                moved(0.0)


def test_arrays_of_contacts_give_arrays_of_gradients(ball: limber3d.Model) -> None:
    found = limber3d.contacts(ball, ball, 0.05, pose_b=([1, 0.2, 0.1, 0], [1.9, 0, 0]))
    contacts = found.records[:24]
    by_b = limber3d.pose_gradient_b(contacts, [1.9, 0, 0])
    corners = limber3d.vertex_gradients_a(contacts)
    assert (limber3d.vertex_gradients_a(found)[:24] == corners).all()
    assert (limber3d.pose_gradient_b(found, [1.9, 0, 0]).force[:24] == by_b.force).all()
    assert by_b.force.shape == by_b.moment.shape == (24, 3) and corners.shape == (24, 3, 3)
    assert (by_b.force == contacts["normal"]).all()
    assert (by_b.moment == numpy.cross(contacts["point_b"] - [1.9, 0, 0], contacts["normal"])).all()
    assert (corners == -contacts["weights_a"][:, :, None] * contacts["normal"][:, None]).all()
    assert (limber3d.vertex_gradients_b(contacts[3]) == limber3d.vertex_gradients_b(contacts)[3]).all()
    folded = contacts.reshape(2, 12)[:, ::2]
    of_folded, of_every_other = (limber3d.pose_gradient_a(some, [0, 0, 0]) for some in (folded, contacts[::2]))
    assert (of_folded.moment.reshape(12, 3) == of_every_other.moment).all()
    assert limber3d.vertex_gradients_b(contacts[:0]).shape == (0, 3, 3)
    # Fields are read by name: a later version may have more, in another order.
    names = contacts.dtype.names or ()
    later = numpy.zeros(24, [("new", "f8"), *((name, contacts.dtype[name]) for name in reversed(names))])
    for name in names:
        later[name] = contacts[name]
    assert (limber3d.pose_gradient_b(later, [1.9, 0, 0]).moment == by_b.moment).all()
    with pytest.raises(ValueError, match="fields of contact_dtype"):
        limber3d.pose_gradient_b(later[["new", "normal"]], [1.9, 0, 0])


def test_mistakes_are_errors(tetra: limber3d.Model) -> None:
    near = limber3d.distance(tetra, tetra, pose_b=([1, 0, 0, 0], [3, 0, 0]))
    assert near.witness is not None
    contact = limber3d.contact_of(tetra, tetra, near.witness, pose_b=([1, 0, 0, 0], [3, 0, 0]))
    with pytest.raises(ValueError, match="center"):
        limber3d.pose_gradient_a(contact, [0, 0])
    for given in (numpy.zeros(3), near.witness, 1):
        with pytest.raises(ValueError, match="contact_dtype"):
            limber3d.vertex_gradients_a(given)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        limber3d.contact_of(tetra, tetra, None)  # type: ignore[arg-type]
    tetra.reset(tetra.vertices, tetra.faces[:1])
    with pytest.raises(ValueError, match="triangle"):
        limber3d.contact_of(tetra, tetra, near.witness)
