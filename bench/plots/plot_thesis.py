#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures that the pages of the classic engine show, from the results of the thesis benchmarks.

Takes the folder of results. Writes docs/images/thesis_queries.png and docs/images/thesis_updates.png.
"""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator  # noqa: E402
from PIL import Image  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]

# Okabe and Ito's palette: told apart with every kind of color vision.
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PINK = "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"
GREY = "#666666"

STYLE = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.6,
    "lines.markersize": 3.5,
    "savefig.dpi": 120,
    "figure.facecolor": "white",
}


def plain(value: float, _position: int = 0) -> str:
    return f"{value:,.0f}".replace(",", " ") if abs(value) >= 10000 else f"{value:g}"


def separation_axis(axes) -> None:
    """From far away at the left to deep in contact at the right, logarithmic on both sides of 0."""
    axes.set_xscale("symlog", linthresh=0.01, linscale=0.5)
    axes.set_xlim(100, -1.8)
    ticks = [64, 8, 1, 0.1, 0.01, 0, -0.1, -1]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}".replace("-", "\N{MINUS SIGN}")))
    axes.axvspan(0, -1.8, color="#f3f0ea", zorder=0)
    axes.set_xlabel("separation, units; right of 0: penetration")
    axes.text(-0.02, 0.97, "in contact", transform=axes.get_xaxis_transform(), fontsize=8, color=GREY, va="top",
              ha="center")


def log_axis(axes, label: str, low: float, high: float) -> None:
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_formatter(FuncFormatter(plain))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylabel(label)


def curve(axes, points: dict[float, float], color: str, **style) -> None:
    axes.plot(list(points), list(points.values()), color=color, marker="o", **style)


def label(axes, x: float, y: float, text: str, color: str, **style) -> None:
    axes.annotate(text, (x, y), color=color, textcoords="offset points", **{"xytext": (4, 4), "fontsize": 8.5, **style})


def key(axes, x: float, y: float, entries: list[tuple[str, str]]) -> None:
    """Names in their curves' colors, from the upper curve down, where no label fits beside the curves."""
    for i, (text, color) in enumerate(entries):
        axes.text(x, y - 0.058 * i, text, color=color, transform=axes.transAxes, fontsize=8.5, fontweight="bold",
                  va="top")


def caption(axes, text: str) -> None:
    axes.text(0, -0.235, text, transform=axes.transAxes, fontsize=8, color=GREY, va="top")


def band(axes, low: dict[float, float], high: dict[float, float], color: str, alpha: float) -> None:
    axes.fill_between(list(low), list(low.values()), list(high.values()), color=color, alpha=alpha, linewidth=0)


def save(figure, name: str, title: str, **layout) -> None:
    """Writes the figure of that name for the pages."""
    figure.suptitle(title, x=0.01, ha="left", fontsize=9.5)
    figure.tight_layout(rect=(0, 0, 1, 0.985), **layout)
    target = ROOT / f"docs/images/{name}.png"
    pixels = io.BytesIO()
    figure.savefig(pixels)
    Image.open(pixels).convert("RGB").quantize(64, dither=Image.Dither.NONE).save(target, optimize=True)
    plt.close(figure)
    print(target)


MODES = {"immediate": "immediate", "batched": "batched", "by_depth": "by depth"}  # and their names
MODE_COLORS = {"immediate": RED, "batched": ORANGE, "by_depth": BLUE}
ERROR_COLORS = {0.01: GREEN, 0.1: SKY, 0.5: ORANGE, 1.0: PINK}


class Results:
    """All rows of a folder, numbers still as text, and the curves in them."""

    def __init__(self, folder: Path) -> None:
        self.queries, self.updates = (list(csv.DictReader((folder / f"thesis_{kind}.csv").open(encoding="utf-8")))
                                      for kind in ("queries", "updates"))

    def query(self, name: str, error: float, column: str) -> dict[float, float]:
        """A column of one query, by separation."""
        return {float(row["separation"]): float(row[column]) for row in self.queries
                if row["query"] == name and float(row["relative_error"]) == error}

    def update(self, motion: str, mode: str, extra_radius: float, column: str) -> dict[int, float]:
        """A column of one mode of maintenance, by dents per commit."""
        return {int(row["batch_dents"]): float(row[column]) for row in self.updates
                if row["motion"] == motion and row["mode"] == mode and float(row["extra_radius"]) == extra_radius}

    def extra_radii(self) -> list[float]:
        return sorted({float(row["extra_radius"]) for row in self.updates if row["motion"] != "whole"})


def with_spread(axes, results: Results, query: str, error: float, color: str) -> None:
    low, median, high = (results.query(query, error, column) for column in ("min_us", "median_us", "p99_us"))
    band(axes, low, high, color, 0.18)
    curve(axes, median, color)


def plot_queries(results: Results) -> None:
    figure, grid = plt.subplots(2, 2, figsize=(10.5, 8.2))
    (collision, exact), (approximate, counters) = grid

    collision.set_title("Collision")
    with_spread(collision, results, "collide", 0, BLUE)
    log_axis(collision, "time per query, µs", 0.02, 1000)
    caption(collision, "Source, 400 MHz Pentium II: tenths of a millisecond far away,\n"
                       "just under 60 ms near contact, under 10 ms in contact.")

    exact.set_title("Exact distance")
    with_spread(exact, results, "distance", 0, BLACK)
    log_axis(exact, "time per query, µs", 100, 1e6)
    caption(exact, "Source: at least 310 ms when separated, slower the farther apart;\n"
                   "260 ms down to 238 ms in contact.")

    approximate.set_title("Distance within a relative error")
    for query in ("distance", "collide"):
        curve(approximate, results.query(query, 0, "median_us"), "#aaaaaa", linewidth=1)
    for error, color in ERROR_COLORS.items():
        curve(approximate, results.query("distance", error, "median_us"), color)
    names = [(f"{error * 100:g} %", color) for error, color in ERROR_COLORS.items()]
    key(approximate, 0.44, 0.37, [("exact", GREY), *names, ("collision", GREY)])
    log_axis(approximate, "time per query, µs", 0.02, 1e6)
    caption(approximate, "Source: between the two; quick far away, slowest when approaching,\n"
                         "cheaper again towards contact. It gives no times here.")

    counters.set_title("Work per query, pairs compared")
    for name, query, error, color, at, shift in (("exact", "distance", 0, BLACK, 32, (4, 5)),
                                                 ("10 %", "distance", 0.1, SKY, 8, (-26, 6)),
                                                 ("collision", "collide", 0, BLUE, 2, (5, -11))):
        nodes = results.query(query, error, "node_tests")
        triangles = {x: y for x, y in results.query(query, error, "primitive_tests").items() if y > 0}
        curve(counters, nodes, color)
        curve(counters, triangles, color, linestyle=(0, (1, 1.2)), linewidth=1.2, markerfacecolor="white")
        label(counters, at, nodes[at], name, color, xytext=shift, fontweight="bold")
    log_axis(counters, "pairs per query", 0.7, 1e7)
    caption(counters, "Full lines: pairs of spheres. Dotted lines, open markers: pairs of triangles.\n"
                      "There are 8.4 million pairs of triangles in all.")

    for axes in grid.flat:
        separation_axis(axes)
    save(figure, "thesis_queries", "A ball of 1024 triangles over a flat square of 8192: classic sphere tree, one thread; "
         "median; bands from minimum to 99th percentile", h_pad=2.2, w_pad=2.5)


def plot_updates(results: Results) -> None:
    figure, grid = plt.subplots(2, 2, figsize=(10.5, 8.2))
    (times, refits), (loose_updates, loose_queries) = grid

    times.set_title("Time per moved vertex")
    refits.set_title("Spheres, or 8-nodes, refitted per moved vertex")
    label_shift = {"immediate": (0, 6), "batched": (0, -13), "by_depth": (0, 6)}
    for mode in MODES:
        low, high, median, count = (results.update("large", mode, 0, column)
                                    for column in ("min_us", "max_us", "median_us", "refits"))
        band(times, low, high, MODE_COLORS[mode], 0.2)
        for axes, points in ((times, median), (refits, count)):
            curve(axes, points, MODE_COLORS[mode])
            label(axes, 1, points[1], MODES[mode], MODE_COLORS[mode], xytext=label_shift[mode], fontweight="bold")
    for axes, column in ((times, "median_us"), (refits, "refits")):
        fast = results.update("large", "fast", 0, column)
        curve(axes, fast, GREEN)
        label(axes, 1, fast[1], "fast engine", GREEN, xytext=(0, -13), fontweight="bold")
    for source, mode in ((130, "immediate"), (90, "batched"), (60, "by_depth")):
        times.axhline(source, color=MODE_COLORS[mode], linewidth=0.8, linestyle=(0, (5, 3)))
    times.text(1000, 150, "source, 400 MHz", fontsize=8, color=GREY, ha="right", va="bottom")
    log_axis(times, "µs", 0.005, 500)
    log_axis(refits, "refits", 0.002, 300)
    caption(times, "Tight spheres, 1000 dents of slope 0.1, a dent moves about 108 vertices.\n"
                   "Source: 0.13 ms immediate, 0.09 ms batched, 0.06 ms by depth, hardly\n"
                   "dependent on the batch.")
    caption(refits, "A tree over 20 000 triangles is 15 levels deep, a vertex has 6 triangles: about 91\n"
                    "refits for each vertex moved alone. When dents of one commit overlap, vertices\n"
                    "moved more than once are repaired once. The fast engine refits 8-nodes, each of\n"
                    "eight leaves of 8 triangles, or of eight nodes.")
    for axes in (times, refits):
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(FixedLocator([1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(plain))
        axes.set_xlabel("dents per commit")

    radii = results.extra_radii()
    dents = 10
    loose_updates.set_title("Looseness: time per moved vertex")
    loose_queries.set_title("Looseness: what a distance query then costs")
    for motion, line in (("large", "-"), ("small", (0, (4, 1.5)))):
        for mode in MODES:
            points = {x: results.update(motion, mode, s, "median_us")[dents] for x, s in enumerate(radii)}
            curve(loose_updates, points, MODE_COLORS[mode], linestyle=line)
            nodes = {x: results.update(motion, mode, s, "query_node_tests")[dents] for x, s in enumerate(radii)}
            curve(loose_queries, nodes, MODE_COLORS[mode], linestyle=line)
    for mode in MODES:
        label(loose_updates, 0, results.update("large", mode, 0, "median_us")[dents], MODES[mode],
              MODE_COLORS[mode], xytext=(-6, -3), ha="right", fontweight="bold")
    for motion, shift in (("large", (-8, 6)), ("small", (6, -12))):
        label(loose_queries, 3, results.update(motion, "by_depth", radii[3], "query_node_tests")[dents],
              f"{motion} motion", BLACK, xytext=shift, ha="right" if motion == "large" else "left")
    log_axis(loose_updates, "µs", 0.05, 10)
    log_axis(loose_queries, "pairs of spheres per query", 5e3, 1e6)
    caption(loose_updates, f"{dents} dents per commit. Full lines: large motion, slope 0.1.\n"
                           "Dashed: small motion, slope 0.001.")
    caption(loose_queries, "Exact distance of the ball hovering 0.5 above the dented sheet; colors as beside.\n"
                           "Source: looseness can only make queries slower; no figures.")
    for axes in (loose_updates, loose_queries):
        axes.set_xlim(-1.4 if axes is loose_updates else -0.25, len(radii) - 0.75)
        axes.set_xticks(range(len(radii)), ["0, tight", *(f"{s:g}" for s in radii[1:])])
        axes.set_xlabel("extra radius as a fraction of the tight one")

    save(figure, "thesis_updates", "Keeping the sphere tree of a 100 x 100 sheet, 20 000 triangles, while it is dented: "
         "one thread; median, band from minimum to maximum", h_pad=2.2, w_pad=2.5)


if __name__ == "__main__":
    results_of_folder = Results(Path(sys.argv[1]))
    with plt.rc_context(STYLE):
        plot_queries(results_of_folder)
        plot_updates(results_of_folder)
