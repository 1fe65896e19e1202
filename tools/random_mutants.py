#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Breaks the sources in places drawn at random, one at a time, and says which faults the tests do not notice.

A survivor is not always a gap in the tests: the fault may only cost time, or change nothing. So survivors are read by
a person, and the exit status is 0 whatever survives; it is 2 if nothing can be said, as in mutants.py.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import random
import re
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import mutants
from repository import CPP_SUFFIXES, cpp_code, line_at

OPERATORS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/",
             "/": "*", "&&": "||", "||": "&&"}
LARGEST_INTEGER = 16  # larger ones are sizes, where one more or less hardly matters
NOT_BUILT = "src/simd/wasm_*"  # but by the JavaScript package

# Clang-format puts spaces around binary operators, and not around references, pointers and lists of types.
OPERATOR = re.compile(r"(?<= )(?:[<>=!]=|&&|\|\||[-<>+*/])(?=\s)")
NUMBER = re.compile(
    r"(?<![\w.'])(?P<digits>0x[\da-fA-F.]+p[-+]?\d+|\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+|\d+(?![\w.']*[.'x]))"
    r"(?P<suffix>[fFuUlL]*)(?![\w.'])")
MIN_OR_MAX = re.compile(r"(?<!>::)\b(?P<name>min|max)(?=[(])")
ASSIGNMENT = re.compile(r"(?m)^ +(?P<statement>[^\s;]+ (?:[-+*/|&^]|<<|>>)?= [^;{}]*;)$")
CONDITION = re.compile(r"\b(?:if|while) (?=[(])")
# What is declared or checked, and what does nothing in a release.
CHECK = re.compile(r"\b(?:static_assert|LIMBER_ASSERT|LIMBER_VALIDATE|alignas|requires) ?(?=[(])")
ARRAYS = r"(?:(?:static|inline|constexpr|const) )*(?!return )[\w:<>]+ \w+\[[^={}]*;"
ARRAY = r"(?<=[\w>*] )\w+(?:\[\w+\])+(?= = |\{)"  # with values
DECLARATION = re.compile(rf"(?m)^ *(?:#.*|template <.*|{ARRAYS} *)$|{ARRAY}|<[\w:, ]*\b\d+>")


@dataclass(frozen=True)
class Mutation(mutants.Mutant):
    """A mutant of one place of a file, where its text is `find`."""

    at: int

    def applied_to(self, text: str) -> str:
        end = self.at + len(self.find)
        if text[self.at : end] != self.find:
            raise mutants.Unusable(f"{self.name}: the file has changed")
        return text[: self.at] + self.replace + text[end:]


def _closing(code: str, opening: int) -> int:
    """The place of the parenthesis that closes the one at `opening`."""
    depth = 0
    for match in re.compile(r"[()]").finditer(code, opening):
        depth += 1 if match.group() == "(" else -1
        if depth == 0:
            return match.start()
    return len(code) - 1


def _statements(text: str) -> str:
    """A source with everything blanked out that is not mutated; every character keeps its place."""
    code = cpp_code(text)
    for check in CHECK.finditer(code):
        end = _closing(code, check.end()) + 1
        code = code[: check.start()] + re.sub(r"[^\n]", " ", code[check.start() : end]) + code[end:]
    return DECLARATION.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), code)


def _changed_number(digits: str, suffix: str) -> list[str]:
    if not digits.isdigit():
        is_zero = float.fromhex(digits) == 0 if digits.startswith("0x") else float(digits) == 0
        return ["1.0" + suffix] if is_zero else [f"({factor}{suffix} * {digits}{suffix})" for factor in ("0.25", "4.0")]
    if int(digits) > LARGEST_INTEGER:
        return []
    return [f"{n}{suffix}" for n in (int(digits) - 1, int(digits) + 1) if n >= 0]


def changes(text: str) -> Iterator[tuple[int, str, str]]:
    """All places of a source that can be changed: where, what is there, and what replaces it."""
    code = _statements(text)
    for found in OPERATOR.finditer(code):
        yield found.start(), found.group(), OPERATORS[found.group()]
    for found in NUMBER.finditer(code):
        for new in _changed_number(found["digits"], found["suffix"]):
            yield found.start(), found.group(), new
    for found in MIN_OR_MAX.finditer(code):
        if not re.search(r"(?<!\breturn)[\w>&*] $", code[: found.start()][-20:]):  # not where it is defined
            yield found.start(), found["name"], "max" if found["name"] == "min" else "min"
    for found in ASSIGNMENT.finditer(code):
        yield found.start("statement"), text[found.start("statement") : found.end("statement")], ";"
    for found in CONDITION.finditer(code):
        end = _closing(code, found.end())
        if not re.search(r";| = ", code[found.end() : end]):
            condition = text[found.end() : end + 1]
            yield found.end(), condition, f"(!{condition})"


def mutations(root: Path, patterns: list[str]) -> list[Mutation]:
    """Every mutation of the sources that fit a pattern."""
    found: dict[str, Mutation] = {}
    for path in sorted((root / "src").rglob("*")):
        file = path.relative_to(root).as_posix()
        is_wanted = path.suffix in CPP_SUFFIXES and any(fnmatch.fnmatchcase(file, pattern) for pattern in patterns)
        if not is_wanted or fnmatch.fnmatchcase(file, NOT_BUILT):
            continue
        tests = ("io",) if file.startswith("src/io/") else mutants.DEFAULT_TESTS
        text = path.read_text(encoding="utf-8")
        for at, old, new in changes(text):
            place = f"{file}:{line_at(text, at)}:{at - text.rfind(chr(10), 0, at)}"
            name = f"{place}: {' '.join(old.split())} becomes {' '.join(new.split())}"
            found[name] = Mutation(name, file, old, new, tests, at)
    return list(found.values())


def draw(candidates: list[Mutation], count: int, seed: int) -> list[Mutation]:
    """Some of the candidates, those of one file next to each other."""
    chosen = random.Random(seed).sample(candidates, min(count, len(candidates)))
    return sorted(chosen, key=lambda mutation: (mutation.file, mutation.at))


def report(mutant: mutants.Mutant, verdict: mutants.Verdict, seconds: float) -> None:
    became = {True: "noticed", False: "SURVIVED", None: "not compiled"}[verdict.noticed]
    by = f", by {verdict.text}" if verdict.noticed else ""
    print(f"{became:<12}  {mutant.name}{by}, {seconds:.0f} s", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description="Breaks the sources in places drawn at random.")
    parser.add_argument("count", nargs="?", type=int, default=50, help="how many mutations")
    parser.add_argument("files", nargs="*", help="patterns such as 'src/pair/*'; all of src if there is none")
    parser.add_argument("--seed", type=int, default=int(time.strftime("%Y%m%d")), help="of the drawing; today's date")
    parser.add_argument("--list", action="store_true", help="only list what is drawn")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="of the compiler")
    arguments = parser.parse_args()
    candidates = mutations(mutants.ROOT, arguments.files or ["*"])
    chosen = draw(candidates, arguments.count, arguments.seed)
    print(f"{len(chosen)} of {len(candidates)} mutations, --seed {arguments.seed}", flush=True)
    if arguments.list:
        for mutation in chosen:
            print(mutation.name)
        return 0
    try:
        shop = mutants.Workshop(mutants.ROOT / "build" / "mutants", arguments.jobs)
        shop.prepare()
        mutants.baseline(shop, chosen)
        verdicts = mutants.run(shop, chosen, report).values()
    except mutants.Unusable as reason:
        print(f"random_mutants: {reason}", file=sys.stderr)
        return 2
    noticed, survived = (sum(verdict.noticed is wanted for verdict in verdicts) for wanted in (True, False))
    print(f"{noticed} noticed, {survived} survived, {len(verdicts) - noticed - survived} not compiled")
    return 0


if __name__ == "__main__":
    sys.exit(main())
