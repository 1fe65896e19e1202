# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The snippets of docs/guide/python_migration.md: other packages and limber3d compute the same."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes

PAGE = Path(__file__).resolve().parents[2] / "docs/guide/python_migration.md"
pytestmark = pytest.mark.skipif(not PAGE.is_file(), reason="the page is not beside the tests")

# What each package's snippets import. trimesh needs the others for collisions and points.
MODULES = {
    "python-fcl": ["fcl"],
    "Coal": ["coal", "eigenpy"],
    "trimesh": ["trimesh", "trimesh.collision", "fcl", "scipy", "rtree"],
}
TOLERANCE = 1e-6  # that of Coal's iterations


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
    for group in groups(PAGE.read_text(encoding="utf-8")):
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
        groups("```python\n# Coal\nhit = True\n```\n")
