// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { invalid } from "./errors.js";
import { check, copyOf, engine, word, writeBytes } from "./wasm.js";

/**
 * A mesh as a file describes it: triangulated; vertices at equal positions are shared.
 *
 * @typedef {object} MeshFile
 * @property {Float64Array} vertices
 * @property {Uint32Array} faces three vertices for each triangle
 * @property {Uint32Array} faceOfTriangle the file's own face, counted from 0, behind each triangle
 * @property {number} faceCount faces in the file
 */

/**
 * Reads a mesh file that is in memory: OBJ, PLY, STL, OFF, or glTF in one piece. The name has the extension, which
 * decides the format, and is what messages call it.
 *
 * Throws unsupportedFormat, malformedFile, emptyMesh, tooLarge, nonFinite or indexOutOfRange.
 *
 * @param {ArrayBuffer | Uint8Array} bytes
 * @param {string} name
 * @returns {MeshFile}
 */
export function readMeshBytes(bytes, name) {
  const isBytes = bytes instanceof Uint8Array || bytes instanceof ArrayBuffer;
  if (!isBytes) throw invalid("bytes is no Uint8Array or ArrayBuffer");
  if (typeof name !== "string") throw invalid("name is no string");
  const nameBytes = new TextEncoder().encode(name);
  writeBytes(bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes), nameBytes);
  check(engine().readMeshBytes(bytes.byteLength, nameBytes.length));
  const file = {
    vertices: new Float64Array(copyOf(word(0), 24 * word(1))),
    faces: new Uint32Array(copyOf(word(2), 12 * word(3))),
    faceOfTriangle: new Uint32Array(copyOf(word(4), 4 * word(3))),
    faceCount: word(5),
  };
  engine().forgetMeshFile();
  return file;
}
