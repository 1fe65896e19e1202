# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The program limber3d: sweeps from files to folders."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import dask.config
import limber3d
import numpy
import pyarrow  # type: ignore[import-untyped]
import pyarrow.parquet  # type: ignore[import-untyped]
import pytest
import shapes
from limber3d.command_line import main
from limber3d.pose_files import NAMES, read_poses
from shared_batches import same_bits

TURNS, SHIFTS = shapes.random_quaternions(30, 40, 1.5)
ROWS = numpy.concatenate([SHIFTS, TURNS], 1)


@pytest.fixture
def meshes(tmp_path: Path) -> tuple[str, str]:
    a = shapes.write_obj(tmp_path / "a.obj", *shapes.ball(12, 8))
    return str(a), str(shapes.write_obj(tmp_path / "b.obj", *shapes.ball(9, 7)))


def csv_of(rows: Any, *header: str) -> str:
    return "".join(f"{line}\n" for line in [*header, *(",".join(map(repr, row)) for row in rows.tolist())])


def write_poses(folder: Path) -> dict[str, Path]:
    """The same poses in every form of file."""
    files = {name: folder / name for name in ("plain.csv", "named.csv", "rows.npy", "named.parquet")}
    files["plain.csv"].write_text("# poses\n\n" + csv_of(ROWS))
    files["named.csv"].write_text(csv_of(numpy.c_[ROWS[:, ::-1], SHIFTS], ",".join([*reversed(NAMES), "t", "u", "v"])))
    numpy.save(files["rows.npy"], ROWS)
    table: Any = pyarrow.table({name: ROWS[:, i] for i, name in enumerate(NAMES)} | {"id": list(range(40))})
    pyarrow.parquet.write_table(table, files["named.parquet"])
    return files


def test_poses_are_read_from_every_kind_of_file(tmp_path: Path) -> None:
    for file in write_poses(tmp_path).values():
        turns, shifts = read_poses(file)
        assert (turns == TURNS).all() and (shifts == SHIFTS).all()
    numpy.save(tmp_path / "m.npy", shapes.random_poses(1, 5))
    matrices = read_poses(tmp_path / "m.npy")
    assert not isinstance(matrices, tuple) and (matrices == shapes.random_poses(1, 5)).all()


def test_files_of_poses_that_are_none_are_told_by_name(tmp_path: Path) -> None:
    file, columns = tmp_path / "rows.npy", {name: ["a"] for name in NAMES}
    numpy.save(file, ROWS)
    whole = file.read_bytes()
    numpy.savez(tmp_path / "rows.npz", ROWS)
    texts = [b"", b"PK", whole[:50], whole[:-9], b"poses", (tmp_path / "rows.npz").read_bytes()]
    files = {f"{i}.npy": text for i, text in enumerate(texts)}
    files |= {"0.csv": b"\xff\xfe", "0.parquet": b"PAR1", "1.parquet": b"", "2.parquet": bytes(100)}
    for name, text in files.items():
        (tmp_path / name).write_bytes(text)
    pyarrow.parquet.write_table(pyarrow.table(columns), tmp_path / "3.parquet")
    for name in [*files, "3.parquet"]:
        with pytest.raises(ValueError, match=f"^{tmp_path / name}: "):
            read_poses(tmp_path / name)
    for suffix in ("npy", "csv", "parquet"):
        (tmp_path / f"folder.{suffix}").mkdir()
        with pytest.raises(OSError, match=f"folder.{suffix}"):
            read_poses(tmp_path / f"folder.{suffix}")


def test_bad_files_of_poses_are_told_by_name_and_line(tmp_path: Path) -> None:
    line = ",".join("0001000")
    texts = [
        ("", "has no pose"),
        ("# none\n", "has no pose"),
        (f"{line}\n\n1,2,3\n", r":3: a pose is 7 numbers tx,ty,tz,qw,qx,qy,qz, not 3"),
        (f"{line},8\n", ":1: a pose is 7 numbers .*, not 8"),
        (f"{line}\n{line.replace('1', 'one')}\n", ":2: 'one' is not a number"),
        ("tx,ty,tz,qw,qx,qy\n", ":1: there is no column qz"),
        (f"{','.join(NAMES)}\n1,2\n", ":2: a pose is"),
    ]
    for text, message in texts:
        (tmp_path / "poses.csv").write_text(text)
        with pytest.raises(ValueError, match=f"poses.csv:? ?.*{message}"):
            read_poses(tmp_path / "poses.csv")
    numpy.save(tmp_path / "poses.npy", numpy.zeros((3, 3, 4)))
    with pytest.raises(ValueError, match=r"poses.npy: expected shape .* got \(3, 3, 4\) of float64"):
        read_poses(tmp_path / "poses.npy")
    pyarrow.parquet.write_table(pyarrow.table({"tx": [1.0]}), tmp_path / "poses.parquet")
    with pytest.raises(ValueError, match="poses.parquet: there is no column ty"):
        read_poses(tmp_path / "poses.parquet")
    (tmp_path / "poses.parquet").write_bytes(b"no")
    with pytest.raises(ValueError, match="poses.parquet: "):
        read_poses(tmp_path / "poses.parquet")
    with pytest.raises(ValueError, match="expected a file of poses: .csv, .npy, .parquet"):
        read_poses(tmp_path / "poses.txt")
    with pytest.raises(OSError):
        read_poses(tmp_path / "none.csv")


def test_sweeps(tmp_path: Path, meshes: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    a, b = map(limber3d.load, meshes)
    poses = str(write_poses(tmp_path)["rows.npy"])
    out = tmp_path / "out"
    command = ["sweep", *meshes, "--poses", poses, "--out", str(out), "--max-distance", "0.5", "--partition-size", "9"]
    for found in (0, 5):
        assert main(command) == 0
        assert capsys.readouterr().out == f"poses 40\npartitions 5\nfound {found}\nfolder {out}\n"
    assert same_bits(limber3d.batch.read(out), limber3d.distance_many(a, b, poses_b=(TURNS, SHIFTS), max_distance=0.5))
    numpy.save(tmp_path / "one.npy", ROWS[:1])
    more = ["--poses-a", poses, "--poses-b", str(tmp_path / "one.npy"), "--query", "collide"]
    assert main(["sweep", *meshes, *more, "--out", str(tmp_path / "hits")]) == 0
    expected = limber3d.collide_many(a, b, (TURNS, SHIFTS), (TURNS[0], SHIFTS[0]))
    assert 0 < expected["is_yes"].sum() < 40 and same_bits(limber3d.batch.read(tmp_path / "hits"), expected)


def test_bad_input_is_told_on_one_line(
    tmp_path: Path, meshes: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "out")]
    calls = [
        (["none.obj", meshes[1]], "none.obj"),
        ([*meshes, "--query", "within"], "max_distance: within needs it"),
        ([*meshes, "--poses-a", "poses.txt"], "poses.txt: expected a file of poses"),
        ([*meshes, "--scheduler", "tcp://127.0.0.1:1"], "127.0.0.1:1"),
    ]
    for arguments, text in calls:
        with dask.config.set({"distributed.comm.timeouts.connect": "200ms"}):
            assert main(["sweep", *arguments, *out]) == 2
        error = capsys.readouterr().err
        assert error.startswith("limber3d: sweep: ") and text in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()
    for usage in ([], ["sweep"], ["sweep", *meshes], ["sweep", *meshes, *out, "--query", "near"]):
        with pytest.raises(SystemExit) as ended:
            main(usage)
        assert ended.value.code == 2


def test_dask_is_asked_for_by_name(
    tmp_path: Path, meshes: tuple[str, str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["sweep", *meshes, "--out", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("limber3d: sweep: limber3d.batch needs distributed: pip install limber3d[cluster]")
    assert not (tmp_path / "out").exists()


def test_ctrl_c_is_told(
    meshes: tuple[str, str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("limber3d.batch.sweep", interrupted)
    assert main(["sweep", *meshes, "--out", "nowhere"]) == 130
    assert capsys.readouterr().err == "limber3d: sweep: interrupted; the same command goes on\n"


def test_the_module_is_the_program() -> None:
    run = subprocess.run([sys.executable, "-m", "limber3d", "--version"], capture_output=True, text=True, check=True)
    assert run.stdout == f"limber3d {limber3d.__version__}\n"
    run = subprocess.run(
        [sys.executable, "-m", "limber3d", "sweep", "--help"], capture_output=True, text=True, check=True
    )
    assert "--scheduler ADDRESS" in run.stdout and "dask worker tcp://10.0.0.1:8786" in run.stdout
