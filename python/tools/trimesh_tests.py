# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs trimesh's own tests of its CollisionManager on limber3d.CollisionManager.

    PYTHONPATH=build/checked/python build/python/bin/python python/tools/trimesh_tests.py [--theirs]

The tests are downloaded with the source distribution of the installed version; nothing of them is kept. That has no
meshes, so a cube and an assembly of two parts that overlap stand in for its files. --theirs runs trimesh's manager.
"""

import logging
import subprocess
import sys
import tarfile
import tempfile
import types
import unittest
from pathlib import Path
from typing import Any

import limber3d
import numpy
import trimesh
import trimesh.collision

FILE = "test_collision.py"


def mesh_of(file_name: str) -> Any:
    """What stands in for a mesh file of trimesh's repository."""
    if file_name == "unit_cube.STL":
        # Two equal cubes in one place come apart in six directions alike. The test expects one of these; which one comes
        # out, of either manager, depends on the order of the vertices.
        return trimesh.creation.box().apply_transform(numpy.diag([-1, 1, -1, 1]))
    parts = [trimesh.creation.icosphere(), trimesh.creation.icosphere().apply_translation([1, 0, 0])]
    return trimesh.Scene(parts)


def generic() -> types.ModuleType:
    """The module of this name that the tests import."""
    module = types.ModuleType("generic")
    vars(module).update(unittest=unittest, np=numpy, trimesh=trimesh, log=logging.getLogger("trimesh"))
    vars(module).update(get_mesh=mesh_of, random=numpy.random.default_rng(1).random)
    return module


def downloaded(folder: str) -> Path:
    """The file of tests, in that folder."""
    wanted = f"trimesh=={trimesh.__version__}"
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary=:all:", wanted]
    subprocess.run(command, cwd=folder, check=True)
    (archive,) = Path(folder).glob("trimesh-*.tar.gz")
    with tarfile.open(archive) as members:
        source = members.extractfile(f"trimesh-{trimesh.__version__}/tests/{FILE}")
        assert source is not None
        target = Path(folder, "trimesh_collision_tests.py")
        target.write_bytes(source.read())
    return target


def main() -> bool:
    if "--theirs" not in sys.argv:
        vars(trimesh.collision)["CollisionManager"] = limber3d.CollisionManager
    sys.modules["generic"] = generic()
    with tempfile.TemporaryDirectory() as folder:
        test_file = downloaded(folder)
        sys.path.insert(0, folder)
        suite = unittest.defaultTestLoader.loadTestsFromName(test_file.stem)
    return unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful()


if __name__ == "__main__":
    sys.exit(not main())
