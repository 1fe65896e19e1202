# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thesis benchmarks' results, read from a folder."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

MODES = ("immediate", "batched", "by_depth")
MODE_NAMES = {"immediate": "immediate", "batched": "batched", "by_depth": "by depth"}


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@dataclass
class Results:
    """All rows, numbers still as text, and the curves in them."""

    queries: list[dict[str, str]]
    updates: list[dict[str, str]]

    @classmethod
    def read(cls, folder: Path) -> Results:
        return cls(_rows(folder / "thesis_queries.csv"), _rows(folder / "thesis_updates.csv"))

    def query(self, name: str, error: float, column: str) -> dict[float, float]:
        """A column of one query, by separation."""
        return {
            float(row["separation"]): float(row[column])
            for row in self.queries
            if row["query"] == name and float(row["relative_error"]) == error
        }

    def update(self, motion: str, mode: str, extra_radius: float, column: str) -> dict[int, float]:
        """A column of one mode of maintenance, by dents per commit."""
        return {
            int(row["batch_dents"]): float(row[column])
            for row in self.updates
            if row["motion"] == motion and row["mode"] == mode and float(row["extra_radius"]) == extra_radius
        }

    def extra_radii(self) -> list[float]:
        return sorted({float(row["extra_radius"]) for row in self.updates if row["motion"] != "whole"})
