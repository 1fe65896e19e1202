# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question        What does the closest pair of links cost in Python, for each of many configurations of a robot?
Workload        The two arms of ten links of python/examples/two_arms.py, 156 pairs that count, random joint angles,
                or paths of 100 steps between such.
Metric          Time, and time of processors, of one call; of a loop over closest_objects(), with a matrix and with a
                function as filter; and of python-fcl's distance() of few pairs. Medians.
Expected shape  One call takes a fraction of the time of a loop where there are several processors.
Checked         The call has the bits of the loop; FCL's distances are the same to 1e-6.

Writes configurations.md."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import fcl
import limber3d
import measure
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python" / "examples"))
import two_arms  # noqa: E402


def angles_of(kind: str, count: int) -> numpy.ndarray:
    """Joint angles (count, 2, links)."""
    random, shape = numpy.random.default_rng(5), (2, two_arms.LINK_COUNT)
    if kind == "random":
        return random.uniform(-0.7, 0.7, (count, *shape))
    corners = random.uniform(-0.7, 0.7, (count // 100 + 2, *shape))
    step = numpy.arange(count)
    part = (step % 100 / 100)[:, None, None]
    return corners[step // 100] * (1 - part) + corners[step // 100 + 1] * part


class Fcl:
    """python-fcl: distance() of the pairs that count, nearest bounding spheres first, until those are farther apart
    than the closest pair so far. Its managers cannot leave out pairs: a callback is not told which objects it gets."""

    def __init__(self, scene: limber3d.Scene, counts: limber3d.ObjectPairMatrix) -> None:
        self.objects, centers, radii = [], [], []
        for id in range(len(scene)):
            model, mesh = scene.model(id), fcl.BVHModel()
            mesh.beginModel(len(model.vertices), len(model.faces))
            mesh.addSubModel(model.vertices, model.faces)
            mesh.endModel()
            self.objects.append(fcl.CollisionObject(mesh))
            centers.append((model.vertices.min(0) + model.vertices.max(0)) / 2)
            radii.append(numpy.linalg.norm(model.vertices - centers[-1], axis=1).max())
        self.centers, self.radii = numpy.array(centers), numpy.array(radii)
        self.a, self.b = numpy.array([(a, b) for b in range(len(scene)) for a in range(b) if counts(a, b)]).T

    def closest(self, poses: numpy.ndarray) -> float:
        """The least distance in one configuration."""
        centers = (poses[:, :3, :3] @ self.centers[:, :, None])[..., 0] + poses[:, :3, 3]
        gaps = numpy.linalg.norm(centers[self.a] - centers[self.b], axis=1) - self.radii[self.a] - self.radii[self.b]
        for of_link, pose in zip(self.objects, poses):
            of_link.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        least = float("inf")
        for i in numpy.argsort(gaps):
            if gaps[i] >= least:
                break
            a, b = self.objects[self.a[i]], self.objects[self.b[i]]
            least = min(least, max(0.0, fcl.distance(a, b, fcl.DistanceRequest(), fcl.DistanceResult())))
        return least


def loop(scene: limber3d.Scene, poses: numpy.ndarray, filter: object) -> list[limber3d.ClosestObjectsResult]:
    """The closest objects of each configuration, one call after the other."""
    ids, found = numpy.arange(len(scene)), []
    for of_links in poses:
        scene.set_poses(ids, of_links)
        scene.commit()
        found.append(scene.closest_objects(filter=filter))
    return found


def rows(kind: str, count: int, fcl_count: int, rounds: int) -> list[str]:
    """A table of one kind of configurations, whose answers have been checked."""
    scene, counts = two_arms.two_arms()
    poses, ids = two_arms.link_poses(angles_of(kind, count)), range(len(scene))
    peer = Fcl(scene, counts)

    def many(threads: int | None = None) -> numpy.ndarray:
        return limber3d.closest_objects_many(scene, ids, poses, filter=counts, threads=threads)

    closest, single = many(), loop(scene, poses, counts)
    expected = [(s.result.upper, *(s.objects or (0, 0))) for s in single]
    if closest[["upper", "object_a", "object_b"]].tolist() != expected:
        sys.exit("one call and the loop answer differently")
    of_fcl = numpy.array([peer.closest(of_links) for of_links in poses[:fcl_count]])
    if numpy.abs(of_fcl - closest["upper"][:fcl_count]).max() > 1e-6:
        sys.exit("FCL answers differently")
    times = measure.in_turn({
        "one call": many,
        "one call, one thread": lambda: many(1),
        "any_within_many, 0": lambda: limber3d.any_within_many(scene, ids, poses, 0.0, filter=counts),
        "loop, matrix": lambda: loop(scene, poses, counts),
        "loop, function": lambda: loop(scene, poses, lambda a, b: counts(a, b)),
        "python-fcl": lambda: [peer.closest(of_links) for of_links in poses[:fcl_count]],
    }, rounds)
    times["python-fcl"] *= count / fcl_count
    one = times["one call"]
    return [f"| {kind} | {name} | {t[0]:.0f} | {t[0] / one[0]:.1f} | {t[1]:.0f} | {t[1] / one[1]:.1f} |"
            for name, t in times.items()]


def main() -> None:
    options = measure.options_of(__doc__, needs_meshes=False)
    count, fcl_count, rounds = (200, 20, 1) if options.quick else (10_000, 500, 3)
    lines = [
        f"# {count} configurations of two arms, {len(os.sched_getaffinity(0))} processors",
        "",
        f"Milliseconds of all configurations; python-fcl's from {fcl_count} of them. `./dev bench configurations`.",
        "",
        "| configurations | | ms | over one call | of processors | over one call |",
        "|:--|:--|--:|--:|--:|--:|",
    ]
    for kind in ("random", "path"):
        lines += rows(kind, count, fcl_count, rounds)
    measure.write(options, "configurations.md", lines)


if __name__ == "__main__":
    main()
