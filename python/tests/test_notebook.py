# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The notebook runs, and its outputs are those that are committed."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples/limber3d.ipynb"
pytestmark = [
    pytest.mark.skipif(not NOTEBOOK.is_file(), reason="the examples are not beside the tests"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),  # of Jupyter
]


def texts(notebook: Any) -> list[str]:
    """What each cell has printed."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return ["".join(output.get("text", "") for output in cell.outputs) for cell in cells]


def test_cells_print_what_is_committed(monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for module in ("ipykernel", "matplotlib"):
        pytest.importorskip(module)
    committed = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(committed)
    assert NOTEBOOK.stat().st_size < 100_000
    run = copy.deepcopy(committed)
    for cell in run.cells:
        if cell.cell_type == "code":
            cell.outputs = []
    monkeypatch.setenv("PYTHONPATH", str(Path(limber3d.__file__).parents[1]))
    monkeypatch.delenv("MPLBACKEND", raising=False)
    nbclient.NotebookClient(run, timeout=120, kernel_name="python3").execute()  # raises where a cell does
    assert texts(run) == texts(committed) and sum(map(bool, texts(run))) >= 6
    pictures = [output for cell in run.cells if cell.cell_type == "code" for output in cell.outputs if "data" in output]
    assert len(pictures) == 1 and len(pictures[0]["data"]["image/png"]) > 10_000


def test_the_distance_is_that_of_the_engine() -> None:
    nbformat = pytest.importorskip("nbformat")
    committed = texts(nbformat.read(NOTEBOOK, as_version=4))
    square = limber3d.Model([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    u, v = numpy.meshgrid(numpy.linspace(0, 2 * numpy.pi, 41), numpy.linspace(0, numpy.pi, 21))
    points = 0.4 * numpy.stack([numpy.sin(v) * numpy.cos(u), numpy.sin(v) * numpy.sin(u), numpy.cos(v)], axis=2)
    points = points.reshape(-1, 3) @ shapes.rotation([0.9, 0.3, 0.1, 0.2]).T + [0.2, -0.1, 0.75]
    (found,) = re.findall(r"([\d.]+) <= distance <= ([\d.]+)", committed[1])
    lowest = points[:, 2].min()  # above the square, so that this is the distance
    assert found == (f"{lowest:.6f}",) * 2
    model = limber3d.Model(points, [[i, i, i] for i in range(len(points))])  # the points themselves
    assert abs(limber3d.distance(square, model).upper - lowest) < 1e-12
