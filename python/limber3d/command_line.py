# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The program limber3d: batches from the command line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from . import __version__, batch
from .batch.folder import imported
from .batch.inputs import Poses
from .files import load
from .pose_files import read_poses

_BAD_INPUT, _INTERRUPTED = 2, 130

_SWEEP_FOOTER = """\
Poses say where a model stands in the world. Files of poses are .csv or .parquet with columns tx,ty,tz,qw,qx,qy,qz:
translation in the meshes' length unit, quaternion of any length; CSV may leave out the header. Or .npy: an array of
4 x 4 matrices, shape (n, 4, 4), or of the seven numbers, shape (n, 7). Without a file a model stands at the identity. A
file of one pose holds for all; otherwise two files have as many poses each.

The answer is a folder with one Parquet file for each partition, a row for each pose in their order: row counts from 0;
lower, upper and status of distance; is_yes, 0 or 1, of the others; points and triangles of a witness.
limber3d.batch.read(FOLDER) reads it, and so does whatever reads folders of Parquet files. status is 0 exact,
1 within_error, 2 collision, 3 beyond_limit.

A sweep that was stopped, however that was, goes on where it was with the same command. The folder of another sweep is
refused.

limber3d[cluster] has to be installed here, and where a scheduler and its workers are. Each worker answers as many
partitions at a time as it has threads. Workers that see the folder write their partitions themselves; those that do not
send them here. Without --scheduler all processors of this machine answer.

Example:

  dask scheduler
  dask worker tcp://10.0.0.1:8786
  limber3d sweep gripper.obj part.stl --poses poses.npy --out answers --scheduler tcp://10.0.0.1:8786
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program. Returns its exit code: 0; 2 for bad usage or bad input, told on one line; 130 after Ctrl-C."""
    parser = _parser()
    parsed = parser.parse_args(arguments)
    try:
        _sweep(parsed)
    except KeyboardInterrupt:
        print("limber3d: sweep: interrupted; the same command goes on", file=sys.stderr)
        return _INTERRUPTED
    except (OSError, ValueError, IndexError, ImportError, RuntimeError) as error:
        print(f"limber3d: sweep: {error}", file=sys.stderr)
        return _BAD_INPUT
    return 0


def _sweep(parsed: argparse.Namespace) -> None:
    a, b = load(parsed.a), load(parsed.b)
    poses_a, poses_b = (None if path is None else _poses(path) for path in (parsed.poses_a, parsed.poses_b))
    with ExitStack() as owned:
        client = None
        if parsed.scheduler is not None:
            distributed = imported("distributed")
            client = owned.enter_context(distributed.Client(parsed.scheduler))
        report = batch.sweep(
            a,
            b,
            poses_a,
            poses_b,
            out=parsed.out,
            query=parsed.query,
            relative_error=parsed.relative_error,
            absolute_error=parsed.absolute_error,
            max_distance=parsed.max_distance,
            executor=client,
            partition_size=parsed.partition_size,
            progress=parsed.progress,
        )
    print(f"poses {report.count}\npartitions {report.partitions}\nfound {report.found}\nfolder {parsed.out}")


def _poses(path: Path) -> Any:
    """Those of a file. One pose holds for all."""
    read = read_poses(path)
    poses = Poses(read)
    return poses.one(0) if poses.count == 1 else read


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="limber3d", description="Collision and distance of triangle meshes, in batches"
    )
    parser.add_argument("--version", action="version", version=f"limber3d {__version__}")
    verbs = parser.add_subparsers(title="verbs", metavar="VERB", required=True)
    sweep = verbs.add_parser(
        "sweep",
        help="a query of two models at many poses, on this machine or on many",
        description="A query of two models at many poses, on this machine or on many",
        epilog=_SWEEP_FOOTER,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    sweep.add_argument("a", metavar="A", type=Path, help="mesh file (.obj .ply .stl .off .gltf .glb)")
    sweep.add_argument("b", metavar="B", type=Path, help="as A, in the same length unit")
    sweep.add_argument("--poses-a", metavar="FILE", type=Path, help="where A stands: one pose, or one after another")
    sweep.add_argument("--poses-b", "--poses", metavar="FILE", type=Path, help="where B stands")
    sweep.add_argument("--out", metavar="FOLDER", type=Path, required=True, help="where the answers are kept")
    sweep.add_argument(
        "--query",
        choices=("distance", "collide", "within"),
        default="distance",
        help="what is asked; distance without it",
    )
    sweep.add_argument(
        "--relative-error",
        metavar="NUMBER",
        type=float,
        help="distance: the answer may exceed the true distance by this fraction of it",
    )
    sweep.add_argument(
        "--absolute-error",
        metavar="LENGTH",
        type=float,
        help="distance: the answer may exceed the true distance by this length; either error will do",
    )
    sweep.add_argument(
        "--max-distance",
        metavar="LENGTH",
        type=float,
        help="distance: stop with beyond_limit when the models are farther apart; within: how far apart at most",
    )
    sweep.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask scheduler, such as tcp://10.0.0.1:8786, whose workers answer"
    )
    sweep.add_argument(
        "--partition-size", metavar="COUNT", type=int, help="poses of a partition; chosen by their number without it"
    )
    sweep.add_argument("--progress", action="store_true", help="show progress, if tqdm is installed")
    return parser
