# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of batches: queries by name; arrays, how they are told apart, cut into partitions, and sent."""

from __future__ import annotations

import hashlib
import io
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy

from .. import _core
from ..typing import ArrayLike, FloatArray, IdArray, PosesLike, RecordArray

QueryName = Literal["distance", "collide", "within"]
AnyArray = numpy.typing.NDArray[Any]

_OPTIONS: dict[QueryName, dict[str, float]] = {
    "distance": {"relative_error": 0.0, "absolute_error": 0.0, "max_distance": math.inf},
    "collide": {},
    "within": {"max_distance": math.nan},  # has to be given
}
QUERY_NAMES = tuple(_OPTIONS)
_ROWS = 4096  # that are looked at together: arrays may be larger than memory


def dtype_of(name: str) -> numpy.dtype[numpy.void]:
    """The element type of the answers of a query."""
    return _core.distance_dtype if name == "distance" else _core.collide_dtype


@dataclass(frozen=True)
class Query:
    """A query with its options."""

    name: QueryName
    options: dict[str, float]

    @staticmethod
    def of(name: QueryName, **given: float | None) -> Query:
        """Options that are None are left out. Raises ValueError for those that the query does not have."""
        if name not in _OPTIONS:
            raise ValueError(f"query: expected one of {', '.join(_OPTIONS)}; got {name!r}")
        options = _OPTIONS[name].copy()
        for option, value in given.items():
            if value is None:
                continue
            if option not in options:
                raise ValueError(f"{option}: {name} has no such option")
            options[option] = float(value)
        if name == "within" and math.isnan(options["max_distance"]):
            raise ValueError("max_distance: within needs it")
        return Query(name, options)

    def described(self) -> dict[str, str]:
        """Itself in words, to the bit."""
        return {"query": self.name} | {name: repr(value) for name, value in self.options.items()}

    def answers(self, batch: _core.Batch, count: int) -> RecordArray:
        """The answers for that many poses, on the calling thread."""
        records = numpy.zeros(count, dtype_of(self.name))
        getattr(batch, self.name)(records, 0, count, *self.options.values())
        return records

    def check(self, a: _core.Model, b: _core.Model) -> None:
        """Raises ValueError where an option is out of range, or a model has moves that are not committed."""
        self.answers(_core.Batch(a, b, None, None, 1), 1)


def digest_of(arrays: Iterable[AnyArray]) -> str:
    """A name for content: SHA-256 of arrays, their element types and shapes."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        rows = numpy.atleast_1d(array)
        for begin in range(0, len(rows), _ROWS):
            digest.update(numpy.ascontiguousarray(rows[begin : begin + _ROWS]).data)
    return digest.hexdigest()


def _array(value: Any) -> AnyArray:
    """An array as it is; lists become numbers."""
    return numpy.asarray(value, None if hasattr(value, "__array__") else float)


class Poses:
    """Poses of one object: one for all, or one after the other. They are well formed: _core.Batch has taken them."""

    def __init__(self, poses: PosesLike) -> None:
        self._is_pair = isinstance(poses, tuple) and len(poses) == 2
        parts: Any = [] if poses is None else poses if self._is_pair else [poses]
        self.parts: list[AnyArray] = [_array(part) for part in parts]
        self._is_list = bool(self.parts) and self.parts[-1].ndim > (1 if self._is_pair else 2)

    @property
    def count(self) -> int | None:
        """How many there are; None if there is one for all."""
        return len(self.parts[0]) if self._is_list else None

    def part(self, begin: int, end: int) -> PosesLike:
        """Poses begin to end, as an argument of a query of many poses."""
        argument: PosesLike = self._at(slice(begin, end))
        return argument

    def one(self, i: int) -> Any:
        """Pose i, as an argument of a query."""
        return self._at(i)

    def digest(self) -> str | None:
        """None if there are none."""
        return digest_of(self.parts) if self.parts else None

    def _at(self, where: int | slice) -> Any:
        parts: list[Any] = [part[where] if self._is_list else part for part in self.parts]
        return tuple(parts) if self._is_pair else parts[0] if parts else None


class Frames:
    """Positions of all vertices, frame by frame: an array (n, v, 3), or a sequence of arrays (v, 3)."""

    def __init__(self, frames: ArrayLike | Sequence[ArrayLike]) -> None:
        self._frames: Any = frames if hasattr(frames, "__getitem__") else numpy.asarray(frames)

    def __len__(self) -> int:
        return len(self._frames)

    def part(self, begin: int, end: int) -> list[AnyArray]:
        return [_array(self._frames[i]) for i in range(begin, end)]

    def digest(self) -> str:
        return digest_of(_array(self._frames[i]) for i in range(len(self)))


class Meshes:
    """The meshes of models, each once however many models have it."""

    def __init__(self, models: Sequence[_core.Model], *names: str) -> None:
        self.digests: list[str] = []  # by model
        self._meshes: dict[str, tuple[FloatArray, IdArray]] = {}
        seen: dict[int, str] = {}
        for i, model in enumerate(models):
            if not hasattr(model, "vertices"):
                name, kind = names[i] if names else f"models[{i}]", type(model).__name__
                raise TypeError(f"{name}: a batch of files takes a Model; got {kind}: ask distance_many() and its like")
            if id(model) not in seen:
                mesh = model.vertices, model.faces
                seen[id(model)] = digest_of(mesh)
                self._meshes[seen[id(model)]] = mesh
            self.digests.append(seen[id(model)])

    def packed(self, poses: Poses | None = None) -> bytes:
        """All meshes, and poses besides, for unpacked()."""
        places = {name: k for k, name in enumerate(self._meshes)}
        arrays: dict[str, AnyArray] = {"mesh_of_model": numpy.array([places[name] for name in self.digests])}
        for k, (vertices, faces) in enumerate(self._meshes.values()):
            arrays |= {f"vertices_{k}": vertices, f"faces_{k}": faces}
        if poses is not None:
            arrays |= {f"poses_{k}": part for k, part in enumerate(poses.parts)}
        file = io.BytesIO()
        save: Callable[..., None] = numpy.savez
        save(file, **arrays)
        return file.getvalue()


def unpacked(data: bytes) -> tuple[list[_core.Model], Poses]:
    """Models of what Meshes.packed() has packed, and poses. Models of the same mesh are one."""
    with numpy.load(io.BytesIO(data), allow_pickle=False) as file:
        arrays: dict[str, AnyArray] = dict(file)
    places = arrays["mesh_of_model"].tolist()
    made = {k: _core.Model(arrays[f"vertices_{k}"], arrays[f"faces_{k}"]) for k in sorted(set(places))}
    parts = [arrays[name] for name in ("poses_0", "poses_1") if name in arrays]
    poses: Any = tuple(parts) if len(parts) == 2 else parts[0] if parts else None
    return [made[k] for k in places], Poses(poses)
