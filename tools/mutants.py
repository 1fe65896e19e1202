#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Breaks the code in the places that mutants.toml lists, one at a time; the tests must notice every one of them.

With --random, in places drawn from all sources. A survivor is then not always a gap in the tests: the fault may only
cost time, or change nothing. So a person reads survivors, and the exit status does not tell of them.

Everything happens in a copy below build/mutants, which is built with light optimisation, checks on, and kernels for
all instruction sets. While the tests of one mutant run, the next one is built.

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
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path

from random_faults import changes
from repository import CPP_SUFFIXES, line_at

ROOT = Path(__file__).resolve().parent.parent
COPIED = ("CMakeLists.txt", "README.md", "clients", "cmake", "docs/guide", "examples", "fuzz", "include", "scenes", "src",
          "tests")
DEFAULT_TESTS = ("unit", "property", "oracle")  # of a mutant that names none
MUTANT_KEYS = {"name", "file", "find", "replace", "tests"}
TESTED_AT_ONCE = 2  # mutants, while another one is built
TIMEOUT_S = 300.0  # for the tests of one executable; a hang counts as noticed
MEMORY_BYTES = 6 << 30  # of that; a fault that fills the memory must not take the machine with it
FLAGS = "-O1"  # kernels for all instruction sets: the one that needs no dispatch is scalar on most compilers
PROPERTY_RUNS = "max_success=1000 seed=1 noshrink=1"
NOT_BUILT = "src/simd/wasm_*"  # but by the JavaScript package


class Unusable(Exception):
    """Why nothing can be said about any mutant."""


@dataclass(frozen=True)
class Mutant:
    name: str
    file: str
    find: str
    replace: str
    tests: tuple[str, ...]  # executable, or executable:filter
    at: int | None = None  # where the text to be replaced is, if it may occur more than once

    def applied_to(self, text: str) -> str:
        if self.at is not None:
            end = self.at + len(self.find)
            if text[self.at : end] != self.find:
                raise Unusable(f"{self.name}: the file has changed")
            return text[: self.at] + self.replace + text[end:]
        count = text.count(self.find)
        if count != 1:
            raise Unusable(f"{self.name}: the text to be replaced occurs {count} times in {self.file}, not once")
        return text.replace(self.find, self.replace)

    def executables(self) -> list[str]:
        return sorted({test.partition(":")[0] for test in self.tests})


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant. `noticed` is None where it could not be built."""

    noticed: bool | None
    text: str


def load(table: Path) -> list[Mutant]:
    """The mutants of a table, those of one file next to each other."""
    with table.open("rb") as file:
        entries = tomllib.load(file)["mutant"]
    mutants = []
    for entry in entries:
        if not entry.keys() <= MUTANT_KEYS or entry["find"] == entry["replace"]:
            raise Unusable(f"{entry.get('name')}: unknown keys, or nothing is replaced")
        tests = tuple(entry.get("tests", DEFAULT_TESTS))
        mutants.append(Mutant(entry["name"], entry["file"], entry["find"], entry["replace"], tests))
    names = [mutant.name for mutant in mutants]
    for name in names:
        if names.count(name) > 1:
            raise Unusable(f"{name}: more than one mutant has this name")
    return sorted(mutants, key=lambda mutant: mutant.file)


def check(root: Path, mutants: Iterable[Mutant]) -> None:
    """Raises Unusable if a mutant does not fit the sources."""
    for mutant in mutants:
        path = root / mutant.file
        if not path.is_file():
            raise Unusable(f"{mutant.name}: there is no {mutant.file}")
        mutant.applied_to(path.read_text(encoding="utf-8"))


def mutations(root: Path, patterns: list[str]) -> list[Mutant]:
    """Every mutation of the sources that fit a pattern."""
    found: dict[str, Mutant] = {}
    for path in sorted((root / "src").rglob("*")):
        file = path.relative_to(root).as_posix()
        is_wanted = path.suffix in CPP_SUFFIXES and any(fnmatch.fnmatchcase(file, pattern) for pattern in patterns)
        if not is_wanted or fnmatch.fnmatchcase(file, NOT_BUILT):
            continue
        tests = ("io",) if file.startswith("src/io/") else DEFAULT_TESTS
        text = path.read_text(encoding="utf-8")
        for at, old, new in changes(text):
            place = f"{file}:{line_at(text, at)}:{at - text.rfind(chr(10), 0, at)}"
            name = f"{place}: {' '.join(old.split())} becomes {' '.join(new.split())}"
            found[name] = Mutant(name, file, old, new, tests, at)
    return list(found.values())


def draw(candidates: list[Mutant], count: int, seed: int) -> list[Mutant]:
    """Some of the candidates, those of one file next to each other."""
    chosen = random.Random(seed).sample(candidates, min(count, len(candidates)))
    return sorted(chosen, key=lambda mutation: (mutation.file, mutation.at))


def _files(root: Path) -> Iterator[Path]:
    for name in COPIED:
        if (root / name).is_file():
            yield Path(name)
        for path in sorted((root / name).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path.relative_to(root)


def copy_sources(root: Path, scratch: Path) -> None:
    """Makes a copy the same as the sources; files that are the same already are not touched."""
    wanted = set(_files(root))
    for path in set(_files(scratch)) - wanted:
        (scratch / path).unlink()
    for path in wanted:
        target = scratch / path
        if target.is_file() and target.read_bytes() == (root / path).read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / path, target)


class Workshop:
    """A copy of the sources, and its build tree."""

    def __init__(self, folder: Path, jobs: int) -> None:
        self.source, self.build_tree = folder / "source", folder / "build"
        self._runs = folder / "run"
        self._jobs = str(jobs)
        self._environment = {**os.environ, "RC_PARAMS": PROPERTY_RUNS}

    def prepare(self) -> None:
        copy_sources(ROOT, self.source)
        shutil.rmtree(self._runs, ignore_errors=True)
        self._runs.mkdir(parents=True)
        options = [f"-DCMAKE_CXX_FLAGS={FLAGS}", "-DCMAKE_BUILD_TYPE=None", "-DLIMBER_CHECKS=ON", "-DLIMBER_INSTALL=OFF",
                   "-DLIMBER_BUILD_TESTS=ON"]
        if ccache := shutil.which("ccache"):
            options.append(f"-DCMAKE_CXX_COMPILER_LAUNCHER={ccache}")
        command = ["cmake", "-S", str(self.source), "-B", str(self.build_tree), "-G", "Ninja", *options]
        if (failed := self._run(command, None)).returncode != 0:
            raise Unusable(failed.stdout)

    def build(self, executables: Iterable[str]) -> str:
        """What the compiler says where it fails, and nothing otherwise."""
        targets = [f"limber_{name}_tests" for name in executables]
        command = ["cmake", "--build", str(self.build_tree), "--parallel", self._jobs, "--target", *targets]
        done = self._run(command, None)
        return "" if done.returncode == 0 else done.stdout

    def without_tests(self, executable: str, tests: str) -> list[str]:
        """The patterns of a filter that no test fits."""
        path = self.build_tree / "tests" / f"limber_{executable}_tests"

        def fits_any(pattern: str) -> bool:
            listed = self._run([str(path), f"--gtest_filter={pattern}", "--gtest_list_tests"], None)
            return listed.returncode == 0 and re.search(r"^  \S", listed.stdout, re.MULTILINE) is not None

        return [pattern for pattern in tests.split(":") if not fits_any(pattern)]

    def take(self, executables: Iterable[str]) -> Path:
        """A folder with these executables, which later builds leave alone."""
        folder = self._runs / str(time.monotonic_ns())
        folder.mkdir()
        for name in executables:
            shutil.copy2(self.build_tree / "tests" / f"limber_{name}_tests", folder / name)
        return folder

    def test(self, folder: Path, tests: Iterable[str]) -> Verdict:
        """Runs tests until one fails, and removes the folder."""
        try:
            for test in tests:
                executable, _, tests_of_it = test.partition(":")
                verdict = self._test_one(folder / executable, executable, tests_of_it or "*")
                if verdict.noticed:
                    return verdict
            return Verdict(False, "")
        finally:
            shutil.rmtree(folder)

    def _test_one(self, path: Path, executable: str, tests: str) -> Verdict:
        limited = ["prlimit", f"--as={MEMORY_BYTES}", str(path)]
        command = [*limited, f"--gtest_filter={tests}", "--gtest_fail_fast", "--gtest_color=no"]
        try:
            done = self._run(command, TIMEOUT_S)
        except subprocess.TimeoutExpired as expired:
            output = (expired.stdout or b"").decode(errors="replace")
            return Verdict(True, f"a hang of {executable} {_last(output, 'RUN      ')}")
        if done.returncode == 0:
            return Verdict(False, "")
        if failed := re.search(r"^\[  FAILED  \] ([\w./]+)", done.stdout, re.MULTILINE):
            return Verdict(True, f"{executable} {failed.group(1)}")
        return Verdict(True, f"a crash of {executable} {_last(done.stdout, 'RUN      ')}")

    def _run(self, command: list[str], timeout: float | None) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", timeout=timeout, check=False, cwd=self.build_tree.parent,
                              env=self._environment)


def _last(output: str, mark: str) -> str:
    found = re.findall(rf"^\[ {mark}\] ([\w./]+)", output, re.MULTILINE)
    return found[-1] if found else "before its first test"


def baseline(shop: Workshop, mutants: Iterable[Mutant]) -> None:
    """All tests that mutants name must pass on the sources as they are."""
    filters: dict[str, list[str]] = {}
    for test in sorted({test for mutant in mutants for test in mutant.tests}):
        executable, _, tests_of_it = test.partition(":")
        filters.setdefault(executable, []).append(tests_of_it or "*")
    if failed := shop.build(filters):
        raise Unusable(failed)
    for executable, tests in filters.items():
        for tests_of_it in tests:
            for pattern in shop.without_tests(executable, tests_of_it):
                raise Unusable(f"no test of {executable} is called {pattern}")
    verdict = shop.test(shop.take(filters), [f"{name}:{':'.join(tests)}" for name, tests in filters.items()])
    if verdict.noticed:
        raise Unusable(f"without any mutant the tests fail: {verdict.text}")


def report(mutant: Mutant, verdict: Verdict, seconds: float) -> None:
    if verdict.noticed is None:
        reason = verdict.text if mutant.at is None else ""  # of those at random many are no C++
        print(f"INVALID   {mutant.name}: it does not compile\n{reason}".rstrip(), flush=True)
    elif verdict.noticed:
        print(f"noticed   {mutant.name}: by {verdict.text}, {seconds:.0f} s", flush=True)
    else:
        print(f"SURVIVED  {mutant.name} in {mutant.file}, {seconds:.0f} s", flush=True)


def run(shop: Workshop, mutants: Sequence[Mutant]) -> dict[str, Verdict]:
    """Builds and tests one mutant after the other, and reports each."""
    verdicts: dict[str, Verdict] = {}

    def conclude(mutant: Mutant, verdict: Verdict, start: float) -> None:
        verdicts[mutant.name] = verdict
        report(mutant, verdict, time.monotonic() - start)

    def tested(mutant: Mutant, folder: Path, start: float) -> None:
        conclude(mutant, shop.test(folder, mutant.tests), start)

    def wait_until_at_most(count: int) -> None:
        while len(running) > count:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                running.remove(future)
                future.result()

    running: set[Future[None]] = set()
    changed: Path | None = None
    with ThreadPoolExecutor(max_workers=TESTED_AT_ONCE) as pool:
        for mutant in mutants:
            start = time.monotonic()
            path = shop.source / mutant.file
            original = (ROOT / mutant.file).read_text(encoding="utf-8")
            if changed is not None and changed != path:
                copy_sources(ROOT, shop.source)
            path.write_text(mutant.applied_to(original), encoding="utf-8")
            changed = path
            if failed := shop.build(mutant.executables()):
                conclude(mutant, Verdict(None, failed), start)
                continue
            wait_until_at_most(TESTED_AT_ONCE - 1)
            running.add(pool.submit(tested, mutant, shop.take(mutant.executables()), start))
            if "program" in mutant.executables():  # which run the program where it has been built
                wait_until_at_most(0)
        wait_until_at_most(0)
    copy_sources(ROOT, shop.source)
    return verdicts


def chosen_mutants(arguments: argparse.Namespace) -> list[Mutant]:
    """Those of the table, or at random, that the command line asks for."""
    patterns = arguments.names or ["*"]
    if arguments.random:
        candidates = mutations(ROOT, patterns)
        chosen = draw(candidates, arguments.random, arguments.seed)
        print(f"{len(chosen)} of {len(candidates)} mutations, --seed {arguments.seed}", flush=True)
    else:
        candidates = load(Path(__file__).with_suffix(".toml"))
        check(ROOT, candidates)
        print(f"{len(candidates)} mutants fit the sources", flush=True)
        chosen = [m for m in candidates if any(fnmatch.fnmatchcase(m.name, pattern) for pattern in patterns)]
    if not chosen:
        raise Unusable(f"no mutant is called {' or '.join(patterns)}")
    return chosen


def main() -> int:
    parser = argparse.ArgumentParser(description="Breaks the code place by place; the tests must notice.")
    parser.add_argument("names", nargs="*", help="mutants, or patterns such as 'simd-*'; with --random files, as 'src/io/*'")
    parser.add_argument("--random", type=int, metavar="N", help="draw N places from the sources")
    parser.add_argument("--seed", type=int, default=int(time.strftime("%Y%m%d")), help="of the drawing; today's date")
    parser.add_argument("--check", action="store_true", help="only say whether every mutant fits the sources")
    parser.add_argument("--list", action="store_true", help="only list the mutants")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="of the compiler")
    arguments = parser.parse_args()
    try:
        chosen = chosen_mutants(arguments)
        if arguments.list:
            print(*(f"{mutant.file}: {mutant.name}" for mutant in chosen), sep="\n")
        if arguments.list or arguments.check:
            return 0
        shop = Workshop(ROOT / "build" / "mutants", arguments.jobs)
        shop.prepare()
        start = time.monotonic()
        baseline(shop, chosen)
        print(f"the tests pass without any mutant, {time.monotonic() - start:.0f} s", flush=True)
        verdicts = run(shop, chosen).values()
    except Unusable as reason:
        print(f"mutants: {reason}", file=sys.stderr)
        return 2
    noticed = sum(verdict.noticed is True for verdict in verdicts)
    survived = sum(verdict.noticed is False for verdict in verdicts)
    print(f"{len(verdicts)} mutants, {noticed} noticed, {survived} survived, {len(verdicts) - noticed - survived} invalid")
    return 0 if arguments.random or noticed == len(verdicts) else 1


if __name__ == "__main__":
    sys.exit(main())
