# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thesis benchmarks' results: read from a folder, written beside them as tables."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

MODES = ("immediate", "batched", "by_depth")
MODE_NAMES = {"immediate": "immediate", "batched": "batched", "by_depth": "by depth"}


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@dataclass
class Results:
    """All rows, numbers still as text, and the curves in them."""

    folder: Path
    queries: list[dict[str, str]]
    poses: list[dict[str, str]]
    updates: list[dict[str, str]]

    @classmethod
    def read(cls, folder: Path) -> Results:
        return cls(
            folder,
            _rows(folder / "thesis_queries.csv"),
            _rows(folder / "thesis_queries_poses.csv"),
            _rows(folder / "thesis_updates.csv"),
        )

    def query(self, name: str, error: float, column: str) -> dict[float, float]:
        """A column of one query in pose 0, by separation; of the other poses when only they have the column."""
        rows = self.queries if column in self.queries[0] else self.poses
        return {
            float(row["separation"]): float(row[column])
            for row in rows
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

    def hovering_us(self, motion: str, mode: str, extra_radius: float) -> float:
        """Time of a hovering query; each batch size has measured it once, on nearly the same tree."""
        return median(self.update(motion, mode, extra_radius, "query_us").values())


def short(us: float) -> str:
    """Three digits are more than the repeatability."""
    if us >= 100:
        return count(us)
    return f"{us:.3g}" if us >= 0.1 else f"{us:.2f}"


def count(number: float) -> str:
    return f"{number:,.0f}".replace(",", " ")


def _table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, [":--" if i == 0 else "--:" for i in range(len(header))], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


QUERY_COLUMNS = (
    ("collision", "collide", 0),
    ("exact", "distance", 0),
    ("within 1 %", "distance", 0.01),
    ("within 10 %", "distance", 0.1),
    ("within 50 %", "distance", 0.5),
    ("within 100 %", "distance", 1),
)


def _queries_table(results: Results, column: str, digits: Callable[[float], str]) -> str:
    curves = [results.query(name, error, column) for _, name, error in QUERY_COLUMNS]
    rows = [[f"{sep:g}", *(digits(curve[sep]) for curve in curves)] for sep in curves[0]]
    return _table(["separation", *(title for title, _, _ in QUERY_COLUMNS)], rows)


def _counters_table(results: Results) -> str:
    shown = [c for c in QUERY_COLUMNS if c[2] in (0, 0.1)]
    pairs = [
        (results.query(name, error, "node_tests"), results.query(name, error, "triangle_tests"))
        for _, name, error in shown
    ]
    rows = [[f"{sep:g}", *(f"{count(n[sep])} / {count(t[sep])}" for n, t in pairs)] for sep in pairs[0][0]]
    return _table(["separation", *(title for title, _, _ in shown)], rows)


def _updates_table(results: Results) -> str:
    modes = [*MODES, "fast"]
    times = [results.update("large", mode, 0, "median_us") for mode in modes]
    refits = [results.update("large", mode, 0, "refits") for mode in modes]
    moves = results.update("large", "by_depth", 0, "move_us")
    header = ["dents per commit"]
    header += [f"{MODE_NAMES[m]}, µs" for m in MODES] + ["fast engine, µs", "of by depth marking, µs"]
    header += [f"{MODE_NAMES[m]}, refits" for m in MODES] + ["fast engine, nodes"]
    rows = [
        [str(b), *(f"{t[b]:.3f}" for t in times), f"{moves[b]:.3f}", *(f"{r[b]:.2f}" for r in refits)] for b in times[0]
    ]
    return _table(header, rows)


def _whole_table(results: Results) -> str:
    rows = [
        [MODE_NAMES[row["mode"]], f"{float(row['median_us']):.3f}", f"{float(row['refits']):.2f}"]
        for row in results.updates
        if row["motion"] == "whole"
    ]
    return _table(["every vertex moved, mode", "µs per vertex", "refits per vertex"], rows)


def _looseness_table(results: Results, dents: int = 10) -> str:
    rows = []
    for motion in ("large", "small"):
        for radius in results.extra_radii():
            row = [motion, f"{radius:g}"]
            for mode in MODES:
                us = results.update(motion, mode, radius, "median_us")[dents]
                refits = results.update(motion, mode, radius, "refits")[dents]
                absorbed = results.update(motion, mode, radius, "absorbed")[dents]
                row.append(f"{us:.3f} ({refits:.2f} / {absorbed:.2f})")
            for mode in ("immediate", "by_depth"):
                nodes = results.update(motion, mode, radius, "query_node_tests")[dents]
                row.append(f"{count(nodes)} ({short(results.hovering_us(motion, mode, radius))} µs)")
            rows.append(row)
    header = ["motion", "extra radius", *(MODE_NAMES[m] for m in MODES)]
    header += ["query after immediate", "query after by depth"]
    return _table(header, rows)


def write_tables(results: Results) -> Path:
    """Writes thesis.md into the folder of the results. docs/experiments.md says what the tables show."""
    tables = {
        "Queries in µs by separation, medians; negative separation is penetration.":
            _queries_table(results, "median_us", short),
        "Means over the other places and turns of the ball.": _queries_table(results, "mean_us", short),
        "Pairs of spheres / pairs of triangles compared.": _counters_table(results),
        "Updates of tight spheres by dents per commit: medians per moved vertex.": _updates_table(results),
        "One step that moves every vertex.": _whole_table(results),
        "Loose spheres, 10 dents per commit: µs per moved vertex (refits / absorbed), and pairs of spheres (median time) "
        "of a query.": _looseness_table(results),
    }
    page = results.folder / "thesis.md"
    texts = ["# The experiments of the source", *(f"{title}\n\n{table}" for title, table in tables.items())]
    page.write_text("\n\n".join(texts) + "\n", encoding="utf-8")
    return page
