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


class ContactData:
    """Two triangles that intersect.

    `names` are those of their meshes, `point` lies on both triangles, `normal` points from the first mesh to the second,
    `depth` is the least overlap of the two triangles.
    """

    def __init__(self, names: tuple[str, str], contact: numpy.void) -> None:
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

    def __init__(self, names: tuple[str, str], result: DistanceResult, is_swapped: bool) -> None:
        assert result.witness is not None  # there is no limit
        self.names = set(names)
        self.pair = (names[1], names[0]) if is_swapped else names
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
    """Objects of one or two managers in one scene, and their names by id."""

    def __init__(self, mine: CollisionManager, theirs: CollisionManager | None = None) -> None:
        self.scene = Scene()
        self.mine = self._add(mine)
        self.theirs = {} if theirs is None else self._add(theirs)
        self.is_between = theirs is not None
        self.scene.commit()

    def _add(self, manager: CollisionManager) -> dict[int, str]:
        return {self.scene.add(model, pose): name for name, (model, pose) in manager._objects.items()}

    def _filter(self) -> Callable[[int, int], bool] | None:
        """Of two managers, only pairs of an object of one and an object of the other count."""
        return (lambda a, b: (a in self.mine) != (b in self.mine)) if self.is_between else None

    def _filter_of(self, name: str) -> Callable[[int, int], bool]:
        """Only pairs of the named object count."""
        named = next(id for id, its_name in self.mine.items() if its_name == name)
        return lambda a, b: named in (a, b)

    def _ordered(self, a: int, b: int) -> _Pair:
        """Objects of the first manager first; in alphabetic order if both are of one."""
        return (b, a) if a in self.theirs or (b in self.mine and self.mine[b] < self.mine[a]) else (a, b)

    def names(self, pair: _Pair) -> tuple[str, str]:
        a, b = (self.mine[id] if id in self.mine else self.theirs[id] for id in pair)
        return a, b

    def collisions(self) -> list[_Pair]:
        """The pairs of objects that meet."""
        pairs = self.scene.candidate_pairs(0.0, filter=self._filter())
        hits = pairs[self.scene.collide(pairs)["is_yes"]]
        return [self._ordered(int(a), int(b)) for a, b in hits]

    def contacts(self, hits: list[_Pair]) -> list[ContactData]:
        """All pairs of triangles that intersect."""
        found: list[ContactData] = []
        for a, b in hits:
            scene = self.scene
            for contact in contacts(scene.model(a), scene.model(b), 0.0, scene.pose(a), scene.pose(b)):
                found.append(ContactData(self.names((a, b)), contact))
        return found

    def closest(self, name: str | None = None) -> DistanceData | None:
        """The two objects that are closest; the named one of the first manager and the one that is closest to it, if
        there is a name; None if there are no two."""
        found = self.scene.closest_objects(filter=self._filter() if name is None else self._filter_of(name))
        if found.objects is None:
            return None
        a, b = found.objects
        return DistanceData(self.names((a, b)), found.result, self._ordered(a, b) != (a, b))


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
        names = {world.names(hit)[0] for hit in hits}
        data = world.contacts(hits) if return_data else []
        return _answer(bool(hits), names, data, return_names, return_data)

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
        data = _World(self, _alone(mesh, transform)).closest()
        return self._min_distance(data, None if data is None else data.pair[0], return_name, return_data)

    def min_distance_internal(
        self, name: str | None = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The shortest distance of two objects, one of which is the named one if there is a name; if asked for, also
        the pair of their names and data."""
        if name is not None:
            self._model(name)
        data = _World(self).closest(name)
        return self._min_distance(data, None if data is None else data.pair, return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The shortest distance of an object to one of another manager; names come as (this manager's, the other's)."""
        data = _World(self, other_manager).closest()
        return self._min_distance(data, None if data is None else data.pair, return_names, return_data)

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
