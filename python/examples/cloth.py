# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
# pyright: basic
"""A sheet falls onto a ring and folds over it: its distance frame by frame, and its contacts, also with itself.

A small simulation in NumPy makes the frames; what it needs to know about the ring it asks limber3d. Then the frames are
asked about. Prints a table; `--plot FILE` draws a frame, and the numbers of all.

    python cloth.py --squares 80 --frames 300 --plot cloth.png
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import limber3d
import numpy
import trimesh
from limber3d.typing import FloatArray, IdArray, RecordArray

Mesh = tuple[FloatArray, IdArray]
THICKNESS = 0.01  # how far the sheet is kept from the ring, and closer than what counts as a contact


def sheet(squares: int) -> Mesh:
    """A flat square of side 1.4, at height 0.4, two triangles for each square of a grid of vertices."""
    line = numpy.linspace(-0.7, 0.7, squares + 1)
    x, y = numpy.meshgrid(line, line)
    row, column = numpy.divmod(numpy.arange(squares**2, dtype=numpy.uint32), squares)
    a, below = row * (squares + 1) + column, squares + 1
    faces = numpy.stack([a, a + 1, a + below + 1, a, a + below + 1, a + below], axis=1).reshape(-1, 3)
    return numpy.stack([x, y, numpy.full_like(x, 0.4)], axis=2).reshape(-1, 3), faces.astype(numpy.uint32)


def ring() -> limber3d.Model:
    """A torus about the z axis."""
    return limber3d.Model(trimesh.creation.torus(0.2, 0.08, major_sections=48, minor_sections=20))


def springs(squares: int) -> list[Any]:
    """Pairs of vertices that keep their distance, in groups where no vertex is in two pairs."""
    ids = numpy.arange((squares + 1) ** 2).reshape(squares + 1, squares + 1)
    pairs = [(ids[:, :-1], ids[:, 1:]), (ids[:-1], ids[1:])]  # sides of the squares,
    pairs += [(ids[:-1, :-1], ids[1:, 1:]), (ids[1:, :-1], ids[:-1, 1:])]  # their diagonals,
    pairs += [(ids[:, :-2], ids[:, 2:]), (ids[:-2], ids[2:])]  # and every other vertex, against folds
    groups: list[Any] = []
    for a, b in pairs:
        both = numpy.stack([a, b], axis=2)
        for i in range(4):
            for j in range(4):
                groups.append(both[i::4, j::4].reshape(-1, 2))
    return groups


def simulated(squares: int, frames: int, body: limber3d.Model, steps: int = 4) -> Iterator[FloatArray]:
    """Positions of a sheet that falls, frame by frame at 60 Hz: position-based dynamics."""
    positions, _ = sheet(squares)
    before = positions.copy()
    groups = springs(squares)
    lengths = [numpy.linalg.norm(positions[g[:, 0]] - positions[g[:, 1]], axis=1) for g in groups]
    surface = limber3d.ClosedSurface(body)
    for _ in range(frames):
        yield positions.copy()
        for _ in range(steps):
            moved = (positions - before) * 0.995
            before = positions.copy()
            positions = positions + moved + numpy.array([0, 0, -9.81]) / (60 * steps) ** 2
            for _ in range(4):
                for group, length in zip(groups, lengths):
                    a, b = group.T
                    across = positions[b] - positions[a]
                    now = numpy.linalg.norm(across, axis=1)
                    shift = across * (0.5 * (1 - length / now))[:, None]
                    positions[a] += shift
                    positions[b] -= shift
            near = surface.signed_distance_many(positions, max_distance=0.1)
            close = numpy.isfinite(near["distance"]) & (near["distance"] < THICKNESS)
            outward = positions[close] - near["position"][close]
            depth = near["distance"][close]
            positions[close] += outward * ((THICKNESS - depth) / depth)[:, None]
            before[close] += 0.6 * (positions[close] - before[close])  # friction


class Found(NamedTuple):
    """What was asked about each frame."""

    distances: RecordArray  # of limber3d.distance_dtype
    contacts: IdArray  # pairs of triangles of sheet and ring closer than the margin
    self_contacts: IdArray  # the same of the sheet with itself, close neighbors left out


def contacts_of(
    cloth: limber3d.Model, frame: FloatArray, body: limber3d.Model, margin: float
) -> tuple[limber3d.Contacts, limber3d.Contacts]:
    """Moves the sheet, and finds its contacts with the ring and with itself."""
    cloth.move_all(frame)
    cloth.commit()
    rings = limber3d.NeighborRings(cloth, 2)  # triangles joined by a path of two edges, or less, do not count
    return limber3d.contacts(cloth, body, margin), limber3d.self_contacts(cloth, margin, filter=rings)


def ask(cloth: limber3d.Model, frames: Sequence[FloatArray], body: limber3d.Model, margin: float) -> Found:
    """Distances of all frames in one call, then the contacts of each."""
    distances = limber3d.track(cloth, frames, body)
    counts = [[len(pairs) for pairs in contacts_of(cloth, frame, body, margin)] for frame in frames]
    return Found(distances, *numpy.array(counts, numpy.uint32).T)


def main(arguments: Sequence[str] | None = None) -> Found:
    parser = argparse.ArgumentParser(description="A sheet falls onto a ring.")
    parser.add_argument("--squares", type=int, default=32, help="squares along a side of the sheet (32)")
    parser.add_argument("--frames", type=int, default=56, help="frames, 60 a second (56)")
    parser.add_argument("--plot", type=Path, help="a file for the picture, such as cloth.png; needs matplotlib")
    options = parser.parse_args(arguments)

    body, (vertices, faces) = ring(), sheet(options.squares)
    frames = list(simulated(options.squares, options.frames, body))
    margin = 2 * THICKNESS
    cloth = limber3d.Model(vertices, faces)
    start = time.perf_counter()
    found = ask(cloth, frames, body, margin)
    took = time.perf_counter() - start

    print(f"{len(faces)} triangles fall on {len(body.faces)}; contacts are pairs closer than {margin}")
    print("frame   distance   contacts   with itself")
    for i in range(0, options.frames, max(1, options.frames // 10)):
        print(f"{i:5} {found.distances['upper'][i]:10.5f} {found.contacts[i]:10} {found.self_contacts[i]:13}")
    print(f"{1000 * took / options.frames:.2f} ms a frame for distance, contacts and contacts with itself")
    assert found.contacts[0] == found.self_contacts[0] == 0 < found.contacts[-1]
    if options.plot is not None:
        draw(options.plot, cloth, frames, body, margin, found)
    return found


def draw(
    file: Path, cloth: limber3d.Model, frames: Sequence[FloatArray], body: limber3d.Model, margin: float, found: Found
) -> None:
    """Left the frame where the sheet meets itself most, with its contacts; right the numbers of all frames."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.colors
    import matplotlib.pyplot as pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    blue, orange, red = "#2b6ca3", "#e07b28", "#d33f49"
    figure = pyplot.figure(figsize=(11, 5), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(1, 1))
    scene: Any = left.add_subplot(projection="3d", computed_zorder=False)
    light = matplotlib.colors.LightSource(azdeg=230, altdeg=55)
    shown = int(numpy.argmax(found.self_contacts))
    touching, folded = contacts_of(cloth, frames[shown], body, margin)
    colors = numpy.tile(matplotlib.colors.to_rgba("#a9c7de"), (len(cloth.faces), 1))
    colors[touching["triangle_a"]] = matplotlib.colors.to_rgba(orange)
    colors[numpy.concatenate([folded["triangle_a"], folded["triangle_b"]])] = matplotlib.colors.to_rgba(red)
    corners = frames[shown][cloth.faces]
    for triangles, paint in ((body.vertices[body.faces], "#5b6770"), (corners, colors)):
        drawn = Poly3DCollection(triangles, facecolors=paint, shade=True, lightsource=light, linewidth=0)
        scene.add_collection3d(drawn)
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    high = numpy.maximum(high, low + 0.1)
    scene.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    scene.set_box_aspect(high - low, zoom=1.15)
    scene.view_init(elev=25, azim=-60)
    scene.set_axis_off()
    left.suptitle(f"frame {shown}: touching the ring (orange), touching itself (red)", fontsize=11)

    above, below = right.subplots(2, 1, sharex=True)
    above.plot(found.distances["upper"], color=blue, linewidth=1.8)
    above.axhline(margin, color="#999999", linewidth=1, linestyle="--")
    end = (len(frames) - 1, margin)
    above.annotate("margin of contacts", end, (0, 4), textcoords="offset points", ha="right", color="#777777")
    above.set(ylabel="distance to the ring", yscale="log")
    below.plot(found.contacts, color=orange, linewidth=1.8, label="contacts with the ring")
    below.plot(found.self_contacts, color=red, linewidth=1.8, label="contacts with itself")
    below.set(xlabel="frame", ylabel="pairs of triangles")
    below.legend(frameon=False, loc="upper left")
    for graph in (above, below):
        graph.grid(color="#e4e4e4")
        graph.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, dpi=110)
    pyplot.close(figure)


if __name__ == "__main__":
    main()
