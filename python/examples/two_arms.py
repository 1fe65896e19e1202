# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
# pyright: basic
"""Two arms of ten links each, and the clearance of thousands of their configurations in one call.

The arm is a table as a robot description has it: for each link its parent, the axis of its joint, and the length and
radius of its mesh. Prints how many configurations collide, and the links that are closest to each other in most others.

    python two_arms.py --configurations 10000
"""

from __future__ import annotations

import argparse
from collections import Counter
from typing import NamedTuple

import limber3d
import numpy
from limber3d.typing import FloatArray, RecordArray

LINK_COUNT, ARM_DISTANCE = 10, 1.2  # arms stand beside each other along x


class Link(NamedTuple):
    """A link, in the frame of its joint, from which it extends along z."""

    parent: int  # of the same arm; -1 for the base
    axis: int  # that its joint turns about: 0, 1, 2 for x, y, z
    length: float
    radius: float


ARM = [Link(i - 1, i % 2, 0.3, 0.08 - 0.004 * i) for i in range(LINK_COUNT)]


def capsule(length: float, radius: float, around: int = 16, rings: int = 5) -> limber3d.Model:
    """A cylinder along z with round ends."""
    angle = numpy.linspace(0, numpy.pi / 2, rings + 1)[1:]
    heights = numpy.concatenate([-radius * numpy.cos(angle), length + radius * numpy.sin(angle[:-1] - angle[0])])
    radii = numpy.concatenate([radius * numpy.sin(angle), radius * numpy.cos(angle[:-1] - angle[0])])
    turn = 2 * numpy.pi * numpy.arange(around) / around
    x, y = radii[:, None] * numpy.cos(turn), radii[:, None] * numpy.sin(turn)
    rows = numpy.stack([x, y, numpy.broadcast_to(heights[:, None], x.shape)], axis=-1)
    vertices = numpy.concatenate([rows.reshape(-1, 3), [[0, 0, -radius], [0, 0, length + radius]]])
    low, next_low = numpy.arange(around), numpy.roll(numpy.arange(around), -1)
    bottom, top, last = len(vertices) - 2, len(vertices) - 1, len(vertices) - 2 - around
    faces = [
        numpy.stack([next_low, low, numpy.full(around, bottom)], 1),
        numpy.stack([last + low, last + next_low, numpy.full(around, top)], 1),
    ]
    for row in range(0, last, around):
        a, b = row + low, row + next_low
        faces += [numpy.stack([a, b, b + around], 1), numpy.stack([a, b + around, a + around], 1)]
    return limber3d.Model(vertices, numpy.concatenate(faces))


def joint(axis: int, angles: FloatArray, shift: float) -> FloatArray:
    """A shift along z, then a turn by each angle: (n, 4, 4)."""
    matrices = numpy.tile(numpy.eye(4), (len(angles), 1, 1))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrices[:, i, i] = matrices[:, j, j] = numpy.cos(angles)
    matrices[:, j, i] = numpy.sin(angles)
    matrices[:, i, j] = -matrices[:, j, i]
    matrices[:, 2, 3] = shift
    return matrices


def link_poses(angles: FloatArray) -> FloatArray:
    """world_from_link of the links of both arms, for angles (n, 2, links): (n, 2 links, 4, 4)."""
    poses: list[FloatArray] = []
    for arm in range(2):
        base = numpy.eye(4)
        base[0, 3] = ARM_DISTANCE * arm
        first = len(poses)
        for i, link in enumerate(ARM):
            parent, shift = base, 0.0
            if link.parent >= 0:
                parent, shift = poses[first + link.parent], ARM[link.parent].length
            poses.append(parent @ joint(link.axis, angles[:, arm, i], shift))
    return numpy.stack(poses, axis=1)


def two_arms() -> tuple[limber3d.Scene, limber3d.ObjectPairMatrix]:
    """Both arms, whose ids are in the order of link_poses(), and the pairs of links that count."""
    scene = limber3d.Scene()
    for _ in range(2):
        for link in ARM:
            scene.add(capsule(link.length, link.radius))
    scene.commit()
    counts = limber3d.ObjectPairMatrix(scene.id_bound)
    for first in (0, LINK_COUNT):
        for i in range(LINK_COUNT - 1):  # links next to each other, or to the same one, touch anyway
            counts.set_among(range(first + i, first + min(i + 3, LINK_COUNT)), False)
    return scene, counts


def main(arguments: list[str] | None = None) -> tuple[FloatArray, RecordArray]:
    """Returns the poses of links, and the closest ones of each configuration."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--configurations", type=int, default=1000)
    options = parser.parse_args(arguments)
    angles = numpy.random.default_rng(5).uniform(-0.7, 0.7, (options.configurations, 2, LINK_COUNT))
    scene, counts = two_arms()
    poses = link_poses(angles)
    closest = limber3d.closest_objects_many(scene, range(len(scene)), poses, filter=counts)
    free = closest[closest["upper"] > 0]
    print(f"{len(closest) - len(free)} of {len(closest)} configurations collide")
    [(pair, times)] = Counter(zip(free["object_a"].tolist(), free["object_b"].tolist())).most_common(1)
    print(f"else links {pair[0]} and {pair[1]} are the closest ones most often, {times} times")
    print(f"the least clearance is {free['upper'].min():.4f}")
    return poses, closest


if __name__ == "__main__":
    main()
