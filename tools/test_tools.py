#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Proves that every check can fail: small repositories with one fault each, and sound twins."""

from __future__ import annotations

import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path

import build_docs
import check_layers
import check_text
import mutants
from repository import cpp_code, texts

HEAD = "// SPDX-FileCopyrightText: The limber authors\n// SPDX-License-Identifier: BSD-3-Clause\n"
HEADERS = {f"include/limber/{name}.h": HEAD for name in ("base", "math", "geometry", "mesh", "io", "eigen")}


class Repository(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def write(self, tree: dict[str, str]) -> None:
        for name, text in tree.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def assert_findings(self, check: Callable[[Path], list[str]], tree: dict[str, str], *starts: str) -> None:
        with tempfile.TemporaryDirectory(dir=self.root) as folder:
            self.root, before = Path(folder), self.root
            self.write(tree)
            found = check(self.root)
            self.root = before
        self.assertEqual(len(found), len(starts), found)
        for finding, start in zip(found, starts):
            self.assertTrue(finding.startswith(start), finding)


class Layers(Repository):
    # Source, what it may include, and what it may not.
    INCLUDES = (
        ("src/base/a.cpp", "<vector>", "geometry/b.h ../geometry/b.h neighbour.h <unistd.h>"),
        ("src/geometry/a.cpp", "base/check.h geometry/b.h", "bvh/tree.h limber/mesh.h <boost/rational.hpp> <CGAL/P.h> <sys/stat.h>"),
        ("src/geometry/orientation.cpp", "<boost/multiprecision/cpp_int.hpp>", "<nlohmann/json.hpp>"),
        ("src/model/a.cpp", "mesh/updates.h limber/mesh.h", "point/placed.h limber/io.h limber/eigen.h"),
        ("src/io/a.cpp", "limber/io.h base/check.h <nlohmann/json.hpp>", "base/rounding.h"),
        ("src/io/scan.cpp", "<xlocale.h>", "<CGAL/P.h>"),
        ("src/io/file_bytes.cpp", "<fcntl.h>", "<CGAL/P.h>"),
        ("src/newcomer/a.cpp", "<vector>", "base/check.h"),
        ("include/limber/mesh.h", "limber/base.h <vector>", "base/check.h <fmt/format.h> <Eigen/Core> limber/no_such.h"),
        ("include/limber/eigen.h", "<Eigen/Core>", "<CGAL/P.h>"),
        ("tests/unit/a_test.cpp", "bvh/tree.h support/b.h scenes/scenes.h", "bench/support/b.h"),
        ("tests/oracle/a_test.cpp", "<CGAL/P.h>", "bvh/tree.h"),
        ("clients/program/a.cpp", "<fmt/format.h>", "<CGAL/P.h> base/check.h bench/support/b.h reference/reference.h scenes/scenes.h"),
        ("clients/javascript/tests/a.cpp", "scenes/scenes.h", "support/b.h"),
        ("bench/thesis/a.cpp", "bench/support/report.h", "bvh/tree.h"),
    )  # fmt: skip

    def test_includes(self) -> None:
        for path, allowed, forbidden in self.INCLUDES:
            for target in (allowed + " " + forbidden).split():
                with self.subTest(path=path, target=target):
                    tree = {**HEADERS, path: HEAD + "#include " + (target if target[0] == "<" else f'"{target}"') + "\n"}
                    if not target.startswith(("<", "limber/", "bench/", "scenes/", "support/")):
                        tree.setdefault(f"src/{target}", HEAD)
                    starts = [f"{path}:3: includes "] if target in forbidden.split() else []
                    self.assert_findings(check_layers.check, tree, *starts)


class Texts(Repository):
    BIB = {"docs/references.bib": "@article{Euler1999,\n title = {x}\n}\n"}

    def test_what_is_sound(self) -> None:
        self.assert_findings(check_text.check, self.BIB | {
            "src/base/b.h": HEAD + "// " + 117 * "a" + "\n" * 400,
            "src/base/a.cpp": "// std::cout, [Euler1999], see docs/a.md\nint x = y[A1999x];\nf(\"printf()\");\nsnprintf(b, n, f);\n"
                              "static_assert(true);\nssize_t exit_code();\n",
            "docs/a.md": "# A b\n[b](b/b.md#c-d) [web](https://example.org/x.md) `[code](nowhere)` [self](#a-b)\n",
            "tests/unit/a_test.cpp": HEAD + "TEST(Square, HasArea) {}\nRC_GTEST_PROP(Circle, IsRound, (double x)) {}\n",
            "docs/algorithms/a.md": "`Square.HasArea`, `Square.*`, `Circle.Is…`\n",
            "docs/b/b.md": "# C, d!\n[up](../a.md)\n```\n[x](nowhere.md)\n```\n",
        })

    def test_what_is_not(self) -> None:
        cases = [
            ({"tests/unit/huge.cpp": HEAD + "\n" * 800}, "tests/unit/huge.cpp:803: "),
            ({"docs/a.md": "\n\nFIXME\n"}, "docs/a.md:3: "),
            ({"src/base/b.h": HEAD + "// " + 118 * "a" + "\n"}, "src/base/b.h:3: 121 "),
            (self.BIB | {"src/a.cpp": "// [Euler1999]\n// [Euler1999, Gauss1988]\n"}, "src/a.cpp:2: [Gauss1988] "),
            (self.BIB, "docs/references.bib:1: Euler1999 is cited nowhere"),
            ({"docs/algorithms/a.md": "`Square.Has*`\n", "tests/a.cpp": HEAD + "TEST(Square, IsFlat) {}\n"}, "docs/algorithms/a.md:1: there"),
            ({"src/a.h": "\n/// Source docs/algorithms/no.md.\n"}, "src/a.h:2: docs/alg"),
        ]
        cases += [({"src/base/b.cpp": HEAD + text + "\n"}, "src/base/b.cpp:3: ")
                  for text in ("std::cout << 1;", 'printf("");', "#include <iostream>", "std::abort();", "assert(x);")]
        cases += [({"docs/a.md": f"\n{link}\n"}, "docs/a.md:2: link ")
                  for link in ("[a](no.md)", "[a]: no.md", '<img src="no.png">', "[a](#no)", "[a](../../etc)")]
        for tree, start in cases:
            with self.subTest(start=start, tree=tree):
                self.assert_findings(check_text.check, tree, start)

    def test_code_keeps_places_and_loses_comments(self) -> None:
        text = "a = \"//x\"; // b\n/* c\n */ d = 1'000 + '\\''; R\"(\n\")\" e\n"
        code = cpp_code(text)
        self.assertEqual(code.split(), ["a", "=", ";", "d", "=", "1'000", "+", ";", "e"])
        self.assertEqual([len(line) for line in code.split("\n")], [len(line) for line in text.split("\n")])

    def test_build_trees_are_left_out(self) -> None:
        self.write(dict.fromkeys(("build/a.cpp", "build-x/a.cpp", ".git/a.cpp", ".ci/run", "src/a.cpp"), ""))
        self.assertEqual([name for name, _ in texts(self.root, suffixes=("",))], [".ci/run", "src/a.cpp"])


class Mutants(Repository):
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

    def load(self, text: str, *entries: dict[str, str | list[str]]) -> None:
        fields = [[f"{key} = {value!r}" for key, value in entry.items()] for entry in entries]
        table = "".join("[[mutant]]\n" + "\n".join(lines) + "\n" for lines in fields)
        self.write({"a.cpp": text, "mutants.toml": table})
        mutants.load(self.root / "mutants.toml", self.root)

    def test_stale_mutants_are_refused(self) -> None:
        mutant = {"name": "m", "file": "a.cpp", "find": "<", "replace": "<="}
        self.load("x < y", mutant)
        for text, entries in (
            ("x > y", [mutant]),
            ("x < y < z", [mutant]),
            ("x < y", [{**mutant, "file": "b.cpp"}]),
            ("x < y", [{**mutant, "replace": "<"}]),
            ("x < y", [{**mutant, "test": "unit"}]),
            ("x < y", [{**mutant, "tests": ["unit:Gone.*"]}]),
            ("x < y", [mutant, mutant]),
        ):
            with self.assertRaises(mutants.Unusable):
                self.load(text, *entries)

    def changed_lines(self, text: str) -> list[str]:
        found = []
        for at, old, new in mutants.changes(text):
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
        for old, new in mutants.OPERATORS.items():
            self.assertEqual(self.changed_lines(f"a {old} b"), [f"a {new} b"])

    def test_a_seed_draws_the_same_mutations_of_the_files_asked_for(self) -> None:
        self.write(dict.fromkeys(("src/pair/a.h", "src/io/b.cpp", "tests/d.cpp"), self.SOURCE))
        every = mutants.mutations(self.root, ["*"])
        self.assertEqual({m.file: m.tests for m in every}, {"src/pair/a.h": mutants.DEFAULT_TESTS, "src/io/b.cpp": ("io",)})
        self.assertIn("src/pair/a.h:9: < becomes <=", [m.name for m in every])
        some = mutants.draw(every, 5, 1)
        self.assertEqual(some, mutants.draw(every, 5, 1))
        self.assertNotEqual(some, mutants.draw(every, 5, 2))
        self.assertEqual({m.file for m in mutants.mutations(self.root, ["src/io/*"])}, {"src/io/b.cpp"})


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
        text = build_docs.for_doxygen(self.HEADER)
        for kept in ("/// @file\n/// About the header.", "  /// @par Cost\n  /// O(1).\n", "class Model {", "void commit();",
                     '<a href="../../docs/algorithms/bounds.html">docs/algorithms/bounds.md</a>'):
            self.assertIn(kept, text)
        for left_out in ("secret_", "Impl", "private"):
            self.assertNotIn(left_out, text)


if __name__ == "__main__":
    unittest.main()
