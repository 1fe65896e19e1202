# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Models of mesh files."""

from __future__ import annotations

import os

from ._core import Model, RebuildPolicy, read_mesh_file


def load(
    path: str | os.PathLike[str],
    *,
    weld: bool = True,
    weld_tolerance: float = 0.0,
    parts: bool = False,
    motion_margin: float = 0.0,
    rebuild_policy: RebuildPolicy = RebuildPolicy.in_commit,
    rebuild_budget_us: float | None = None,
    preallocate: bool = False,
) -> Model:
    """The model of a mesh file: OBJ, PLY, STL, OFF or glTF. Options are those of read_mesh_file() and of Model.

    Raises   OSError if the file cannot be read, ValueError or IndexError if it is no mesh, as read_mesh_file().
    """
    return Model(
        read_mesh_file(path, weld=weld, weld_tolerance=weld_tolerance, parts=parts),
        motion_margin=motion_margin,
        rebuild_policy=rebuild_policy,
        rebuild_budget_us=rebuild_budget_us,
        preallocate=preallocate,
    )
