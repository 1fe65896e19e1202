# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""A sweep on Dask: on processes of this machine, or of a scheduler whose address is given."""

import sys
import tempfile

import distributed
import limber3d
import numpy
from limber3d import batch


def main(addresses: list[str]) -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    tetrahedron = limber3d.Model(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    turns = numpy.tile([1.0, 0, 0, 0], (4000, 1))
    shifts = numpy.linspace([0, 0, 0], [4, 0, 0], 4000)

    places = {"address": addresses[0]} if addresses else {"n_workers": 2, "threads_per_worker": 1}
    client = distributed.Client(**places, dashboard_address=None)  # type: ignore
    with client, tempfile.TemporaryDirectory() as out:
        report = batch.sweep(tetrahedron, tetrahedron, poses_b=(turns, shifts), out=out, executor=client)
        print(f"{report.count} poses in {report.partitions} partitions")
        answers = batch.read(out)
        print(f"they meet at {(answers['upper'] == 0).sum()} poses, and are {answers['upper'].max()} apart at most")
        report = batch.sweep(tetrahedron, tetrahedron, poses_b=(turns, shifts), out=out, executor=client)
        print(f"the same call again finds {report.found} partitions done")


if __name__ == "__main__":  # the processes of this machine import this file
    main(sys.argv[1:])
