# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
# pyright: basic
"""An arm takes something out of one compartment of a shelf and puts it into another. Is its path free?

The bodies of the arm are made by trimesh, their poses by forward kinematics in NumPy. For each pair of bodies one call
asks for the distances at all times. Prints for two paths when bodies collide, or else how close they come, and where.
`--plot FILE` draws the arm and its clearance over time.

    python robot_arm.py --samples 20000 --plot robot_arm.png
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import limber3d
import numpy
import trimesh
from limber3d.typing import FloatArray, RecordArray

Mesh = Any  # a trimesh.Trimesh

# Joint angles in degrees: turntable, shoulder, elbow, wrist, roll of the gripper. A row each second.
HOME, FOLDED = [100, -40, 130, 20, 0], [-100, -42, 142, 75, 0]
BEFORE_LOWER, IN_LOWER = [0, 23, 133, -66, 0], [0, 41, 96, -47, 0]
BEFORE_UPPER, IN_UPPER = [0, -5, 100, -5, 90], [0, 23, 66, 1, 90]
PATHS = {
    "straight": [HOME, BEFORE_LOWER, IN_LOWER, IN_UPPER, BEFORE_UPPER, FOLDED],
    "detour": [HOME, BEFORE_LOWER, IN_LOWER, BEFORE_LOWER, BEFORE_UPPER, IN_UPPER, BEFORE_UPPER, FOLDED],
}
NAMES = ["base", "upper arm", "forearm", "wrist", "gripper"]
# Bodies of the arm that could meet. Those beside each other always touch; the wrist keeps forearm and gripper apart.
SELF_PAIRS = [(0, 2), (0, 3), (0, 4), (1, 3), (1, 4)]


def box(size: Sequence[float], center: Sequence[float]) -> Mesh:
    """A box along the axes."""
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(center)
    return mesh


def capsule(radius: float, length: float) -> Mesh:
    """A cylinder from the origin to `length` on the z axis, with round ends beyond."""
    return trimesh.creation.capsule(height=length, radius=radius, count=[24, 12])


def arm() -> list[Mesh]:
    """The bodies, each in the frame of its joint, from which it extends along z. Lengths are in meters."""
    fingers = [box((0.03, 0.02, 0.1), (0, y, 0.21)) for y in (-0.045, 0.045)]
    hand = [box((0.06, 0.12, 0.05), (0, 0, 0.145)), *fingers]
    base = [box((0.36, 0.36, 0.06), (0, 0, 0.03)), box((0.2, 0.2, 0.18), (0, 0, 0.14))]
    links = [capsule(0.07, 0.55), capsule(0.055, 0.45), capsule(0.045, 0.1)]
    return [trimesh.util.concatenate(base), *links, trimesh.util.concatenate(hand)]


def shelf() -> Mesh:
    """Three boards between two sides."""
    boards = [box((0.35, 0.9, 0.03), (0.95, 0, z)) for z in (0.2, 0.62, 1.04)]
    return trimesh.util.concatenate(boards + [box((0.35, 0.03, 1.1), (0.95, y, 0.55)) for y in (-0.465, 0.465)])


def motion(waypoints: Sequence[Sequence[float]], count: int) -> tuple[FloatArray, FloatArray]:
    """Times, and joint angles in radians, which go from waypoint to waypoint and rest at each."""
    times = numpy.linspace(0, len(waypoints) - 1, count)
    step = numpy.minimum(times.astype(int), len(waypoints) - 2)
    part = (times - step)[:, None]
    angles = numpy.radians(numpy.array(waypoints, float))
    return times, angles[step] + (angles[step + 1] - angles[step]) * part**2 * (3 - 2 * part)


def turned(axis: int, angles: FloatArray, shift: float = 0.0) -> FloatArray:
    """A rotation about x, y or z for each angle, after a shift along z: (n, 4, 4)."""
    matrices = numpy.tile(numpy.eye(4), (len(angles), 1, 1))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrices[:, i, i] = matrices[:, j, j] = numpy.cos(angles)
    matrices[:, j, i] = numpy.sin(angles)
    matrices[:, i, j] = -matrices[:, j, i]
    matrices[:, 2, 3] = shift
    return matrices


def body_poses(angles: FloatArray) -> FloatArray:
    """world_from_body of each body at each time: (bodies, n, 4, 4)."""
    base = turned(2, 0 * angles[:, 0])
    upper_arm = turned(2, angles[:, 0], 0.32) @ turned(1, angles[:, 1])
    forearm = upper_arm @ turned(1, angles[:, 2], 0.55)
    wrist = forearm @ turned(1, angles[:, 3], 0.45)
    return numpy.stack([base, upper_arm, forearm, wrist, wrist @ turned(2, angles[:, 4])])


class Sweep(NamedTuple):
    """Distances along a path: for each pair of bodies, which the arm's come first, one record for each time."""

    times: FloatArray
    poses: FloatArray
    to_shelf: dict[tuple[str, str], RecordArray]
    to_itself: dict[tuple[str, str], RecordArray]


def sweep(waypoints: Sequence[Sequence[float]], count: int) -> Sweep:
    """The distances of all pairs that could meet, at `count` times."""
    times, angles = motion(waypoints, count)
    poses = body_poses(angles)
    bodies, obstacle = [limber3d.Model(mesh) for mesh in arm()], limber3d.Model(shelf())
    moving = range(1, len(bodies))
    return Sweep(
        times,
        poses,
        {(NAMES[i], "shelf"): limber3d.distance_many(bodies[i], obstacle, poses[i]) for i in moving},
        {(NAMES[i], NAMES[j]): limber3d.distance_many(bodies[i], bodies[j], poses[i], poses[j]) for i, j in SELF_PAIRS},
    )


def clearance(pairs: dict[tuple[str, str], RecordArray]) -> FloatArray:
    """The smallest distance of all pairs, at each time. It is exactly 0 where bodies collide, and never otherwise."""
    least: FloatArray = numpy.min([records["upper"] for records in pairs.values()], axis=0)
    return least


def closest(pairs: dict[tuple[str, str], RecordArray]) -> tuple[tuple[str, str], int]:
    """The pair that comes closest, and when."""
    names = min(pairs, key=lambda names: float(pairs[names]["upper"].min()))
    return names, int(numpy.argmin(pairs[names]["upper"]))


def collisions(distances: FloatArray) -> list[tuple[int, int]]:
    """First and last index of each run of zeros."""
    edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], (distances == 0).astype(int), [0]])))
    return [(int(begin), int(end) - 1) for begin, end in zip(edges[::2], edges[1::2])]


def report(name: str, swept: Sweep) -> None:
    """Prints when bodies collide, or how close they come."""
    print(f"{name}:")
    for label, pairs in (("the shelf", swept.to_shelf), ("itself", swept.to_itself)):
        for names, records in pairs.items():
            for begin, end in collisions(records["upper"]):
                print(f"  {' and '.join(names)} collide from {swept.times[begin]:.2f} s to {swept.times[end]:.2f} s")
        names, i = closest(pairs)
        record = pairs[names][i]
        if record["upper"] > 0:
            print(f"  {1000 * record['upper']:.2f} mm from {label} at {swept.times[i]:.2f} s, {' and '.join(names)},")
            print(f"    at {record['point_a'].round(3)} and {record['point_b'].round(3)}")


def main(arguments: Sequence[str] | None = None) -> dict[str, Sweep]:
    parser = argparse.ArgumentParser(description="The clearance of an arm along two paths.")
    parser.add_argument("--samples", type=int, default=1000, help="times on each path (1000)")
    parser.add_argument("--plot", type=Path, help="a file for the picture, such as robot_arm.png; needs matplotlib")
    options = parser.parse_args(arguments)
    swept = {name: sweep(waypoints, options.samples) for name, waypoints in PATHS.items()}
    for name, one in swept.items():
        report(name, one)
    assert clearance(swept["straight"].to_shelf).min() == 0 < clearance(swept["detour"].to_shelf).min()
    assert clearance(swept["detour"].to_itself).min() > 0
    if options.plot is not None:
        draw(options.plot, swept)
    return swept


def draw(file: Path, swept: dict[str, Sweep]) -> None:
    """Left the arm in collision; right the clearance along each path, with collisions in red."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.colors
    import matplotlib.pyplot as pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    blue, orange, red = "#2b6ca3", "#e07b28", "#d33f49"
    figure = pyplot.figure(figsize=(11, 5), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(0.8, 1))
    scene: Any = left.add_subplot(projection="3d")
    light = matplotlib.colors.LightSource(azdeg=200, altdeg=50)

    def show(mesh: Mesh, pose: FloatArray, color: str, alpha: float) -> None:
        corners = (mesh.vertices @ pose[:3, :3].T + pose[:3, 3])[mesh.faces]
        scene.add_collection3d(
            Poly3DCollection(corners, facecolors=color, alpha=alpha, shade=True, lightsource=light, linewidth=0)
        )

    straight = swept["straight"]
    (begin, end), *_ = collisions(clearance(straight.to_shelf))
    moment = (begin + end) // 2
    show(shelf(), numpy.eye(4), "#9db8c9", 0.4)
    colors = ["#5b6770", orange, "#f0a860", "#c9742e", red]
    for mesh, pose, color in zip(arm(), straight.poses[:, moment], colors):
        show(mesh, pose, color, 1.0)
    for (name, one), color in zip(swept.items(), (orange, blue)):
        gripper = one.poses[-1]
        scene.plot(*(gripper[:, :3, 3] + 0.25 * gripper[:, :3, 2]).T, color=color, linewidth=1.2, label=name)
    scene.set(xlim=(-0.35, 1.15), ylim=(-0.75, 0.75), zlim=(0, 1.15))
    scene.set_box_aspect((1.5, 1.5, 1.15), zoom=1.2)
    scene.view_init(elev=20, azim=-125)
    scene.set_axis_off()
    left.suptitle(f"straight, at {straight.times[moment]:.2f} s", fontsize=11)

    graphs: Any = right.subplots(2, 1, sharey=True)
    for graph, (name, one) in zip(graphs, swept.items()):
        lines = (("to the shelf", one.to_shelf, blue), ("to itself", one.to_itself, orange))
        for label, pairs, color in lines:
            distances = 1000 * clearance(pairs)
            graph.plot(one.times, distances, color=color, label=label, linewidth=1.8)
            for begin, end in collisions(distances):
                graph.axvspan(one.times[begin], one.times[end], color=red, alpha=0.25, linewidth=0, label="collision")
            _, i = closest(pairs)
            if distances[i] > 0:
                graph.plot(one.times[i], distances[i], "o", color=color, markersize=6)
                place, text = (one.times[i], distances[i]), f"{distances[i]:.0f} mm"
                graph.annotate(text, place, (-9, -4), textcoords="offset points", ha="right", color=color)
        graph.set(title=name, ylabel="clearance, mm", xlim=(0, one.times[-1]), ylim=(-15, None))
        graph.grid(color="#e4e4e4")
        graph.spines[["top", "right"]].set_visible(False)
    found = dict(zip(*reversed(graphs[0].get_legend_handles_labels())))
    graphs[1].legend(found.values(), found.keys(), frameon=False, loc="upper center")
    graphs[-1].set_xlabel("time, s")
    figure.savefig(file, dpi=110)
    pyplot.close(figure)


if __name__ == "__main__":
    main()
