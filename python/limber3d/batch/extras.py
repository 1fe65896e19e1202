# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Packages that only batches need."""

from __future__ import annotations

import importlib
from typing import Any


def imported(module: str) -> Any:
    """A module of an optional package. Raises ImportError that says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"limber3d.batch needs {package}: pip install limber3d[cluster] ({error})") from error
