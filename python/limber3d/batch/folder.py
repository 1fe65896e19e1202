# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a batch: what was asked, the meshes, and one file for each partition that is done."""

from __future__ import annotations

import json
import operator
import os
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

from .queries import QUERY_NAMES

MANIFEST, TOKEN, MESHES = "_manifest.json", "_token", "_meshes.npz"  # readers of Parquet folders skip names with _
_TEMPORARY = "_temporary-"


def part_name(index: int) -> str:
    """The file of a partition. Names sort as partitions do."""
    return f"part-{index:08}.parquet"


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file that has its name only once it is whole."""
    temporary = path.with_name(f"{_TEMPORARY}{uuid.uuid4().hex}")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    except FileNotFoundError:
        if not path.exists():  # else another client of this folder has written the same, and removed what was left
            raise
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, IsADirectoryError):
            raise IsADirectoryError(f"out: {path} is a folder, where a file is to be written") from None
        raise


def is_shared(folder: str, token: str) -> bool:
    """Whether this process sees the folder that the client has opened under that token, not one of the same name."""
    try:
        return Path(folder, TOKEN).read_text() == token
    except OSError:
        return False


def read_manifest(folder: Path) -> dict[str, Any]:
    """Raises OSError if there is none, ValueError if it is none."""
    try:
        manifest: Any = json.loads((folder / MANIFEST).read_text())
    except (ValueError, RecursionError) as error:
        raise ValueError(f"out: {folder / MANIFEST} is not JSON: {error}") from None
    if not _is_manifest(manifest):
        raise ValueError(f"out: {folder / MANIFEST} is not the manifest of a batch")
    return cast("dict[str, Any]", manifest)


def _is_manifest(value: Any) -> bool:
    """Whether this has what readers need, and nothing deeper than a list."""
    if not isinstance(value, dict):
        return False
    values = cast("dict[str, Any]", value)
    items: list[Any] = []
    for entry in values.values():
        items += cast("Sequence[Any]", entry) if isinstance(entry, list) else [entry]
    count, size = values.get("count"), values.get("partition_size")
    return (
        not any(isinstance(item, (dict, list)) for item in items)
        and type(count) is int and count >= 0
        and type(size) is int and size >= 1
        and values.get("query") in QUERY_NAMES
    )  # fmt: skip


def open_folder(folder: Path, manifest: dict[str, Any], partition_size: int | None, usual_size: int) -> tuple[str, int]:
    """Makes the folder of a batch, or goes on with one that is there.

    Returns  A token, by which processes elsewhere tell that they see this very folder, and the partition size.
    Raises   ValueError if it is the folder of another batch, or holds something else.
    """
    if partition_size is not None:
        partition_size = operator.index(partition_size)
        if partition_size < 1:
            raise ValueError(f"partition_size: expected at least 1, got {partition_size}")
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / MANIFEST).exists():
        theirs = read_manifest(folder)
        size: int = theirs["partition_size"] if partition_size is None else partition_size
        ours = manifest | {"partition_size": size}
        for name in [*ours, *theirs]:
            if ours.get(name) != theirs.get(name):
                raise ValueError(
                    f"out: {folder} is the folder of another batch: {name} is {_text(theirs.get(name))} there, "
                    f"{_text(ours.get(name))} here"
                )
    elif any(name != TOKEN and not name.startswith(_TEMPORARY) for name in os.listdir(folder)):
        raise ValueError(f"out: {folder} is not empty, and has no {MANIFEST}")
    else:
        size = usual_size if partition_size is None else partition_size
        ours = manifest | {"partition_size": size}
        write_whole(folder / MANIFEST, (json.dumps(ours, indent=2) + "\n").encode())
    token = uuid.uuid4().hex
    write_whole(folder / TOKEN, token.encode())
    return token, size


def remove_leftovers(folder: Path) -> None:
    """Removes what writers that were killed have left, and the meshes, which nobody needs any more."""
    for path in [*folder.glob(f"{_TEMPORARY}*"), folder / MESHES]:
        if not path.is_dir():
            path.unlink(missing_ok=True)


def _text(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 24 else text[:20] + "…"
