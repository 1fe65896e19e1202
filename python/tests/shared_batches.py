# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests of batches share: a batch that can be held at a gate, and processes that are killed meanwhile."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import limber3d
import shapes
from limber3d.batch import folder, work
from limber3d.typing import RecordArray

COUNT, SIZE = 2400, 100  # poses, and of a partition
PARTS = COUNT // SIZE


def models() -> tuple[limber3d.Model, limber3d.Model]:
    return limber3d.Model(*shapes.ball(40, 30)), limber3d.Model(*shapes.ball(64, 48))


def poses(count: int = COUNT) -> Any:
    return shapes.random_poses(20, count, 1.0)


def sweep(out: Path | str, executor: Any = None, count: int = COUNT) -> limber3d.batch.Report:
    a, b = models()
    return limber3d.batch.sweep(a, b, poses_b=poses(count), out=out, executor=executor, partition_size=SIZE)


def expected(count: int = COUNT) -> RecordArray:
    """What one process answers."""
    a, b = models()
    return limber3d.distance_many(a, b, poses_b=poses(count))


def same_bits(a: RecordArray, b: RecordArray) -> bool:
    """All fields to the bit, what is not a number included."""
    names = a.dtype.names or ()
    return a.dtype == b.dtype and all(a[name].tobytes() == b[name].tobytes() for name in names)


def done(out: Path) -> int:
    """Partitions that are finished."""
    return len(list(out.glob("part-*.parquet")))


def wait_for(condition: Callable[[], bool]) -> None:
    """Waits for what another process is to do."""
    deadline = time.monotonic() + 60
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError("waited in vain")
        time.sleep(0.005)


def set_gate(out: Path, count: int) -> None:
    """Has workers that use gated_run() wait once so many partitions are done."""
    folder.write_whole(out.with_name(f"{out.name}.gate"), str(count).encode())


def gated_run(task: work.Task, meshes: bytes | str) -> bytes | None:
    """A partition, held at the gate."""
    out = Path(task.batch.folder)
    wait_for(lambda: done(out) < int(out.with_name(f"{out.name}.gate").read_text()))
    return work.run(task, meshes)


def start_client(out: Path, executor: str) -> subprocess.Popen[bytes]:
    """A process that sweeps, held at the gate. `executor` is Python's text."""
    code = f"""
import concurrent.futures
import distributed
import limber3d.batch.running
import shared_batches
limber3d.batch.running.run = shared_batches.gated_run
shared_batches.sweep({str(out)!r}, {executor})
"""
    return subprocess.Popen([sys.executable, "-c", code], env=environment())


def environment() -> dict[str, str]:
    """That of processes. They import what tests import, and Dask does not look for one that was killed for long."""
    paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    timeout = {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s"}
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))} | timeout


def kill(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()
