# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thesis benchmarks' results: read from a folder, written as the tables of docs/experiments.md."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from statistics import median

MODES = ("immediate", "batched", "by_depth")
MODE_NAMES = {"immediate": "immediate", "batched": "batched", "by_depth": "by depth"}


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _with_extra_radius(row: dict[str, str]) -> dict[str, str]:
    """The row with today's name of the column that older results call `slack`."""
    return {"extra_radius" if name == "slack" else name: value for name, value in row.items()}


@dataclass
class Results:
    """All rows, numbers still as text, and the curves in them."""

    folder: Path
    machine: str
    queries: list[dict[str, str]]
    poses: list[dict[str, str]]
    updates: list[dict[str, str]]

    @classmethod
    def read(cls, folder: Path) -> Results:
        return cls(
            folder,
            (folder / "machine.txt").read_text(encoding="utf-8"),
            _rows(folder / "thesis_queries.csv"),
            _rows(folder / "thesis_queries_poses.csv"),
            [_with_extra_radius(row) for row in _rows(folder / "thesis_updates.csv")],
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


def _machine_table(results: Results) -> str:
    rows = [line.split(None, 1) for line in results.machine.splitlines()]
    rows.append(["results", f"`bench/results/{results.folder.name}/`"])
    return _table(["", ""], rows).replace("--:", ":--")


def _query_columns() -> list[tuple[str, str, float]]:
    return [
        ("collision", "collide", 0),
        ("exact", "distance", 0),
        ("within 1 %", "distance", 0.01),
        ("within 10 %", "distance", 0.1),
        ("within 50 %", "distance", 0.5),
        ("within 100 %", "distance", 1),
    ]


def _queries_table(results: Results) -> str:
    curves = [results.query(name, error, "median_us") for _, name, error in _query_columns()]
    rows = [[f"{sep:g}", *(short(curve[sep]) for curve in curves)] for sep in curves[0]]
    return _table(["separation", *(title for title, _, _ in _query_columns())], rows)


def _updates_table(results: Results) -> str:
    modes = [*MODES, "fast"]
    times = [results.update("large", mode, 0, "median_us") for mode in modes]
    refits = [results.update("large", mode, 0, "refits") for mode in modes]
    header = ["dents per commit"]
    header += [f"{MODE_NAMES[m]}, µs" for m in MODES] + ["fast engine, µs"]
    header += [f"{MODE_NAMES[m]}, refits" for m in MODES] + ["fast engine, nodes"]
    rows = [[str(b), *(f"{t[b]:.3f}" for t in times), *(f"{r[b]:.2f}" for r in refits)] for b in times[0]]
    return _table(header, rows)


def _looseness_table(results: Results, dents: int = 10) -> str:
    rows = []
    for motion in ("large", "small"):
        for radius in results.extra_radii():
            times = [results.update(motion, mode, radius, "median_us")[dents] for mode in MODES]
            pairs = results.update(motion, "by_depth", radius, "query_node_tests")[dents]
            query = f"{count(pairs)} ({short(results.hovering_us(motion, 'by_depth', radius))} µs)"
            rows.append([motion, f"{radius:g}", *(f"{us:.3f}" for us in times), query])
    return _table(["motion", "extra radius", *(MODE_NAMES[m] for m in MODES), "query after by depth"], rows)


def tables(results: Results) -> dict[str, str]:
    return {
        "machine": _machine_table(results),
        "queries": _queries_table(results),
        "updates": _updates_table(results),
        "looseness": _looseness_table(results),
    }


def write_tables(results: Results, page: Path) -> None:
    """Replaces what stands between `<!-- table: name -->` and `<!-- end -->` on the page."""
    text = page.read_text(encoding="utf-8")
    for name, table in tables(results).items():
        block = re.compile(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        text, count = block.subn(lambda match: match.group(1) + "\n" + table + "\n\n" + match.group(2), text)
        if count != 1:
            raise SystemExit(f"{page}: {count} places for the table '{name}' instead of one")
    page.write_text(text, encoding="utf-8")
