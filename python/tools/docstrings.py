#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns the comments of the public headers into a header of strings, from which the Python module takes its docstrings.

A comment `///` in front of a class, function or member becomes the constant docs::NAME, that of a member of a class
docs::CLASS_NAME, that in front of the namespace docs::header_FILE. Where overloads follow each other, the first comment
counts. A member's `///<` counts too.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

# How the two languages call the same things. Applied in order.
WORDS = (
    (r"\bstd::invalid_argument\b", "ValueError"),
    (r"\bstd::bad_alloc\b", "MemoryError"),
    (r"\bstd::logic_error\b", "RuntimeError"),
    (r"^Throws   ", "Raises   "),
    (r"\b(\w+)::(\w+)", r"\1.\2"),
)
SCOPE = re.compile(r"^(?:class|struct|enum class)\s+(\w+)[^;]*\{\s*$")
SCOPE_ON_ONE_LINE = re.compile(r"^(?:class|struct)\s+(\w+)[^;{]*\{.*\};")
FUNCTION = re.compile(r"^(?:[\w:<>,*&\s\[\]]*?[\s*&])?(\w+)\(")
MEMBER = re.compile(r"(\w+)(?:\s*=[^;,]*|\{[^;]*\})?[;,]")
REMARK = re.compile(r"^(.*?)///<\s?(.*)$")


def translated(lines: list[str]) -> str:
    result = []
    for line in lines:
        for pattern, replacement in WORDS:
            line = re.sub(pattern, replacement, line)
        result.append(line)
    return "\n".join(result).strip()


def names_in(code: str, scope: str | None) -> str | None:
    """What a line of code declares, if that is worth a docstring."""
    if opened := SCOPE.match(code) or SCOPE_ON_ONE_LINE.match(code):
        return opened[1]
    if re.match(r"^explicit\s", code):
        code = re.sub(r"^explicit\s+", "", code)
    if function := FUNCTION.match(code):
        return f"{scope}_init" if function[1] == scope else function[1]
    if member := MEMBER.search(code):
        return member[1]
    return None


def docstrings(text: str, header: str) -> dict[str, str]:
    found: dict[str, str] = {}
    scope: str | None = None
    comment: list[str] = []
    for line in text.splitlines():
        code = line.strip()
        if code.startswith("///") and not code.startswith("///<"):
            comment.append(code[3:].removeprefix(" "))
            continue
        if line.startswith("}"):
            scope = None
        if remark := REMARK.match(code):
            code, comment = remark[1].strip(), comment or [remark[2]]
        if comment and code.startswith("namespace"):
            found[f"header_{header}"] = translated(comment)
        elif comment and code and not code.startswith("//"):
            opened = SCOPE.match(code)
            name = names_in(code, scope)
            if name is not None:
                full = name if opened or scope is None or name == f"{scope}_init" else f"{scope}_{name}"
                found.setdefault(full, translated(comment))
        if opened := SCOPE.match(line):
            scope = opened[1]
        comment = []
    return found


def main() -> int:
    headers, target = [Path(name) for name in sys.argv[1:-1]], Path(sys.argv[-1])
    found: dict[str, str] = {}
    for header in headers:
        for name, text in docstrings(header.read_text(encoding="utf-8"), header.stem).items():
            found.setdefault(name, text)
    lines = ["#pragma once", "", "namespace limber::python::docs {", ""]
    for name, text in sorted(found.items()):
        if not re.fullmatch(r"[A-Za-z_]\w*", name):
            continue
        lines += [f"inline constexpr const char* {name} =", f'    R"docs({text})docs";']
    lines += ["", "}  // namespace limber::python::docs", ""]
    target.write_text("\n".join(lines), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
