# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the examples print is what brute force finds."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import brute_force
import limber3d
import numpy
import pytest
from limber3d.typing import FloatArray

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
pytestmark = pytest.mark.skipif(not EXAMPLES.is_dir(), reason="the examples are not beside the tests")


def example(name: str, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of an example."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    return importlib.import_module(name)


def least(a: Any, b: Any, pose_a: Any = None, pose_b: Any = None) -> float:
    """The distance of two meshes by brute force."""
    corners = brute_force.corners
    return brute_force.min_distance(corners(a.vertices, a.faces, pose_a), corners(b.vertices, b.faces, pose_b))


def assert_is_picture(file: Path) -> None:
    """A picture of at least a thousand pixels across, with many colors."""
    import matplotlib.image

    pixels = matplotlib.image.imread(file)
    assert pixels.shape[1] > 1000 and len(numpy.unique(pixels.reshape(-1, pixels.shape[2]), axis=0)) > 200


def test_brute_force_knows_a_few_answers() -> None:
    flat = numpy.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    others = {
        2.0: [[0.2, 0.2, 2], [0.3, 0.2, 3], [0.2, 0.3, 3]],  # a corner above the inside
        0.0: [[0.2, 0.2, -1], [0.3, 0.2, 1], [0.2, 0.3, 1]],  # through it
        0.5: [[-0.5, 0.2, -1], [-0.5, 0.2, 1], [-3, 0, 0]],  # an edge beside an edge
        5.0: [[4.0, -4, 0], [4, -4, 9], [9, -9, 0]],  # corners
    }
    for distance, other in others.items():
        for b in (numpy.array([other]), numpy.array([other])[:, [1, 2, 0]]):
            for one, two in ((flat, b), (b, flat)):
                assert abs(brute_force.pair_distances(one, two)[0] - distance) < 1e-12
                assert abs(brute_force.min_distance(one, two) - distance) < 1e-12


def test_the_arm_has_the_clearance_of_brute_force(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib")
    arm = example("robot_arm", monkeypatch)
    swept = arm.main(["--samples", "600", "--plot", str(tmp_path / "arm.png")])
    assert_is_picture(tmp_path / "arm.png")
    bodies, shelf = dict(zip(arm.NAMES, arm.arm())), arm.shelf()

    def brute(one: Any, names: tuple[str, str], i: int) -> float:
        poses = dict(zip(arm.NAMES, one.poses[:, i]))
        b = shelf if names[1] == "shelf" else bodies[names[1]]
        return least(bodies[names[0]], b, poses[names[0]], poses.get(names[1]))

    random, collisions = numpy.random.default_rng(1), 0
    for one in swept.values():
        for names, records in {**one.to_shelf, **one.to_itself}.items():
            for i in {int(records["upper"].argmin()), int(random.integers(600))}:
                assert abs(brute(one, names, i) - records["upper"][i]) < 1e-9, (names, i)
                collisions += bool(records["upper"][i] == 0)
    assert collisions >= 2
    (line,) = [line for line in capsys.readouterr().out.split("detour:")[1].splitlines() if "mm from the shelf" in line]
    names, i = arm.closest(swept["detour"].to_shelf)
    printed, expected = float(line.split()[0]), 1000 * brute(swept["detour"], names, i)
    assert abs(printed - expected) < 0.006 and " and ".join(names) in line
    # No other time is closer, by brute force on a coarse grid of them.
    for i in range(0, 600, 100):
        assert min(brute(swept["detour"], pair, i) for pair in swept["detour"].to_shelf) * 1000 >= expected - 1e-9


def test_two_arms_have_the_clearance_of_all_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    arms = example("two_arms", monkeypatch)
    poses, closest = arms.main(["--configurations", "60"])
    scene, counts = arms.two_arms()
    pairs = [(a, b) for b in range(20) for a in range(b) if counts(a, b)]
    assert len(pairs) == 156 and closest.shape == (60,) and 0 < (closest["upper"] == 0).sum() < 60
    for i in range(0, 60, 6):
        a, b = closest["object_a"][i], closest["object_b"][i]
        found = [limber3d.distance(scene.model(a), scene.model(b), poses[i, a], poses[i, b]).upper for a, b in pairs]
        assert abs(min(found) - closest["upper"][i]) < 1e-13
        assert abs(least(scene.model(a), scene.model(b), poses[i, a], poses[i, b]) - closest["upper"][i]) < 1e-9


def test_the_sheet_has_the_contacts_of_brute_force(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    cloth = example("cloth", monkeypatch)
    squares, count, margin = 32, 42, 2 * cloth.THICKNESS
    found = cloth.main(["--squares", str(squares), "--frames", str(count), "--plot", str(tmp_path / "cloth.png")])
    assert_is_picture(tmp_path / "cloth.png")
    ring, (_, faces) = cloth.ring(), cloth.sheet(squares)
    frames: list[FloatArray] = list(cloth.simulated(squares, count, ring))
    body = brute_force.corners(ring.vertices, ring.faces)
    vertex_of = numpy.zeros((len(faces), int(faces.max()) + 1), numpy.float32)
    numpy.put_along_axis(vertex_of, faces.astype(int), 1, axis=1)
    edges = (vertex_of.T @ vertex_of > 0).astype(numpy.float32)  # of the sheet, and from each vertex to itself
    is_far = vertex_of @ (edges @ edges) @ vertex_of.T == 0  # triangles without a path of up to 2 edges between them
    most = int(found.self_contacts.argmax())
    assert found.self_contacts[most] > 0 and found.contacts[-1] > 0
    assert (found.distances["lower"] == found.distances["upper"]).all()
    for i in (17, most):
        sheet = frames[i][faces]
        assert abs(brute_force.min_distance(sheet, body) - found.distances["upper"][i]) < 1e-9
        assert len(brute_force.pairs_within(sheet, body, margin)[0]) == found.contacts[i]
        one, two, _ = brute_force.pairs_within(sheet, sheet, margin)
        assert ((one < two) & is_far[one, two]).sum() == found.self_contacts[i]


def test_mujoco_has_the_contacts_of_limber(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    flex = example("mujoco_flex", monkeypatch)
    last = flex.main(["--count", "9", "--steps", "200"])[-1]
    assert last.distance < -1e-4
    assert len(last.mujoco_elements) > 5
    assert last.agrees()
    assert not last._replace(mujoco_elements=last.mujoco_elements - {min(last.touching(-flex.TOLERANCE))}).agrees()
    assert not last._replace(mujoco_distance=last.mujoco_distance + 1e-4).agrees()


def test_without_mujoco_one_line_says_so(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.delitem(sys.modules, "mujoco_flex", raising=False)
    try:
        assert example("mujoco_flex", monkeypatch).main([]) is None
    finally:
        sys.modules.pop("mujoco_flex", None)
    assert capsys.readouterr().out == "skipped: MuJoCo is not installed (pip install mujoco)\n"
