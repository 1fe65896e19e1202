# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
import limber3d
import pytest
import shapes
import shared_batches
from limber3d.typing import RecordArray


@pytest.fixture
def tetra() -> limber3d.Model:
    return limber3d.Model(shapes.TETRA_VERTICES, shapes.TETRA_FACES)


@pytest.fixture
def ball() -> limber3d.Model:
    return limber3d.Model(*shapes.ball())


@pytest.fixture(scope="session")
def expected() -> RecordArray:
    """What one process answers to the batch of shared_batches."""
    return shared_batches.expected()
