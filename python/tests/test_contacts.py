# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Contacts, self-queries, filters and pairs of elements."""

from __future__ import annotations

import limber3d
import numpy
import pytest
from shapes import ball as ball_arrays

NEAR = ([1, 0.2, 0.1, 0], [1.9, 0, 0])


def test_intersections_are_pairs_of_ids(ball: limber3d.Model) -> None:
    pairs = limber3d.intersections(ball, ball, pose_b=NEAR).records
    assert pairs.dtype == numpy.uint32 and pairs.shape[1] == 2 and len(pairs) > 10
    assert limber3d.intersections(ball, ball, pose_b=NEAR, max_count=3).records.tolist() == pairs[:3].tolist()
    assert limber3d.intersections(ball, ball, pose_b=NEAR, max_count=0).records.shape == (0, 2)
    assert limber3d.intersections(ball, ball, pose_b=([1, 0, 0, 0], [9, 0, 0])).records.shape == (0, 2)


def test_results_say_whether_they_are_all(ball: limber3d.Model) -> None:
    found = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    assert found.is_complete and found.stopped_by is limber3d.StoppedBy.nothing and found.stats.primitive_tests > 0
    for max_count in (0, 1, len(found)):
        some = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, max_count=max_count)
        assert len(some) == max_count and not some.is_complete and some.stopped_by is limber3d.StoppedBy.nothing
    assert limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, max_count=len(found) + 1).is_complete
    assert limber3d.closest_pairs(ball, ball, 3, pose_b=NEAR).is_complete


def test_contacts_are_records(ball: limber3d.Model) -> None:
    contacts = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR).records
    assert contacts.dtype == limber3d.contact_dtype and 0 < contacts["distance"].max() <= 0.05
    meeting = {(c["triangle_a"], c["triangle_b"]) for c in contacts[contacts["distance"] == 0]}
    assert meeting == {tuple(pair) for pair in limber3d.intersections(ball, ball, pose_b=NEAR).records.tolist()}
    weights = contacts["weights_a"]
    assert (weights >= 0).all() and numpy.allclose(weights.sum(axis=1), 1)
    corners = ball.vertices[ball.faces[contacts["triangle_a"]]]
    assert numpy.allclose(numpy.einsum("ki,kij->kj", weights, corners), contacts["point_a"], atol=1e-12)
    with pytest.raises(ValueError, match="margin"):
        limber3d.contacts(ball, ball, -1.0)


def test_pairs_are_the_same_on_all_threads(ball: limber3d.Model) -> None:
    one_by_one = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR).records
    assert (limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, parallel=True).records == one_by_one).all()
    four = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, parallel=True, max_count=4)
    assert (four.records == one_by_one[:4]).all() and not four.is_complete

    def even(a: int, b: int) -> bool:
        return a % 2 == 0

    some = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, filter=even).records
    assert (limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, parallel=True, filter=even).records == some).all()
    pairs = limber3d.intersections(ball, ball, pose_b=NEAR).records
    assert (limber3d.intersections(ball, ball, pose_b=NEAR, parallel=True).records == pairs).all()
    model, rings = folded(), limber3d.NeighborRings(folded(), 1)
    pairs = limber3d.self_intersections(model).records
    assert (limber3d.self_intersections(model, parallel=True).records == pairs).all()
    own = limber3d.self_contacts(model, 0.3, filter=rings).records
    assert len(own) > 0 and (limber3d.self_contacts(model, 0.3, filter=rings, parallel=True).records == own).all()


def test_budgets_end_searches(ball: limber3d.Model) -> None:
    enough, few = limber3d.QueryBudget(max_steps=2**40), limber3d.QueryBudget(max_steps=10)
    late, flag = limber3d.QueryBudget(deadline=0.0), limber3d.CancelFlag()
    flag.set()
    model = folded()

    def asked(budget: limber3d.QueryBudget | None) -> list[limber3d.Contacts | limber3d.TrianglePairs]:
        return [
            limber3d.intersections(ball, ball, pose_b=NEAR, budget=budget),
            limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, parallel=True, budget=budget),
            limber3d.closest_pairs(ball, ball, 9, pose_b=NEAR, budget=budget),
            limber3d.self_intersections(model, budget=budget),
            limber3d.self_contacts(model, 0.3, budget=budget),
            limber3d.self_closest_pairs(model, 9, budget=budget),
        ]

    whole = asked(None)
    for found, all_pairs in zip(asked(enough), whole, strict=True):
        assert found.is_complete and found.stopped_by is limber3d.StoppedBy.nothing
        assert (found.records == all_pairs.records).all() and len(found) > 0
    for found, all_pairs in zip(asked(few), whole, strict=True):
        assert found.stopped_by is limber3d.StoppedBy.max_steps and len(found) <= len(all_pairs)
        assert not found.is_complete
    some = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, budget=limber3d.QueryBudget(max_steps=40))
    assert 0 < len(some) < len(whole[1]) and all(c in whole[1].records for c in some)
    assert len({(c["triangle_a"], c["triangle_b"]) for c in some}) == len(some)
    for found in asked(late):
        assert found.stopped_by is limber3d.StoppedBy.deadline and len(found) < 720
    for found in asked(limber3d.QueryBudget(cancel=flag)):
        assert found.stopped_by is limber3d.StoppedBy.cancel
    first = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR, max_count=2, budget=enough)
    assert len(first) == 2 and first.stopped_by is limber3d.StoppedBy.nothing
    with pytest.raises(TypeError):
        limber3d.contacts(ball, ball, 0.05, budget=0.001)  # type: ignore[arg-type]


def test_normals_take_the_side_of_closed_meshes(ball: limber3d.Model) -> None:
    found = limber3d.contacts(ball, ball, 0.0, pose_b=NEAR)
    assert set(found["normal_side"]) == {limber3d.NormalSide.outward}
    plain = limber3d.contacts(ball, ball, 0.0, pose_b=NEAR, oriented_faces=limber3d.OrientedFaces.none)
    assert set(plain["normal_side"]) == {limber3d.NormalSide.unknown} and len(plain) == len(found)
    wide = limber3d.contacts(ball, ball, 0.05, pose_b=NEAR)
    assert limber3d.NormalSide.inward in wide["normal_side"]
    with pytest.raises(TypeError):
        limber3d.contacts(ball, ball, 0.0, oriented_faces="both")  # type: ignore[arg-type]


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
    before = contacts.records.copy()
    kept = limber3d.reduce_contacts(contacts, radius=0.5, max_points=2)
    assert (contacts.records == before).all() and 0 < len(kept) < len(contacts) and len(kept.patch_ids) == len(kept)
    assert kept[0] in contacts.records and numpy.bincount(kept.patch_ids).max() <= 2
    assert (limber3d.reduce_contacts(kept, radius=0.5, max_points=2).records == kept.records).all()
    assert len(limber3d.reduce_contacts(contacts[:0], radius=0.5)) == 0
    assert len(limber3d.reduce_contacts(contacts[::2], radius=0.5)) > 0
    with pytest.raises(ValueError, match="radius"):
        limber3d.reduce_contacts(contacts, radius=0.0)
    before["normal"][3] = 0
    with pytest.raises(ValueError, match="contact 3 has a normal of length 0"):
        limber3d.reduce_contacts(before, radius=0.5)


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
    pairs = limber3d.self_intersections(model).records
    assert len(pairs) > 0 and (pairs[:, 0] < pairs[:, 1]).all()
    assert len(limber3d.self_contacts(model, 0.0)) == len(pairs)
    assert limber3d.self_closest_pairs(ball, 3)["distance"][0] == limber3d.self_distance(ball).upper


def test_rings_of_neighbors_filter_pairs(ball: limber3d.Model) -> None:
    rings = limber3d.NeighborRings(ball, 2)
    near = limber3d.self_contacts(ball, 0.3)
    kept = limber3d.self_contacts(ball, 0.3, filter=rings)
    assert 0 < len(kept) < len(near) and rings.triangle_count == 720
    are_far = [not rings.are_near(c["triangle_a"], c["triangle_b"]) for c in near]
    assert (kept.records == near[are_far]).all()
    assert rings(0, 719) and not rings(5, 5)
    by_function = limber3d.self_contacts(ball, 0.3, filter=lambda a, b: not rings.are_near(a, b))
    assert (by_function.records == kept.records).all()
    with pytest.raises((ValueError, IndexError)):
        rings.are_near(0, 720)


def test_functions_filter_pairs_and_their_errors_come_through(ball: limber3d.Model) -> None:
    all_pairs = limber3d.intersections(ball, ball, pose_b=NEAR)
    even = limber3d.intersections(ball, ball, pose_b=NEAR, filter=lambda a, b: a % 2 == 0)
    assert even.records.tolist() == [pair for pair in all_pairs.records.tolist() if pair[0] % 2 == 0]

    def failing(a: int, b: int) -> bool:
        raise KeyError(a)

    with pytest.raises(KeyError):
        limber3d.intersections(ball, ball, pose_b=NEAR, filter=failing)
    with pytest.raises(TypeError, match="filter"):
        limber3d.intersections(ball, ball, filter=3)  # type: ignore[arg-type]

    def moving(a: int, b: int) -> bool:
        ball.move_vertices([0], [[0, 0, 0]])
        return True

    with pytest.raises(limber3d.BusyError):
        limber3d.intersections(ball, ball, pose_b=NEAR, filter=moving)
    assert ball.is_committed


def test_elements_come_with_weights_and_edges(tetra: limber3d.Model) -> None:
    pose = ([1, 0, 0, 0], [1.5, 0, 0])
    found = limber3d.element_pairs(tetra, tetra, 0.6, pose_b=pose)
    assert found.is_complete and found.stopped_by is limber3d.StoppedBy.nothing and found.stats.primitive_tests > 0
    vertex_face, edge_edge = found.vertex_face, found.edge_edge
    assert vertex_face.dtype == limber3d.vertex_face_dtype and edge_edge.dtype == limber3d.edge_edge_dtype
    assert numpy.allclose(vertex_face["weights"].sum(axis=1), 1) and vertex_face["is_vertex_of_b"].any()
    edges = tetra.edges
    assert len(edges) == 6 and edges.vertices.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert edges.of_triangles.shape == (4, 3) and edges.representatives.shape == (6,) and edges.vertex_representatives.shape == (4,)
    pair = edge_edge[0]
    a, b = tetra.vertices[edges.vertices[pair["a"]]], tetra.vertices[edges.vertices[pair["b"]]] + [1.5, 0, 0]
    points = a[0] + pair["parameter_a"] * (a[1] - a[0]), b[0] + pair["parameter_b"] * (b[1] - b[0])
    assert numpy.linalg.norm(points[0] - points[1]) == pytest.approx(pair["distance"])
    own = limber3d.self_element_pairs(tetra, 2.0)
    assert len(own.vertex_face) == 4 and len(own.edge_edge) == 3
    for one, several in (
        (found, limber3d.element_pairs(tetra, tetra, 0.6, pose_b=pose, parallel=True)),
        (own, limber3d.self_element_pairs(tetra, 2.0, parallel=True)),
    ):
        assert (several.vertex_face == one.vertex_face).all() and (several.edge_edge == one.edge_edge).all()
    budget = limber3d.QueryBudget(max_steps=0)
    for none in (
        limber3d.element_pairs(tetra, tetra, 0.6, budget=budget),
        limber3d.self_element_pairs(tetra, 2.0, budget=budget),
    ):
        assert not none.is_complete and none.stopped_by is limber3d.StoppedBy.max_steps and len(none.edge_edge) == 0


def test_features_come_once_with_all_that_a_penalty_needs(tetra: limber3d.Model) -> None:
    pose = ([1, 0, 0, 0], [1.5, 0, 0])
    found, pairs = limber3d.feature_pairs(tetra, tetra, 0.6, pose_b=pose), limber3d.element_pairs(tetra, tetra, 0.6, pose_b=pose)
    assert found.is_complete and found.records.dtype == limber3d.feature_pair_dtype and found.stats.primitive_tests > 0
    assert found["multiplicity"].sum() == len(pairs.vertex_face) + len(pairs.edge_edge) > len(found)
    assert len({tuple(ids) for ids in found[["kind_a", "a", "kind_b", "b"]].tolist()}) == len(found)
    tips = found[(found["kind_a"] == limber3d.FeatureKind.vertex.value) & (found["kind_b"] == limber3d.FeatureKind.vertex.value)]
    assert len(tips) > 0 and (tips["vertices_a"] == tips["a"][:, None]).all() and (tips["weights_b"] == [1, 0, 0]).all()
    vertices = tetra.vertices
    for side, offset in (("a", [0, 0, 0]), ("b", [1.5, 0, 0])):
        points = (found["weights_" + side][:, :, None] * vertices[found["vertices_" + side]]).sum(axis=1) + offset
        assert numpy.allclose(points, found["point_" + side])
    assert numpy.allclose(found["point_a"] + found["distance"][:, None] * found["normal"], found["point_b"])
    own = limber3d.self_feature_pairs(tetra, 2.0)
    assert own["multiplicity"].sum() == 7
    budget = limber3d.QueryBudget(max_steps=0)
    for none in (
        limber3d.feature_pairs(tetra, tetra, 0.6, budget=budget),
        limber3d.self_feature_pairs(tetra, 2.0, budget=budget),
    ):
        assert not none.is_complete and none.stopped_by is limber3d.StoppedBy.max_steps and len(none) == 0
    with pytest.raises(ValueError, match="limber.*feature_pairs: margin"):
        limber3d.self_feature_pairs(tetra, -1.0)
