# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""The places of a source that mutants.py --random may change, and what to."""

from __future__ import annotations

import re
from collections.abc import Iterator

from repository import cpp_code

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
