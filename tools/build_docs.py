#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the site: pages, the C++ interface from the public headers, the Python interface from the package.

Pages link to each other, to pictures and to sources as they stand in the repository. So they are copied to a folder that
has the same shape, and Sphinx reads that. A link that leads nowhere is an error, as every warning is.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SETTINGS = ROOT / "docs/site"
FOLDERS = ("docs", "include", "examples", "python", "bench", "tests/data", "tools")
SUFFIXES = (".md", ".h", ".cpp", ".py", ".bib", ".csv", ".txt", ".png", ".ipynb")
DOXYFILE = """
PROJECT_NAME = limber
INPUT = {headers}
INPUT_FILTER = "{python} {filter} --filter"
OUTPUT_DIRECTORY = {out}
GENERATE_XML = YES
GENERATE_HTML = NO
GENERATE_LATEX = NO
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
EXTRACT_LOCAL_CLASSES = NO
HIDE_UNDOC_MEMBERS = NO
QUIET = YES
WARNINGS = YES
WARN_IF_UNDOCUMENTED = NO
AUTOLINK_SUPPORT = NO
STRIP_FROM_PATH = {root}/include
"""
_LABEL = re.compile(r"^(\s*///) ([A-Z]\w+) {2,}(?=\S)", re.MULTILINE)
_ABOUT_THE_HEADER = re.compile(r"^((?:///.*\n)+)(?=namespace )", re.MULTILINE)
_PRIVATE = re.compile(r"^ private:\n.*?(?=^};)", re.MULTILINE | re.DOTALL)
_FOR_THE_LIBRARY = re.compile(r"^ */// For the library's own use.*?(?=^\n|^};)", re.MULTILINE | re.DOTALL)
_PAGE = re.compile(r"\bdocs/([\w/]+)\.md\b")


def for_doxygen(header: str) -> str:
    """What Doxygen reads instead of a public header.

    The comment in front of the namespace is about the header, each label of a comment starts a paragraph, and names of
    pages become links. What is private or for the library alone is left out.
    """
    header = header.replace("LIMBER_API ", "").replace("[[nodiscard]] ", "")
    header = _FOR_THE_LIBRARY.sub("", _PRIVATE.sub("", header))
    header = _ABOUT_THE_HEADER.sub(r"/// @file\n\1", header, count=1)
    header = _LABEL.sub(r"\1 @par \2\n\1 ", header)
    return _PAGE.sub(r'<a href="../../docs/\1.html">docs/\1.md</a>', header)  # from api/cpp


def stage(folder: Path) -> None:
    """Copies what pages are and what they may link to."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in FOLDERS:
        for file in sorted((ROOT / name).rglob("*")):
            if file.suffix in SUFFIXES and file.is_file() and file != SETTINGS / "contents.md":
                target = folder / file.relative_to(ROOT)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, target)
    for file in (*ROOT.glob("*.md"), ROOT / "LICENSE"):
        shutil.copy(file, folder)
    with (folder / "README.md").open("a", encoding="utf-8") as start:
        start.write((SETTINGS / "contents.md").read_text(encoding="utf-8"))


def write_interfaces(folder: Path) -> None:
    """A page for each public header, and one for the Python package."""
    headers = sorted(file.name for file in (ROOT / "include/limber").glob("*.h") if file.name != "limber.h")
    cpp = folder / "api/cpp"
    cpp.mkdir(parents=True)
    for header in headers:
        page = f"# limber/{header}\n\n```{{doxygenfile}} {header}\n:project: limber\n```\n"
        (cpp / Path(header).with_suffix(".md")).write_text(page, encoding="utf-8")
    entries = "\n".join(f"cpp/{Path(header).stem}" for header in headers)
    about = "The public headers, and their comments. `limber/limber.h` includes all but `io.h` and `eigen.h`."
    contents = f"# C++\n\n{about}\n\n```{{toctree}}\n{entries}\n```\n"
    (folder / "api/cpp.md").write_text(contents, encoding="utf-8")
    options = ":members:\n:imported-members:\n:undoc-members:"
    page = "# Python\n"
    for module in ("limber3d", "limber3d.batch"):
        settings = options.replace("\n", "\n   ")
        page += f"\n## {module}\n\n```{{eval-rst}}\n.. automodule:: {module}\n   {settings}\n```\n"
    (folder / "api/python.md").write_text(page, encoding="utf-8")


def read_headers(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    text = DOXYFILE.format(
        headers=ROOT / "include/limber", python=sys.executable, filter=Path(__file__).resolve(), out=folder, root=ROOT
    )
    (folder / "Doxyfile").write_text(text, encoding="utf-8")
    subprocess.run(["doxygen", folder / "Doxyfile"], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the site and what it is made of are written")
    parser.add_argument("--filter", action="store_true", help="print what Doxygen is to read of a header instead")
    arguments = parser.parse_args()
    if arguments.filter:
        sys.stdout.write(for_doxygen(arguments.folder.read_text(encoding="utf-8")))
        return 0
    folder: Path = arguments.folder.resolve()
    source, site = folder / "source", folder / "site"
    stage(source)
    write_interfaces(source)
    read_headers(folder / "doxygen")
    shutil.rmtree(site, ignore_errors=True)
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-j", "auto", "-d", folder / "doctrees"]
    result = subprocess.run(
        [*sphinx, "-c", SETTINGS, "-D", f"breathe_projects.limber={folder / 'doxygen/xml'}", source, site], check=False
    )
    if result.returncode != 0:
        return result.returncode
    shutil.copy(site / "README.html", site / "index.html")
    print(f"the site is {site / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
