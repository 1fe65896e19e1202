#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gathers what solvers ask for from the tables bodies.md, contacts.md and configurations.md of a folder of results, and
writes and prints solvers.md. A table that is not there is left out."""

from __future__ import annotations

import sys
from pathlib import Path

# What is done, the table, how its rows begin, and the columns, counted from 0, of the time and of the ratio.
ROWS = (
    ("us a contact of a heap of 2 000 bodies, one thread", "bodies.md", ("1",), 1, None),
    ("the same, two threads; times as fast as on one", "bodies.md", ("2",), 1, 5),
    *((f"self-intersections, {mesh}, us; MeshLib over it", "contacts.md", ("self_intersections", mesh), 2, 8)
      for mesh in ("cloth", "bunny", "armadillo")),
    ("elements within 1e-3 of the size, cloth, us; IPC Toolkit's candidates alone over it", "contacts.md",
     ("move all, commit, self_element_pairs", "cloth"), 2, 8),
    ("closest links of 10 000 random configurations, Python, ms", "configurations.md", ("random", "one call"), 2, None),
    ("the same, python-fcl; over one call", "configurations.md", ("random", "python-fcl"), 2, 3),
)


def rows_of(path: Path) -> list[list[str]]:
    """The cells of each row of the tables of a page."""
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]


def main() -> None:
    folder = Path(sys.argv[1])
    lines = ["# What solvers ask for", "",
             "From bodies.md, contacts.md and configurations.md beside this page, which say more. "
             "`./dev bench solvers FOLDER`.", "", "| what | limber | ratio |", "|:--|--:|--:|"]
    for what, page, begin, time, ratio in ROWS:
        found = next((row for row in rows_of(folder / page) if tuple(row[:len(begin)]) == begin), None)
        if found is None:
            print(f"{page} has no row {' | '.join(begin)}: it is left out", file=sys.stderr)
            continue
        lines.append(f"| {what} | {found[time]} | {'' if ratio is None else found[ratio]} |")
    text = "\n".join(lines) + "\n"
    (folder / "solvers.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main()
