# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the figures of the benchmarks share: colors, axes, labels, files."""

from __future__ import annotations

import io
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
