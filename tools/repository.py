# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The repository as the checks see it: which files are ours, their text, and how a finding is reported."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

CPP_SUFFIXES = (".h", ".cpp")


@dataclass(frozen=True, order=True)
class Finding:
    path: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"


def _is_ours(folder: str) -> bool:
    return folder == ".ci" or not (folder.startswith((".", "build")) or folder in ("__pycache__", "node_modules"))


def files(root: Path, *folders: str, suffixes: tuple[str, ...] = ()) -> Iterator[Path]:
    """Our files below the named folders (all of them if none is named), sorted; build trees are left out."""
    for top in folders or (".",):
        for parent, children, names in os.walk(root / top):
            children[:] = sorted(child for child in children if _is_ours(child))
            for name in sorted(names):
                if not suffixes or name.endswith(suffixes):
                    yield Path(parent, name)


def shown(root: Path, path: Path) -> str:
    return Path(os.path.relpath(path, root)).as_posix()


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace")


def line_at(text: str, offset: int) -> int:
    return text.count("\n", 0, offset) + 1


_CPP_TOKEN = re.compile(
    r'(?P<comment>//[^\n]*|/\*.*?\*/)'
    r'|(?P<raw>R"(?P<mark>[^()\s\\]{0,16})\(.*?\)(?P=mark)")'
    r'|(?P<string>"(?:\\.|[^"\\\n])*")'
    r"|(?P<char>(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+')",
    re.DOTALL,
)


def _blank(text: str) -> str:
    return re.sub(r"[^\n]", " ", text)


def cpp_code(text: str) -> str:
    """C++ with comments and literals blanked out; every character keeps its line and column."""
    return _CPP_TOKEN.sub(lambda token: _blank(token.group()), text)


def run(purpose: str, check: Callable[[Path], list[Finding]]) -> int:
    """The main function of a check: prints its findings; 1 if there are any."""
    parser = argparse.ArgumentParser(description=purpose)
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent)
    findings = sorted(set(check(parser.parse_args().root)))
    for finding in findings:
        print(finding)
    return 1 if findings else 0
