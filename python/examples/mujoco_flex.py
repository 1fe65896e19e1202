# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
# pyright: basic
"""A cloth of MuJoCo falls on a stone: limber3d follows its vertices and finds the contacts, next to MuJoCo's own.

MuJoCo simulates; after each step the vertices of its flex go into a limber3d.Model. The stone is a mesh geom. MuJoCo
makes a contact of an element of the cloth whose distance is less than the cloth's radius, so its smallest contact
distance is limber3d's distance, less that radius, and the elements in contact are those that limber3d finds.

    python mujoco_flex.py --count 33 --steps 1000
"""

from __future__ import annotations

import argparse
import importlib.util
from collections.abc import Sequence
from typing import Any, NamedTuple

import limber3d
import numpy

TOLERANCE = 1e-5  # MuJoCo finds distances of convex meshes by iteration, and keeps meshes in float32


def scene(count: int) -> str:
    """A cloth of count x count vertices, 0.8 on a side, above a convex stone."""
    random = numpy.random.default_rng(5)
    directions = random.normal(size=(40, 3))
    stone = directions / numpy.linalg.norm(directions, axis=1, keepdims=True) * (0.24, 0.2, 0.15)
    points = " ".join(f"{x:.6f}" for x in stone.ravel())
    side = 0.8 / (count - 1)
    return f"""
      <mujoco>
        <option timestep="0.002" solver="CG" tolerance="1e-6" integrator="implicitfast"/>
        <asset><mesh name="stone" vertex="{points}"/></asset>
        <worldbody>
          <geom name="stone" type="mesh" mesh="stone" euler="10 15 20" solref=".004 1"/>
          <flexcomp name="cloth" type="grid" dim="2" count="{count} {count} 1" spacing="{side} {side} 1" pos="0 0 .22"
                    radius="0.02" mass="0.1">
            <edge equality="true" damping="1"/>
            <contact selfcollide="none" solref=".004 1"/>
          </flexcomp>
        </worldbody>
      </mujoco>"""


class Step(NamedTuple):
    """One step, as both see it. Distances are those of the cloth's middle surface, less its radius."""

    distance: float  # by limber3d
    mujoco_distance: float  # the smallest of MuJoCo's contacts; infinite if there are none
    elements: dict[int, float]  # those in contact or nearly so, and their distances
    mujoco_elements: frozenset[int]  # those in contact

    def touching(self, margin: float = 0.0) -> set[int]:
        """The elements whose distance is at most the margin, by limber3d."""
        return {element for element, distance in self.elements.items() if distance <= margin}

    def agrees(self) -> bool:
        """Whether both find the same, but for elements at a distance of just about 0."""
        theirs = self.mujoco_elements
        is_close = self.distance > TOLERANCE or abs(self.distance - self.mujoco_distance) < TOLERANCE
        return is_close and self.touching(-TOLERANCE) <= theirs <= self.touching(TOLERANCE)


def stone_of(model: Any) -> limber3d.Model:
    """The mesh of the stone's geom, in the geom's frame."""
    mesh = model.geom_dataid[model.geom("stone").id]
    vertex, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    vertices = model.mesh_vert[vertex : vertex + model.mesh_vertnum[mesh]]
    return limber3d.Model(vertices, model.mesh_face[face : face + model.mesh_facenum[mesh]])


def simulate(count: int, steps: int) -> list[Step]:
    """Steps MuJoCo, and asks limber3d after each step."""
    mujoco: Any = importlib.import_module("mujoco")
    model = mujoco.MjModel.from_xml_string(scene(count))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    faces = model.flex_elem.reshape(-1, 3)  # there is one flex; of several, flex_elemdataadr says where each begins
    cloth, stone = limber3d.Model(data.flexvert_xpos, faces), stone_of(model)
    radius, cache = float(model.flex_radius[0]), limber3d.QueryCache()
    geom = data.geom("stone")
    found: list[Step] = []
    for _ in range(steps):
        mujoco.mj_step(model, data)  # leaves vertices and contacts as they were before the bodies moved on
        pose = (geom.xmat.reshape(3, 3), geom.xpos)
        cloth.move_all(data.flexvert_xpos)
        cloth.commit()
        distance = limber3d.distance(cloth, stone, pose_b=pose, cache=cache).upper - radius
        elements: dict[int, float] = {}
        for contact in limber3d.contacts(cloth, stone, radius + TOLERANCE, pose_b=pose):
            element = int(contact["triangle_a"])
            elements[element] = min(elements.get(element, numpy.inf), float(contact["distance"]) - radius)
        theirs = data.contact.dist.min() if data.ncon else numpy.inf
        found.append(Step(distance, float(theirs), elements, frozenset(data.contact.elem[:, 1].tolist())))
    return found


def main(arguments: Sequence[str] | None = None) -> list[Step] | None:
    parser = argparse.ArgumentParser(description="A cloth of MuJoCo falls on a stone.")
    parser.add_argument("--count", type=int, default=17, help="vertices along a side of the cloth (17)")
    parser.add_argument("--steps", type=int, default=300, help="steps of 2 ms (300)")
    options = parser.parse_args(arguments)
    if importlib.util.find_spec("mujoco") is None:
        print("skipped: MuJoCo is not installed (pip install mujoco)")
        return None

    steps = simulate(options.count, options.steps)
    print("  step   distance by limber3d, MuJoCo   elements in contact by limber3d, MuJoCo")
    for i in range(0, options.steps, max(1, options.steps // 12)):
        step = steps[i]
        numbers = (step.distance, step.mujoco_distance, len(step.touching()), len(step.mujoco_elements))
        print("{:6} {:22.7f} {:10.7f} {:23} {:8}".format(i, *numbers))
    touching = [step for step in steps if step.distance < -TOLERANCE]
    worst = max(abs(step.distance - step.mujoco_distance) for step in touching)
    print(f"{len(touching)} steps in contact; distances differ by {worst:.1e} at most")
    assert all(step.agrees() for step in steps)
    return steps


if __name__ == "__main__":
    main()
