#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the picture of the README from the page that `limber demo` writes; needs Debian's chromium."""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH, HEIGHT = 640, 690  # of the layout in CSS pixels; texts of 16 pixels are read when it is shown 400 pixels wide
PIXELS = 2  # of the picture, for each of the layout's
STYLE = """
:root { --page: #ffffff; color-scheme: only light; }
body { padding: 0; width: 640px; height: 690px; overflow: hidden; position: relative; font-size: 16px; }
section { margin: 0; padding: 0; border: 0; }
#sheet h2, .soft { display: none; }
#sheet svg { margin: 6px 0 0; width: 640px; }
.tiles { display: block; margin: 0; }
.tiles div { position: absolute; padding: 0; border: 0; background: none; width: 180px; top: 8px; }
.tiles .soft { display: block; color: var(--ink); font-size: 16px; line-height: 1.25; }
.tiles div:nth-child(1) { left: 14px; }
.tiles div:nth-child(2) { left: 14px; top: 276px; }
.tiles div:nth-child(3) { right: 14px; text-align: right; }
.tiles div:nth-child(4) { right: 14px; top: 276px; text-align: right; }
#update, #query { position: absolute; top: 362px; left: 14px; width: 300px; }
#query { left: 334px; }
#update .legend, #query .legend, .chart text { font-size: 16px; color: var(--ink); fill: var(--ink); }
section > .chart { width: 228px; margin: 12px 0 0 62px; }
.numbers { display: none; }
.legend { margin-top: 0; gap: 0 16px; }
.legend .unit { flex-basis: 100%; }
"""


def part(page: str, pattern: str) -> str:
    """What a pattern matches in the page, from its start tag to its end tag."""
    match = re.search(pattern, page, re.DOTALL)
    if not match:
        raise SystemExit(f"the page of the demonstration has no {pattern}")
    return match.group()


def picture_page(page: str) -> str:
    """The sheet with the medians in its corners, and below it the times of updates and queries."""
    tiles = part(page, r'<div class="tiles">.*?</div>\n</div>\n')
    sections = [part(page, rf'<section id="{name}">.*?</section>') for name in ("sheet", "update", "query")]
    head = part(page, r"\A.*?</style>").replace("</style>", STYLE + "</style>")
    # The picture looks the same wherever it is made.
    head = re.sub(r"@media \(prefers-color-scheme: dark\) \{\n.*?\n\}\n", "", head, flags=re.DOTALL)
    return head + "</head>\n<body>\n" + "\n".join([sections[0], tiles, *sections[1:]]) + "\n</body>\n</html>\n"


def photograph(html: str, picture: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "picture.html")
        page.write_text(html, encoding="utf-8")
        subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={folder}",
             f"--force-device-scale-factor={PIXELS}", f"--window-size={WIDTH},{HEIGHT}",
             f"--screenshot={picture.resolve()}", page.as_uri()],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", nargs="?", type=Path, default=ROOT / "build/limber-demo.html")
    parser.add_argument("picture", nargs="?", type=Path, default=ROOT / "docs/images/demo.png")
    arguments = parser.parse_args()
    photograph(picture_page(arguments.page.read_text(encoding="utf-8")), arguments.picture)
    print(arguments.picture)
    sys.exit(0)
