# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Models: moves, options, friends, pickling, lifetimes."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref
from pathlib import Path
from types import SimpleNamespace

import limber3d
import numpy
import pytest
import shapes
import trimesh
from shapes import TETRA_FACES, TETRA_VERTICES


def test_a_model_keeps_its_own_copy(tetra: limber3d.Model) -> None:
    vertices, faces = TETRA_VERTICES.copy(), TETRA_FACES.copy()
    model = limber3d.Model(vertices, faces)
    vertices[:], faces[:] = 7, 0
    assert (model.vertices == TETRA_VERTICES).all() and (model.faces == TETRA_FACES).all()
    witness = limber3d.distance(model, tetra).witness
    assert witness is not None
    for property in (model.vertices, model.faces, model.edges.vertices, witness.point_a):
        with pytest.raises(ValueError, match="read-only"):
            property[:] = 7
    assert (model.vertices == TETRA_VERTICES).all()


def test_moves_count_after_a_commit(tetra: limber3d.Model) -> None:
    other = limber3d.Model(TETRA_VERTICES + [5, 0, 0], TETRA_FACES)
    tetra.move_vertices([1], numpy.array([[3, 0, 0]], numpy.float32))
    assert not tetra.is_committed
    with pytest.raises(ValueError, match="committed"):
        limber3d.distance(tetra, other)
    tetra.commit()
    assert tetra.is_committed and limber3d.distance(tetra, other).upper == 2
    tetra.move_all(TETRA_VERTICES)
    tetra.rebuild()
    assert limber3d.distance(tetra, other).upper == 4
    assert tetra.maintenance_stats.moved_vertices == 5
    tetra.validate()


def test_reset_takes_another_mesh(tetra: limber3d.Model) -> None:
    vertices, faces = shapes.ball()
    assert len(tetra.edges) == 6
    tetra.reset(vertices, faces)
    assert tetra.tree_stats.leaves >= len(faces) / 8 and len(tetra.edges) == 3 * len(faces) / 2
    with pytest.raises(IndexError):
        tetra.reset(vertices, faces + 1000)
    assert (tetra.faces == faces).all()
    assert limber3d.element_pairs(tetra, tetra, 0.0).vertex_face.size > 0


def test_options_are_keywords_and_come_back() -> None:
    options = {
        "motion_margin": 0.25,
        "rebuild_policy": limber3d.RebuildPolicy.off,
        "rebuild_budget_us": 30.0,
        "preallocate": True,
    }
    assert limber3d.Model(TETRA_VERTICES, TETRA_FACES, **options).options == options  # type: ignore[arg-type]
    defaults = limber3d.Model(TETRA_VERTICES, TETRA_FACES).options
    assert defaults == {
        "motion_margin": 0,
        "rebuild_policy": limber3d.RebuildPolicy.in_commit,
        "rebuild_budget_us": None,
        "preallocate": False,
    }


def test_bounds_contain_the_model(ball: limber3d.Model) -> None:
    box, sphere = ball.bounding_box(), ball.bounding_sphere()
    assert (box.low <= ball.vertices).all() and (ball.vertices <= box.high).all() and (box.high < 1.01).all()
    assert (numpy.linalg.norm(ball.vertices - sphere.center, axis=1) <= sphere.radius).all() and sphere.radius < 1.5


def test_meshes_of_friends_are_taken() -> None:
    box = trimesh.creation.box()
    for mesh in (
        box,
        SimpleNamespace(vertices=box.vertices, triangles=box.faces.astype("int32")),
        # As Open3D's TriangleMesh: buffers that are not arrays of NumPy.
        SimpleNamespace(vertices=numpy.array(box.vertices).data, triangles=box.faces.astype(numpy.int32).data),
    ):
        model = limber3d.Model(mesh)
        assert (model.vertices == box.vertices).all() and (model.faces == box.faces).all()
    with pytest.raises(TypeError, match="expected vertices and faces"):
        limber3d.Model(TETRA_VERTICES)


def test_what_refers_to_a_model_keeps_it_alive() -> None:
    def surface_and_scene() -> tuple[limber3d.ClosedSurface, limber3d.Scene]:
        model = limber3d.Model(*shapes.ball())
        scene = limber3d.Scene()
        scene.add(model)
        return limber3d.ClosedSurface(model), scene

    surface, scene = surface_and_scene()
    gc.collect()
    rubbish = [limber3d.Model(*shapes.ball()) for _ in range(20)]
    assert surface.contains([0, 0, 0]) and len(rubbish) == 20
    scene.add(rubbish[0], ([1, 0, 0, 0], [4, 0, 0]))
    scene.commit()
    assert scene.closest_objects().result.upper == pytest.approx(2, abs=0.02)
    model = scene.model(0)
    assert isinstance(model, limber3d.Model) and (model is surface.model or len(model.faces) > 0)


def test_files_are_loaded(tmp_path: Path) -> None:
    path = shapes.write_obj(tmp_path / "ball.obj", *shapes.ball())
    model = limber3d.load(path, motion_margin=0.25)
    assert (model.vertices == shapes.ball()[0]).all() and model.options["motion_margin"] == 0.25
    with pytest.raises(OSError, match="missing.obj"):
        limber3d.load(tmp_path / "missing.obj")
    (tmp_path / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises((ValueError, IndexError), match="bad.obj"):
        limber3d.load(str(tmp_path / "bad.obj"))
    sequence = limber3d.MeshSequence(path)
    assert (sequence.read_positions(path, 1) == sequence.vertices).all()


def test_vertices_of_files_are_welded_as_asked(tmp_path: Path) -> None:
    def frame(name: str, x: float) -> Path:
        corners = f"v 0 0 0\nv 1 0 0\nv 1 1 0\nv {x} 0 0\nv {x} 1 0\nv 9 0 0\n"
        (tmp_path / name).write_text(corners + "o a\nf 1 2 3\no b\nf 4 6 5\n")
        return tmp_path / name

    first, second, near = frame("0.obj", 1), frame("1.obj", 5), frame("2.obj", 1.001)
    assert len(limber3d.load(first).vertices) == 4 and len(limber3d.load(first, weld=False).vertices) == 6
    assert len(limber3d.load(first, parts=True).vertices) == 6 == len(limber3d.load(near).vertices)
    file = limber3d.read_mesh_file(near, weld_tolerance=0.01)
    assert file.vertex_of_file_vertex.tolist() == [0, 1, 2, 1, 2, 3] and file.parts == ["a", "b"]
    with pytest.raises(ValueError, match="weld_tolerance"):
        limber3d.load(first, weld_tolerance=-1)
    assert limber3d.MeshSequence([first, second]).read_positions(second, 1)[:, 0].tolist() == [0, 1, 1, 5, 5, 9]
    with pytest.raises(ValueError, match="parts vertices 1 and 3"):
        limber3d.MeshSequence(first).read_positions(second, 1)


class Organ(limber3d.Model):
    """A model with a constructor and an attribute of its own, and a cycle of references."""

    def __init__(self, name: str) -> None:
        super().__init__(*shapes.ball(), motion_margin=0.01)
        self.name = name
        self.surface: limber3d.ClosedSurface | None = None
        self.scene: limber3d.Scene | None = None


def test_pickles_and_copies_keep_mesh_options_and_attributes(ball: limber3d.Model) -> None:
    organ, far = Organ("liver"), ([1, 0, 0, 0], [0, 0, 6])
    organ.move_all(organ.vertices * 2)
    pickles = [pickle.loads(pickle.dumps(organ, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
    twins = [*pickles, copy.copy(organ), copy.deepcopy(organ)]
    organ.commit()
    for twin in twins:
        assert isinstance(twin, Organ) and vars(twin) == vars(organ) and vars(twin) is not vars(organ)
        assert (twin.vertices == organ.vertices).all() and (twin.faces == organ.faces).all()
        assert twin.options == organ.options and twin.is_committed
        assert limber3d.distance(twin, ball, far).upper == limber3d.distance(organ, ball, far).upper
    assert type(copy.copy(ball)) is limber3d.Model and (copy.copy(ball).vertices == ball.vertices).all()


@pytest.mark.filterwarnings("ignore:nanobind")
@pytest.mark.parametrize("state", [(), (1, 2), (1, 2, {}, None), (shapes.TETRA_VERTICES, [[0, 1, 9]], None, None)])
def test_damaged_pickles_are_refused(state: tuple[object, ...]) -> None:
    model = limber3d.Model.__new__(limber3d.Model)
    with pytest.raises((TypeError, ValueError, RuntimeError, KeyError)):
        model.__setstate__(state)
    with pytest.raises(TypeError):
        repr(model)


def test_cycles_of_references_are_collected() -> None:
    organs = [weakref.ref(organ) for organ in map(Organ, ["liver", "heart"]) if tie(organ)]
    gc.collect()
    assert [organ() for organ in organs] == [None, None]


def tie(organ: Organ) -> bool:
    """Lets a model know objects that keep it alive."""
    organ.surface, organ.scene = limber3d.ClosedSurface(organ), limber3d.Scene()
    organ.scene.add(organ)
    return True


def test_weld_makes_a_surface_of_a_soup(ball: limber3d.Model) -> None:
    corners = ball.vertices[ball.faces].reshape(-1, 3)
    welded = limber3d.weld(corners, numpy.arange(len(corners)).reshape(-1, 3))
    assert len(welded.vertices) == len(ball.vertices) and welded.faces.shape == ball.faces.shape
    assert (welded.vertices[welded.welded_of] == corners).all() and (corners[welded.first_of] == welded.vertices).all()
    assert (welded.vertices[welded.faces] == ball.vertices[ball.faces]).all()
    assert (limber3d.weld(ball).faces == limber3d.weld(ball.vertices, ball.faces).faces).all()
    assert limber3d.ClosedSurface(limber3d.Model(welded)).contains([0, 0, 0])
    with pytest.raises(TypeError, match="weld: expected vertices and faces"):
        limber3d.weld(corners)
