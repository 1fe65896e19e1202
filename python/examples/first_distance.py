# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two models, one turned and shifted: distance, witness points, contact."""

import limber3d

corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
square = limber3d.Model(corners, [[0, 1, 2], [0, 2, 3]])

above = ([1, 0, 0, 0.2], [0.5, 0, 2])  # a quaternion w, x, y, z, of any length, and a translation
near = limber3d.distance(square, square, pose_b=above)
assert near.witness is not None and near.upper == 2
print(f"{near.upper} apart: {near.witness.point_a} and {near.witness.point_b}")

dropped = ([1, 0.3, 0, 0], [0.5, 0.2, -0.1])
hit = limber3d.collide(square, square, pose_b=dropped)
assert hit and hit.witness is not None
print(f"touching at {hit.witness.point_a}")
