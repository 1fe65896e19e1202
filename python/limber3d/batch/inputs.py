# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of batches: how they are told apart, cut into partitions, and sent."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable, Sequence
from typing import Any

import numpy

from .. import _core
from ..typing import ArrayLike, FloatArray, IdArray, PosesLike

AnyArray = numpy.typing.NDArray[Any]
_ROWS = 4096  # that are looked at together: arrays may be larger than memory


class Digest:
    """A name for content: SHA-256 of arrays, their element types and shapes."""

    def __init__(self) -> None:
        self._hash = hashlib.sha256()

    def add(self, array: AnyArray) -> None:
        self._hash.update(f"{array.dtype.str}{array.shape}".encode())
        rows = numpy.atleast_1d(array)
        for begin in range(0, len(rows), _ROWS):
            self._hash.update(numpy.ascontiguousarray(rows[begin : begin + _ROWS]).data)

    def text(self) -> str:
        return self._hash.hexdigest()


def _array(value: Any) -> AnyArray:
    """An array as it is; lists become numbers."""
    return numpy.asarray(value, None if hasattr(value, "__array__") else float)


class Poses:
    """Poses of one object: one for all, or one after the other. They are well formed: _core.Batch has taken them."""

    def __init__(self, poses: PosesLike) -> None:
        is_pair = isinstance(poses, tuple) and len(poses) == 2
        self._is_pair = is_pair
        self.parts: list[AnyArray] = []
        if is_pair:
            self.parts = [_array(part) for part in poses]  # type: ignore[union-attr]
        elif poses is not None:
            self.parts = [_array(poses)]
        self._is_list = bool(self.parts) and self.parts[-1].ndim > (1 if is_pair else 2)

    @property
    def count(self) -> int | None:
        """How many there are; None if there is one for all."""
        return len(self.parts[0]) if self._is_list else None

    def part(self, begin: int, end: int) -> PosesLike:
        """Poses begin to end, as an argument of a query of many poses."""
        argument: PosesLike = self._as_argument([part[begin:end] if self._is_list else part for part in self.parts])
        return argument

    def one(self, i: int) -> Any:
        """Pose i, as an argument of a query."""
        return self._as_argument([part[i] if self._is_list else part for part in self.parts])

    def digest(self) -> str | None:
        """None if there are none."""
        if not self.parts:
            return None
        digest = Digest()
        for part in self.parts:
            digest.add(part)
        return digest.text()

    def _as_argument(self, parts: list[AnyArray]) -> Any:
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
        digest = Digest()
        for i in range(len(self)):
            digest.add(self.part(i, i + 1)[0])
        return digest.text()


class Meshes:
    """The meshes of models, each once however many models have it."""

    def __init__(self, models: Sequence[_core.Model]) -> None:
        self.digests: list[str] = []  # by model
        self._places: dict[str, int] = {}
        self._meshes: list[tuple[FloatArray, IdArray]] = []
        seen: dict[int, str] = {}
        for model in models:
            if id(model) not in seen:
                seen[id(model)] = self._add(model.vertices, model.faces)
            self.digests.append(seen[id(model)])

    def _add(self, vertices: FloatArray, faces: IdArray) -> str:
        digest = Digest()
        digest.add(vertices)
        digest.add(faces)
        name = digest.text()
        if name not in self._places:
            self._places[name] = len(self._meshes)
            self._meshes.append((vertices, faces))
        return name

    def packed(self, **arrays: AnyArray) -> bytes:
        """All meshes and the arrays besides, for unpacked()."""
        for k, (vertices, faces) in enumerate(self._meshes):
            arrays |= {f"vertices_{k}": vertices, f"faces_{k}": faces}
        arrays["mesh_of_model"] = numpy.array([self._places[name] for name in self.digests], numpy.uint32)
        file = io.BytesIO()
        save: Callable[..., None] = numpy.savez
        save(file, **arrays)
        return file.getvalue()


class Unpacked:
    """What Meshes.packed() has packed."""

    def __init__(self, data: bytes) -> None:
        with numpy.load(io.BytesIO(data), allow_pickle=False) as file:
            self.arrays: dict[str, AnyArray] = dict(file)

    def mesh(self, i: int) -> tuple[FloatArray, IdArray]:
        """Vertices and faces of model i."""
        k = self.arrays["mesh_of_model"][i]
        return self.arrays[f"vertices_{k}"], self.arrays[f"faces_{k}"]

    def models(self) -> list[_core.Model]:
        """All models. Those of the same mesh are one."""
        places = self.arrays["mesh_of_model"].tolist()
        made = {k: _core.Model(self.arrays[f"vertices_{k}"], self.arrays[f"faces_{k}"]) for k in sorted(set(places))}
        return [made[k] for k in places]
