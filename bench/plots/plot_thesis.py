#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures that the pages of the classic engine show, from the results of the thesis benchmarks.

Takes the folder of results. Writes docs/images/thesis_queries.png and docs/images/thesis_updates.png.
"""

from __future__ import annotations

import sys
from pathlib import Path

from figures import (
    BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED, SKY, STYLE, FixedLocator, FuncFormatter, NullLocator, band, caption,
    curve, key, label, log_axis, plain, plt, save, separation_axis,
)
from thesis_results import MODE_NAMES, MODES, Results

MODE_COLORS = {"immediate": RED, "batched": ORANGE, "by_depth": BLUE}
ERROR_COLORS = {0.01: GREEN, 0.1: SKY, 0.5: ORANGE, 1.0: PINK}


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
            label(axes, 1, points[1], MODE_NAMES[mode], MODE_COLORS[mode], xytext=label_shift[mode], fontweight="bold")
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
        label(loose_updates, 0, results.update("large", mode, 0, "median_us")[dents], MODE_NAMES[mode],
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
    results_of_folder = Results.read(Path(sys.argv[1]).resolve())
    with plt.rc_context(STYLE):
        plot_queries(results_of_folder)
        plot_updates(results_of_folder)
