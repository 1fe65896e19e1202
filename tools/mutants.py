#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Breaks the code in the places that mutants.toml lists, one at a time; the tests must notice every one of them.

With --random, in places drawn from all sources. A survivor is then not always a gap in the tests: the fault may only
cost time, or change nothing. So a person reads survivors, and the exit status does not tell of them.

Everything happens in a copy below build/mutants, which is built with light optimisation, checks on, and kernels for
all instruction sets.

Exit status: 0 if every mutant was noticed, 1 if one survived or does not compile, 2 if nothing can be said: the
table is stale, or the tests fail without any mutant.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import random
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from repository import CPP_SUFFIXES, blank, cpp_code, finding, texts

ROOT = Path(__file__).resolve().parent.parent
SOURCE, BUILD = ROOT / "build/mutants/source", ROOT / "build/mutants/build"
COPIED = ("CMakeLists.txt", "README.md", "clients", "cmake", "docs/guide", "examples", "fuzz", "include", "scenes", "src",
          "tests")
DEFAULT_TESTS = ("unit", "property", "oracle")  # of a mutant that names none
MUTANT_KEYS = {"name", "file", "find", "replace", "tests"}
TIMEOUT_S = 300.0  # for the tests of one executable; a hang counts as noticed
MEMORY_BYTES = 6 << 30  # of that; a fault that fills the memory must not take the machine with it
OPTIONS = ("-DCMAKE_CXX_FLAGS=-O1", "-DCMAKE_BUILD_TYPE=None", "-DLIMBER_CHECKS=ON", "-DLIMBER_INSTALL=OFF",
           "-DLIMBER_BUILD_TESTS=ON")
PROPERTY_RUNS = "max_success=1000 seed=1 noshrink=1"

# What --random changes, and what to.
OPERATORS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+", "*": "/",
             "/": "*", "&&": "||", "||": "&&"}
LARGEST_INTEGER = 16  # larger ones are sizes, where one more or less hardly matters
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


class Unusable(Exception):
    """Why nothing can be said about any mutant."""


@dataclass(frozen=True)
class Mutant:
    name: str
    file: str
    find: str
    replace: str
    tests: tuple[str, ...] = DEFAULT_TESTS  # executable, or executable:filter
    at: int | None = None  # where the text to be replaced is, if it may occur more than once

    def applied_to(self, text: str) -> str:
        at = text.find(self.find) if self.at is None else self.at
        if not text.startswith(self.find, at) or (self.at is None and text.count(self.find) > 1):
            raise Unusable(f"{self.name}: the text to be replaced is not there, or more than once, in {self.file}")
        return text[:at] + self.replace + text[at + len(self.find) :]

    def executables(self) -> set[str]:
        return {test.partition(":")[0] for test in self.tests}


def load(table: Path, root: Path) -> list[Mutant]:
    """The mutants of a table, those of one file next to each other. Raises Unusable if one does not fit the sources."""
    entries = tomllib.loads(table.read_text(encoding="utf-8"))["mutant"]
    for entry in entries:
        if not entry.keys() <= MUTANT_KEYS or entry["find"] == entry["replace"]:
            raise Unusable(f"{entry.get('name')}: unknown keys, or nothing is replaced")
    mutants = [Mutant(**{**entry, "tests": tuple(entry.get("tests", DEFAULT_TESTS))}) for entry in entries]
    if len({mutant.name for mutant in mutants}) < len(mutants):
        raise Unusable("two mutants have one name")
    tests = "\n".join(path.read_text(encoding="utf-8") for at in ("tests", "clients/program/tests")
                      for path in (root / at).rglob("*.cpp"))
    for mutant in mutants:
        if not (root / mutant.file).is_file():
            raise Unusable(f"{mutant.name}: there is no {mutant.file}")
        mutant.applied_to((root / mutant.file).read_text(encoding="utf-8"))
        for suite in re.findall(r"[:-](\w+)\.", " ".join(mutant.tests)):
            if not re.search(rf"\b{suite}\b", tests):
                raise Unusable(f"{mutant.name}: there are no tests called {suite}")
    return sorted(mutants, key=lambda mutant: mutant.file)


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
        code = code[: check.start()] + blank(code[check.start() : end]) + code[end:]
    return DECLARATION.sub(lambda found: blank(found.group()), code)


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


def mutations(root: Path, patterns: list[str]) -> list[Mutant]:
    """Every mutation of the sources that fit a pattern."""
    found = []
    for file, text in texts(root, "src", suffixes=CPP_SUFFIXES):
        if not any(fnmatch.fnmatchcase(file, pattern) for pattern in patterns):
            continue
        tests = ("io",) if file.startswith("src/io/") else DEFAULT_TESTS
        for at, old, new in changes(text):
            change = f"{' '.join(old.split())} becomes {' '.join(new.split())}"
            found.append(Mutant(finding(file, text, at, change), file, old, new, tests, at))
    return found


def draw(candidates: list[Mutant], count: int, seed: int) -> list[Mutant]:
    """Some of the candidates, those of one file next to each other."""
    chosen = random.Random(seed).sample(candidates, min(count, len(candidates)))
    return sorted(chosen, key=lambda mutation: (mutation.file, mutation.at))


def _run(command: Iterable[object], timeout: float | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", timeout=timeout, check=False, cwd=ROOT,
                          env={**os.environ, "RC_PARAMS": PROPERTY_RUNS})


def _do(command: Iterable[object]) -> None:
    if (done := _run(command)).returncode != 0:
        raise Unusable(done.stdout)


def _executable(name: str) -> Path:
    return BUILD / f"tests/limber_{name}_tests"


def build(executables: Iterable[str]) -> None:
    _do(["cmake", "--build", BUILD, "--target", *(f"limber_{name}_tests" for name in sorted(executables))])


def noticed_by(tests: Iterable[str]) -> str:
    """The first test that fails; none if all pass."""
    for name, _, filter_of_it in (test.partition(":") for test in tests):
        command = ["prlimit", f"--as={MEMORY_BYTES}", _executable(name), f"--gtest_filter={filter_of_it or '*'}",
                   "--gtest_fail_fast", "--gtest_color=no"]
        try:
            done = _run(command, TIMEOUT_S)
            status, output = done.returncode, done.stdout
        except subprocess.TimeoutExpired as expired:
            status, output = 1, (expired.stdout or b"").decode(errors="replace")
        if status != 0:
            failed = re.findall(r"^\[  FAILED  \] ([\w./]+)", output, re.MULTILINE)
            started = re.findall(r"^\[ RUN      \] ([\w./]+)", output, re.MULTILINE)
            return f"{name} {failed[0]}" if failed else f"a crash or hang of {name} {started[-1:]}"
    return ""


def prepare(mutants: list[Mutant]) -> None:
    """Copies, configures and builds the sources. All tests that mutants name must be there, and must pass."""
    SOURCE.mkdir(parents=True, exist_ok=True)
    _do(["rsync", "-rcR", "--delete", "--exclude=node_modules", "--exclude=__pycache__", *COPIED, SOURCE])
    launcher = shutil.which("ccache") or ""
    _do(["cmake", "-S", SOURCE, "-B", BUILD, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", *OPTIONS])
    build({name for mutant in mutants for name in mutant.executables()})
    filters: dict[str, set[str]] = {}
    for name, _, filter_of_it in (test.partition(":") for mutant in mutants for test in mutant.tests):
        filters.setdefault(name, set()).update((filter_of_it or "*").split(":"))
    for name, patterns in filters.items():
        for pattern in patterns:
            if "\n  " not in _run([_executable(name), f"--gtest_filter={pattern}", "--gtest_list_tests"]).stdout:
                raise Unusable(f"no test of {name} is called {pattern}")
    if failed := noticed_by(f"{name}:{':'.join(patterns)}" for name, patterns in filters.items()):
        raise Unusable(f"without any mutant the tests fail: {failed}")


def verdict_on(mutant: Mutant) -> str:
    """Builds and tests a mutant: whether it was noticed, SURVIVED, or is INVALID, and why."""
    path, original = SOURCE / mutant.file, (ROOT / mutant.file).read_text(encoding="utf-8")
    path.write_text(mutant.applied_to(original), encoding="utf-8")
    try:
        build(mutant.executables())
        failed = noticed_by(mutant.tests)
        return f"noticed   {mutant.name}: by {failed}" if failed else f"SURVIVED  {mutant.name} in {mutant.file}"
    except Unusable as reason:
        return f"INVALID   {mutant.name}: it does not compile" + (f"\n{reason}" if mutant.at is None else "")
    finally:
        path.write_text(original, encoding="utf-8")


def chosen_mutants(arguments: argparse.Namespace) -> list[Mutant]:
    """Those of the table, or at random, that the command line asks for."""
    patterns = arguments.names or ["*"]
    if arguments.random:
        chosen = draw(mutations(ROOT, patterns), arguments.random, arguments.seed)
        print(f"{len(chosen)} mutations, --seed {arguments.seed}", flush=True)
    else:
        every = load(Path(__file__).with_suffix(".toml"), ROOT)
        print(f"{len(every)} mutants fit the sources", flush=True)
        chosen = [m for m in every if any(fnmatch.fnmatchcase(m.name, pattern) for pattern in patterns)]
    if not chosen:
        raise Unusable(f"no mutant is called {' or '.join(patterns)}")
    return chosen


def main() -> int:
    parser = argparse.ArgumentParser(description="Breaks the code place by place; the tests must notice.")
    parser.add_argument("names", nargs="*", help="mutants, or patterns such as 'simd-*'; with --random files, as 'src/io/*'")
    parser.add_argument("--random", type=int, metavar="N", help="draw N places from the sources")
    parser.add_argument("--seed", type=int, default=int(time.strftime("%Y%m%d")), help="of the drawing; today's date")
    parser.add_argument("--check", action="store_true", help="only say whether every mutant fits the sources")
    arguments = parser.parse_args()
    try:
        chosen = chosen_mutants(arguments)
        if arguments.check:
            return 0
        prepare(chosen)
        print("the tests pass without any mutant", flush=True)
    except Unusable as reason:
        print(f"mutants: {reason}", file=sys.stderr)
        return 2
    count = 0
    for mutant in chosen:
        verdict = verdict_on(mutant)
        print(verdict, flush=True)
        count += verdict.startswith("noticed")
    print(f"{len(chosen)} mutants, {count} noticed")
    return 0 if arguments.random or count == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
