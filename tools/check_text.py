#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files stay short, nothing is left unfinished, the library is silent, and what sources and pages refer to exists."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from repository import CPP_SUFFIXES, Finding, cpp_code, files, line_at, run, shown, text_of

USUAL_LINES, USUAL_SHARE = 400, 0.9  # at least this share of the source files are not longer
MOST_LINES = 800
MOST_COLUMNS = 120  # clang-format sees to code, not to comments: it would tear labelled ones apart

CODE_SUFFIXES = CPP_SUFFIXES + (".ts", ".mjs", ".js")
TEXT_SUFFIXES = CODE_SUFFIXES + (".py", ".sh", ".cmake", ".md", ".bib", "CMakeLists.txt", "dev", ".ci/run")
BIBLIOGRAPHY = "docs/references.bib"

UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b(?!\(#\d+\))")
PRINTING = re.compile(
    r"\bstd\s*::\s*(?:cout|cerr|clog|print|println)\b|#\s*include\s*<iostream>"
    r"|\b(?:v?f?printf|f?puts|f?putc|putchar|perror)\s*\("
)
ENDING = re.compile(r"(?<![\w.>])(?:std\s*::\s*)?(?:abort|exit|_Exit|quick_exit|terminate)\s*\(|(?<!\w)assert\s*\(")
_KEY = r"[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?"
CITATION = re.compile(rf"\[({_KEY}(?:[,;] *{_KEY})*)\]")
OWN_FILE = re.compile(
    r"(?<![\w/.<>*-])(?:docs|include|src|scenes|clients|tests|bench|examples|tools)/[\w./-]*\.(?:md|bib|h|cpp|py|csv|svg|png)\b"
)
FENCE = re.compile(r"^[ \t]*(```|~~~).*?^[ \t]*\1[^\n]*$", re.MULTILINE | re.DOTALL)
CODE_SPAN = re.compile(r"`[^`\n]*`")
LINK = re.compile(
    r"\]\(\s*<?([^()\s<>]+)>?(?:\s+\"[^\"]*\")?\s*\)|^[ \t]*\[[^\]\n]+\]:[ \t]+(\S+)|\b(?:src|href)=\"([^\"]+)\"",
    re.MULTILINE,
)


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match.group())


def _anchors(text: str) -> set[str]:
    """The anchors that a page gets for its headings; the second of equal ones ends in -1."""
    anchors = set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))
    for heading in re.findall(r"^#{1,6}[ \t]+(.*?)[ \t]*#*$", FENCE.sub(_blank, text), re.MULTILINE):
        plain = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        anchors.add(plain if plain not in anchors else f"{plain}-1")
    return anchors


def _link_faults(root: Path, name: str, text: str) -> Iterator[tuple[int, str]]:
    prose = CODE_SPAN.sub(_blank, FENCE.sub(_blank, text))
    for match in LINK.finditer(prose):
        target = next(group for group in match.groups() if group)
        place, _, anchor = unquote(target).partition("#")
        page = ((root / name).parent / place).resolve() if place else (root / name).resolve()
        if re.match(r"[a-z][a-z0-9+.-]*:", target, re.IGNORECASE):
            continue
        if not page.is_relative_to(root.resolve()) or not page.exists():
            yield match.start(), f"link {target} leads nowhere"
        elif anchor and page.suffix == ".md" and anchor not in _anchors(text_of(page)):
            yield match.start(), f"link {target}: there is no such heading"


def _faults(root: Path, name: str, text: str, known: set[str]) -> Iterator[tuple[int, str]]:
    """Where a file is at fault, and how."""
    code = cpp_code(text) if name.startswith("src/") and name.endswith(CPP_SUFFIXES) else ""
    for pattern, searched, why in ((UNFINISHED, text, "finish it, or name its issue as in TODO(#1)"),
                                   (PRINTING, code, "the library never prints"),
                                   (ENDING, code, "the library never ends the process")):
        yield from ((match.start(), f"{match.group().strip()}: {why}") for match in pattern.finditer(searched))
    if name.endswith(CODE_SUFFIXES):
        for match in re.finditer(rf"^.{{{MOST_COLUMNS + 1},}}$", text, re.MULTILINE):
            yield match.start(), f"{len(match.group())} columns, the most allowed are {MOST_COLUMNS}"
    for match in CITATION.finditer(text):
        for key in re.findall(_KEY, match.group(1)):
            if key not in known:
                yield match.start(), f"[{key}] is not in {BIBLIOGRAPHY}"
    for match in OWN_FILE.finditer(text):
        if not (root / match.group()).exists():
            yield match.start(), f"{match.group()} does not exist"
    if name.endswith(".md"):
        yield from _link_faults(root, name, text)


def check(root: Path) -> list[Finding]:
    texts = {shown(root, path): text_of(path) for path in files(root, suffixes=TEXT_SUFFIXES)}
    # These two have to name what they look for.
    texts = {name: text for name, text in texts.items() if name not in ("tools/check_text.py", "tools/test_tools.py")}
    entries = re.findall(r"^[ \t]*@(?!comment|string)\w+[ \t]*\{[ \t]*([^,\s]+)", texts.get(BIBLIOGRAPHY, ""), re.MULTILINE)
    findings = [Finding(name, line_at(text, at), what)
                for name, text in texts.items() for at, what in _faults(root, name, text, set(entries))]
    cited = {key for text in texts.values() for match in CITATION.finditer(text) for key in re.findall(_KEY, match.group(1))}
    findings += [Finding(BIBLIOGRAPHY, 1, f"{key} is cited nowhere, or defined twice")
                 for key in set(entries) if key not in cited or entries.count(key) > 1]
    lengths = {name: text.count("\n") for name, text in texts.items() if name.endswith((*CODE_SUFFIXES, ".py"))}
    long = [name for name, length in lengths.items() if length > USUAL_LINES]
    too_many = len(long) > (1 - USUAL_SHARE) * len(lengths)
    return findings + [Finding(name, lengths[name], f"{lengths[name]} lines; {len(long)} of {len(lengths)} files exceed "
                               f"{USUAL_LINES}, and none may exceed {MOST_LINES}")
                       for name in long if too_many or lengths[name] > MOST_LINES]


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
