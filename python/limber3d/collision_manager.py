# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many named meshes, with the methods of trimesh.collision.CollisionManager."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy

from ._core import DistanceResult, Model, Scene, contacts
from .typing import FloatArray, MeshLike, PoseLike

_EXTERNAL = "__external"  # the name that trimesh gives to a mesh which is no object of the manager

_Pair = tuple[int, int]  # ids of two objects of a scene
_Names = tuple[str, str]  # of a pair


class ContactData:
    """Two triangles that intersect.

    `names` are those of their meshes, `point` lies on both triangles, `normal` points from the first mesh to the second,
    `depth` is the least overlap of the two triangles.
    """

    def __init__(self, names: _Names, contact: numpy.void) -> None:
        self.names = set(names)
        self.normal: FloatArray = contact["normal"]
        self.point: FloatArray = contact["point_a"]
        self.depth = float(contact["depth"])
        self._triangles = dict(zip(names, (int(contact["triangle_a"]), int(contact["triangle_b"]))))

    def index(self, name: str) -> int:
        """The triangle of that mesh."""
        return self._triangles[name]


class DistanceData:
    """The shortest distance of two meshes: `names`, `distance`, and for each name a point and its triangle."""

    def __init__(self, names: _Names, result: DistanceResult) -> None:
        assert result.witness is not None  # there is no limit
        self.names = set(names)
        self.distance = result.upper
        self._points = dict(zip(names, (result.witness.point_a, result.witness.point_b)))
        self._triangles = dict(zip(names, (result.witness.triangle_a, result.witness.triangle_b)))

    def point(self, name: str) -> FloatArray:
        """The point of that mesh, in the world."""
        return self._points[name]

    def index(self, name: str) -> int:
        """The triangle of that mesh."""
        return self._triangles[name]


def _answer(answer: Any, names: Any, data: Any, return_names: bool, return_data: bool) -> Any:
    """The answer, followed by what was asked for besides."""
    parts = (answer, *((names,) if return_names else ()), *((data,) if return_data else ()))
    return parts if len(parts) > 1 else answer


class _World:
    """Objects of one or two managers in one scene, and which pairs of them count: of two managers one object of each;
    of one manager all pairs, or those of the named object."""

    def __init__(self, mine: CollisionManager, theirs: CollisionManager | None = None, name: str | None = None) -> None:
        self.scene = Scene()
        self._names: list[str] = []  # by id
        for manager in (mine,) if theirs is None else (mine, theirs):
            for its_name, (model, pose) in manager._objects.items():
                self.scene.add(model, pose)
                self._names.append(its_name)
        self.scene.commit()
        self._mine = len(mine._objects)  # ids from there on are of the other manager
        self._filter: Callable[[int, int], bool] | None = None
        if theirs is not None:
            self._filter = lambda a, b: (a < self._mine) != (b < self._mine)
        elif name is not None:
            named = self._names.index(name)
            self._filter = lambda a, b: named in (a, b)

    def names(self, pair: _Pair) -> _Names:
        return self._names[pair[0]], self._names[pair[1]]

    def ordered(self, pair: _Pair) -> _Pair:
        """Objects of the first manager first; in alphabetic order if both are of one."""
        a, b = sorted(pair, key=lambda id: (id >= self._mine, self._names[id]))
        return a, b

    def collisions(self) -> list[_Pair]:
        """The pairs of objects that meet."""
        pairs = self.scene.candidate_pairs(0.0, filter=self._filter)
        hits = pairs[self.scene.collide(pairs)["is_yes"]]
        return [self.ordered((int(a), int(b))) for a, b in hits]

    def contacts(self, hits: list[_Pair]) -> list[ContactData]:
        """All pairs of triangles that intersect."""
        scene = self.scene
        return [
            ContactData(self.names((a, b)), contact)
            for a, b in hits
            for contact in contacts(scene.model(a), scene.model(b), 0.0, scene.pose(a), scene.pose(b))
        ]

    def closest(self) -> tuple[_Names | None, DistanceData | None]:
        """The two objects that are closest; None if there are no two."""
        found = self.scene.closest_objects(filter=self._filter)
        if found.objects is None:
            return None, None
        return self.names(self.ordered(found.objects)), DistanceData(self.names(found.objects), found.result)


def _as_model(mesh: Model | MeshLike) -> Model:
    return mesh if isinstance(mesh, Model) else Model(mesh)


class CollisionManager:
    """A drop-in for trimesh.collision.CollisionManager: the same methods, arguments and answers.

    Meshes are trimesh.Trimesh, anything else that Model takes, or a Model, which is shared and may deform. They are
    surfaces: a mesh wholly inside another does not collide with it. Transforms are rigid motions, in any of the forms
    of a pose. Distances of meshes that meet are 0, and infinite where there are no two meshes.

    Cost     Each question builds a scene of all objects, in O(n log n).
    """

    def __init__(self) -> None:
        self._objects: dict[str, tuple[Model, PoseLike]] = {}

    def add_object(self, name: str, mesh: Model | MeshLike, transform: PoseLike = None) -> None:
        """Adds a mesh; one that has the name already is replaced."""
        model = _as_model(mesh)
        self._objects[name] = (model, _checked(model, transform))

    def remove_object(self, name: str) -> None:
        """Takes a mesh out. Raises ValueError if there is none of that name."""
        self._model(name)
        del self._objects[name]

    def set_transform(self, name: str, transform: PoseLike) -> None:
        """Places a mesh elsewhere. Raises ValueError if there is none of that name."""
        model = self._model(name)
        self._objects[name] = (model, _checked(model, transform))

    def in_collision_single(
        self,
        mesh: Model | MeshLike,
        transform: PoseLike = None,
        return_names: bool = False,
        return_data: bool = False,
    ) -> Any:
        """Whether a mesh meets any of the objects; if asked for, also the set of their names and the contacts."""
        world = _World(self, _alone(mesh, transform))
        hits = world.collisions()
        data = world.contacts(hits) if return_data else []
        return _answer(bool(hits), {world.names(hit)[0] for hit in hits}, data, return_names, return_data)

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Whether two of the objects meet; if asked for, also the set of pairs of names and the list of contacts."""
        return self._in_collision(_World(self), return_names, return_data)

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Whether an object meets one of another manager; names come as (this manager's, the other's)."""
        return self._in_collision(_World(self, other_manager), return_names, return_data)

    def min_distance_single(
        self,
        mesh: Model | MeshLike,
        transform: PoseLike = None,
        return_name: bool = False,
        return_data: bool = False,
    ) -> Any:
        """The shortest distance of a mesh to any of the objects; if asked for, also its name and data."""
        names, data = _World(self, _alone(mesh, transform)).closest()
        return self._min_distance(data, names and names[0], return_name, return_data)

    def min_distance_internal(
        self, name: str | None = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The shortest distance of two objects, one of which is the named one if there is a name; if asked for, also
        the pair of their names and data."""
        if name is not None:
            self._model(name)
        names, data = _World(self, name=name).closest()
        return self._min_distance(data, names, return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The shortest distance of an object to one of another manager; names come as (this manager's, the other's)."""
        names, data = _World(self, other_manager).closest()
        return self._min_distance(data, names, return_names, return_data)

    def _model(self, name: str) -> Model:
        if name not in self._objects:
            raise ValueError(f"{name} is not an object of the manager")
        return self._objects[name][0]

    @staticmethod
    def _in_collision(world: _World, return_names: bool, return_data: bool) -> Any:
        hits = world.collisions()
        data = world.contacts(hits) if return_data else []
        return _answer(bool(hits), {world.names(hit) for hit in hits}, data, return_names, return_data)

    @staticmethod
    def _min_distance(data: DistanceData | None, names: Any, return_names: bool, return_data: bool) -> Any:
        distance = float("inf") if data is None else data.distance
        return _answer(distance, names, data, return_names, return_data)


def _alone(mesh: Model | MeshLike, transform: PoseLike) -> CollisionManager:
    manager = CollisionManager()
    manager.add_object(_EXTERNAL, mesh, transform)
    return manager


def _checked(model: Model, transform: PoseLike) -> PoseLike:
    """A copy of a pose. Raises ValueError unless it is one."""
    scene = Scene()
    return scene.pose(scene.add(model, transform))
