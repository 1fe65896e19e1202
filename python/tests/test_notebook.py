# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The notebook runs, and its outputs are those that are committed."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import limber3d
import pytest

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
