# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The same bits as C++: answers of the command-line program, which writes all digits, next to those of the package."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import limber3d
import pytest
import shapes

PROGRAM = os.environ.get("LIMBER_PROGRAM", "")
pytestmark = pytest.mark.skipif(not PROGRAM, reason="LIMBER_PROGRAM does not name the command-line program")

# Quaternions as the program takes them, so that both make the same matrices.
TURNS, SHIFTS = shapes.random_quaternions(11, 200, 1.6)
KINDS = ["vertex", "edge", "face"]


def lines(*arguments: object) -> list[Any]:
    """The objects that the program answers with."""
    answer = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)
    return [json.loads(line) for line in answer.stdout.splitlines()]


def pose_text(i: int) -> str:
    return ",".join(map(repr, [*SHIFTS[i].tolist(), *TURNS[i].tolist()]))


@pytest.fixture
def meshes(tmp_path: Path) -> tuple[Path, Path]:
    vertices, faces = shapes.ball(30, 20)
    a = shapes.write_obj(tmp_path / "a.obj", vertices * [1, 0.7, 1.3], faces)
    return a, shapes.write_obj(tmp_path / "b.obj", *shapes.ball(17, 9))


def same_witness(theirs: Any, ours: limber3d.Witness | None) -> bool:
    if theirs is None or ours is None:
        return theirs is ours
    points = ours.point_a.tolist() == theirs["point_a"] and ours.point_b.tolist() == theirs["point_b"]
    return points and (ours.triangle_a, ours.triangle_b) == (theirs["triangle_a"], theirs["triangle_b"])


def test_distances(meshes: tuple[Path, Path], tmp_path: Path) -> None:
    a, b = map(limber3d.load, meshes)
    names = [f"pose_b_{name}" for name in ("tx", "ty", "tz", "qw", "qx", "qy", "qz")]
    rows = [",".join([str(meshes[0]), str(meshes[1]), pose_text(i)]) for i in range(len(TURNS))]
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("\n".join([",".join(["model_a", "model_b", *names]), *rows]) + "\n")
    theirs = lines("distance", "--pairs", pairs, "--json", "--max-distance", 2.5)
    assert {answer["status"] for answer in theirs} == {"exact", "collision", "beyond_limit"}
    many = limber3d.distance_many(a, b, poses_b=(TURNS, SHIFTS), max_distance=2.5)
    for answer, turn, shift, record in zip(theirs, TURNS, SHIFTS, many):
        ours = limber3d.distance(a, b, pose_b=(turn, shift), max_distance=2.5)
        assert ours.status.name == answer["status"] and ours.lower == answer["lower"] == record["lower"]
        assert answer["upper"] in (ours.upper, None) and ours.upper == record["upper"]
        assert same_witness(answer["witness"], ours.witness)
        assert (ours.stats.node_tests, ours.stats.primitive_tests) == (answer["node_tests"], answer["primitive_tests"])


def test_contacts(meshes: tuple[Path, Path]) -> None:
    a, b = map(limber3d.load, meshes)
    found = 0
    for i in range(12):
        (answer,) = lines("contacts", *meshes, "--pose-b", pose_text(i), "--margin", 0.02, "--json")
        ours = limber3d.contacts(a, b, 0.02, pose_b=(TURNS[i], SHIFTS[i]))
        by_ids = {(int(c["triangle_a"]), int(c["triangle_b"])): c for c in ours}
        assert len(by_ids) == len(ours) == len(answer["pairs"])
        for pair in answer["pairs"]:
            contact = by_ids[pair["triangle_a"], pair["triangle_b"]]
            for name in ("distance", "depth", "point_a", "point_b", "normal"):
                assert contact[name].tolist() == pair[name]
            assert limber3d.NormalSide(contact["normal_side"]).name == pair["normal_side"]
            for name in ("feature_a", "feature_b"):
                kind, _, index = pair[name].partition(" ")
                assert (KINDS[contact[name]["kind"]], contact[name]["index"]) == (kind, int(index or 0))
        found += len(ours)
    assert found > 100
