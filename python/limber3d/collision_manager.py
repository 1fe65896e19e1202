# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many named meshes, with the methods of trimesh.collision.CollisionManager."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy

from ._core import (
    ClosedSurface,
    Model,
    Scene,
    Witness,
    contacts,
    separating_translation,
    signed_distance,
)
from .errors import InputError
from .typing import FloatArray, MeshLike, PoseLike

_EXTERNAL = "__external"  # the name that trimesh gives to a mesh which is no object of the manager

_Pair = tuple[int, int]  # ids of two objects of a scene
_Names = tuple[str, str]  # of a pair


class ContactData:
    """Two triangles that intersect, or two convex meshes that do.

    `names` are those of the meshes, `normal` points from the first mesh to the second. Of triangles, `point` lies on
    both, and `depth` is their least overlap. Of convex meshes, `depth` is how far they have to move apart along the
    normal, and `point` is in the middle between the points that part last.
    """

    def __init__(self, names: _Names, contact: Mapping[str, Any] | numpy.void) -> None:
        self.names = set(names)
        self.normal: FloatArray = contact["normal"]
        self.point: FloatArray = contact["point_a"]
        self.depth = float(contact["depth"])
        self._triangles = dict(zip(names, (int(contact["triangle_a"]), int(contact["triangle_b"]))))

    def index(self, name: str) -> int:
        """The triangle of that mesh."""
        return self._triangles[name]


class DistanceData:
    """The shortest distance of two meshes: `names`, `distance`, and for each name a point and its triangle. If the
    distance is negative, these are the points that part last."""

    def __init__(self, names: _Names, distance: float, witness: Witness) -> None:
        self.names = set(names)
        self.distance = distance
        self._points = dict(zip(names, (witness.point_a, witness.point_b)))
        self._triangles = dict(zip(names, (witness.triangle_a, witness.triangle_b)))

    def point(self, name: str) -> FloatArray:
        """The point of that mesh, in the world."""
        return self._points[name]

    def index(self, name: str) -> int:
        """The triangle of that mesh."""
        return self._triangles[name]


class _Object(NamedTuple):
    """What a manager knows by a name."""

    model: Model
    pose: PoseLike
    mesh: Model | MeshLike  # as it was given

    @property
    def is_convex(self) -> bool:
        return bool(getattr(self.mesh, "is_convex", False))


class _WayOut(NamedTuple):
    """The shortest way that is known to part two closed objects that meet, and the points that part last."""

    pair: _Pair
    depth: float
    direction: FloatArray  # of the second object
    witness: Witness

    def contact(self) -> Mapping[str, Any]:
        witness = self.witness
        return {
            "normal": self.direction,
            "point_a": (witness.point_a + witness.point_b) / 2,
            "depth": self.depth,
            "triangle_a": witness.triangle_a,
            "triangle_b": witness.triangle_b,
        }


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
        self._objects: list[_Object] = []
        self._surfaces: dict[int, ClosedSurface | None] = {}  # None if it is not closed
        for manager in (mine,) if theirs is None else (mine, theirs):
            for its_name, thing in manager._objects.items():
                self.scene.add(thing.model, thing.pose)
                self._names.append(its_name)
                self._objects.append(thing)
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
        """One of two convex meshes; of others, all pairs of triangles that intersect."""
        return [ContactData(self.names(hit), contact) for hit in hits for contact in self._contacts_of(hit)]

    def _contacts_of(self, hit: _Pair) -> list[Any]:
        if all(self._objects[id].is_convex for id in hit):
            way = self._way_out(hit)
            if way is not None:
                return [way.contact()]
        a, b = hit
        scene = self.scene
        return list(contacts(scene.model(a), scene.model(b), 0.0, scene.pose(a), scene.pose(b)))

    def closest(self) -> tuple[_Names | None, DistanceData | None]:
        """The two objects that are closest, or deepest in each other; None if there are no two."""
        found = self.scene.closest_objects(filter=self._filter)
        if found.objects is None:
            return None, None
        deepest = self._deepest() if found.result.upper == 0 else None
        if deepest is not None:
            names = self.names(deepest.pair)
            return names, DistanceData(names, -deepest.depth, deepest.witness)
        assert found.result.witness is not None  # there is no limit
        data = DistanceData(self.names(found.objects), found.result.upper, found.result.witness)
        return self.names(self.ordered(found.objects)), data

    def _deepest(self) -> _WayOut | None:
        """Of the closed objects that meet, the two that have to move farthest to part."""
        deepest: _WayOut | None = None
        hits = sorted(((self._overlap(hit), hit) for hit in self.collisions()), reverse=True)
        for overlap, hit in hits:
            if deepest is not None and overlap <= deepest.depth:
                break
            way = self._way_out(hit)
            if way is not None and (deepest is None or way.depth > deepest.depth):
                deepest = way
        return deepest

    def _overlap(self, hit: _Pair) -> float:
        """How far an object has to move to part the bounds of two: no less than what parts the objects."""
        a, b = (self.scene.bounding_box(id) for id in hit)
        return float(min(numpy.min(a.high - b.low), numpy.min(b.high - a.low)))

    def _way_out(self, hit: _Pair) -> _WayOut | None:
        """Nothing unless both objects are closed."""
        a, b = (self._surface(id) for id in hit)
        if a is None or b is None:
            return None
        poses = [self.scene.pose(id) for id in hit]
        translation = signed_distance(a, b, *poses).translation
        depth = float(numpy.linalg.norm(translation))
        if depth == 0:
            return None
        witness = separating_translation(a, b, translation, *poses).witness
        return None if witness is None else _WayOut(hit, depth, translation / depth, witness)

    def _surface(self, id: int) -> ClosedSurface | None:
        if id not in self._surfaces:
            try:
                self._surfaces[id] = ClosedSurface(self._objects[id].model)
            except InputError:
                self._surfaces[id] = None
        return self._surfaces[id]


def _as_model(mesh: Model | MeshLike) -> Model:
    return mesh if isinstance(mesh, Model) else Model(mesh)


class CollisionManager:
    """A drop-in for trimesh.collision.CollisionManager: the same methods, arguments and answers.

    Meshes are trimesh.Trimesh, anything else that Model takes, or a Model, which is shared and may deform. They are
    surfaces: a mesh wholly inside another does not collide with it. Transforms are rigid motions, in any of the forms
    of a pose. Distances are infinite where there are no two meshes.

    Meeting  Of closed meshes that meet, the distance is minus the length of a translation that parts them, as
             signed_distance() finds it; the pair that has to move farthest counts. It is 0 unless both are closed.
             Contacts are all pairs of triangles; of two meshes with a true `is_convex`, such as a trimesh.Trimesh may
             have, there is one, whose depth is that of the bodies.
    Cost     Each question builds a scene of all objects, in O(n log n). Depths take some milliseconds for each pair
             that may be the deepest. Only distances of meshes that meet and contacts of convex ones ask for them.
    """

    def __init__(self) -> None:
        self._objects: dict[str, _Object] = {}

    def add_object(self, name: str, mesh: Model | MeshLike, transform: PoseLike = None) -> None:
        """Adds a mesh; one that has the name already is replaced."""
        model = _as_model(mesh)
        self._objects[name] = _Object(model, _checked(model, transform), mesh)

    def remove_object(self, name: str) -> None:
        """Takes a mesh out. Raises ValueError if there is none of that name."""
        self._model(name)
        del self._objects[name]

    def set_transform(self, name: str, transform: PoseLike) -> None:
        """Places a mesh elsewhere. Raises ValueError if there is none of that name."""
        pose = _checked(self._model(name), transform)
        self._objects[name] = self._objects[name]._replace(pose=pose)

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
        return self._objects[name].model

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
