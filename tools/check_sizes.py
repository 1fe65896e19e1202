#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Files stay short; the library stays checked and silent."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from repository import CPP_SUFFIXES, Finding, cpp_code, files, line_at, run, shown, text_of

USUAL_LINES = 400  # at least USUAL_SHARE of the source files are not longer
USUAL_SHARE = 0.9
MOST_LINES = 800  # none is longer
MOST_COLUMNS = 120  # clang-format sees to code, not to comments: it would tear labelled ones apart
CHECKS_WANTED = 10.0  # LIMBER_ASSERT, LIMBER_REQUIRE and LIMBER_VALIDATE per thousand lines of src; fewer are a warning
CHECKS_REQUIRED = 10.0  # fewer are an error; only ever raised

SOURCES = ("include", "src", "scenes", "apps", "tests", "bench", "examples", "fuzz", "python", "tools", "web")
WEB_SUFFIXES = (".ts", ".mjs", ".js")
TEXT_SUFFIXES = CPP_SUFFIXES + WEB_SUFFIXES + (".py", ".sh", ".cmake", ".cff", ".md", ".bib")
TEXT_NAMES = ("CMakeLists.txt", "dev", ".ci/run")
TEXT_NAMES += (".clang-format", ".clang-tidy", ".editorconfig", ".gitignore", ".shellcheckrc")
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b(?!\(#\d+\))")
PRINTING = re.compile(
    r"\bstd\s*::\s*(?:cout|cerr|clog|wcout|wcerr|wclog|print|println)\b"
    r"|\b(?:v?f?printf|f?puts|f?putc|putchar|perror)\s*\(|#\s*include\s*<iostream>"
)
ENDING = re.compile(r"(?<![\w.>])(?:std\s*::\s*)?(?:abort|exit|_Exit|quick_exit|terminate)\s*\(|(?<!\w)assert\s*\(")
CHECK = re.compile(r"\bLIMBER_(?:ASSERT|REQUIRE|VALIDATE)\s*\(")


def _length(path: Path) -> int:
    return len(text_of(path).splitlines())


def check_lengths(root: Path) -> list[Finding]:
    lengths = {path: _length(path) for path in files(root, *SOURCES, suffixes=CPP_SUFFIXES + WEB_SUFFIXES + (".py",))}
    long = {path: length for path, length in lengths.items() if length > USUAL_LINES}
    findings = [
        Finding(shown(root, path), length, f"{length} lines, the most allowed are {MOST_LINES}")
        for path, length in long.items()
        if length > MOST_LINES
    ]
    if len(long) > (1 - USUAL_SHARE) * len(lengths):
        findings += [
            Finding(shown(root, path), length, f"{length} lines; {len(long)} of {len(lengths)} files exceed {USUAL_LINES}")
            for path, length in long.items()
        ]
    print(f"sizes: {len(lengths)} source files, {sum(lengths.values())} lines, {len(long)} above {USUAL_LINES}")
    return findings


def check_checks(root: Path) -> list[Finding]:
    lines = checks = 0
    for path in files(root, "src", suffixes=CPP_SUFFIXES):
        text = text_of(path)
        lines += len(text.splitlines())
        checks += sum(
            len(CHECK.findall(line)) for line in cpp_code(text).splitlines() if not re.match(r"\s*#\s*define\b", line)
        )
    density = 1000 * checks / lines if lines else CHECKS_WANTED
    remark = "" if density >= CHECKS_WANTED else f"; warning: {CHECKS_WANTED:g} are wanted"
    print(f"sizes: {checks} checks in {lines} lines of src, {density:.1f} per thousand{remark}")
    if lines and density < CHECKS_REQUIRED:
        return [Finding("src", 1, f"{density:.1f} checks per thousand lines, at least {CHECKS_REQUIRED:g} are required")]
    return []


def check_text(root: Path) -> list[Finding]:
    findings = []

    def note(path: Path, text: str, pattern: re.Pattern[str], why: str) -> None:
        for match in pattern.finditer(text):
            findings.append(Finding(shown(root, path), line_at(text, match.start()), f"{match.group().strip()}: {why}"))

    for path in files(root):
        name = shown(root, path)
        if not (name.endswith(TEXT_SUFFIXES) or path.name in TEXT_NAMES or name in TEXT_NAMES):
            continue
        text = text_of(path)
        if not name.startswith("tools/"):  # which have to name what they look for
            note(path, text, UNFINISHED, "finish it, or name its issue as in TODO(#1)")
        if path.suffix in CPP_SUFFIXES + WEB_SUFFIXES:
            findings += [
                Finding(name, i, f"{len(line)} columns, the most allowed are {MOST_COLUMNS}")
                for i, line in enumerate(text.splitlines(), 1)
                if len(line) > MOST_COLUMNS
            ]
        if name.startswith("src/") and path.suffix in CPP_SUFFIXES:
            note(path, cpp_code(text), PRINTING, "the library never prints")
            note(path, cpp_code(text), ENDING, "the library never ends the process; preconditions are LIMBER_ASSERT")
    return findings


def check(root: Path) -> list[Finding]:
    return check_lengths(root) + check_checks(root) + check_text(root)


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
