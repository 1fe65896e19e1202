#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws states of examples/08_falling_cloth.cpp side by side, from the OBJ files that it writes. Needs Python alone.

A rasterizer with a depth buffer: parallel projection, one light with shadows, shading that is smooth over vertices. The
two sides of the cloth have two colors, so that folds can be told from the side that was up.
"""

from __future__ import annotations

import argparse
import math
import struct
import sys
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = 2  # along each side of a pixel
VIEW_WIDTH, VIEW_CENTER = 2.1, (0.15, 0.0, 0.6)  # in meters
TURN, RISE = math.radians(35), math.radians(24)  # of the camera
TO_LIGHT = (-0.12, -0.62, 0.72)
FLOOR, BODY, UP_SIDE, DOWN_SIDE = (236, 236, 232), (176, 168, 156), (66, 120, 190), (226, 140, 60)
AMBIENT, SHADOW_BIAS, SHADOW_CELLS = 0.45, 0.02, 700

Vector = tuple[float, float, float]


def dot(a, b) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a) -> Vector:
    size = math.sqrt(dot(a, a)) or 1.0
    return (a[0] / size, a[1] / size, a[2] / size)


def read_obj(path: Path) -> tuple[list[Vector], list[tuple[int, int, int]]]:
    positions, triangles = [], []
    for line in path.read_text(encoding="ascii").splitlines():
        words = line.split()
        if words and words[0] == "v":
            positions.append((float(words[1]), float(words[2]), float(words[3])))
        elif words and words[0] == "f":
            triangles.append(tuple(int(word) - 1 for word in words[1:4]))
    return positions, triangles


class Frame:
    """Axes of a view: x to the right, y down, z toward the eye or the light; in cells of its buffer."""

    def __init__(self, toward: Vector, cells: int, width: float):
        self.toward = unit(toward)
        self.right = unit(cross((0, 0, 1), self.toward))
        self.down = cross(self.right, self.toward)
        self.cells, self.scale = cells, cells / width

    def __call__(self, p: Vector) -> Vector:
        q = (p[0] - VIEW_CENTER[0], p[1] - VIEW_CENTER[1], p[2] - VIEW_CENTER[2])
        half = self.cells / 2
        return (half + self.scale * dot(q, self.right), half + self.scale * dot(q, self.down), dot(q, self.toward))


def cells_of(corners, cells: int):
    """Rows that a projected triangle covers: (y, first x, one past the last x), by the centers of cells."""
    ys = [c[1] for c in corners]
    for y in range(max(0, math.ceil(min(ys) - 0.5)), min(cells, math.floor(max(ys) - 0.5) + 1)):
        at, left, right = y + 0.5, math.inf, -math.inf
        for (x0, y0, _), (x1, y1, _) in ((corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])):
            if (y0 <= at) != (y1 <= at):
                x = x0 + (at - y0) * (x1 - x0) / (y1 - y0)
                left, right = min(left, x), max(right, x)
        if left < right:
            yield y, max(0, math.ceil(left - 0.5)), min(cells, math.floor(right - 0.5) + 1)


def slopes(corners, values) -> tuple[float, float, float] | None:
    """The linear function of x and y with these values at the corners: its slopes, and its value at (0.5, 0.5)."""
    (x0, y0, _), (x1, y1, _), (x2, y2, _) = corners
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if abs(area) < 1e-12:
        return None
    d1, d2 = values[1] - values[0], values[2] - values[0]
    along_x = (d1 * (y2 - y0) - d2 * (y1 - y0)) / area
    along_y = (d2 * (x1 - x0) - d1 * (x2 - x0)) / area
    return along_x, along_y, values[0] - along_x * (x0 - 0.5) - along_y * (y0 - 0.5)


def shadow_map(light: Frame, meshes) -> list[list[float]]:
    """How far toward the light the first surface is, cell by cell."""
    depth = [[-math.inf] * light.cells for _ in range(light.cells)]
    for positions, triangles in meshes:
        placed = [light(p) for p in positions]
        for triangle in triangles:
            corners = [placed[i] for i in triangle]
            plane = slopes(corners, [c[2] for c in corners])
            if plane is None:
                continue
            for y, first, last in cells_of(corners, light.cells):
                row, z = depth[y], plane[2] + plane[1] * y + plane[0] * first
                for x in range(first, last):
                    if z > row[x]:
                        row[x] = z
                    z += plane[0]
    return depth


def vertex_normals(positions, triangles) -> list[Vector]:
    sums = [(0.0, 0.0, 0.0)] * len(positions)
    for a, b, c in triangles:
        p, q, r = positions[a], positions[b], positions[c]
        n = cross((q[0] - p[0], q[1] - p[1], q[2] - p[2]), (r[0] - p[0], r[1] - p[1], r[2] - p[2]))
        for i in (a, b, c):
            sums[i] = (sums[i][0] + n[0], sums[i][1] + n[1], sums[i][2] + n[2])
    return [unit(n) for n in sums]


class Picture:
    def __init__(self, pixels: int):
        self.eye = Frame((math.cos(RISE) * math.sin(TURN), -math.cos(RISE) * math.cos(TURN), math.sin(RISE)),
                         pixels * SAMPLES, VIEW_WIDTH)
        cells = self.eye.cells
        self.depth = [[-math.inf] * cells for _ in range(cells)]
        self.shade = [[0.0] * cells for _ in range(cells)]
        self.color = [[FLOOR] * cells for _ in range(cells)]

    def draw(self, mesh, front, back) -> None:
        positions, triangles = mesh
        to_light = unit(TO_LIGHT)
        placed = [self.eye(p) for p in positions]
        lit = [dot(n, to_light) for n in vertex_normals(positions, triangles)]
        for triangle in triangles:
            corners = [placed[i] for i in triangle]
            plane = slopes(corners, [c[2] for c in corners])
            if plane is None:
                continue
            (x0, y0, _), (x1, y1, _), (x2, y2, _) = corners
            is_front = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0) < 0  # y goes down
            sign, color = (1, front) if is_front else (-1, back)
            light = slopes(corners, [sign * lit[i] for i in triangle])
            for y, first, last in cells_of(corners, self.eye.cells):
                depth, shade, colors = self.depth[y], self.shade[y], self.color[y]
                z = plane[2] + plane[1] * y + plane[0] * first
                for x in range(first, last):
                    if z > depth[x]:
                        depth[x], shade[x], colors[x] = z, light[2] + light[1] * y + light[0] * x, color
                    z += plane[0]

    def draw_floor(self) -> None:
        """The plane z = 0, wherever nothing is in front of it."""
        eye, facing = self.eye, dot((0, 0, 1), unit(TO_LIGHT))
        for y in range(eye.cells):
            q_y = (y + 0.5 - eye.cells / 2) / eye.scale
            z = (-VIEW_CENTER[2] - q_y * eye.down[2]) / eye.toward[2]
            for x in range(eye.cells):
                if z > self.depth[y][x]:
                    self.depth[y][x], self.shade[y][x], self.color[y][x] = z, facing, FLOOR

    def finished(self, light: Frame, shadows) -> list[list[Vector]]:
        """The colors of cells, darker where something is between them and the light."""
        eye = self.eye
        u, v, w = ([dot(a, b) for b in (light.right, light.down, light.toward)] for a in (eye.right, eye.down, eye.toward))
        rows, half = [], light.cells / 2
        for y in range(eye.cells):
            row, q_y = [], (y + 0.5 - eye.cells / 2) / eye.scale
            for x in range(eye.cells):
                q_x, q_z = (x + 0.5 - eye.cells / 2) / eye.scale, self.depth[y][x]
                i = int(half + light.scale * (q_x * u[0] + q_y * v[0] + q_z * w[0]))
                j = int(half + light.scale * (q_x * u[1] + q_y * v[1] + q_z * w[1]))
                height = q_x * u[2] + q_y * v[2] + q_z * w[2]
                shade = self.shade[y][x]
                direct = max(0.0, shade)
                if 0 <= i < light.cells and 0 <= j < light.cells and shadows[j][i] > height + SHADOW_BIAS:
                    direct *= 0.25
                brightness = AMBIENT + 0.08 * min(0.0, shade) + (1 - AMBIENT) * direct
                row.append(tuple(min(255.0, 1.12 * brightness * c) for c in self.color[y][x]))
            rows.append(row)
        return rows


def averaged(rows, pixels: int) -> list[bytes]:
    result = []
    for y in range(pixels):
        line = bytearray()
        for x in range(pixels):
            cells = [rows[SAMPLES * y + j][SAMPLES * x + i] for j in range(SAMPLES) for i in range(SAMPLES)]
            line += bytes(round(sum(c[k] for c in cells) / len(cells)) & 0xFE for k in range(3))
        result.append(bytes(line))
    return result


def write_png(path: Path, rows: list[bytes]) -> None:
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    filtered, above = bytearray(), bytes(len(rows[0]))
    for row in rows:  # the filter "average": what differs from the pixels to the left and above
        filtered.append(3)
        filtered += bytes((c - ((row[i - 3] if i >= 3 else 0) + above[i]) // 2) & 0xFF for i, c in enumerate(row))
        above = row
    header = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(filtered), 9))
                     + chunk(b"IEND", b""))


def panel(body, cloth, pixels: int) -> list[bytes]:
    picture = Picture(pixels)
    picture.draw(body, BODY, BODY)
    picture.draw(cloth, UP_SIDE, DOWN_SIDE)
    picture.draw_floor()
    light = Frame(TO_LIGHT, SHADOW_CELLS, 1.3 * VIEW_WIDTH)
    return averaged(picture.finished(light, shadow_map(light, (body, cloth))), pixels)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the example has written its OBJ files")
    parser.add_argument("picture", nargs="?", type=Path, default=ROOT / "docs/images/falling_cloth.png")
    parser.add_argument("--frames", type=int, nargs="+", default=[45, 75, 600])
    parser.add_argument("--pixels", type=int, default=420, help="width and height of each state")
    arguments = parser.parse_args()
    positions, triangles = read_obj(arguments.folder / "body.obj")
    seen = (positions, triangles[:-2])  # the last two are the floor
    panels = [panel(seen, read_obj(arguments.folder / f"cloth_{frame}.obj"), arguments.pixels) for frame in arguments.frames]
    write_png(arguments.picture, [b"".join(lines) for lines in zip(*panels)])
    print(arguments.picture)
    sys.exit(0)
