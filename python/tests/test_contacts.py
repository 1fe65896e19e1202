# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Contacts, self-queries, filters and pairs of elements."""

from __future__ import annotations

from typing import Any

import limber3d
import numpy
import numpy.typing
import pytest
from shapes import ball as ball_arrays

NEAR = ([1, 0.2, 0.1, 0], [1.9, 0, 0])


def test_intersections_are_pairs_of_ids(ball: limber3d.Model) -> None:
    pairs = limber3d.intersections(ball, ball, pose_b=NEAR)
    assert pairs.dtype == numpy.uint32 and pairs.shape[1] == 2 and len(pairs) > 10
    assert limber3d.intersections(ball, ball, pose_b=NEAR, max_count=3).tolist() == pairs[:3].tolist()
    assert limber3d.intersections(ball, ball, pose_b=NEAR, max_count=0).shape == (0, 2)
    assert limber3d.intersections(ball, ball, pose_b=([1, 0, 0, 0], [9, 0, 0])).shape == (0, 2)


def test_contacts_are_records(ball: limber3d.Model) -> None:
    contacts = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    assert contacts.dtype == limber3d.contact_dtype and 0 < contacts["distance"].max() <= 0.05
    meeting = {(c["triangle_a"], c["triangle_b"]) for c in contacts[contacts["distance"] == 0]}
    assert meeting == {tuple(pair) for pair in limber3d.intersections(ball, ball, pose_b=NEAR).tolist()}
    weights = contacts["weights_a"]
    assert (weights >= 0).all() and numpy.allclose(weights.sum(axis=1), 1)
    corners = ball.vertices[ball.faces[contacts["triangle_a"]]]
    assert numpy.allclose(numpy.einsum("ki,kij->kj", weights, corners), contacts["point_a"], atol=1e-12)
    with pytest.raises(ValueError, match="margin"):
        limber3d.contacts(ball, ball, -1.0)


def test_pairs_are_the_same_on_all_threads(ball: limber3d.Model) -> None:
    one_by_one = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    assert (limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, is_parallel=True) == one_by_one).all()
    assert (limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, is_parallel=True, max_count=4) == one_by_one[:4]).all()
    def even(a: int, b: int) -> bool:
        return a % 2 == 0

    some = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, filter=even)
    assert (limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, is_parallel=True, filter=even) == some).all()
    pairs = limber3d.intersections(ball, ball, pose_b=NEAR)
    assert (limber3d.intersections(ball, ball, pose_b=NEAR, is_parallel=True) == pairs).all()
    model, rings = folded(), limber3d.NeighborRings(folded(), 1)
    assert (limber3d.self_intersections(model, is_parallel=True) == limber3d.self_intersections(model)).all()
    own = limber3d.self_contacts(model, 0.3, filter=rings)
    assert len(own) > 0 and (limber3d.self_contacts(model, 0.3, filter=rings, is_parallel=True) == own).all()


def test_budgets_end_searches(ball: limber3d.Model) -> None:
    enough, few = limber3d.QueryBudget(max_steps=2**40), limber3d.QueryBudget(max_steps=10)
    late, flag = limber3d.QueryBudget(deadline=0.0), limber3d.CancelFlag()
    flag.set()
    model = folded()

    def asked(budget: limber3d.QueryBudget) -> list[tuple[numpy.typing.NDArray[Any], limber3d.StoppedBy]]:
        return [
            limber3d.intersections(ball, ball, pose_b=NEAR, budget=budget),
            limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, is_parallel=True, budget=budget),
            limber3d.closest_pairs(ball, ball, 9, pose_b=NEAR, budget=budget),
            limber3d.self_intersections(model, budget=budget),
            limber3d.self_contacts(model, 0.3, budget=budget),
            limber3d.self_closest_pairs(model, 9, budget=budget),
        ]

    whole = [
        limber3d.intersections(ball, ball, pose_b=NEAR),
        limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, budget=None),
        limber3d.closest_pairs(ball, ball, 9, pose_b=NEAR),
        limber3d.self_intersections(model),
        limber3d.self_contacts(model, 0.3),
        limber3d.self_closest_pairs(model, 9, budget=None),
    ]
    for (found, stopped_by), all_pairs in zip(asked(enough), whole, strict=True):
        assert stopped_by is limber3d.StoppedBy.nothing and (found == all_pairs).all() and len(found) > 0
    for (found, stopped_by), all_pairs in zip(asked(few), whole, strict=True):
        assert stopped_by is limber3d.StoppedBy.max_steps and len(found) <= len(all_pairs)
    some, _ = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, budget=limber3d.QueryBudget(max_steps=40))
    assert 0 < len(some) < len(whole[1]) and all(c in whole[1] for c in some)
    assert len({(c["triangle_a"], c["triangle_b"]) for c in some}) == len(some)
    for found, stopped_by in asked(late):
        assert stopped_by is limber3d.StoppedBy.deadline and len(found) < 720
    for _, stopped_by in asked(limber3d.QueryBudget(cancel=flag)):
        assert stopped_by is limber3d.StoppedBy.cancel
    first, stopped_by = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, max_count=2, budget=enough)
    assert len(first) == 2 and stopped_by is limber3d.StoppedBy.nothing
    none, stopped_by = limber3d.contacts(ball, ball, 0.05, max_count=0, budget=few)
    assert len(none) == 0 and stopped_by is limber3d.StoppedBy.nothing
    with pytest.raises(TypeError):
        limber3d.contacts(ball, ball, 0.05, budget=0.001)  # type: ignore[call-overload]


def test_normals_take_the_side_of_closed_meshes(ball: limber3d.Model) -> None:
    found = limber3d.contacts(ball, ball, 0.0, pose_b=NEAR)
    assert set(found["normal_side"]) == {limber3d.NormalSide.outward}
    plain = limber3d.contacts(ball, ball, 0.0, pose_b=NEAR, oriented_faces=limber3d.OrientedFaces.none)
    assert set(plain["normal_side"]) == {limber3d.NormalSide.unknown} and len(plain) == len(found)
    wide = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    assert limber3d.NormalSide.inward in wide["normal_side"]
    with pytest.raises(TypeError):
        limber3d.contacts(ball, ball, 0.0, oriented_faces="both")  # type: ignore[call-overload]


def test_closest_pairs_come_nearest_first(ball: limber3d.Model) -> None:
    pose = ([1, 0, 0, 0], [2.5, 0, 0])
    pairs = limber3d.closest_pairs(ball, ball, 7, pose_b=pose)
    assert len(pairs) == 7 and (numpy.diff(pairs["distance"]) >= 0).all()
    assert pairs["distance"][0] == limber3d.distance(ball, ball, pose_b=pose).upper
    assert len(limber3d.closest_pairs(ball, ball, 2**62, pose_b=pose)) == 720 * 720
    near = limber3d.closest_pairs(ball, ball, 2**62, pose_b=pose, max_distance=0.52)
    assert len(near) == len(limber3d.contacts(ball, ball, 0.52, pose_b=pose)) > 0
    with pytest.raises(ValueError, match="max_distance"):
        limber3d.closest_pairs(ball, ball, 1, max_distance=-1.0)


def test_reduction_keeps_a_few_and_leaves_its_argument_alone(ball: limber3d.Model) -> None:
    contacts = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    before = contacts.copy()
    kept, patches = limber3d.reduce_contacts(contacts, radius=0.5, max_points=2)
    assert (contacts == before).all() and 0 < len(kept) < len(contacts) and len(patches) == len(kept)
    assert kept[0] in contacts and numpy.bincount(patches).max() <= 2
    assert len(limber3d.reduce_contacts(contacts[:0], radius=0.5)[0]) == 0
    assert len(limber3d.reduce_contacts(contacts[::2], radius=0.5)[0]) > 0
    with pytest.raises(ValueError, match="radius"):
        limber3d.reduce_contacts(contacts, radius=0.0)


def folded() -> limber3d.Model:
    """A ball whose poles have been pushed through each other."""
    vertices, faces = ball_arrays()
    vertices = vertices.copy()
    vertices[0, 2], vertices[-1, 2] = 1.5, -1.5
    return limber3d.Model(vertices, faces)


def test_a_model_can_meet_itself(ball: limber3d.Model) -> None:
    model = folded()
    cache = limber3d.QueryCache()
    assert (
        limber3d.self_collide(model) and limber3d.self_collide(model, cache=cache) and not limber3d.self_collide(ball)
    )
    assert limber3d.self_distance(model, cache=cache).status is limber3d.DistanceStatus.collision
    assert limber3d.self_distance(ball).upper > 0
    pairs = limber3d.self_intersections(model)
    assert len(pairs) > 0 and (pairs[:, 0] < pairs[:, 1]).all()
    assert len(limber3d.self_contacts(model, 0.0)) == len(pairs)
    assert limber3d.self_closest_pairs(ball, 3)["distance"][0] == limber3d.self_distance(ball).upper


def test_rings_of_neighbors_filter_pairs(ball: limber3d.Model) -> None:
    rings = limber3d.NeighborRings(ball, 2)
    near = limber3d.self_contacts(ball, 0.3)
    kept = limber3d.self_contacts(ball, 0.3, filter=rings)
    assert 0 < len(kept) < len(near) and rings.triangle_count == 720
    are_far = [not rings.are_near(c["triangle_a"], c["triangle_b"]) for c in near]
    assert (kept == near[are_far]).all()
    assert rings(0, 719) and not rings(5, 5)
    by_function = limber3d.self_contacts(ball, 0.3, filter=lambda a, b: not rings.are_near(a, b))
    assert (by_function == kept).all()
    with pytest.raises((ValueError, IndexError)):
        rings.are_near(0, 720)


def test_functions_filter_pairs_and_their_errors_come_through(ball: limber3d.Model) -> None:
    all_pairs = limber3d.intersections(ball, ball, pose_b=NEAR)
    even = limber3d.intersections(ball, ball, pose_b=NEAR, filter=lambda a, b: a % 2 == 0)
    assert even.tolist() == [pair for pair in all_pairs.tolist() if pair[0] % 2 == 0]

    def failing(a: int, b: int) -> bool:
        raise KeyError(a)

    with pytest.raises(KeyError):
        limber3d.intersections(ball, ball, pose_b=NEAR, filter=failing)
    with pytest.raises(TypeError, match="filter"):
        limber3d.intersections(ball, ball, filter=3)  # type: ignore[call-overload]

    def moving(a: int, b: int) -> bool:
        ball.move_vertices([0], [[0, 0, 0]])
        return True

    with pytest.raises(limber3d.BusyError):
        limber3d.intersections(ball, ball, pose_b=NEAR, filter=moving)
    assert ball.is_committed


def test_elements_come_with_weights_and_edges(tetra: limber3d.Model) -> None:
    pose = ([1, 0, 0, 0], [1.5, 0, 0])
    vertex_face, edge_edge = limber3d.element_pairs(tetra, tetra, 0.6, pose_b=pose)
    assert vertex_face.dtype == limber3d.vertex_face_dtype and edge_edge.dtype == limber3d.edge_edge_dtype
    assert numpy.allclose(vertex_face["weights"].sum(axis=1), 1) and vertex_face["is_vertex_of_b"].any()
    edges = tetra.edges
    assert len(edges) == 6 and edges.vertices.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert edges.of_triangles.shape == (4, 3) and edges.representatives.shape == (6,) and edges.vertex_representatives.shape == (4,)
    pair = edge_edge[0]
    a, b = tetra.vertices[edges.vertices[pair["a"]]], tetra.vertices[edges.vertices[pair["b"]]] + [1.5, 0, 0]
    points = a[0] + pair["parameter_a"] * (a[1] - a[0]), b[0] + pair["parameter_b"] * (b[1] - b[0])
    assert numpy.linalg.norm(points[0] - points[1]) == pytest.approx(pair["distance"])
    vertex_face, edge_edge = limber3d.self_element_pairs(tetra, 2.0)
    assert len(vertex_face) == 4 and len(edge_edge) == 3
