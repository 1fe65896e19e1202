# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
import limber3d
import pytest
import shapes


@pytest.fixture
def tetra() -> limber3d.Model:
    return limber3d.Model(shapes.TETRA_VERTICES, shapes.TETRA_FACES)


@pytest.fixture
def ball() -> limber3d.Model:
    return limber3d.Model(*shapes.ball())
