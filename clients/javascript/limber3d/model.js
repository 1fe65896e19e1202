// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { checkNames, coordinatesOf, flagOf, idsOf, numberOf } from "./arrays.js";
import { LimberError, invalid } from "./errors.js";
import { Owner, check, copyOf, engine, number, ownedAddress, point, word, writeBytes, writeInput } from "./wasm.js";
/** @import { Coordinates, Ids, Point } from "./arrays.js" */

/**
 * @typedef {object} ModelOptions
 * @property {number} [motionMargin] How far a vertex may move before its bounds are refitted. A length in the model's
 *   frame, finite and >= 0. With 0, the default, every commit() refits all that has moved. Answers do not depend on it
 *   beyond rounding.
 * @property {"off" | "inCommit"} [rebuildPolicy] When a tree is rebuilt in part, because motion has degraded it: never,
 *   or in commits, a little each, which is the default. There is no worker thread, as C++ has it.
 * @property {number | "automatic"} [rebuildBudgetUs] Microseconds that one commit may spend on rebuilding, as estimated
 *   from counts. Finite and >= 0, where 0 means that nothing is ever rebuilt, or "automatic", the default: in
 *   proportion to what else the commit does.
 * @property {boolean} [preallocate] Whether the constructor allocates what moves, commits and rebuilds will need.
 *   Otherwise the first move and the first rebuild do.
 */

/**
 * @typedef {object} TreeStats
 * @property {number} levels of nodes, the root's included
 * @property {number} nodes
 * @property {number} leaves of up to 8 triangles each
 * @property {number} bytes without positions and triangles
 */

/**
 * Work done on the tree since the model was built.
 *
 * @typedef {object} MaintenanceStats
 * @property {number} movedVertices vertices named by updates, repetitions included
 * @property {number} refits 8-wide nodes whose bounds were recomputed
 * @property {number} wholePasses times that a move or commit has gone over the whole tree, or over all vertices
 * @property {number} absorbed vertex moves that stayed within the motion margin and needed no refit
 * @property {number} motionMargin the margin in use
 * @property {number} rebuiltTriangles triangles assigned to leaves anew
 * @property {number} rebuildUs what rebuilding has cost commits, in microseconds estimated from counts
 */

/**
 * @param {number | undefined} margin
 * @returns {number}
 */
function marginOf(margin = 0) {
  if (!(Number.isFinite(margin) && margin >= 0)) throw invalid("motionMargin is not finite and >= 0");
  return margin;
}

/**
 * @param {number | "automatic" | undefined} budget
 * @returns {number} -1 for "automatic"
 */
function budgetOf(budget = "automatic") {
  if (budget === "automatic") return -1;
  if (!(Number.isFinite(budget) && budget >= 0)) {
    throw invalid('rebuildBudgetUs is neither finite and >= 0 nor "automatic"');
  }
  return budget;
}

/**
 * Reads a mesh, and then writes it for the next call; returns the counts as the module takes them.
 *
 * @param {Coordinates} vertices
 * @param {Ids} faces
 * @returns {[vertexCount: number, isFloat32: number, triangleCount: number]}
 */
function writeMesh(vertices, faces) {
  const coordinates = coordinatesOf(vertices, "vertices");
  const ids = idsOf(faces, "faces");
  if (ids.length % 3 !== 0) {
    throw new LimberError("sizeMismatch", `limber3d: faces has ${ids.length} ids, not three a triangle`);
  }
  writeInput(coordinates, ids);
  return [coordinates.length / 3, coordinates instanceof Float32Array ? 1 : 0, ids.length / 3];
}

/**
 * A mesh and its bounding volume hierarchy. Vertices may move; connectivity is fixed.
 *
 * Its memory belongs to the module: dispose() frees it. Otherwise it is freed at some time after the model has become
 * unreachable.
 */
export class Model extends Owner {
  /**
   * Copies the arrays. Throws emptyMesh, nonFinite, tooLarge or indexOutOfRange.
   *
   * Cost: O(n log n).
   *
   * @param {Coordinates} vertices
   * @param {Ids} faces three vertices for each triangle
   * @param {ModelOptions} [options]
   */
  constructor(vertices, faces, options = {}) {
    checkNames(options, ["motionMargin", "rebuildPolicy", "rebuildBudgetUs", "preallocate"]);
    const { motionMargin, rebuildPolicy = "inCommit", rebuildBudgetUs, preallocate } = options;
    if (rebuildPolicy !== "off" && rebuildPolicy !== "inCommit") {
      throw invalid('rebuildPolicy is neither "off" nor "inCommit"');
    }
    const allocatesAtOnce = flagOf(preallocate, "preallocate");
    const margin = marginOf(motionMargin);
    const budget = budgetOf(rebuildBudgetUs);
    const mesh = writeMesh(vertices, faces);
    const rebuilds = rebuildPolicy === "inCommit" ? 1 : 0;
    super(engine().newModel(...mesh, margin, rebuilds, budget, allocatesAtOnce), "deleteBody");
  }

  /**
   * Moves vertex ids[i] to the i-th of `positions`; later entries win where an id is repeated. The tree is repaired by
   * commit().
   *
   * Throws sizeMismatch, indexOutOfRange, nonFinite or tooLarge with the entry's index; the model is then as before.
   * Cost: O(entries), plus O(n) for the first call without `preallocate`.
   *
   * @param {Ids} ids
   * @param {Coordinates} positions in the model's own frame
   */
  moveVertices(ids, positions) {
    const coordinates = coordinatesOf(positions, "positions");
    const entries = idsOf(ids, "ids");
    const address = addressOf(this);
    if (coordinates.length !== 3 * entries.length) {
      throw new LimberError(
        "sizeMismatch",
        `limber3d: ${entries.length} ids, but positions of ${coordinates.length / 3} vertices`,
      );
    }
    writeInput(coordinates, entries);
    check(engine().moveVertices(address, entries.length, coordinates instanceof Float32Array ? 1 : 0));
  }

  /**
   * Moves every vertex. Throws as moveVertices().
   *
   * @param {Coordinates} positions in the model's own frame
   */
  moveAll(positions) {
    const coordinates = coordinatesOf(positions, "positions");
    const address = addressOf(this);
    writeInput(coordinates);
    check(engine().moveAll(address, coordinates.length / 3, coordinates instanceof Float32Array ? 1 : 0));
  }

  /**
   * Repairs the tree; afterwards the model may be queried. Does nothing when no vertex has moved.
   *
   * Cost: O(nodes above moved vertices), at most that of one pass over the whole tree; rebuilding takes what the
   * options say.
   */
  commit() {
    check(engine().commit(addressOf(this)));
  }

  /** Whether nothing has moved since the last commit(). */
  get isCommitted() {
    return engine().isCommitted(addressOf(this)) !== 0;
  }

  /** Commits, and rebuilds the whole tree whatever the options say. Cost: O(n log n). */
  rebuild() {
    check(engine().rebuild(addressOf(this)));
  }

  /**
   * Replaces the option, from the next move or commit on.
   *
   * @param {number} motionMargin
   */
  setMotionMargin(motionMargin) {
    check(engine().setMotionMargin(addressOf(this), marginOf(motionMargin)));
  }

  get vertexCount() {
    engine().meshOf(addressOf(this));
    return word(1);
  }

  get triangleCount() {
    engine().meshOf(addressOf(this));
    return word(3);
  }

  /** A copy of the positions, x, y, z of each vertex. */
  vertices() {
    engine().meshOf(addressOf(this));
    return new Float64Array(copyOf(word(0), 24 * word(1)));
  }

  /** A copy of the triangles, three vertices each. */
  faces() {
    engine().meshOf(addressOf(this));
    return new Uint32Array(copyOf(word(2), 12 * word(3)));
  }

  /**
   * A box along the axes of the model's frame that contains the model. Throws invalidArgument unless committed.
   *
   * @returns {{ low: Point, high: Point }}
   */
  boundingBox() {
    check(engine().boundingBox(addressOf(this)));
    return { low: point(0), high: point(3) };
  }

  /**
   * A sphere that contains the model, in its own frame. Throws invalidArgument unless committed.
   *
   * @returns {{ center: Point, radius: number }}
   */
  boundingSphere() {
    check(engine().boundingSphere(addressOf(this)));
    return { center: point(0), radius: number(3) };
  }

  /**
   * The bounding spheres of one level of the tree, to draw it: of the root on level 0, of all leaves on the last one,
   * treeStats().levels - 1. Each holds the triangles below it. Throws invalidArgument unless committed, and if there is
   * no such level.
   *
   * @param {number} level
   * @returns {Float64Array} x, y, z of the center and the radius of each sphere, in the model's own frame
   */
  nodeSpheres(level) {
    check(engine().nodeSpheres(addressOf(this), numberOf(level, "level")));
    return new Float64Array(copyOf(word(0), word(1)));
  }

  /** @returns {TreeStats} */
  treeStats() {
    engine().treeStats(addressOf(this));
    return { levels: number(0), nodes: number(1), leaves: number(2), bytes: number(3) };
  }

  /**
   * The two vertices of each edge, the smaller id first: what the ids of edges in answers stand for. The first call, or
   * the first motion of a MovingModel, builds them and keeps them: 34 bytes a triangle.
   *
   * @returns {Uint32Array}
   */
  edges() {
    check(engine().edgesOf(addressOf(this)));
    return new Uint32Array(copyOf(word(0), word(1)));
  }

  /** @returns {MaintenanceStats} */
  maintenanceStats() {
    engine().maintenanceStats(addressOf(this));
    return {
      movedVertices: number(0),
      refits: number(1),
      wholePasses: number(2),
      absorbed: number(3),
      motionMargin: number(4),
      rebuiltTriangles: number(5),
      rebuildUs: number(6),
    };
  }

  /** Checks every invariant of the tree; throws brokenInvariant. For tests. Cost: O(n log n). */
  validate() {
    check(engine().validate(addressOf(this)));
  }
}

/**
 * Where a model is in the module's memory. Private to the package.
 *
 * @param {Model} model
 * @param {string} [name] of the argument
 */
export function addressOf(model, name = "model") {
  if (!(model instanceof Model)) throw invalid(`${name} is no Model`);
  return ownedAddress(model, name);
}

/**
 * A mesh whose vertices at equal positions are one.
 *
 * @typedef {object} WeldedMesh
 * @property {Float64Array} vertices
 * @property {Uint32Array} faces three vertices for each triangle
 * @property {Uint32Array} weldedOf for each vertex that was given, the one that it has become
 */

/**
 * Makes one vertex of those at equal positions, as queries need it that go by vertex ids: ClosedSurface, and what
 * neighbors are. A soup of triangles, whose corners are vertices of their own, becomes a surface.
 *
 * Triangles keep their order and that of their corners. Those with two corners in one place name a vertex twice.
 * Vertices are numbered in order of first appearance; -0 equals 0. Throws as the constructor of a Model. Cost: O(n).
 *
 * @param {Coordinates} vertices
 * @param {Ids} faces three vertices for each triangle
 * @returns {WeldedMesh}
 */
export function weld(vertices, faces) {
  const [vertexCount, isFloat32, triangleCount] = writeMesh(vertices, faces);
  check(engine().weld(vertexCount, isFloat32, triangleCount));
  const welded = {
    vertices: new Float64Array(copyOf(word(0), 24 * word(1))),
    faces: new Uint32Array(copyOf(word(2), 12 * word(3))),
    weldedOf: new Uint32Array(copyOf(word(4), 4 * vertexCount)),
  };
  engine().forgetWelded();
  return welded;
}

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
