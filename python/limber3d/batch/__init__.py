# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many poses, frames or pairs on many processes or machines.

    batch.sweep(a, b, poses_b=poses, out="answers", executor=distributed.Client("tcp://10.0.0.1:8786"))
    records = batch.read("answers")

Work is cut into partitions. Each becomes one Parquet file in a folder, which gets its name only once it is whole. So
the same call goes on where an earlier one was stopped, however it was stopped.

Executors  None: threads of this process, one for each processor. A distributed.Client of Dask: local processes, or
           those of a scheduler. Anything with submit() as concurrent.futures has it; its processes must see the folder.
Promise    The same bits whatever the executor, its workers, their number and their failures.
Needs      pip install limber3d[cluster], here and where the workers are.
"""

from .calls import pairs, sweep, track
from .folder import read
from .running import Report

__all__ = ["Report", "pairs", "read", "sweep", "track"]
