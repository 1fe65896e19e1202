#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the site: pages, the C++ interface from the public headers, the Python interface from the package.

Pages link to each other, to pictures and to sources as they stand in the repository. So they are copied to a folder that
has the same shape, and Sphinx reads that. A link that leads nowhere is an error, as every warning is.
"""

from __future__ import annotations

import argparse
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
INPUT_FILTER = "{python} {filter}"
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
    headers = sorted(file.name for file in (ROOT / "include/limber").glob("*.h") if file.name not in ("limber.h", "export.h"))
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
        headers=ROOT / "include/limber", python=sys.executable, filter=ROOT / "tools/doxygen_filter.py", out=folder, root=ROOT
    )
    (folder / "Doxyfile").write_text(text, encoding="utf-8")
    subprocess.run(["doxygen", folder / "Doxyfile"], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the site and what it is made of are written")
    folder: Path = parser.parse_args().folder.resolve()
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
