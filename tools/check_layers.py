#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Includes may only point down the layers; third-party headers stay where the tables below put them."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from repository import CPP_SUFFIXES, finding, run, texts

# Folder of src -> the folders of src its files may include, besides itself. A file name stands for that file alone.
PRIVATE = {
    "base": (),
    "layout": (),
    "simd": ("kernels", "layout", "base"),
    "kernels": ("simd", "layout", "base"),
    "geometry": ("simd", "layout", "base"),
    "mesh": ("geometry", "simd", "layout", "base"),
    "bvh": ("geometry", "simd", "layout", "base"),
    "model": ("bvh", "mesh", "geometry", "simd", "layout", "base"),
    "point": ("model", "bvh", "mesh", "geometry", "simd", "layout", "base"),
    "pair": ("point", "model", "bvh", "mesh", "geometry", "simd", "layout", "base"),
    "motion": ("pair", "model", "bvh", "mesh", "geometry", "simd", "layout", "base"),
    "penetration": ("pair", "point", "model", "bvh", "mesh", "geometry", "simd", "layout", "base"),
    "solid": ("pair", "point", "model", "bvh", "mesh", "geometry", "simd", "layout", "base"),
    "scene": ("motion/rigid", "model", "bvh", "geometry", "simd", "layout", "base"),
    "io": ("base/check.h", "base/float_environment.h"),
}

# Folder of src -> the public headers it may include, where that is not every one but io.h and eigen.h.
PUBLIC = {
    "base": ("base.h", "math.h", "distance.h", "points.h"),
    "layout": ("base.h", "math.h"),
    "simd": ("base.h", "math.h", "geometry.h"),
    "kernels": ("base.h", "math.h", "geometry.h"),
    "geometry": ("base.h", "math.h", "geometry.h"),
    "mesh": ("base.h", "math.h", "geometry.h", "mesh.h", "contacts.h", "elements.h"),
    "bvh": ("base.h", "math.h", "geometry.h", "mesh.h"),
    "io": ("base.h", "math.h", "geometry.h", "mesh.h", "io.h"),
}

# First part of a third-party include -> where in the library or above it is welcome. A trailing slash means a folder.
THIRD_PARTY = {
    "boost": ("src/geometry/orientation.cpp", "src/geometry/integers.h", "tests/", "fuzz/", "bench/"),
    "CGAL": ("tests/", "bench/"),
    "Eigen": ("include/limber/eigen.h",),
    "fcntl.h": ("src/io/file_bytes.cpp", "clients/", "tests/"),
    "gmpxx.h": ("tests/",),
    "hwy": ("src/simd/", "src/kernels/"),
    "sys": ("src/io/file_bytes.cpp", "clients/", "tests/", "bench/realtime/haptics.cpp"),
    "tbb": ("src/base/",),
    "unistd.h": ("src/io/file_bytes.cpp", "clients/", "tests/", "fuzz/"),
    "nlohmann": ("src/io/", "clients/", "tests/", "bench/"),
    "nanobind": ("python/",),
    "oneapi": ("src/base/", "clients/", "python/", "tests/", "bench/"),
    "xlocale.h": ("src/io/scan.cpp",),
    "xmmintrin.h": ("src/base/", "tests/", "fuzz/"),
}

MAY_LOOK_INSIDE = ("tests/unit/", "tests/property/", "tests/peers/", "tests/reference/")
# Folders above the library -> the parts of the repository that their code may name in full.
EDGES = {
    "clients": (),
    "scenes": ("scenes",),
    "tests": ("tests", "scenes"),
    "bench": ("bench", "examples", "scenes"),
    "examples": ("examples", "scenes"),
    "fuzz": ("fuzz", "scenes"),
    "python": ("python", "scenes"),
}

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"]', re.MULTILINE)


def _within(path: str, places: tuple[str, ...]) -> bool:
    return any(path.startswith(place) if place.endswith("/") else path == place for place in places)


def _objection(root: Path, path: str, target: str) -> str | None:
    """Why `path` may not include `target`; None if it may."""
    first, _, rest = target.partition("/")
    top, *folders = path.split("/")[:-1]
    layer = folders[0] if top == "src" and folders else ""
    if ".." in target.split("/"):
        return "names its place from the top, not by '..'"
    if "." not in target and "/" not in target:
        return None  # of the standard library

    if first == "limber":
        if not (root / "include" / target).is_file():
            return "there is no such public header"
        allowed = rest in PUBLIC[layer] if layer in PUBLIC else rest not in ("io.h", "eigen.h")
        return None if top != "src" or allowed else "points up: not a header below this layer"
    if first in THIRD_PARTY:
        return None if _within(path, THIRD_PARTY[first]) else f"{first} is only for {', '.join(THIRD_PARTY[first])}"
    if top == "include":
        return "public headers include the standard library and limber/ only"

    if top == "src":
        if layer not in PRIVATE:
            return f"src/{layer} is not a layer; add it to the table of tools/check_layers.py"
        if first == layer or _within(target, tuple(p if "." in p else p + "/" for p in PRIVATE[layer])):
            return None
        return f"{layer} may include {', '.join(PRIVATE[layer]) or 'no other layer'}, named folder/file.h"

    if first in PRIVATE and (root / "src" / target).is_file():
        return None if path.startswith(MAY_LOOK_INSIDE) else "private header: only public ones may be used here"
    if top == "clients" and first in ("scenes", "reference", "support"):
        # The native twin of the JavaScript package answers about the scenes that the package is asked about.
        is_twin = path.startswith("clients/javascript/tests/") and first == "scenes"
        return None if is_twin else "clients use what is installed: public headers, and their own"
    return None if first in EDGES[top] or first not in EDGES else f"{top} may include {', '.join(EDGES[top])}"


def check(root: Path) -> list[str]:
    return [
        finding(name, text, match.start(), f"includes {match.group(1)}: {objection}")
        for name, text in texts(root, "include", "src", *EDGES, suffixes=CPP_SUFFIXES)
        for match in _INCLUDE.finditer(text)
        if (objection := _objection(root, name, match.group(1))) is not None
    ]


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
