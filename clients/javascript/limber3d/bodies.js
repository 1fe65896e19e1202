// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models, shapes, and what queries keep of them.

import { checkNames, coordinatesOf, idsOf, none, numberOf, pointOf, poseOf, writePose } from "./arguments.js";
import { LimberError, invalid } from "./errors.js";
import { Owner, check, engine, givenBytes, number, ownedAddress, writeInput } from "./wasm.js";
/** @import { Body, Coordinates, Ids, ModelOptions, Point, PoseOptions, Vector } from "./types.js" */

/** How many points there are, and whether they are float32. @param {Float32Array | Float64Array} coordinates */
export const countOf = (coordinates) => [coordinates.length / 3, coordinates instanceof Float32Array ? 1 : 0];

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
  constructor(vertices, faces, options = none) {
    checkNames(options, ["motionMargin", "rebuildPolicy"]);
    const { motionMargin = 0, rebuildPolicy = "inCommit" } = options;
    if (rebuildPolicy !== "off" && rebuildPolicy !== "inCommit") {
      throw invalid('rebuildPolicy is neither "off" nor "inCommit"');
    }
    if (!(Number.isFinite(motionMargin) && motionMargin >= 0)) throw invalid("motionMargin is not finite and >= 0");
    const coordinates = coordinatesOf(vertices, "vertices"), ids = idsOf(faces, "faces");
    if (ids.length % 3 !== 0) {
      throw new LimberError("sizeMismatch", `limber3d: faces has ${ids.length} ids, not three a triangle`);
    }
    writeInput(coordinates, ids);
    const rebuilds = rebuildPolicy === "inCommit" ? 1 : 0;
    super(engine().newModel(...countOf(coordinates), ids.length / 3, motionMargin, rebuilds));
  }

  /**
   * Moves vertex ids[i] to the i-th of `positions`; later entries win where an id is repeated. The tree is repaired by
   * commit().
   *
   * Throws sizeMismatch, indexOutOfRange, nonFinite or tooLarge with the entry's index; the model is then as before.
   * Cost: O(entries), plus O(n) for the first call.
   *
   * @param {Ids} ids
   * @param {Coordinates} positions in the model's own frame
   */
  moveVertices(ids, positions) {
    const coordinates = coordinatesOf(positions, "positions"), entries = idsOf(ids, "ids");
    const address = modelAddress(this);
    if (coordinates.length !== 3 * entries.length) {
      const found = `${entries.length} ids, but positions of ${coordinates.length / 3} vertices`;
      throw new LimberError("sizeMismatch", `limber3d: ${found}`);
    }
    writeInput(coordinates, entries);
    check(engine().moveVertices(address, ...countOf(coordinates)));
  }

  /**
   * Moves every vertex. Throws as moveVertices().
   *
   * @param {Coordinates} positions in the model's own frame
   */
  moveAll(positions) {
    const coordinates = coordinatesOf(positions, "positions"), address = modelAddress(this);
    writeInput(coordinates);
    check(engine().moveAll(address, ...countOf(coordinates)));
  }

  /**
   * Repairs the tree; afterwards the model may be queried. Does nothing when no vertex has moved.
   *
   * Cost: O(nodes above moved vertices), at most that of one pass over the whole tree, and of what rebuilding takes.
   */
  commit() {
    check(engine().commit(modelAddress(this)));
  }

  /** Commits, and rebuilds the whole tree whatever the options say. Cost: O(n log n). */
  rebuild() {
    check(engine().rebuild(modelAddress(this)));
  }

  /** A copy of the positions, x, y, z of each vertex. */
  vertices() {
    engine().verticesOf(modelAddress(this));
    return new Float64Array(givenBytes());
  }

  /**
   * The two vertices of each edge, the smaller id first: what the ids of edges in answers stand for. The first call, or
   * the first motion of a MovingModel, builds them and keeps them: 34 bytes a triangle.
   */
  edges() {
    check(engine().edgesOf(modelAddress(this)));
    return new Uint32Array(givenBytes());
  }

  /**
   * A box along the axes of the model's frame that contains the model. Throws invalidArgument unless committed.
   *
   * @returns {{ low: Point, high: Point }}
   */
  boundingBox() {
    check(engine().boundingBox(modelAddress(this)));
    return { low: [number(0), number(1), number(2)], high: [number(3), number(4), number(5)] };
  }
}

/**
 * A shape: all points that are at most a radius from its core, a few triangles; of a solid also all points that these
 * enclose. Functions of two bodies, and scenes, take shapes as they take models. A shape does not change.
 *
 * Functions that make one throw invalidArgument unless all lengths, coordinates and radii are finite, at most 2 ** 200
 * in size and, where they are sizes, >= 0. Its memory belongs to the module, as that of a model: dispose() frees it.
 */
export class Shape extends Owner {
  /** How far points of the shape are from the core at most, but for the inside of solids. @readonly */
  radius = number(0);

  /** Whether the core's surface is closed, and what it encloses belongs to the shape. @readonly */
  isSolid = number(1) === 1;

  /**
   * Private: made by the functions below, of what the module has just made.
   *
   * @private
   * @param {number} address
   */
  constructor(address) {
    if (typeof address !== "number") throw invalid("a Shape is made by functions such as Shape.sphere()");
    super(address);
  }

  /** A ball around the origin. @param {number} radius */
  static sphere(radius) {
    return new Shape(engine().newSphere(numberOf(radius, "radius")));
  }

  /**
   * All points at most `radius` from a segment.
   *
   * @param {Vector} start
   * @param {Vector} end
   * @param {number} radius
   */
  static capsule(start, end, radius) {
    const ends = Float64Array.of(...pointOf(start, "start"), ...pointOf(end, "end"));
    const size = numberOf(radius, "radius");
    writeInput(ends);
    return new Shape(engine().newCapsule(size));
  }

  /**
   * A solid box around the origin. With a radius, all points that are at most that far from it: a larger box with round
   * edges.
   *
   * @param {Vector} halfExtents
   * @param {number} [radius] 0 if not given
   */
  static box(halfExtents, radius) {
    const extents = pointOf(halfExtents, "halfExtents");
    return new Shape(engine().newBox(...extents, numberOf(radius, "radius", 0)));
  }

  /**
   * The convex hull of some points, a solid; or a flat polygon, a segment or a point, where the points leave no more.
   * With a radius, all points that are at most that far from it. It is exactly the hull, and its corners are points.
   *
   * Throws also unless there is a point. Cost: O(n h) for h triangles of the hull.
   *
   * @param {Coordinates} points
   * @param {number} [radius] 0 if not given
   */
  static convexHull(points, radius) {
    const coordinates = coordinatesOf(points, "points"), size = numberOf(radius, "radius", 0);
    writeInput(coordinates);
    return new Shape(engine().newConvexHull(...countOf(coordinates), size));
  }
}

/**
 * What a query of two models has found, for the next query of the same two to start from. Keep one for each pair, from
 * frame to frame. Answers do not depend on it beyond the asked error and rounding. 90 kB, which dispose() frees.
 */
export class QueryCache extends Owner {
  constructor() {
    super(engine().newCache());
  }

  /** Makes the next query start from nothing. */
  clear() {
    engine().clearCache(cacheAddress(this));
  }
}

/**
 * Which triangles of a mesh are near each other along the surface, as a filter for self-queries: triangles do not count
 * if a vertex of one and a vertex of the other are joined by a path of at most `maxEdges` edges. With 0 edges, if they
 * share a vertex.
 *
 * Connectivity alone matters, so one object serves all shapes that a model takes. dispose() frees its memory.
 */
export class NeighborRings extends Owner {
  /** @param {Model} model @param {number} maxEdges */
  constructor(model, maxEdges) {
    super(engine().newRings(modelAddress(model), numberOf(maxEdges, "maxEdges")));
  }
}

// --- where they are in the module's memory: private to the package ---

/** @param {Model} model @param {string} [name] of the argument */
export function modelAddress(model, name = "model") {
  if (!(model instanceof Model)) throw invalid(`${name} is no Model`);
  return ownedAddress(model, name);
}

/** @param {Body} body @param {string} name of the argument */
export function bodyAddress(body, name) {
  if (!(body instanceof Shape || body instanceof Model)) throw invalid(`${name} is no Model or Shape`);
  return ownedAddress(body, name);
}

/** @param {QueryCache | undefined} cache */
export function cacheAddress(cache) {
  if (cache === undefined) return 0;
  if (!(cache instanceof QueryCache)) throw invalid("cache is no QueryCache");
  return ownedAddress(cache, "cache");
}

/** @param {NeighborRings | undefined} filter */
export function ringsAddress(filter) {
  if (filter === undefined) return 0;
  if (!(filter instanceof NeighborRings)) throw invalid("filter is no NeighborRings");
  return ownedAddress(filter, "filter");
}

/**
 * Reads the poses and writes them; returns two bodies and poses, as the module takes them.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PoseOptions} poses
 * @returns {[number, number, number, number]}
 */
export function placedBodies(a, b, { poseA, poseB }) {
  const readA = poseOf(poseA, "poseA"), readB = poseOf(poseB, "poseB");
  const first = bodyAddress(a, "a"), second = bodyAddress(b, "b");
  return [first, writePose(readA, 0), second, writePose(readB, 1)];
}
