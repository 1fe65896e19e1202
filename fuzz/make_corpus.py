#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the seed inputs of the fuzz targets: fuzz/make_corpus.py [folder], by default fuzz/corpus beside this script.

Mesh files are small and valid, one for each variant of a format that the readers know. The binary targets get random
bytes in which small numbers are frequent, long enough for a scene and some operations. Output never changes.
"""

from __future__ import annotations

import base64
import json
import random
import struct
import sys
from pathlib import Path

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.25, 0.5, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]


def numbers(values) -> str:
    return " ".join(f"{v:g}" for v in values)


def lines(*parts: str, end: str = "\n") -> bytes:
    return "".join(part + end for part in parts).encode()


def obj_files():
    vertices = [f"v {numbers(p)}" for p in POINTS]
    plain = [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES]
    yield "plain.obj", lines(*vertices, *plain)
    yield "relative_and_textured.obj", lines(
        "# a comment", "mtllib none.mtl", "o body", *(v + " 1" for v in vertices), "vt 0 0", "vn 0 0 1",
        "g side", "usemtl red", "s off", "f -4/1/1 -3/1/1 -2/1/1", "f 1//1 2//1 4//1", "f 2/1 3/1 4/1", "l 1 2", "p 3",
        end="\r\n",
    )  # fmt: skip
    yield "polygon_continued.obj", lines("v 0 0 0", "v 1e0 0 0", "v 1 +1. 0", "v .0 1 -0", "f 1 2 \\", "3 4", "f 1 2")
    yield "coloured.obj", lines(*(v + " 0.5 0.5 0.5" for v in vertices), "vp 0.1", *plain, "#end")


def ply_files():
    def header(form: str, coordinate: str, count: str, index: str, extra: str = "") -> bytes:
        return lines(
            "ply", f"format {form} 1.0", "comment made for tests", f"element vertex {len(POINTS)}",
            *(f"property {coordinate} {axis}" for axis in "xyz"), *([extra] if extra else []),
            f"element face {len(FACES)}", f"property list {count} {index} vertex_indices", "end_header",
        )  # fmt: skip

    rows = [numbers(p) for p in POINTS], [f"3 {numbers(f)}" for f in FACES]
    yield "text.ply", header("ascii", "float", "uchar", "int") + lines(*rows[0], *rows[1])
    yield "text_coloured.ply", header("ascii", "double", "uchar", "uint", "property uchar red") + lines(
        *(row + " 255" for row in rows[0]), *rows[1]
    )
    for name, form, mark in (("little", "binary_little_endian", "<"), ("big", "binary_big_endian", ">")):
        body = b"".join(struct.pack(mark + "3f", *p) for p in POINTS)
        body += b"".join(struct.pack(mark + "B3i", 3, *f) for f in FACES)
        yield f"{name}.ply", header(form, "float", "uchar", "int") + body
    body = b"".join(struct.pack("<3dB", *p, 7) for p in POINTS) + b"".join(struct.pack("<H3H", 3, *f) for f in FACES)
    yield "doubles_and_shorts.ply", header("binary_little_endian", "double", "ushort", "ushort", "property uchar a") + body
    yield "edges_first.ply", lines(
        "ply", "format ascii 1.0", "element edge 1", "property int vertex1", "property int vertex2", "element vertex 3",
        "property float x", "property float y", "property float z", "element face 1",
        "property list uchar int vertex_index", "end_header", "0 1", "0 0 0", "1 0 0", "0 1 0", "3 0 1 2",
    )  # fmt: skip


def off_files():
    rows = [numbers(p) for p in POINTS], [f"3 {numbers(f)}" for f in FACES]
    yield "plain.off", lines("OFF", "4 4 6", *rows[0], *rows[1])
    yield "commented.off", lines("OFF 4 4 0 # counts", "# points", "", *rows[0], *(row + " 255 0 0" for row in rows[1]))
    yield "colours.off", lines("COFF", "4 4 0", *(row + " 255 128 0 255" for row in rows[0]), *rows[1])
    yield "normals.off", lines("NOFF", "4 4 0", *(row + " 0 0 1" for row in rows[0]), *rows[1])
    yield "polygon.off", lines("OFF", "4 1 0", "0 0 0", "1 0 0", "1 1 0", "0 1 0", "4 0 1 2 3")
    body = struct.pack(">3i", 4, 4, 0) + b"".join(struct.pack(">3f", *p) for p in POINTS)
    body += b"".join(struct.pack(">5i", 3, *f, 0) for f in FACES)
    yield "binary.off", b"OFF BINARY\n" + body


def stl_files():
    facets = []
    for face in FACES:
        corners = [f"vertex {numbers(POINTS[v])}" for v in face]
        facets += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    yield "text.stl", lines("solid body", *facets, "endsolid body")
    yield "two_solids.stl", lines("solid", *facets[:7], "endsolid", "solid", *facets[7:], "endsolid", end="\r\n")
    triangles = b"".join(
        struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *POINTS[v]) for v in f) + b"\0\0" for f in FACES
    )
    yield "binary.stl", b"binary".ljust(80, b"\0") + struct.pack("<I", len(FACES)) + triangles
    yield "binary_called_solid.stl", b"solid body".ljust(80) + struct.pack("<I", len(FACES)) + triangles


def gltf_document(body: bytes, uri: str | None, *, indices: bool = True, **node) -> dict:
    buffer: dict = {"byteLength": len(body)}
    if uri is not None:
        buffer["uri"] = uri
    primitive: dict = {"attributes": {"POSITION": 0}, "mode": 4}
    accessors = [{"bufferView": 0, "componentType": 5126, "count": len(POINTS), "type": "VEC3",
                  "min": [0, 0, 0], "max": [1, 1, 1]}]  # fmt: skip
    views = [{"buffer": 0, "byteLength": 12 * len(POINTS), "target": 34962}]
    if indices:
        primitive["indices"] = 1
        accessors.append({"bufferView": 1, "componentType": 5123, "count": 3 * len(FACES), "type": "SCALAR"})
        views.append({"buffer": 0, "byteOffset": 12 * len(POINTS), "byteLength": 6 * len(FACES), "target": 34963})
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **node}],
            "meshes": [{"primitives": [primitive]}], "accessors": accessors, "bufferViews": views,
            "buffers": [buffer]}  # fmt: skip


def gltf_files():
    points = b"".join(struct.pack("<3f", *p) for p in POINTS)
    body = points + b"".join(struct.pack("<3H", *f) for f in FACES)

    def data_uri(data: bytes) -> str:
        return "data:application/octet-stream;base64," + base64.b64encode(data).decode()

    def text(document: dict) -> bytes:
        return json.dumps(document, separators=(",", ":")).encode()

    def container(document: dict, data: bytes) -> bytes:
        head = text(document)
        head += b" " * (-len(head) % 4)
        data += b"\0" * (-len(data) % 4)
        chunks = struct.pack("<I4s", len(head), b"JSON") + head + struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    yield "indexed.gltf", text(gltf_document(body, data_uri(body), translation=[1, 2, 3]))
    yield "turned.gltf", text(gltf_document(body, data_uri(body), rotation=[0, 0, 1, 0], scale=[1, 2, 1]))
    soup = gltf_document(points, data_uri(points), indices=False)
    for mode, name in ((4, "list"), (5, "strip"), (6, "fan")):
        soup["meshes"][0]["primitives"][0]["mode"] = mode
        yield f"{name}.gltf", text(soup)
    sparse = gltf_document(body, data_uri(body))
    sparse["bufferViews"] += [{"buffer": 0, "byteOffset": 48, "byteLength": 2}, {"buffer": 0, "byteLength": 12}]
    sparse["accessors"][0]["sparse"] = {
        "count": 1, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3},
    }  # fmt: skip
    yield "sparse.gltf", text(sparse)
    strided = b"".join(struct.pack("<3f4x", *p) for p in POINTS)
    document = gltf_document(strided, data_uri(strided), indices=False)
    document["bufferViews"][0].update(byteLength=len(strided), byteStride=16)
    yield "strided.gltf", text(document)
    tree = gltf_document(body, data_uri(body))
    tree["nodes"] = [{"children": [1, 2], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]}, {"mesh": 0},
                     {"mesh": 0, "scale": [2, 2, 2]}]  # fmt: skip
    yield "tree.gltf", text(tree)
    yield "indexed.glb", container(gltf_document(body, None), body)


def pose_csv_files():
    yield "one.csv", b"1,2,3,1,0,0,0"
    yield "header.csv", lines("tx,ty,tz,qw,qx,qy,qz", "0,0,0,1,0,0,0", "0.5,-1e-3,+2,0.5,0.5,0.5,0.5")
    yield "commented.csv", lines("# poses", "", " 1 , 2 , 3 , 0 , 0 , 0 , 2 ", end="\r\n")
    yield "marked.csv", b"\xef\xbb\xbf" + lines("x,y,z,w,i,j,k", "1e6,0,0,1,1e-9,0,0")
    yield "extreme.csv", lines("1.6e60,0,0,1e-300,0,0,0", "1e-320,0,0,1e300,1e300,0,0")


def triangle_pair_files():
    yield from random_files(1, 20, range(30, 60))
    # Environment, kind, scale; lattice triangles that share a corner, an edge, a plane, or touch inside; a needle.
    for name, kind, a, b in (
        ("shared_corner", 0, "333 433 343", "333 233 334"),
        ("shared_edge", 0, "333 433 343", "333 433 334"),
        ("coplanar_apart", 0, "333 433 343", "553 653 563"),
        ("corner_on_face", 0, "333 533 353", "443 444 554"),
        ("crossing", 0, "333 533 353", "442 444 664"),
        ("equal_points", 0, "444 444 444", "444 444 444"),
        ("needles", 0, "333 433 533", "433 434 435"),
    ):
        yield name, bytes([0, kind, 0]) + bytes(int(c) for c in (a + b).replace(" ", ""))
    for kind in (2, 3):
        yield f"beside_{kind}", bytes([0, kind, 0]) + bytes(range(3, 21)) + bytes([5, 4, 2, 2, 2, 8, 8, 1, 2, 3])


def random_files(seed: int, count: int, sizes: range):
    source = random.Random(seed)

    def byte() -> int:
        return source.randrange(128) if source.random() < 0.75 else source.randrange(256)

    for i in range(count):
        plain = bytes([0, 0, 0]) if i % 2 == 0 else bytes(byte() for _ in range(3))  # environment, kind, scale
        yield f"random_{i:02}", plain + bytes(byte() for _ in range(source.choice(sizes)))


CORPORA = {
    "obj": obj_files,
    "ply": ply_files,
    "off": off_files,
    "stl": stl_files,
    "gltf": gltf_files,
    "pose_csv": pose_csv_files,
    "triangle_pair": triangle_pair_files,
    "model_operations": lambda: random_files(2, 40, range(150, 500)),
}


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "corpus"
    for target, inputs in CORPORA.items():
        (folder / target).mkdir(parents=True, exist_ok=True)
        for name, data in inputs():
            (folder / target / name).write_bytes(data)


if __name__ == "__main__":
    main()
