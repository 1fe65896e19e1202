#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Proves that every check can fail: small repositories with one fault each, and sound twins."""

from __future__ import annotations

import contextlib
import io
import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path

import check_layers
import check_text
import doxygen_filter
import mutants
import random_faults
from repository import Finding, cpp_code, files

HEAD = "// SPDX-FileCopyrightText: The limber authors\n// SPDX-License-Identifier: BSD-3-Clause\n"
HEADERS = {f"include/limber/{name}.h": HEAD for name in ("base", "math", "geometry", "mesh", "io")}


class Repository(unittest.TestCase):
    def findings(self, check: Callable[[Path], list[Finding]], tree: dict[str, str]) -> list[str]:
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            for name, text in tree.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return [str(finding) for finding in check(Path(folder))]

    def assert_sound(self, check: Callable[[Path], list[Finding]], tree: dict[str, str]) -> None:
        self.assertEqual(self.findings(check, tree), [])

    def assert_faulty(self, check: Callable[[Path], list[Finding]], tree: dict[str, str], *starts: str) -> None:
        found = self.findings(check, tree)
        self.assertEqual(len(found), len(starts), found)
        for finding, start in zip(found, starts):
            self.assertTrue(finding.startswith(start), finding)


class Layers(Repository):
    def includes(self, path: str, target: str) -> dict[str, str]:
        line = f"#include {target}\n" if target.startswith("<") else f'#include "{target}"\n'
        tree = {**HEADERS, path: HEAD + line}
        if not target.startswith(("<", "limber/", "bench/", "scenes/", "support/", "tests/")):
            tree.setdefault(f"src/{target}", HEAD)
        return tree

    def test_down_is_allowed(self) -> None:
        for path, target in (
            ("src/geometry/a.cpp", "base/check.h"),
            ("src/geometry/a.cpp", "geometry/b.h"),
            ("src/model/a.cpp", "mesh/updates.h"),
            ("src/io/a.cpp", "limber/io.h"),
            ("src/io/a.cpp", "base/check.h"),
            ("src/io/a.cpp", "<nlohmann/json.hpp>"),
            ("src/io/scan.cpp", "<xlocale.h>"),
            ("src/geometry/exact_sign.cpp", "<boost/multiprecision/cpp_int.hpp>"),
            ("src/geometry/integers.h", "<boost/multiprecision/cpp_int.hpp>"),
            ("include/limber/mesh.h", "limber/base.h"),
            ("include/limber/mesh.h", "<vector>"),
            ("include/limber/eigen.h", "<Eigen/Core>"),
            ("tests/unit/a_test.cpp", "bvh/tree.h"),
            ("tests/property/a_test.cpp", "bvh/tree.h"),
            ("tests/oracle/a_test.cpp", "<CGAL/Point_3.h>"),
            ("clients/program/a.cpp", "<fmt/format.h>"),
            ("tests/unit/a_test.cpp", "support/b.h"),
            ("tests/unit/a_test.cpp", "scenes/scenes.h"),
            ("bench/thesis/a.cpp", "bench/support/report.h"),
        ):
            with self.subTest(path=path, target=target):
                self.assert_sound(check_layers.check, self.includes(path, target))

    def test_everything_else_is_not(self) -> None:
        for path, target in (
            ("src/base/a.cpp", "geometry/b.h"),
            ("src/geometry/a.cpp", "bvh/tree.h"),
            ("src/geometry/a.cpp", "limber/mesh.h"),
            ("src/mesh/a.cpp", "model/placed.h"),
            ("src/model/a.cpp", "limber/io.h"),
            ("src/io/a.cpp", "base/rounding.h"),
            ("src/newcomer/a.cpp", "base/check.h"),
            ("src/base/a.cpp", "../geometry/b.h"),
            ("src/base/a.cpp", "neighbour.h"),
            ("src/base/a.cpp", "<unistd.h>"),
            ("src/geometry/a.cpp", "<boost/rational.hpp>"),
            ("src/geometry/a.cpp", "<CGAL/Point_3.h>"),
            ("src/io/a.cpp", "<CGAL/Point_3.h>"),
            ("src/io/a.cpp", "<sys/stat.h>"),
            ("src/geometry/a.cpp", "<nlohmann/json.hpp>"),
            ("clients/program/a.cpp", "<CGAL/Point_3.h>"),
            ("clients/program/a.cpp", "base/check.h"),
            ("tests/oracle/a_test.cpp", "bvh/tree.h"),
            ("bench/thesis/a.cpp", "bvh/tree.h"),
            ("include/limber/mesh.h", "base/check.h"),
            ("include/limber/mesh.h", "<fmt/format.h>"),
            ("include/limber/mesh.h", "<Eigen/Core>"),
            ("src/model/a.cpp", "limber/eigen.h"),
            ("include/limber/mesh.h", "limber/no_such.h"),
            ("clients/program/a.cpp", "bench/support/b.h"),
            ("clients/program/a.cpp", "reference/reference.h"),
            ("clients/program/tests/a.cpp", "scenes/scenes.h"),
            ("scenes/a.cpp", "bench/support/b.h"),
        ):
            with self.subTest(path=path, target=target):
                self.assert_faulty(check_layers.check, self.includes(path, target), f"{path}:3: includes ")


class Texts(Repository):
    BIB = {"docs/references.bib": "@article{Euler1999,\n title = {x}\n}\n"}

    def test_what_is_sound(self) -> None:
        self.assert_sound(check_text.check, self.BIB | {
            "src/base/b.h": HEAD + "// " + 117 * "a" + "\n" * 400,
            "src/base/a.cpp": "// std::cout, [Euler1999], see docs/a.md\nint x = y[A1999x];\nf(\"printf()\");\nsnprintf(b, n, f);\n"
                              "static_assert(true);\nssize_t exit_code();\n",
            "docs/a.md": "# A b\n[b](b/b.md#c-d) [web](https://example.org/x.md) `[code](nowhere)` [self](#a-b)\n",
            "docs/b/b.md": "# C, d!\n[up](../a.md)\n```\n[x](nowhere.md)\n```\n",
        })

    def test_what_is_not(self) -> None:
        cases = [
            ({"tests/unit/huge.cpp": HEAD + "\n" * 800}, "tests/unit/huge.cpp:803: "),
            ({"docs/a.md": "\n\nFIXME\n"}, "docs/a.md:3: "),
            ({"src/base/b.h": HEAD + "// " + 118 * "a" + "\n"}, "src/base/b.h:3: 121 "),
            (self.BIB | {"src/a.cpp": "// [Euler1999]\n// [Euler1999, Gauss1988]\n"}, "src/a.cpp:2: [Gauss1988] "),
            (self.BIB, "docs/references.bib:1: Euler1999 is cited nowhere"),
            ({"src/a.h": "\n/// Source docs/algorithms/no.md.\n"}, "src/a.h:2: docs/alg"),
        ]
        cases += [({"src/base/b.cpp": HEAD + text + "\n"}, "src/base/b.cpp:3: ")
                  for text in ("std::cout << 1;", 'printf("");', "#include <iostream>", "std::abort();", "assert(x);")]
        cases += [({"docs/a.md": f"\n{link}\n"}, "docs/a.md:2: link ")
                  for link in ("[a](no.md)", "[a]: no.md", '<img src="no.png">', "[a](#no)", "[a](../../etc)")]
        for tree, start in cases:
            with self.subTest(start=start, tree=tree):
                self.assert_faulty(check_text.check, tree, start)

    def test_code_keeps_places_and_loses_comments(self) -> None:
        text = "a = \"//x\"; // b\n/* c\n */ d = 1'000 + '\\''; R\"(\n\")\" e\n"
        code = cpp_code(text)
        self.assertEqual(code.split(), ["a", "=", ";", "d", "=", "1'000", "+", ";", "e"])
        self.assertEqual([len(line) for line in code.split("\n")], [len(line) for line in text.split("\n")])

    def test_build_trees_are_left_out(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for name in ("build/a.cpp", "build-x/a.cpp", ".git/a.cpp", ".ci/run", "src/a.cpp"):
                Path(folder, name).parent.mkdir()
                Path(folder, name).touch()
            self.assertEqual([path.relative_to(folder).as_posix() for path in files(Path(folder))], [".ci/run", "src/a.cpp"])


class Mutants(unittest.TestCase):
    def check(self, text: str, *entries: dict[str, str]) -> None:
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "a.cpp").write_text(text, encoding="utf-8")
            table = Path(folder, "mutants.toml")
            fields = [[f"{key} = '{value}'" for key, value in entry.items()] for entry in entries]
            table.write_text("".join("[[mutant]]\n" + "\n".join(lines) + "\n" for lines in fields), encoding="utf-8")
            mutants.check(Path(folder), mutants.load(table))

    def test_stale_mutants_are_refused(self) -> None:
        mutant = {"name": "m", "file": "a.cpp", "find": "<", "replace": "<="}
        self.check("x < y", mutant)
        for text, entries in (
            ("x > y", [mutant]),
            ("x < y < z", [mutant]),
            ("x < y", [{**mutant, "file": "b.cpp"}]),
            ("x < y", [{**mutant, "replace": "<"}]),
            ("x < y", [{**mutant, "test": "unit"}]),
            ("x < y", [mutant, mutant]),
        ):
            with self.assertRaises(mutants.Unusable):
                self.check(text, *entries)
        with self.assertRaises(mutants.Unusable):
            mutants.Mutant("m", "a.cpp", "<", "<=", (), 2).applied_to("x > y")


class RandomMutants(unittest.TestCase):
    SOURCE = """#include <array> // a < b
template <int n = 3>
struct S {
  alignas(16) float v[9][width];  // 3
};
double f(const T& x, T* y, double&& z) {
  LIMBER_ASSERT(x < 1 &&
                y > 2);
  if (x < 100) return std::min(0x1p-3F, "a < 2"[n]);
  const float* const ends[2] = {y, z};
  at[0] += z;
}
Packet max(Packet a);
"""

    def changed_lines(self, text: str) -> list[str]:
        found = []
        for at, old, new in random_faults.changes(text):
            changed = mutants.Mutant("m", "a.cpp", old, new, (), at).applied_to(text).split("\n")
            (line,) = [after for before, after in zip(text.split("\n"), changed, strict=True) if before != after]
            found.append(line.strip())
        return found

    def test_statements_are_changed_one_place_at_a_time(self) -> None:
        self.assertCountEqual(self.changed_lines(self.SOURCE), [
            'if (x <= 100) return std::min(0x1p-3F, "a < 2"[n]);',
            'if (x < 100) return std::min((0.25F * 0x1p-3F), "a < 2"[n]);',
            'if (x < 100) return std::min((4.0F * 0x1p-3F), "a < 2"[n]);',
            'if (x < 100) return std::max(0x1p-3F, "a < 2"[n]);',
            'if (!(x < 100)) return std::min(0x1p-3F, "a < 2"[n]);',
            "at[1] += z;",
            ";",
        ])
        for text, changed in (("x(1U)", ["x(0U)", "x(2U)"]), ("x(0)", ["x(1)"]), ("x(0.0)", ["x(1.0)"]), ("x(0xff, 64, 1'000, p1, 17)", [])):
            self.assertEqual(self.changed_lines(text), changed)
        for old, new in random_faults.OPERATORS.items():
            self.assertEqual(self.changed_lines(f"a {old} b"), [f"a {new} b"])

    def test_a_seed_draws_the_same_mutations_of_the_files_asked_for(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for name in ("src/pair/a.h", "src/io/b.cpp", "src/simd/wasm_c.h", "tests/d.cpp"):
                Path(folder, name).parent.mkdir(parents=True, exist_ok=True)
                Path(folder, name).write_text(self.SOURCE, encoding="utf-8")
            every = mutants.mutations(Path(folder), ["*"])
            self.assertEqual({m.file: m.tests for m in every},
                             {"src/pair/a.h": mutants.DEFAULT_TESTS, "src/io/b.cpp": ("io",)})
            self.assertIn("src/pair/a.h:9:9: < becomes <=", [m.name for m in every])
            some = mutants.draw(every, 5, 1)
            self.assertEqual(some, mutants.draw(every, 5, 1))
            self.assertNotEqual(some, mutants.draw(every, 5, 2))
            self.assertEqual(len({m.name for m in some}), 5)
            self.assertEqual({m.file for m in mutants.mutations(Path(folder), ["src/io/*"])}, {"src/io/b.cpp"})


class Docs(unittest.TestCase):
    HEADER = """/// About the header.
namespace limber {

class Model {
 public:
  /// For the library's own use.
  struct Impl;

  /// Public, see docs/algorithms/bounds.md.
  ///
  /// Cost     O(1).
  void commit();

 private:
  int secret_;
};
"""

    def test_what_doxygen_reads(self) -> None:
        text = doxygen_filter.for_doxygen(self.HEADER)
        for kept in ("/// @file\n/// About the header.", "  /// @par Cost\n  /// O(1).\n", "class Model {", "void commit();",
                     '<a href="../../docs/algorithms/bounds.html">docs/algorithms/bounds.md</a>'):
            self.assertIn(kept, text)
        for left_out in ("secret_", "Impl", "private"):
            self.assertNotIn(left_out, text)


if __name__ == "__main__":
    unittest.main()
