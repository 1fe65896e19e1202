# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Folders of batches: going on after a kill, damage, two clients, and folders that are refused."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes
import shared_batches
from limber3d import batch
from limber3d.batch import folder
from limber3d.typing import RecordArray
from shared_batches import COUNT, PARTS, same_bits


def test_a_client_that_was_killed_goes_on_where_it_was(tmp_path: Path, expected: RecordArray) -> None:
    out = tmp_path / "out"
    shared_batches.set_gate(out, 3)
    client = shared_batches.start_client(out, "concurrent.futures.ThreadPoolExecutor(1)")
    shared_batches.wait_for(lambda: shared_batches.done(out) == 3)
    shared_batches.kill(client)
    (out / "_temporary-left").write_bytes(b"PAR1")
    (out / "_notes.txt").write_text("mine")
    with pytest.raises(
        ValueError, match=rf"of {PARTS} partitions in .*, {PARTS - 3} are missing or damaged, part-00000003"
    ):
        batch.read(out)
    times = {path: path.stat().st_mtime_ns for path in out.glob("part-*")}
    assert shared_batches.sweep(out) == batch.Report(count=COUNT, partitions=PARTS, found=3)
    assert all(path.stat().st_mtime_ns == then for path, then in times.items())
    assert same_bits(batch.read(out), expected)
    assert {path.name for path in out.glob("_*")} == {folder.MANIFEST, folder.TOKEN, "_notes.txt"}


def test_files_that_are_not_whole_or_of_another_batch_are_made_again(tmp_path: Path, expected: RecordArray) -> None:
    shared_batches.sweep(tmp_path / "a")
    shared_batches.sweep(tmp_path / "b", None, 500)
    names = [folder.part_name(i) for i in range(4)]
    (tmp_path / "a" / names[0]).write_bytes((tmp_path / "b" / names[0]).read_bytes())
    (tmp_path / "a" / names[1]).write_bytes((tmp_path / "a" / names[2]).read_bytes())
    whole = (tmp_path / "a" / names[2]).read_bytes()
    (tmp_path / "a" / names[2]).write_bytes(whole[: len(whole) // 2])
    (tmp_path / "a" / names[3]).write_bytes(b"")
    assert shared_batches.sweep(tmp_path / "a").found == PARTS - 4
    assert same_bits(batch.read(tmp_path / "a"), expected)


def test_no_damage_goes_unnoticed(tmp_path: Path) -> None:
    shared_batches.sweep(tmp_path, None, 200)
    answers, path = batch.read(tmp_path), tmp_path / folder.part_name(1)
    whole = path.read_bytes()
    random, noticed = numpy.random.default_rng(7), 0
    for place in random.integers(len(whole), size=200).tolist():
        data = bytearray(whole)
        data[place] ^= 1 << random.integers(8)
        path.write_bytes(data)
        try:
            assert same_bits(batch.read(tmp_path), answers)  # the damage is where nothing is read
        except ValueError as error:
            assert "of 2 partitions" in str(error) and "1 are missing or damaged, part-00000001" in str(error)
            noticed += 1
    assert noticed > 150
    path.write_bytes(whole.replace(b"lower", b"lowes"))
    with pytest.raises(ValueError, match="1 are missing or damaged"):
        batch.read(tmp_path)
    data = bytearray(whole)
    data[len(whole) // 2] ^= 1
    path.write_bytes(data)
    assert shared_batches.sweep(tmp_path, None, 200).found == 1
    assert same_bits(batch.read(tmp_path), answers) and path.read_bytes() == whole


def test_two_clients_of_one_folder_do_no_harm(tmp_path: Path, expected: RecordArray) -> None:
    with ThreadPoolExecutor(2) as clients:
        reports = [clients.submit(shared_batches.sweep, tmp_path) for _ in range(2)]
    assert all(report.result().partitions == PARTS for report in reports)
    assert same_bits(batch.read(tmp_path), expected)


def test_a_client_may_come_while_another_opens_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    listdir = os.listdir

    def later(folder: Path) -> list[str]:
        monkeypatch.undo()
        shared_batches.sweep(tmp_path)
        return listdir(folder)

    monkeypatch.setattr(os, "listdir", later)
    assert shared_batches.sweep(tmp_path).found == PARTS


def test_a_file_has_its_name_only_once_it_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, seen, replace = tmp_path / "part", list[bytes](), os.replace

    def renamed(temporary: Path, target: Path) -> None:
        assert target == path and not path.exists()
        seen.append(temporary.read_bytes())
        replace(temporary, target)

    def full(temporary: Path, data: bytes) -> None:
        with temporary.open("wb") as file:
            file.write(data[:2])
        raise OSError("disk full")

    monkeypatch.setattr("os.replace", renamed)
    folder.write_whole(path, b"mine")
    assert seen == [b"mine"] and path.read_bytes() == b"mine"
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="disk full"):
        folder.write_whole(path, b"other")
    assert path.read_bytes() == b"mine" and [file.name for file in tmp_path.iterdir()] == ["part"]


def test_a_file_that_another_client_has_removed_is_no_loss(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def removed(temporary: Path, path: Path) -> None:
        temporary.unlink()
        raise FileNotFoundError

    monkeypatch.setattr("os.replace", removed)
    with pytest.raises(FileNotFoundError):
        folder.write_whole(tmp_path / "part", b"mine")
    (tmp_path / "part").write_bytes(b"theirs, which is the same")
    folder.write_whole(tmp_path / "part", b"mine")
    assert [path.name for path in tmp_path.iterdir()] == ["part"]


def test_the_folder_of_another_batch_is_refused(tmp_path: Path, ball: limber3d.Model, tetra: limber3d.Model) -> None:
    poses = shapes.random_poses(1, 20)
    batch.sweep(ball, tetra, poses, out=tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.glob("part-*")}
    other = poses.copy()
    other[19, 0, 3] += 1
    moved = limber3d.Model(numpy.nextafter(ball.vertices, 9), ball.faces)
    others: list[tuple[str, Any, Any, Any, dict[str, Any]]] = [
        ("poses_a", ball, tetra, other, {}),
        ("model_a", moved, tetra, poses, {}),
        ("model_b", ball, ball, poses, {}),
        ("query", ball, tetra, poses, {"query": "collide"}),
        ("max_distance", ball, tetra, poses, {"max_distance": 1.0}),
        ("partition_size", ball, tetra, poses, {"partition_size": 7}),
    ]
    for name, a, b, placed, options in others:
        with pytest.raises(ValueError, match=f"out: .* is the folder of another batch: {name} is "):
            batch.sweep(a, b, placed, out=tmp_path, **options)
    with pytest.raises(ValueError, match="out: .* is the folder of another batch: batch is "):
        batch.pairs([ball, tetra], poses[:2], [[0, 1]] * 20, out=tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.glob("part-*")} == before
    assert batch.sweep(ball, tetra, poses, out=tmp_path).found == 1
    manifest = json.loads((tmp_path / folder.MANIFEST).read_text())
    (tmp_path / folder.MANIFEST).write_text(json.dumps(manifest | {"version": "0.0.1"}))
    with pytest.raises(ValueError, match='another batch: version is "0.0.1" there'):
        batch.sweep(ball, tetra, poses, out=tmp_path)


def test_folders_that_are_none_are_refused(tmp_path: Path, ball: limber3d.Model) -> None:
    (tmp_path / "_notes.txt").write_text("mine")
    with pytest.raises(ValueError, match=r"is not empty, and has no _manifest.json"):
        batch.sweep(ball, ball, out=tmp_path)
    with pytest.raises(OSError):
        batch.read(tmp_path)
    (tmp_path / folder.MANIFEST).write_text("{")
    with pytest.raises(ValueError, match="is not JSON"):
        batch.read(tmp_path)
    for text in ("[]", "3", "{}"):
        (tmp_path / folder.MANIFEST).write_text(text)
        with pytest.raises(ValueError, match="not the manifest of a batch"):
            batch.sweep(ball, ball, out=tmp_path)
    with pytest.raises(FileExistsError):
        batch.sweep(ball, ball, out=tmp_path / "_notes.txt")


def test_manifests_that_are_none_are_refused_by_name(tmp_path: Path, ball: limber3d.Model) -> None:
    batch.sweep(ball, ball, shapes.random_poses(1, 20), out=tmp_path)
    path = tmp_path / folder.MANIFEST
    manifest = json.loads(path.read_text())
    texts: list[str | bytes] = ["[" * 100_000, '{"count": ' * 100_000, "9" * 5000, "\N{DEGREE SIGN}".encode("latin-1")]
    wrong: list[tuple[str, Any]] = [
        *((name, value) for name in ("count", "partition_size") for value in ("7", None, 1.5, True, -1, [7], 1e400)),
        ("partition_size", 0),
        ("query", "touch"),
        ("query", None),
        ("version", {"major": 1}),
        ("models", [["deep"]]),
    ]
    texts += [json.dumps(manifest | {name: value}) for name, value in wrong]
    texts += [json.dumps({key: manifest[key] for key in manifest if key != name}) for name in ("count", "query")]
    for text in texts:
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        for call in (lambda: batch.read(tmp_path), lambda: batch.sweep(ball, ball, out=tmp_path)):
            with pytest.raises(ValueError, match="out: .*_manifest.json is not (JSON|the manifest of a batch)"):
                call()
    path.write_text(json.dumps(manifest | {"count": 10**30}))
    with pytest.raises(MemoryError, match=f"out: no memory for 1{30 * '0'} answers"):
        batch.read(tmp_path)
    path.write_text(json.dumps(manifest | {"partition_size": 10**30}))
    with pytest.raises(ValueError, match="out: of 1 partitions in .*, 1 are missing or damaged"):
        batch.read(tmp_path)


@pytest.mark.parametrize("name", [folder.part_name(1), folder.TOKEN, folder.MESHES, "_temporary-mine"])
def test_folders_in_place_of_files_are_named(tmp_path: Path, name: str) -> None:
    shared_batches.sweep(tmp_path, None, 200)
    (tmp_path / name).unlink(missing_ok=True)
    (tmp_path / name).mkdir()
    (tmp_path / folder.part_name(0)).unlink()
    if name.startswith("_temporary-"):
        assert shared_batches.sweep(tmp_path, None, 200).found == 1
        return
    with pytest.raises(IsADirectoryError, match=f"^out: .*{name} is a folder"):
        shared_batches.sweep(tmp_path, None, 200)
    assert not [path for path in tmp_path.iterdir() if path.is_file() and path.name.startswith("_temporary-")]


def test_partition_sizes_are_whole_and_positive(tmp_path: Path, ball: limber3d.Model) -> None:
    poses, wrong = shapes.random_poses(1, 20), list[Any]([1.5, "7"])
    for size in (0, -1):
        with pytest.raises(ValueError, match="partition_size: expected at least 1"):
            batch.sweep(ball, ball, poses, out=tmp_path / "none", partition_size=size)
    for size in wrong:
        with pytest.raises(TypeError, match="cannot be interpreted as an integer"):
            batch.sweep(ball, ball, poses, out=tmp_path / "none", partition_size=size)
    assert not (tmp_path / "none").exists()
    whole_number: Any = numpy.int64(7)
    assert batch.sweep(ball, ball, poses, out=tmp_path, partition_size=whole_number).partitions == 3
    assert batch.sweep(ball, ball, poses, out=tmp_path / "one", partition_size=2**80).partitions == 1
    whole = numpy.tile(numpy.eye(4, dtype=int), (20, 1, 1))
    assert batch.sweep(ball, ball, whole, out=tmp_path / "whole").count == 20


def test_folders_are_read_by_readers_of_parquet(tmp_path: Path, ball: limber3d.Model) -> None:
    import pyarrow.parquet  # type: ignore[import-untyped]

    poses = shapes.random_poses(1, 40)
    batch.sweep(ball, ball, poses, out=tmp_path, partition_size=7)
    table: Any = pyarrow.parquet.read_table(tmp_path)
    many = limber3d.distance_many(ball, ball, poses)
    assert table.column("row").to_pylist() == list(range(40))
    assert table.column("upper").to_pylist() == many["upper"].tolist()
    assert table.column("point_a_y").to_numpy().tobytes() == many["point_a"][:, 1].tobytes()
