# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""A sheet that waves over a plate: distance of each frame, contacts of the closest one, and a batch of poses."""

import numpy

import limber3d


def sheet(count: int) -> tuple[limber3d.typing.FloatArray, limber3d.typing.IdArray]:
    """A flat square of count x count squares, two triangles each."""
    x, y = numpy.meshgrid(numpy.linspace(0, 1, count + 1), numpy.linspace(0, 1, count + 1))
    vertices = numpy.stack([x.ravel(), y.ravel(), numpy.zeros(x.size)], axis=1)
    row, column = numpy.divmod(numpy.arange(count * count, dtype=numpy.uint32), count)
    a = row * (count + 1) + column
    faces = numpy.stack([a, a + 1, a + count + 2, a, a + count + 2, a + count + 1], axis=1).reshape(-1, 3)
    return vertices, faces.astype(numpy.uint32)


vertices, faces = sheet(40)
cloth, plate = limber3d.Model(vertices, faces), limber3d.Model(vertices, faces)
frames: list[limber3d.typing.FloatArray] = []
for t in numpy.linspace(0, 6, 25):
    frame = vertices.copy()
    frame[:, 2] = 0.2 + 0.1 * numpy.sin(7 * vertices[:, 0] + t)
    frames.append(frame)

answers = limber3d.track(cloth, frames, plate)
closest = int(numpy.argmin(answers["upper"]))
print(f"frame {closest} is {answers['upper'][closest]:.6f} apart")

cloth.move_all(frames[closest])
cloth.commit()
contacts = limber3d.contacts(cloth, plate, margin=0.11)
print(f"{len(contacts)} pairs of triangles are closer than 0.11")

poses = numpy.tile(numpy.eye(4), (1000, 1, 1))
poses[:, 2, 3] = numpy.linspace(-1, 1, 1000)
collisions = limber3d.collide_many(cloth, plate, poses_a=poses)
print(f"{collisions['is_yes'].sum()} of 1000 heights collide")
assert 0 < closest < 25 and len(contacts) > 0 and 0 < collisions["is_yes"].sum() < 1000
