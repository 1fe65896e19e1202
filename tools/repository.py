# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The repository as the checks see it: which files are ours, their text, and how findings are reported."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

CPP_SUFFIXES = (".h", ".cpp")


def _is_ours(folder: str) -> bool:
    return folder == ".ci" or not (folder.startswith((".", "build")) or folder in ("__pycache__", "node_modules"))


def texts(root: Path, *folders: str, suffixes: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Name and text of our files below the named folders, of all if none is named; build trees are left out."""
    for top in folders or (".",):
        for parent, children, names in os.walk(root / top):
            children[:] = sorted(child for child in children if _is_ours(child))
            for path in (Path(parent, name) for name in sorted(names) if name.endswith(suffixes)):
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8", errors="replace")


def finding(name: str, text: str, offset: int, what: str) -> str:
    return f"{name}:{text.count(chr(10), 0, offset) + 1}: {what}"


_CPP_TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/'
    r'|R"(?P<mark>[^()\s\\]{0,16})\(.*?\)(?P=mark)"'
    r'|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'",
    re.DOTALL,
)


def blank(text: str) -> str:
    return re.sub(r"[^\n]", " ", text)


def cpp_code(text: str) -> str:
    """C++ with comments and literals blanked out; every character keeps its line and column."""
    return _CPP_TOKEN.sub(lambda token: blank(token.group()), text)


def run(purpose: str, check: Callable[[Path], list[str]]) -> int:
    """The main function of a check: prints its findings; 1 if there are any."""
    parser = argparse.ArgumentParser(description=purpose)
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent)
    findings = check(parser.parse_args().root)
    print(*findings, sep="\n", end="\n" if findings else "")
    return 1 if findings else 0
