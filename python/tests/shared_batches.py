# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests of batches share: a batch of some seconds, and processes that are killed in the middle of it."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import limber3d
import shapes
from limber3d.typing import RecordArray

COUNT, SIZE = 24_000, 250  # poses, and of a partition
PARTS = COUNT // SIZE
SCRIPT = """
import sys
from concurrent.futures import ThreadPoolExecutor
import shared_batches
shared_batches.sweep(sys.argv[1], ThreadPoolExecutor(1), int(sys.argv[2]))
"""


def models() -> tuple[limber3d.Model, limber3d.Model]:
    return limber3d.Model(*shapes.ball(40, 30)), limber3d.Model(*shapes.ball(64, 48))


def poses(count: int = COUNT) -> Any:
    return shapes.random_poses(20, count, 1.0)


def sweep(out: Path | str, executor: Any, count: int = COUNT, size: int = SIZE) -> limber3d.batch.Report:
    a, b = models()
    return limber3d.batch.sweep(a, b, poses_b=poses(count), out=out, executor=executor, partition_size=size)


def expected(count: int = COUNT) -> RecordArray:
    """What one process answers."""
    a, b = models()
    return limber3d.distance_many(a, b, poses_b=poses(count))


def done(out: Path) -> int:
    """Partitions that are finished."""
    return len(list(out.glob("part-*.parquet")))


def wait_for(condition: Callable[[], bool], process: subprocess.Popen[bytes] | None = None) -> None:
    """Waits for what a process is to do."""
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        assert process is None or process.poll() is None, "the process has ended"
        time.sleep(0.005)


def start(*arguments: object) -> subprocess.Popen[bytes]:
    """Python with this folder on its path."""
    environment_path = f"{Path(__file__).parent}"
    code = f"import sys; sys.path.insert(0, {environment_path!r})\n"
    first, *others = map(str, arguments)
    return subprocess.Popen([sys.executable, "-c", code + first, *others])


def kill(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()
