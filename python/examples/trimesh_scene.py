# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
# pyright: basic
"""A scene of trimesh: which of its parts meet, how close the others are, and what a tool touches on its way.

limber3d.CollisionManager has the methods of trimesh's manager of that name, which needs python-fcl and SciPy. Where
they are installed, both are asked and have to agree.

    python trimesh_scene.py --parts 200
"""

from __future__ import annotations

import argparse
import importlib.util
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import limber3d
import numpy
import trimesh
import trimesh.collision
from limber3d.typing import FloatArray

Pair = tuple[str, str]


def scene_of(parts: int) -> trimesh.Scene:
    """Instances of a few shapes on a plate, somewhere and turned somehow; some meet."""
    shapes = {
        "plate": trimesh.creation.box((8, 8, 0.1)),
        "ball": trimesh.creation.icosphere(subdivisions=3, radius=0.4),
        "pin": trimesh.creation.cylinder(radius=0.15, height=1.2, sections=48),
        "ring": trimesh.creation.torus(major_radius=0.5, minor_radius=0.12),
        "block": trimesh.creation.box((0.7, 0.5, 0.4)),
    }
    random = numpy.random.default_rng(3)
    scene = trimesh.Scene()
    scene.add_geometry(shapes["plate"], "plate", "plate")
    for i in range(parts):
        name = random.choice(["ball", "pin", "ring", "block"])
        pose = trimesh.transformations.random_rotation_matrix(random.uniform(size=3))
        pose[:3, 3] = random.uniform((-3.5, -3.5, 0.4), (3.5, 3.5, 2.5))
        scene.add_geometry(shapes[name], f"{name} {i}", name, transform=pose)
    return scene


def manager_of(scene: trimesh.Scene, manager: Any) -> Any:
    """Fills a manager, of limber3d or of trimesh, with the parts of a scene."""
    models: dict[Any, Any] = {}
    for node in scene.graph.nodes_geometry:
        pose, shape = scene.graph[node]
        if shape not in models:
            mesh = scene.geometry[shape]
            models[shape] = limber3d.Model(mesh) if isinstance(manager, limber3d.CollisionManager) else mesh
        manager.add_object(node, models[shape], pose)  # instances share a model; a mesh does, too
    return manager


class Answers(NamedTuple):
    """What managers are asked."""

    colliding: set[Pair]
    clearance: float  # of the tool from everything, before it moves
    nearest: str
    touched: list[set[str]]  # by the tool, step by step


def ask(manager: Any, tool: trimesh.Trimesh, path: FloatArray) -> Answers:
    """The same calls for either manager."""
    _, colliding = manager.in_collision_internal(return_names=True)
    clearance, nearest = manager.min_distance_single(tool, path[0], return_name=True)
    touched = [manager.in_collision_single(tool, pose, return_names=True)[1] for pose in path]
    return Answers({(min(a, b), max(a, b)) for a, b in colliding}, float(clearance), nearest, touched)


def timed(name: str, call: Callable[[], Answers]) -> Answers:
    start = time.perf_counter()
    answers = call()
    print(f"{name}: {1000 * (time.perf_counter() - start):.1f} ms")
    return answers


def same(a: Answers, b: Answers) -> bool:
    """Whether answers agree; distances up to the rounding of another library."""
    return a._replace(clearance=0) == b._replace(clearance=0) and abs(a.clearance - b.clearance) < 1e-6


def main(arguments: Sequence[str] | None = None) -> Answers:
    parser = argparse.ArgumentParser(description="A scene of trimesh, asked by limber3d.")
    parser.add_argument("--parts", type=int, default=40, help="parts besides the plate (40)")
    parser.add_argument("--steps", type=int, default=50, help="steps of the tool (50)")
    options = parser.parse_args(arguments)

    scene = scene_of(options.parts)
    tool = trimesh.creation.capsule(height=0.6, radius=0.1)
    path = numpy.tile(numpy.eye(4), (options.steps, 1, 1))
    path[:, :3, 3] = numpy.linspace((-3, -3, 3), (3, 3, 0.3), options.steps)

    manager = manager_of(scene, limber3d.CollisionManager())
    ours = timed("limber3d.CollisionManager", lambda: ask(manager, tool, path))
    if not all(map(importlib.util.find_spec, ("fcl", "scipy"))):
        print("trimesh's own manager is not asked: python-fcl or SciPy is not installed")
    else:
        trimesh_manager: Any = trimesh.collision.CollisionManager
        theirs = manager_of(scene, trimesh_manager())
        assert same(ours, timed("trimesh.collision.CollisionManager", lambda: ask(theirs, tool, path)))

    print(f"{len(ours.colliding)} pairs of parts meet, such as {' and '.join(min(ours.colliding))}")
    print(f"the tool starts {ours.clearance:.6f} from {ours.nearest}")
    print(f"on its way it touches {sorted(set().union(*ours.touched))}")
    assert ours.colliding and any(ours.touched)
    return ours


if __name__ == "__main__":
    main()
