# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distances of pairs of triangles, in NumPy: an oracle without a tree."""

from __future__ import annotations

from typing import Any

import numpy
from limber3d.typing import FloatArray


def corners(vertices: Any, faces: Any, pose: Any = None) -> FloatArray:
    """The corners of each triangle in the world: (n, 3, 3)."""
    placed = numpy.asarray(vertices, float)
    if pose is not None:
        placed = placed @ pose[:3, :3].T + pose[:3, 3]
    found: FloatArray = placed[numpy.asarray(faces, int)]
    return found


def _dot(a: Any, b: Any) -> Any:
    return numpy.einsum("...i,...i->...", a, b)


def _corner_and_sides(triangles: Any) -> tuple[Any, Any, Any]:
    a = triangles[..., 0, :]
    return a, triangles[..., 1, :] - a, triangles[..., 2, :] - a


def _from_points(points: Any, triangles: Any) -> Any:
    """Distances from points to triangles where the foot is inside; infinite where it is not, as edges cover that."""
    a, u, v = _corner_and_sides(triangles)
    normal, w = numpy.cross(u, v), points - a
    area = _dot(normal, normal)
    beta, gamma = _dot(numpy.cross(w, v), normal) / area, _dot(numpy.cross(u, w), normal) / area
    inside = (beta >= 0) & (gamma >= 0) & (beta + gamma <= 1)
    return numpy.where(inside, abs(_dot(w, normal)) / numpy.sqrt(area), numpy.inf)


def _of_segments(p: Any, d: Any, q: Any, e: Any) -> Any:
    """Distances of segments p + s d and q + t e: the best of the four ends, and of the inside where there is one."""

    def from_end(end: Any, start: Any, direction: Any) -> Any:
        part = numpy.clip(_dot(end - start, direction) / _dot(direction, direction), 0, 1)
        return numpy.linalg.norm(end - start - part[..., None] * direction, axis=-1)

    best = numpy.minimum(from_end(p, q, e), from_end(p + d, q, e))
    best = numpy.minimum(best, numpy.minimum(from_end(q, p, d), from_end(q + e, p, d)))
    w, dd, de, ee = p - q, _dot(d, d), _dot(d, e), _dot(e, e)
    determinant = numpy.maximum(dd * ee - de * de, 1e-300)
    s = (de * _dot(e, w) - ee * _dot(d, w)) / determinant
    t = (dd * _dot(e, w) - de * _dot(d, w)) / determinant
    inside = (s > 0) & (s < 1) & (t > 0) & (t < 1)
    gap = numpy.linalg.norm(
        w + numpy.where(inside, s, 0)[..., None] * d - numpy.where(inside, t, 0)[..., None] * e, axis=-1
    )
    return numpy.where(inside, numpy.minimum(best, gap), best)


def _crosses(p: Any, d: Any, triangles: Any) -> Any:
    """Whether segments p + s d pass through triangles."""
    a, u, v = _corner_and_sides(triangles)
    across = numpy.cross(d, v)
    determinant = _dot(u, across)
    scale = numpy.where(determinant == 0, 1, determinant)
    w = p - a
    beta, turned = _dot(w, across) / scale, numpy.cross(w, u)
    gamma, s = _dot(d, turned) / scale, _dot(v, turned) / scale
    return (determinant != 0) & (beta >= 0) & (gamma >= 0) & (beta + gamma <= 1) & (s >= 0) & (s <= 1)


def pair_distances(a: FloatArray, b: FloatArray) -> Any:
    """The distance of each triangle of a, (n, 3, 3), from that of b in the same place; 0 where they intersect."""
    best = numpy.full(len(a), numpy.inf)
    for one, other in ((a, b), (b, a)):
        for i in range(3):
            start, side = one[:, i], one[:, (i + 1) % 3] - one[:, i]
            best = numpy.minimum(best, _from_points(start, other))
            best = numpy.where(_crosses(start, side, other), 0, best)
    for i in range(3):
        for j in range(3):
            p, q = a[:, i], b[:, j]
            best = numpy.minimum(best, _of_segments(p, a[:, (i + 1) % 3] - p, q, b[:, (j + 1) % 3] - q))
    return best


def _sphere_gaps(a: FloatArray, b: FloatArray) -> tuple[Any, Any]:
    """For all pairs: how far apart spheres about the triangles are, and their centers, which lie on the triangles."""
    centers_a, centers_b = a.mean(axis=1), b.mean(axis=1)
    radius_a = numpy.linalg.norm(a - centers_a[:, None], axis=2).max(axis=1)
    radius_b = numpy.linalg.norm(b - centers_b[:, None], axis=2).max(axis=1)
    between = numpy.linalg.norm(centers_a[:, None] - centers_b[None], axis=2)
    return between - radius_a[:, None] - radius_b, between


def pairs_within(a: FloatArray, b: FloatArray, margin: float) -> tuple[Any, Any, Any]:
    """All pairs of triangles at most that far apart, (n, 3, 3) and (m, 3, 3): indices in a, in b, distances."""
    i, j = numpy.nonzero(_sphere_gaps(a, b)[0] <= margin + 1e-9)
    distances = pair_distances(a[i], b[j])
    close = distances <= margin
    return i[close], j[close], distances[close]


def min_distance(a: FloatArray, b: FloatArray) -> float:
    """The distance of two meshes, (n, 3, 3) and (m, 3, 3)."""
    return float(pairs_within(a, b, float(_sphere_gaps(a, b)[1].min()))[2].min())
