#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""What Doxygen reads instead of a public header.

The comment in front of the namespace is about the header, each label of a comment starts a paragraph, and names of pages
become links. What is private or for the library alone is left out.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

_LABEL = re.compile(r"^(\s*///) ([A-Z]\w+) {2,}(?=\S)", re.MULTILINE)
_ABOUT_THE_HEADER = re.compile(r"^((?:///.*\n)+)(?=namespace )", re.MULTILINE)
_PRIVATE = re.compile(r"^ private:\n.*?(?=^};)", re.MULTILINE | re.DOTALL)
_FOR_THE_LIBRARY = re.compile(r"^ */// For the library's own use.*?(?=^\n|^};)", re.MULTILINE | re.DOTALL)
_PAGE = re.compile(r"\bdocs/([\w/]+)\.md\b")


def for_doxygen(header: str) -> str:
    header = header.replace("LIMBER_API ", "").replace("[[nodiscard]] ", "")
    header = _FOR_THE_LIBRARY.sub("", _PRIVATE.sub("", header))
    header = _ABOUT_THE_HEADER.sub(r"/// @file\n\1", header, count=1)
    header = _LABEL.sub(r"\1 @par \2\n\1 ", header)
    return _PAGE.sub(r'<a href="../../docs/\1.html">docs/\1.md</a>', header)  # from api/cpp


if __name__ == "__main__":
    sys.stdout.write(for_doxygen(Path(sys.argv[1]).read_text(encoding="utf-8")))
