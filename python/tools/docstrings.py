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
import textwrap
from pathlib import Path

# What the package says otherwise, in any place. Applied in order, to text without line breaks.
WORDS = (
    (r"std::invalid_argument\b", "ValueError"),
    (r"std::bad_alloc\b", "MemoryError"),
    (r"\bvisit_(?=self_|intersections|contacts|element_pairs|candidate_pairs|impact)", ""),
    (r"\bConst functions, queries included, may\b", "Queries may"),
    (r"\b[Cc]onst functions may\b", "Calls may"),
    (r"\b(allocate|filter|visitor) throws?\b", r"\1 raises"),
    (r"\bwhich throws\b", "which raises"),
    (r"\bwhatever (a visitor or )?(a|the) (filter|visitor) raises\b", "whatever the filter raises"),
    (r"\b(query|geometry)\.h states\b", "the guide to numerics states"),
    (r"\b(query|geometry)\.h\b", "the library"),
    (r" \((contacts|distance|elements)\.h\)", ""),
    (r"\b(\w+)::(\w+)", r"\1.\2"),
)
# Sentences about what Python does not have, or has otherwise. Each of them has to be found.
SENTENCES = (
    (" The second form writes the first `?[a-z]+\\.size\\(\\)`? of them; count says how many there are.", ""),
    (" The second form writes the first pairs that there is room for; the counts say how many there are.", ""),
    (" Keeps a pointer: the model must outlive it, and must not be reset\\(\\)\\.", " The model must not be reset()."),
    ("Keeps a pointer: the model must outlive it\\. Changing the model", "Keeps its model alive. Changing it"),
    ("^Moved    .*", ""),
    (" A (model|scene) that has been moved from may be .*", ""),
    ("; with the default ones if the model has been moved from", ""),
    (" if the mesh has been moved from; MemoryError", " MemoryError"),
    ("Keeps a pointer to each model: a model must outlive its objects, at its address\\.", "Keeps its models alive."),
    (" Keeps a pointer: the model that it is of, or that a shape has, must outlive it\\.", " Keeps its model alive."),
    ("; allocates nothing but a cache's memory", ""),
    (" 40 kB of stack; allocates nothing( once the models have their edges)?, unless it is parallel\\.", ""),
    ("^found    What was in it is replaced;.*", ""),
    ("; `found` is then empty or unchanged", ""),
    (" `found` then has no pairs that mean something\\.", ""),
    ("^Room     .* closest_pairs\\(\\) with .*", "Nearest  closest_pairs() with `max_distance` finds them."),
    (" Allocates nothing if `memory` has grown to it; else 250 bytes a contact in six pieces\\.", ""),
    ("The contacts of contacts\\.h need no contact_of\\(\\): they are .*", "Those of contacts() need no contact_of()."),
    (" For one model with itself, both are Placed.*", " For one model with itself, pass it twice, without poses."),
    (": a TrianglePairFilter for self-queries", ": a filter for self-queries"),
    (r"Functions that allocate raises MemoryError when they cannot", "MemoryError"),
)
WIDTH = 116  # of lines
LABEL = re.compile(r"^([A-Z]\w+)  +")
SCOPE = re.compile(r"^(?:class|struct|enum class)\s+(\w+)[^;]*\{\s*$")
SCOPE_ON_ONE_LINE = re.compile(r"^(?:class|struct)\s+(\w+)[^;{]*\{.*\};")
FUNCTION = re.compile(r"^(?:[\w:<>,*&\s\[\]]*?[\s*&])?(\w+)\(")
MEMBER = re.compile(r"(\w+)(?:\s*=[^;,]*|\{[^;]*\})?[;,]")
REMARK = re.compile(r"^(.*?)///<\s?(.*)$")


found_sentences = set[str]()


def blocks(lines: list[str]) -> list[str]:
    """Paragraphs and labelled texts, each in one line; empty lines between paragraphs; examples in C++ are left out."""
    result: list[str] = []
    for line in lines:
        if not line.strip():
            result.append("")
        elif line.startswith("         ") or (result and result[-1] and not LABEL.match(line) and line[0] != " "):
            result[-1] += " " + re.sub(r"  +", " ", line.strip())  # columns inside of a label are lost
        elif line.startswith("  "):
            continue
        else:
            result.append(line)
    return result


def wrapped(block: str) -> str:
    label = LABEL.match(block)
    if label is None:
        return "\n".join(textwrap.wrap(block, WIDTH, break_long_words=False, break_on_hyphens=False))
    lines = textwrap.wrap(block[label.end() :], WIDTH - 9, break_long_words=False, break_on_hyphens=False)
    return "\n".join(f"{label[1] if i == 0 else '':<8} {line}" for i, line in enumerate(lines))


def translated(lines: list[str]) -> str:
    result = []
    for given in blocks(lines):
        block = re.sub(r"^Throws   ", "Raises   ", given)
        for pattern, replacement in WORDS:
            block = re.sub(pattern, replacement, block)
        for pattern, replacement in SENTENCES:
            block, count = re.subn(pattern, replacement, block)
            if count:
                found_sentences.add(pattern)
        if block or not given:  # some are about what Python does not have
            result.append(wrapped(block))
    return re.sub(r"\n{3,}", "\n\n", "\n".join(result)).strip()


def names_in(code: str, scope: str | None) -> str | None:
    """What a line of code declares, if that is worth a docstring."""
    if opened := SCOPE.match(code) or SCOPE_ON_ONE_LINE.match(code):
        return opened[1]
    if re.match(r"^explicit\s", code):
        code = re.sub(r"^explicit\s+", "", code)
    if function := FUNCTION.match(code):
        return f"{scope}_init" if function[1] == scope else function[1]
    if member := MEMBER.search(re.sub(r"<[^<>]*>", "", code)):
        return member[1]
    return None


def docstrings(text: str, header: str) -> dict[str, str]:
    found: dict[str, str] = {}
    scope: str | None = None
    comment: list[str] = []
    for line in text.replace("LIMBER_API ", "").replace("[[nodiscard]] ", "").splitlines():
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
    if missing := [pattern for pattern, _ in SENTENCES if pattern not in found_sentences]:
        print("no comment has any more:", *missing, sep="\n  ", file=sys.stderr)
        return 1
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
