#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Nothing is left unfinished, the library is silent, and what sources and pages refer to exists."""

from __future__ import annotations

import fnmatch
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from repository import CPP_SUFFIXES, blank, cpp_code, finding, run, texts

MOST_LINES = 800
CODE_SUFFIXES = (*CPP_SUFFIXES, ".ts", ".mjs", ".js")
TEXT_SUFFIXES = (*CODE_SUFFIXES, ".py", ".sh", ".cmake", ".md", ".bib", "CMakeLists.txt", "dev", ".ci/run")
BIBLIOGRAPHY = "docs/references.bib"
NAME_WHAT_IS_LOOKED_FOR = ("tools/check_text.py", "tools/test_tools.py")

UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
PRINTING_OR_ENDING = re.compile(
    r"\bstd::(?:cout|cerr|clog|print|println)\b|#include <iostream>|\b(?:v?f?printf|f?puts|f?putc|putchar|perror)\("
    r"|(?<![\w.>])(?:std::)?(?:abort|exit|_Exit|quick_exit|terminate)\(|(?<!\w)assert\("
)
TOO_WIDE = re.compile(r"^.{121,}$", re.MULTILINE)  # clang-format sees to code, not to comments: it would tear them apart
KEY = r"[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?"
CITATION = re.compile(rf"\[({KEY}(?:[,;] *{KEY})*)\]")
ENTRY = re.compile(r"^[ \t]*@(?!comment|string)\w+[ \t]*\{[ \t]*([^,\s]+)", re.MULTILINE)
OWN_FILE = re.compile(
    r"(?<![\w/.<>*-])(?:docs|include|src|scenes|clients|tests|bench|examples|tools)/[\w./-]*\.(?:md|bib|h|cpp|py|csv|svg|png)\b"
)
CODE = re.compile(r"^[ \t]*(```|~~~).*?^[ \t]*\1[^\n]*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)  # of a page
LINK = re.compile(r"\]\(\s*<?([^()\s<>]+)|^[ \t]*\[[^\]\n]+\]:[ \t]+(\S+)|\b(?:src|href)=\"([^\"]+)\"", re.MULTILINE)
HEADING = re.compile(r"^#{1,6}[ \t]+(.*?)[ \t]*#*$|<a (?:id|name)=\"([^\"]+)\"", re.MULTILINE)

TEST = re.compile(r"^\w*(?:TEST\w*|_PROP)\((\w+), *(\w+)", re.MULTILINE)
NAME_OF_TESTS = re.compile(r"`([A-Z]\w+\.(?:\w+[*…]?|\*))`")  # in a page of docs/algorithms


def _anchors(page: Path) -> set[str]:
    """The anchors of a page: those that it gets for its headings, and its own."""
    found = HEADING.findall(page.read_text(encoding="utf-8"))
    return {own or re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading, own in found}


def _link_faults(root: Path, name: str, text: str) -> Iterator[tuple[int, str]]:
    for match in LINK.finditer(CODE.sub(lambda code: blank(code.group()), text)):
        target = next(group for group in match.groups() if group)
        place, _, anchor = unquote(target).partition("#")
        page = ((root / name).parent / place if place else root / name).resolve()
        if re.match(r"[a-z][a-z0-9+.-]*:", target, re.IGNORECASE):
            continue
        if not page.is_relative_to(root.resolve()) or not page.exists():
            yield match.start(), f"link {target} leads nowhere"
        elif anchor and page.suffix == ".md" and anchor not in _anchors(page):
            yield match.start(), f"link {target}: there is no such heading"


def _faults(root: Path, name: str, text: str, known: list[str], tests: set[str]) -> Iterator[tuple[int, str]]:
    """Where a file is at fault, and how."""
    yield from ((match.start(), f"{match.group()} is to be finished") for match in UNFINISHED.finditer(text))
    if name.startswith("src/") and name.endswith(CPP_SUFFIXES):
        yield from ((match.start(), f"{match.group()}: a library") for match in PRINTING_OR_ENDING.finditer(cpp_code(text)))
    if name.endswith(CODE_SUFFIXES):
        yield from ((match.start(), f"{len(match.group())} columns, more than 120") for match in TOO_WIDE.finditer(text))
    for match in CITATION.finditer(text):
        yield from ((match.start(), f"[{key}] is not in {BIBLIOGRAPHY}") for key in re.findall(KEY, match.group()) if key not in known)
    for match in OWN_FILE.finditer(text):
        if not (root / match.group()).exists():
            yield match.start(), f"{match.group()} does not exist"
    if name.endswith(".md"):
        yield from _link_faults(root, name, text)
    if name.startswith("docs/algorithms/"):
        for match in NAME_OF_TESTS.finditer(text):
            if not fnmatch.filter(tests, match[1].replace("…", "*")):
                yield match.start(), f"there are no tests called {match[1]}"
    if name.endswith((*CODE_SUFFIXES, ".py")) and text.count("\n") > MOST_LINES:
        yield len(text), f"more than {MOST_LINES} lines"


def check(root: Path) -> list[str]:
    ours = {name: text for name, text in texts(root, suffixes=TEXT_SUFFIXES) if name not in NAME_WHAT_IS_LOOKED_FOR}
    entries = ENTRY.findall(ours.get(BIBLIOGRAPHY, ""))
    cited = {key for text in ours.values() for found in CITATION.findall(text) for key in re.findall(KEY, found)}
    tests = {".".join(test) for name, text in ours.items() if name.startswith("tests/") for test in TEST.findall(text)}
    idle = [key for key in sorted(set(entries)) if key not in cited or entries.count(key) > 1]
    return [f"{BIBLIOGRAPHY}:1: {key} is cited nowhere, or defined twice" for key in idle] + [
        finding(name, text, at, what) for name, text in ours.items() for at, what in _faults(root, name, text, entries, tests)
    ]


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
