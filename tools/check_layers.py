#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Includes may only point down the layers; third-party headers stay where the tables below put them."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from repository import CPP_SUFFIXES, Finding, files, run, shown, text_of

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

# Folder of src -> the public headers it may include; None: every one but io.h, which only io may, and eigen.h.
PUBLIC: dict[str, tuple[str, ...] | None] = {
    "base": ("base.h", "math.h", "distance.h", "points.h"),
    "layout": ("base.h", "math.h"),
    "simd": ("base.h", "math.h", "geometry.h"),
    "kernels": ("base.h", "math.h", "geometry.h"),
    "geometry": ("base.h", "math.h", "geometry.h"),
    "mesh": ("base.h", "math.h", "geometry.h", "mesh.h", "contacts.h", "elements.h"),
    "bvh": ("base.h", "math.h", "geometry.h", "mesh.h"),
    "model": None,
    "point": None,
    "pair": None,
    "motion": None,
    "penetration": None,
    "solid": None,
    "scene": None,
    "io": ("base.h", "math.h", "geometry.h", "mesh.h", "io.h"),
}

# First part of a third-party include -> where in the library or above it is welcome. A trailing slash means a folder.
THIRD_PARTY = {
    "boost": ("src/geometry/exact_sign.cpp", "src/geometry/integers.h", "tests/", "fuzz/", "bench/"),
    "CGAL": ("tests/", "bench/"),
    "Eigen": ("include/limber/eigen.h",),
    "fcntl.h": ("clients/", "tests/"),
    "gmpxx.h": ("tests/",),
    "hwy": ("src/simd/", "src/kernels/"),
    "sys": ("clients/", "tests/", "bench/realtime/haptics.cpp"),
    "tbb": ("src/base/",),
    "unistd.h": ("clients/", "tests/", "fuzz/"),
    "nlohmann": ("src/io/", "clients/", "tests/", "bench/"),
    "nanobind": ("python/",),
    "oneapi": ("src/base/", "clients/", "python/", "tests/", "bench/"),
    "wasm_simd128.h": ("src/simd/", "src/kernels/"),
    "xlocale.h": ("src/io/scan.cpp",),
    "xmmintrin.h": ("src/base/", "tests/", "fuzz/"),
}

# Folders above the library, and which of its private headers they may see.
EDGES = ("clients", "scenes", "tests", "bench", "examples", "fuzz", "python")
MAY_LOOK_INSIDE = ("tests/unit/", "tests/property/", "tests/peers/", "tests/reference/")
# Parts of the repository that edge code may name in full.
EDGE_MAY_INCLUDE = {
    "clients": (),
    "scenes": ("scenes/",),
    "tests": ("tests/", "scenes/"),
    "bench": ("bench/", "examples/", "scenes/"),
    "examples": ("examples/", "scenes/"),
    "fuzz": ("fuzz/", "scenes/"),
    "python": ("python/", "scenes/"),
}

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:<([^>\n]+)>|"([^"\n]+)")')


def _within(path: str, places: tuple[str, ...]) -> bool:
    return any(path.startswith(place) if place.endswith("/") else path == place for place in places)


def _objection(root: Path, path: str, target: str) -> str | None:
    """Why `path` may not include `target`; None if it may."""
    first, _, rest = target.partition("/")
    parts = path.split("/")
    top, layer = parts[0], parts[1] if parts[0] == "src" and len(parts) > 2 else ""
    if ".." in target.split("/"):
        return "names its place from the top, not by '..'"
    if "." not in target and "/" not in target:
        return None  # of the standard library

    if first == "limber":
        if not (root / "include" / target).is_file():
            return "there is no such public header"
        if top != "src":
            return None
        allowed = PUBLIC.get(layer, ())
        if allowed is None:
            return {"io.h": "only src/io may include it", "eigen.h": "the library does not need Eigen"}.get(rest)
        return None if rest in allowed else "points up: not a header below this layer"
    if top == "include" and not _within(path, THIRD_PARTY.get(first, ())):
        return "public headers include the standard library and limber/ only"
    if first in THIRD_PARTY:
        return None if _within(path, THIRD_PARTY[first]) else f"{first} is only for {', '.join(THIRD_PARTY[first])}"

    if top == "src":
        if layer not in PRIVATE:
            return f"src/{layer} is not a layer; add it to the table of tools/check_layers.py"
        if first == layer or _within(target, tuple(p if "." in p else p + "/" for p in PRIVATE[layer])):
            return None
        if first in PRIVATE:
            return f"points up or aside: {layer} may include {', '.join(PRIVATE[layer]) or 'no other layer'}"
        return "neither a standard header nor one of ours (private headers are named folder/file.h)"

    if first in PRIVATE and (root / "src" / target).is_file():
        return None if path.startswith(MAY_LOOK_INSIDE) else "private header: only public ones may be used here"
    if top == "clients" and first in ("scenes", "reference", "support"):
        # The native twin of the JavaScript package answers about the scenes that the package is asked about.
        is_twin = path.startswith("clients/javascript/tests/") and first == "scenes"
        return None if is_twin else "clients use what is installed: public headers, and their own"
    if first + "/" in EDGE_MAY_INCLUDE[top] or first not in EDGES:
        return None
    return f"{top} may include {', '.join(EDGE_MAY_INCLUDE[top])}"


def check(root: Path) -> list[Finding]:
    findings = []
    for path in files(root, "include", "src", *EDGES, suffixes=CPP_SUFFIXES):
        name = shown(root, path)
        for number, line in enumerate(text_of(path).splitlines(), 1):
            match = _INCLUDE.match(line)
            if match is None:
                continue
            target = match.group(1) or match.group(2)
            objection = _objection(root, name, target)
            if objection is not None:
                findings.append(Finding(name, number, f"includes {target}: {objection}"))
    return findings


if __name__ == "__main__":
    sys.exit(run(__doc__, check))
