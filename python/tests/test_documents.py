# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What documents show: programs run, snippets of other packages and of limber3d compute the same, and the notebook
prints what is committed."""

from __future__ import annotations

import ast
import copy
import importlib
import re
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(not (ROOT / "README.md").is_file(), reason="the tests stand outside of the sources")


@pytest.mark.parametrize(
    ("page", "output"),
    [
        ("README.md", "2.0 Witness(point_a=(1.0, 0.0, 0.0)"),
        ("docs/guide/python.md", "0.0 0.0 Witness("),
        ("docs/guide/from_other_libraries_python.md", "False 1.0\n"),
        ("docs/guide/python_cluster.md", "4000 poses in 4 partitions, of which 0 were done\n1000 poses meet\n"),
    ],
)
def test_the_first_program_of_a_page_runs(
    page: str, output: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    program = re.search(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert program is not None
    if "batch" in program[1]:
        pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    exec(compile(program[1], page, "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out.startswith(output)


def test_edges_that_a_planner_takes_for_free_are_free() -> None:
    """The recipe of the guide, with an arm of two links in a plane, which dense samples must not contradict."""
    page = (ROOT / "docs/guide/motion.md").read_text(encoding="utf-8")
    names: dict[str, Any] = {"numpy": numpy}
    exec(re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[0], names)
    link, wall = limber3d.Shape.capsule([0, 0, 0], [1, 0, 0], 0.05), limber3d.Shape.box([0.1, 0.3, 1])

    def clearance(q: Any) -> Any:
        turns = [([numpy.cos(a / 2), 0, 0, numpy.sin(a / 2)], [*at, 0]) for a, at in ((q[0], (0, 0)), (q[0] + q[1], (numpy.cos(q[0]), numpy.sin(q[0]))))]
        return numpy.array([limber3d.distance(link, wall, turn, ([1, 0, 0, 0], [1.5, 0, 0])).lower for turn in turns])

    reach, counts = numpy.array([[1.05, 0], [2.05, 1.05]]), {True: 0, False: 0}
    for start, end in numpy.random.default_rng(5).uniform(-2, 2, (60, 2, 2)):
        is_free = names["certainly_apart"](start, end, clearance, reach, 0.01, 1e-3)
        least = min(clearance(start + t * (end - start)).min() for t in numpy.linspace(0, 1, 60))
        assert least > 0.01 or not is_free
        counts[is_free] += 1
    assert min(counts.values()) > 5, counts


# What each package's snippets import. trimesh needs the others for collisions and points.
MODULES = {
    "python-fcl": ["fcl"],
    "trimesh": ["trimesh", "trimesh.collision", "fcl", "scipy", "rtree"],
}
TOLERANCE = 1e-6


def given() -> dict[str, Any]:
    """What every snippet has."""
    vertices_a, faces_a = shapes.ball(20, 12)
    vertices_b, faces_b = shapes.ball(15, 10)
    vertices_b = vertices_b * [1, 0.7, 1.3]
    vertices_b[vertices_b[:, 2] > 0.9] *= [1, 1, 0.2]  # a dent, as trimesh takes convex meshes for solids
    random = numpy.random.default_rng(1)
    rotation, translation, far = (
        shapes.rotation([1, 0.2, 0.3, 0.1]),
        numpy.array([1.6, 0.1, 0.2]),
        numpy.array([0.9, 0, 0]),
    )
    matrix_b = numpy.eye(4)
    matrix_b[:3, :3], matrix_b[:3, 3] = rotation, translation
    far_b = matrix_b.copy()
    far_b[:3, 3] += far
    return {
        "numpy": numpy,
        "vertices_a": vertices_a,
        "faces_a": faces_a.astype(numpy.int64),
        "vertices_b": vertices_b,
        "faces_b": faces_b.astype(numpy.int64),
        "rotation": rotation,
        "translation": translation,
        "far": far,
        "matrix_b": matrix_b,
        "far_b": far_b,
        "quaternion": numpy.array([1.0, 0.4, -0.2, 0.7]),
        "shifts": random.uniform(-3, 3, size=(20, 3)),
        "points": random.uniform(-1.3, 1.3, size=(50, 3)),
    }


def groups(text: str) -> list[dict[str, str]]:
    """Snippets by package: each group ends with that of limber3d."""
    found: list[dict[str, str]] = [{}]
    for package, code in re.findall(r"^```python\n# ([\w-]+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        assert package not in found[-1], f"two snippets of {package} in one group"
        found[-1][package] = code
        if package == "limber3d":
            found.append({})
    assert not found.pop(), "the last group has no snippet of limber3d"
    return found


def run(code: str, names: dict[str, Any]) -> dict[str, Any]:
    """Those variables that a snippet sets which may be compared: numbers, arrays, sets and the like."""
    exec(code, names)
    kinds = (bool, int, float, tuple, list, set, dict, numpy.ndarray, numpy.generic)
    nodes = [
        node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    ]
    return {node.id: names[node.id] for node in nodes if isinstance(names.get(node.id), kinds)}


def same(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(abs(a[key] - b[key]) < TOLERANCE for key in a)
    if isinstance(a, (set, str)) or (isinstance(a, tuple) and isinstance(a[0], str)):
        return bool(a == b)
    return numpy.shape(a) == numpy.shape(b) and bool(numpy.allclose(a, b, rtol=0, atol=TOLERANCE))


@pytest.mark.parametrize("package", MODULES)
def test_snippets_compute_the_same(package: str) -> None:
    modules = {name: pytest.importorskip(name) for name in MODULES[package]}
    theirs = {**given(), **modules}
    ours = {**given(), "limber3d": limber3d, "trimesh": importlib.import_module("trimesh")}
    compared: list[str] = []
    for group in groups((ROOT / "docs/guide/from_other_libraries_python.md").read_text(encoding="utf-8")):
        our_values = run(group["limber3d"], ours)
        if package in group:
            their_values = run(group[package], theirs)
            both = sorted(our_values.keys() & their_values.keys())
            for name in both:
                assert same(their_values[name], our_values[name]), (name, their_values[name], our_values[name])
            assert both or "def model_of" in group[package], group[package]
            compared += both
    # What is compared tells something: meshes meet in one place and are apart in the other.
    if package == "trimesh":
        assert {"hit", "names", "gap", "closest", "distances", "signed", "inside"} <= set(compared)
        assert ours["hit"] and ours["gap"] > 0.1 and set(ours["inside"].tolist()) == {True, False}
    else:
        assert {"matrix", "hit", "pairs", "gap", "point_a", "point_b", "gaps", "meeting"} <= set(compared)
        assert ours["pairs"] and 0 < len(ours["meeting"]) < 190


def test_a_wrong_snippet_is_noticed() -> None:
    assert same(1.0, 1.0 + 1e-9) and not same(1.0, 1.001) and not same({1}, {2}) and not same([1.0], [1.0, 2.0])
    assert not same({(1, 2): 0.5}, {(1, 2): 0.6}) and not same({(1, 2): 0.5}, {(1, 3): 0.5}) and not same(True, False)
    with pytest.raises(AssertionError, match="no snippet of limber3d"):
        groups("```python\n# python-fcl\nhit = True\n```\n")


def texts(notebook: Any) -> list[str]:
    """What each cell has printed."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return ["".join(output.get("text", "") for output in cell.outputs) for cell in cells]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Jupyter
def test_cells_print_what_is_committed(monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for module in ("ipykernel", "matplotlib"):
        pytest.importorskip(module)
    notebook_file = ROOT / "python/examples/limber3d.ipynb"
    committed = nbformat.read(notebook_file, as_version=4)
    nbformat.validate(committed)
    assert notebook_file.stat().st_size < 100_000
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
