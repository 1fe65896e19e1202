#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What sources and pages refer to exists: bibliography keys, our own files, links between pages, tests of peers' bugs."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from urllib.parse import unquote

from repository import Finding, files, line_at, run, shown, text_of

BIBLIOGRAPHY = "docs/references.bib"
PEERS = "docs/peers.md"
CONTENTS = "docs/site/contents.md"
READ_SUFFIXES = (".h", ".cpp", ".py", ".md", ".cmake", "CMakeLists.txt")
NOT_READ = ("tools/test_tools.py",)  # makes up references that lead nowhere

_KEY = r"[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?"
CITATION = re.compile(rf"\[({_KEY}(?:[,;] *{_KEY})*)\]")
ENTRY = re.compile(r"^[ \t]*@(\w+)[ \t]*\{[ \t]*([^,\s]+)[ \t]*,", re.MULTILINE)
OWN_FILE = re.compile(
    r"(?<![\w/.<>*-])((?:docs|include|src|scenes|apps|tests|bench|examples|tools)/[\w./-]*\.(?:md|bib|h|cpp|py|csv|svg|png))\b"
)
FENCE = re.compile(r"^[ \t]*(```|~~~).*?^[ \t]*\1[^\n]*$", re.MULTILINE | re.DOTALL)
CODE_SPAN = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\]\(\s*<?([^()\s<>]+)>?(?:\s+\"[^\"]*\")?\s*\)|^[ \t]*\[[^\]\n]+\]:[ \t]+(\S+)|\b(?:src|href)=\"([^\"]+)\"",
                  re.MULTILINE)
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)
HEADING = re.compile(r"^#{1,6}[ \t]+(.*?)[ \t]*#*$", re.MULTILINE)


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match.group())


def check_citations(root: Path, texts: dict[str, str]) -> list[Finding]:
    findings, entries, cited = [], dict[str, int](), set[str]()
    bibliography = root / BIBLIOGRAPHY
    if bibliography.is_file():
        text = text_of(bibliography)
        for match in ENTRY.finditer(text):
            kind, key = match.group(1).lower(), match.group(2)
            if kind in ("comment", "string", "preamble"):
                continue
            if key in entries:
                findings.append(Finding(BIBLIOGRAPHY, line_at(text, match.start()), f"{key} is defined twice"))
            entries[key] = line_at(text, match.start())
    for name, text in texts.items():
        for match in CITATION.finditer(text):
            for key in re.findall(_KEY, match.group(1)):
                cited.add(key)
                if key not in entries:
                    findings.append(Finding(name, line_at(text, match.start()), f"[{key}] is not in {BIBLIOGRAPHY}"))
    findings += [
        Finding(BIBLIOGRAPHY, line, f"{key} is cited nowhere") for key, line in entries.items() if key not in cited
    ]
    return findings


def check_own_files(root: Path, texts: dict[str, str]) -> list[Finding]:
    return [
        Finding(name, line_at(text, match.start()), f"{match.group(1)} does not exist")
        for name, text in texts.items()
        for match in OWN_FILE.finditer(text)
        if not (root / match.group(1)).exists()
    ]


def _anchors(text: str) -> set[str]:
    """The anchors a page gets for its headings."""
    anchors = set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))
    for heading in HEADING.findall(FENCE.sub(_blank, text)):
        plain = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        count = 0
        while (slug := plain if count == 0 else f"{plain}-{count}") in anchors:
            count += 1
        anchors.add(slug)
    return anchors


def check_links(root: Path, texts: dict[str, str]) -> list[Finding]:
    findings = []
    for name, text in texts.items():
        if not name.endswith(".md"):
            continue
        prose = CODE_SPAN.sub(_blank, FENCE.sub(_blank, text))
        for match in LINK.finditer(prose):
            target = next(group for group in match.groups() if group)
            if ELSEWHERE.match(target):
                continue
            place, _, anchor = unquote(target).partition("#")
            page = ((root / name).parent / place).resolve() if place else (root / name).resolve()
            line = line_at(prose, match.start())
            if not page.is_relative_to(root.resolve()):
                findings.append(Finding(name, line, f"link {target} leads out of the repository"))
            elif not page.exists():
                findings.append(Finding(name, line, f"link {target} leads nowhere"))
            elif anchor and page.suffix == ".md" and anchor not in _anchors(text_of(page)):
                findings.append(Finding(name, line, f"link {target}: there is no such heading"))
    return findings


def check_contents(root: Path, texts: dict[str, str]) -> list[Finding]:
    """Each entry of the site's contents is a page with a title. Pages of api/ are generated, so they are left out."""
    findings = []
    for match in re.finditer(r"^(?:docs|bench|python|tests|[A-Z]+\b)[\w/*]*$", texts.get(CONTENTS, ""), re.MULTILINE):
        pages = list(root.glob(match.group() + ".md"))
        line = line_at(texts[CONTENTS], match.start())
        findings += [] if pages else [Finding(CONTENTS, line, f"there is no page {match.group()}")]
        for page in pages:
            if not re.match(r"\s*#+ ", re.sub(r"<!--.*?-->", "", text_of(page), flags=re.DOTALL)):
                findings.append(Finding(shown(root, page), 1, "a page begins with a title"))
    return findings


def check_peers(texts: dict[str, str]) -> list[Finding]:
    """The page of other libraries' bugs and the tests name the same tests and threads, and the page counts them."""
    if PEERS not in texts:
        return []
    page, sources = texts[PEERS], "\n".join(text for name, text in texts.items() if name.startswith("tests/peers/"))
    tests = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST\((\w+), (\w+)\)", sources, re.MULTILINE)}
    named, threads, right, others = set[str](), list[str](), 0, 0
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        numbers = re.findall(r"#(\d+)", cells[0]) if cells else []
        if len(cells) == 4 and cells[2].startswith("`"):
            named.add(cells[2].strip("`"))
            threads += numbers
            right += len(numbers) if cells[3].startswith("right") else 0
        else:
            others += len(numbers)
    counts = f"Asked: {len(threads)} threads, {len(tests)} tests. Right: {right}. Not askable: {others} threads."
    wrong = [f"{test} is not both on this page and in tests/peers" for test in sorted(named ^ tests)]
    wrong += [f"#{n} is not on both" for n in sorted(set(threads) ^ set(re.findall(r"#(\d+)", sources)))]
    wrong += [] if counts in page else [f"wrong counts; right are: {counts}"]
    return [Finding(PEERS, 1, text) for text in wrong]


def check(root: Path) -> list[Finding]:
    texts = {shown(root, path): text_of(path) for path in files(root, suffixes=READ_SUFFIXES)}
    for name in NOT_READ:
        texts.pop(name, None)
    findings = check_citations(root, texts) + check_own_files(root, texts) + check_links(root, texts)
    return findings + check_contents(root, texts) + check_peers(texts)


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
