#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Nothing is left unfinished, the library is silent, and what sources and pages refer to exists."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from repository import CPP_SUFFIXES, Finding, cpp_code, files, line_at, run, shown, text_of

MOST_LINES = 800
CODE_SUFFIXES = (*CPP_SUFFIXES, ".ts", ".mjs", ".js")
TEXT_SUFFIXES = (*CODE_SUFFIXES, ".py", ".sh", ".cmake", ".md", ".bib", "CMakeLists.txt", "dev", ".ci/run")
BIBLIOGRAPHY = "docs/references.bib"

UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
PRINTING_OR_ENDING = re.compile(
    r"\bstd::(?:cout|cerr|clog|print|println)\b|#include <iostream>|\b(?:v?f?printf|f?puts|f?putc|putchar|perror)\("
    r"|(?<![\w.>])(?:std::)?(?:abort|exit|_Exit|quick_exit|terminate)\(|(?<!\w)assert\("
)
TOO_WIDE = re.compile(r"^.{121,}$", re.MULTILINE)  # clang-format sees to code, not to comments: it would tear them apart
_KEY = r"[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?"
CITATION = re.compile(rf"\[({_KEY}(?:[,;] *{_KEY})*)\]")
OWN_FILE = re.compile(
    r"(?<![\w/.<>*-])(?:docs|include|src|scenes|clients|tests|bench|examples|tools)/[\w./-]*\.(?:md|bib|h|cpp|py|csv|svg|png)\b"
)
CODE = re.compile(r"^[ \t]*(```|~~~).*?^[ \t]*\1[^\n]*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)  # of a page
LINK = re.compile(r"\]\(\s*<?([^()\s<>]+)|^[ \t]*\[[^\]\n]+\]:[ \t]+(\S+)|\b(?:src|href)=\"([^\"]+)\"", re.MULTILINE)


def _anchors(text: str) -> set[str]:
    """The anchors that a page gets for its headings."""
    headings = re.findall(r"^#{1,6}[ \t]+(.*?)[ \t]*#*$", text, re.MULTILINE)
    anchors = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
    return anchors | set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))


def _link_faults(root: Path, name: str, text: str) -> Iterator[tuple[int, str]]:
    prose = CODE.sub(lambda code: re.sub(r"[^\n]", " ", code.group()), text)
    for match in LINK.finditer(prose):
        target = next(group for group in match.groups() if group)
        place, _, anchor = unquote(target).partition("#")
        page = ((root / name).parent / place if place else root / name).resolve()
        if re.match(r"[a-z][a-z0-9+.-]*:", target, re.IGNORECASE):
            continue
        if not page.is_relative_to(root.resolve()) or not page.exists():
            yield match.start(), f"link {target} leads nowhere"
        elif anchor and page.suffix == ".md" and anchor not in _anchors(text_of(page)):
            yield match.start(), f"link {target}: there is no such heading"


def _faults(root: Path, name: str, text: str, known: set[str]) -> Iterator[tuple[int, str]]:
    """Where a file is at fault, and how."""
    code = cpp_code(text) if name.startswith("src/") and name.endswith(CPP_SUFFIXES) else ""
    wide = TOO_WIDE.finditer(text) if name.endswith(CODE_SUFFIXES) else ()
    yield from ((match.start(), f"{match.group()} is to be finished") for match in UNFINISHED.finditer(text))
    yield from ((match.start(), f"{match.group()}: a library") for match in PRINTING_OR_ENDING.finditer(code))
    yield from ((match.start(), f"{len(match.group())} columns, more than 120") for match in wide)
    for match in CITATION.finditer(text):
        for key in set(re.findall(_KEY, match.group(1))) - known:
            yield match.start(), f"[{key}] is not in {BIBLIOGRAPHY}"
    for match in OWN_FILE.finditer(text):
        if not (root / match.group()).exists():
            yield match.start(), f"{match.group()} does not exist"
    if name.endswith(".md"):
        yield from _link_faults(root, name, text)
    if name.endswith((*CODE_SUFFIXES, ".py")) and text.count("\n") > MOST_LINES:
        yield len(text), f"more than {MOST_LINES} lines"


def check(root: Path) -> list[Finding]:
    texts = {shown(root, path): text_of(path) for path in files(root, suffixes=TEXT_SUFFIXES)}
    # These two have to name what they look for.
    texts = {name: text for name, text in texts.items() if name not in ("tools/check_text.py", "tools/test_tools.py")}
    entries = re.findall(r"^[ \t]*@(?!comment|string)\w+[ \t]*\{[ \t]*([^,\s]+)", texts.get(BIBLIOGRAPHY, ""), re.MULTILINE)
    cited = {key for text in texts.values() for found in CITATION.findall(text) for key in re.findall(_KEY, found)}
    idle = [key for key in set(entries) if key not in cited or entries.count(key) > 1]
    return [Finding(BIBLIOGRAPHY, 1, f"{key} is cited nowhere, or defined twice") for key in idle] + [
        Finding(name, line_at(text, at), what)
        for name, text in texts.items() for at, what in _faults(root, name, text, set(entries))
    ]  # fmt: skip


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
