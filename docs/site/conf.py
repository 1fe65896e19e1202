# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""How Sphinx turns the staged pages into a site; see tools/build_docs.py."""

from __future__ import annotations

import re
from pathlib import Path

from sphinx.application import Sphinx

_here = Path(__file__).resolve().parent
_version = re.search(r"project\(limber\s+VERSION\s+([\d.]+)", (_here.parents[1] / "CMakeLists.txt").read_text(encoding="utf-8"))
if _version is None:
    raise SystemExit("CMakeLists.txt names no version")

project = "limber"
author = "The limber authors"
copyright = author  # noqa: A001, the name is Sphinx's
release = version = _version[1]

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx_copybutton"]
root_doc = "README"
nitpicky = False  # names of the standard library and of NumPy have no page here; links between pages are checked all the same
default_role = "code"
# Namespace limber is declared by every header. Tables of results begin with the heading that their program writes. The
# type `object` is not the member of that name that two results have.
suppress_warnings = ["duplicate_declaration.cpp", "myst.header", "ref.python"]

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence", "html_image"]

breathe_default_project = "limber"
breathe_domain_by_extension = {"h": "cpp"}
breathe_show_include = False
cpp_maximum_signature_line_length = 100

autodoc_member_order = "bysource"
autodoc_typehints = "signature"

html_theme = "furo"
html_title = f"limber {release}"
html_copy_source = False
html_show_sourcelink = False

# A label of a comment stands at the start of a line, with two spaces or more behind it.
_LABEL = re.compile(r"^([A-Z]\w+) {2,}(\S.*)$")


def _docstring(app: Sphinx, what: str, name: str, item: object, options: object, lines: list[str]) -> None:
    """Docstrings have the form of the C++ comments: each label becomes a field, and an indented text is code."""
    result: list[str] = []
    before = ""  # which kind of line came last: "label", "code", or another
    for line in lines:
        if label := _LABEL.match(line):
            result += [""] * (before != "label") + [f":{label[1]}: {label[2]}"]
            before = "label"
        elif before == "label" and line.startswith("  "):
            result.append("    " + line.strip())
        elif line.startswith("    "):
            result += ["", "::", ""] * (before != "code") + [line]
            before = "code"
        else:
            result += [""] * (before == "label") + [line]
            before = before if not line else ""
    lines[:] = result


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-docstring", _docstring)
