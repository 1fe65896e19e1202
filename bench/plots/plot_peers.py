#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figure of ball over square next to other libraries: writes docs/images/peers_queries.svg."""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from figures import (  # noqa: E402
    BLUE, GREY, ORANGE, RED, ROOT, SKY, STYLE, caption, contact_note, curve, key, log_axis, plt, save, separation_axis,
)

SCENE = "ball over square, turned"
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


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "peers_queries.csv").open(newline="", encoding="utf-8") as file:
        # The name of the scene has a comma.
        names = next(csv.reader(file))
        return [dict(zip(names, [SCENE, *line.removeprefix(SCENE + ",").split(",")])) for line in file.read().splitlines()
                if line.startswith(SCENE)]


def points(rows: list[dict[str, str]], query: str, library: str, column: str) -> dict[float, float]:
    return {float(row["situation"]): float(row[column]) for row in rows
            if row["query"] == query and row["library"] == library}


def plot(rows: list[dict[str, str]], machine: str, target: Path) -> None:
    figure, panels = plt.subplots(1, 3, figsize=(13.5, 4.9))
    for axes, (query, title, limits, source) in zip(panels, PANELS):
        axes.set_title(title)
        names = []
        for library, (name, color) in CURVES.items():
            median = points(rows, query, library, "median_us")
            if not median:
                continue
            low, high = (points(rows, query, library, column) for column in ("min_us", "p99_us"))
            axes.fill_between(list(low), list(low.values()), list(high.values()), color=color, alpha=0.15, linewidth=0)
            curve(axes, median, color)
            names.append((name, color))
        log_axis(axes, "time per query, µs", *limits)
        separation_axis(axes)
        contact_note(axes)
        caption(axes, source)
        if query == "within 10 %":
            key(axes, 0.03, 0.97, names)
    figure.suptitle("A ball of 1024 triangles over a flat square of 8192, both turned: one thread; median of 16 poses, "
                    f"band from the fastest to the 99th percentile. {machine}", x=0.01, ha="left", fontsize=9.5, color=GREY)
    figure.tight_layout(rect=(0, 0, 1, 0.985), w_pad=2)
    save(figure, target)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="folder with peers_queries.csv and machine.txt")
    parser.add_argument("--preview", type=Path, metavar="FOLDER", help="as PNG into FOLDER")
    arguments = parser.parse_args()
    try:
        rows = rows_of(arguments.results)
        machine = (arguments.results / "machine.txt").read_text(encoding="utf-8").splitlines()[0]
        machine = machine.removeprefix("processor").strip()
    except FileNotFoundError as error:
        sys.exit(f"plot_peers.py: no {error.filename}; run limber_bench_peers with --out {arguments.results}")
    folder, suffix = (arguments.preview, ".png") if arguments.preview else (ROOT / "docs/images", ".svg")
    with plt.rc_context(STYLE):
        plot(rows, machine, folder / f"peers_queries{suffix}")


if __name__ == "__main__":
    main()
