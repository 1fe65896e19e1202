#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figure of ball over square next to other libraries: writes docs/images/peers_queries.png.

Takes the folder of results, which has peers.md and machine.txt."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from figures import BLUE, ORANGE, RED, SKY, STYLE, band, caption, curve, key, log_axis, plt, save, separation_axis

CURVES = {
    "limber": ("limber", BLUE),
    "classic": ("the source's tree, limber::classic", ORANGE),
    "fcl": ("FCL, OBBRSS", RED),
    "fcl-forced": ("FCL, its error forced", SKY),
}
PANELS = (
    ("collide", "Collision", (0.02, 2000), "Source, 400 MHz Pentium II: tenths of a millisecond far away,\n"
                                           "just under 60 ms near contact, under 10 ms in contact."),
    ("distance", "Exact distance", (1, 1e6), "Source: at least 310 ms when separated, slower the farther\n"
                                             "apart; 260 ms down to 238 ms in contact."),
    ("within 10 %", "Distance within 10 %", (0.05, 1e5), "Source: quick far away, slowest when approaching, cheaper\n"
                                                         "again towards contact. It gives no times here."),
)


def points(rows: list[list[str]], query: str, library: str, column: int) -> dict[float, float]:
    return {float(row[0]): float(row[column]) for row in rows if row[1:3] == [query, library] and row[4]}


def plot(folder: Path) -> None:
    page = (folder / "peers.md").read_text(encoding="utf-8")
    lines = page.split("### ball over square, turned")[1].split("###")[0].splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if re.match(r"\| -?\d", line)]
    machine = (folder / "machine.txt").read_text(encoding="utf-8").splitlines()[0].removeprefix("processor").strip()
    figure, panels = plt.subplots(1, 3, figsize=(13.5, 4.9))
    for axes, (query, title, limits, source) in zip(panels, PANELS):
        axes.set_title(title)
        names = []
        for library, (name, color) in CURVES.items():
            low, median, high = (points(rows, query, library, column) for column in (3, 4, 5))
            if median:
                band(axes, low, high, color, 0.15)
                curve(axes, median, color)
                names.append((name, color))
        log_axis(axes, "time per query, µs", *limits)
        separation_axis(axes)
        caption(axes, source)
        if query == "within 10 %":
            key(axes, 0.03, 0.97, names)
    save(figure, "peers_queries", "A ball of 1024 triangles over a flat square of 8192, both turned: one thread; median of "
         f"16 poses, band from the fastest to the 99th percentile. {machine}", w_pad=2)


if __name__ == "__main__":
    with plt.rc_context(STYLE):
        plot(Path(sys.argv[1]))
