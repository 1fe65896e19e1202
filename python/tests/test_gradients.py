# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of distances: those of the library, which C++ compares with differences, for each contact."""

from __future__ import annotations

import limber3d
import numpy
import pytest


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
    by_a, normals = limber3d.pose_gradient_a(contacts, [1, 2, 3]), contacts["normal"]
    assert (by_a.force == -normals).all()
    assert numpy.allclose(by_a.moment, -numpy.cross(contacts["point_a"] - [1, 2, 3], normals), atol=1e-14)
    of_b = limber3d.vertex_gradients_b(contacts)
    assert (of_b == contacts["weights_b"][:, :, None] * normals[:, None]).all()
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
    assert contact["distance"] == near.upper and contact["point_b"].tolist() == near.witness.point_b.tolist()
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
