# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What documents show runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("page", "output"),
    [
        ("README.md", "2.0 Witness(point_a=(1.0, 0.0, 0.0)"),
        ("docs/guide/python.md", "0.0 0.0 Witness("),
        ("docs/guide/python_migration.md", "False 1.0\n"),
        ("docs/guide/python_cluster.md", "4000 poses in 4 partitions, of which 0 were done\n1000 poses meet\n"),
    ],
)
def test_the_first_program_of_a_page_runs(
    page: str, output: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    if not (ROOT / page).is_file():
        pytest.skip("the tests stand outside of the sources")
    program = re.search(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert program is not None
    if "batch" in program[1]:
        pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    exec(compile(program[1], page, "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out.startswith(output)
