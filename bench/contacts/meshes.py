# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Meshes for peers.py: readers, a writer, and what the comparison makes itself. A mesh is (positions, triangles)."""

import numpy as np


def read_obj(path):
    """Positions and triangles of an OBJ file; corners name vertices by position alone."""
    positions, triangles = [], []
    for line in open(path, encoding="ascii", errors="replace"):
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            triangles.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return np.array(positions), np.array(triangles, dtype=np.int32)


def read_ply(path):
    """Positions and triangles of a binary PLY file that has only them: float or double positions, triangles alone."""
    header, body = open(path, "rb").read().split(b"end_header\n", 1)
    words = header.decode("ascii").split()
    end = ">" if "binary_big_endian" in words else "<"
    real = np.dtype(end + ("f8" if "double" in words else "f4"))
    vertex_count, face_count = (int(words[words.index(kind) + 1]) for kind in ("vertex", "face"))
    positions = np.frombuffer(body, real, 3 * vertex_count).reshape(-1, 3).astype(float)
    corners = np.dtype([("count", "u1"), ("ids", end + "i4", 3)])
    faces = np.frombuffer(body, corners, face_count, positions.size * real.itemsize)
    if not (faces["count"] == 3).all():
        raise ValueError(f"{path}: not triangles alone")
    return positions, faces["ids"].astype(np.int32)


def read(path):
    """A mesh file, by its extension."""
    return read_ply(path) if str(path).endswith(".ply") else read_obj(path)


def write_ply(path, mesh):
    """Writes positions as double, so that a reader gets the same bits."""
    positions, triangles = mesh
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("ids", "<i4", 3)])
    faces["count"], faces["ids"] = 3, triangles
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\nproperty double x\n"
                   f"property double y\nproperty double z\nelement face {len(triangles)}\n"
                   "property list uchar int vertex_indices\nend_header\n".encode())
        file.write(np.ascontiguousarray(positions, "<f8").tobytes() + faces.tobytes())


def ball(center, radius, rings, sectors):
    """A ball of 2 * sectors * (rings - 1) triangles: poles on the y axis, normals outward."""
    angles = np.pi * np.arange(1, rings) / rings
    turns = 2 * np.pi * np.arange(sectors) / sectors
    points = [(0.0, 1.0, 0.0)]
    points += [(np.sin(a) * np.cos(t), np.cos(a), -np.sin(a) * np.sin(t)) for a in angles for t in turns]
    points.append((0.0, -1.0, 0.0))
    triangles = []
    for s in range(sectors):
        right = (s + 1) % sectors
        triangles.append((0, 1 + s, 1 + right))
        for r in range(rings - 2):
            up, down = 1 + r * sectors, 1 + (r + 1) * sectors
            triangles += [(up + s, down + s, down + right), (up + s, down + right, up + right)]
        triangles.append((len(points) - 1, 1 + (rings - 2) * sectors + right, 1 + (rings - 2) * sectors + s))
    return np.array(center) + radius * np.array(points), np.array(triangles, dtype=np.int32)


def folded_cloth(phase):
    """A cloth of 100 000 triangles around the upper half of a ball of radius 1 at the origin, folded once: its second
    half lies back over its first. `phase` moves every vertex. Gaps below it and between its halves open and close
    between nothing and twice the margin of a thousandth of its size."""
    columns, rows, size = 250, 200, 1.8  # along the fold, across it; roughly the diagonal of its bounding box
    s, y = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows, indexing="ij")
    along = 0.7 * (1 - 4 * np.abs(s - 0.5)) + 0.02 * np.sin(phase)
    across = 1.4 * (y - 0.5)
    ripple = 1 + 0.5 * np.sin(9 * along + phase) * np.cos(8 * across - 0.7 * phase)
    radius = 1 + 1e-3 * size * (0.7 * ripple + 2.2 * s)
    positions = np.stack([radius * np.sin(along) * np.cos(across), radius * np.cos(along) * np.cos(across),
                          radius * np.sin(across)], axis=-1).reshape(-1, 3)
    first = (np.arange(columns)[:, None] * (rows + 1) + np.arange(rows)).ravel()
    quads = np.stack([first, first + 1, first + rows + 2, first + rows + 1], axis=-1)
    return positions, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)


def joined(a, b):
    """Two meshes as one: vertices and triangles of b follow those of a."""
    return np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + np.int32(len(a[0]))])


def diagonal(mesh):
    """The diagonal of the bounding box, the size that margins are relative to."""
    return float(np.linalg.norm(mesh[0].max(axis=0) - mesh[0].min(axis=0)))
