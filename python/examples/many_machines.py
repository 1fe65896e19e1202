# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""A sweep on Dask, stopped and gone on with. Its processes are of this machine; a scheduler's address takes it to others."""

import tempfile

import distributed
import limber3d
import numpy
from limber3d import batch


def main() -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    tetrahedron = limber3d.Model(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    poses = numpy.tile(numpy.eye(4), (4000, 1, 1))
    poses[:, 0, 3] = numpy.linspace(0, 4, 4000)

    with tempfile.TemporaryDirectory() as out:
        client = distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None)  # type: ignore[no-untyped-call]
        with client:
            report = batch.sweep(tetrahedron, tetrahedron, poses_b=poses, out=out, executor=client)
        print(f"{report.count} poses in {report.partitions} partitions")
        print(f"they meet at {(batch.read(out)['upper'] == 0).sum()} poses")
        report = batch.sweep(tetrahedron, tetrahedron, poses_b=poses, out=out)
        print(f"the same call again finds {report.found} partitions")


if __name__ == "__main__":  # its processes import this file
    main()
