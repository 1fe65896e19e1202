// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { checkNames, numberOf } from "./arrays.js";
import { invalid } from "./errors.js";
import { checkIndex, columnsOfLast, each, threeOf } from "./many.js";
import { addressOf } from "./model.js";
import { cacheAddress, collideResult, distanceResult, errorsOf, placedBodies, stats } from "./queries.js";
import { Owner, callWithFilter, copyOf, engine, ownedAddress, word } from "./wasm.js";
/** @import { Point } from "./arrays.js" */
/** @import { Model } from "./model.js" */
/** @import { CollideResult, DistanceResult, ErrorOptions, PoseOptions, QueryCache, QueryStats } from "./queries.js" */
/** @import { Body } from "./shapes.js" */

/**
 * Which pairs count: called with the ids of two triangles whose bounds are close, before they are compared. May not
 * call the library; what it throws ends the query.
 *
 * @typedef {(a: number, b: number) => boolean} TrianglePairFilter
 */

/**
 * @typedef {object} PairOptions
 * @property {TrianglePairFilter} [filter] all pairs count without one
 */

/**
 * @typedef {object} SelfPairOptions
 * @property {TrianglePairFilter | NeighborRings} [filter] all pairs count without one
 */

/**
 * Which model's triangles have an outside, for the normals of contacts. Without it, those of a closed mesh have one: if
 * each edge, by vertex ids, is run through as often in one direction as in the other. The outside is where corners run
 * counter-clockwise. For one model with itself, any but "none" means that its triangles have one.
 *
 * @typedef {object} OrientedFacesOptions
 * @property {"none" | "ofA" | "ofB" | "both"} [orientedFaces]
 */

/**
 * @typedef {object} CountOptions
 * @property {number} [maxCount] stop after that many pairs
 */

/**
 * @typedef {object} MaxDistanceOptions
 * @property {number} [maxDistance] pairs farther apart do not count; no limit if not given
 */

/**
 * Pairs of triangles, in an order that depends on the models, their history and their poses alone.
 *
 * @typedef {object} TrianglePairs
 * @property {number} count
 * @property {boolean} isComplete false if there may be more than maxCount
 * @property {Uint32Array} triangles two for each pair
 * @property {QueryStats} stats
 */

/** A part of a triangle: vertex i is corner i, edge i goes from corner i to the next one; 0 for the face.
 * @typedef {{ kind: "vertex" | "edge" | "face", index: number }} Feature */

/** How a normal lies to the outsides of the faces: "outward" out of a and into b; "inward" if the triangles are apart,
 * and one looks at the back of the other; "unknown" if neither has an outside, or the faces do not tell.
 * @typedef {"unknown" | "outward" | "inward"} NormalSide */

/**
 * Two triangles that intersect or are close, in the world; for pairs of one model, in the model's own frame.
 *
 * @typedef {object} Contact
 * @property {number} distance 0 exactly when the triangles intersect
 * @property {number} depth 0 unless they intersect: their least overlap, a motion of b that parts them
 * @property {Point} pointA
 * @property {Point} pointB
 * @property {Point} normal of length 1, from a to b
 * @property {Point} weightsA of pointA, by corner of its triangle: >= 0, together 1; 0 off the feature
 * @property {Point} weightsB
 * @property {number} triangleA
 * @property {number} triangleB
 * @property {Feature} featureA
 * @property {Feature} featureB
 * @property {NormalSide} normalSide whether the normal points the way that parts bodies
 */

/** What the first number of each feature stands for, in arrays of features. @type {readonly Feature["kind"][]} */
export const featureKinds = Object.freeze(["vertex", "edge", "face"]);
/** What the numbers in `normalSides` of contacts stand for. @type {readonly NormalSide[]} */
export const normalSides = Object.freeze(["unknown", "outward", "inward"]);

/**
 * Private to the package: a feature of one of many, each of which has two numbers.
 *
 * @param {Uint8Array} from
 * @param {number} i
 * @returns {Feature}
 */
export const featureOf = (from, i) => ({ kind: featureKinds[from[2 * i]], index: from[2 * i + 1] });

/** Many contacts, one array for each of their numbers. */
export class Contacts {
  /** Private: made by queries, of what these have left in the module's memory. */
  constructor() {
    const n = word(2), next = columnsOfLast();
    /** How many there are. */
    this.count = n;
    /** False if there may be more than maxCount. */
    this.isComplete = word(3) !== 0;
    this.distances = next(Float64Array, n);
    this.depths = next(Float64Array, n);
    /** Three numbers for each contact, as for the next two. */
    this.pointsA = next(Float64Array, 3 * n);
    this.pointsB = next(Float64Array, 3 * n);
    this.normals = next(Float64Array, 3 * n);
    /** Of the points, by corner of their triangles: three for each contact, >= 0, together 1. */
    this.weightsA = next(Float64Array, 3 * n);
    this.weightsB = next(Float64Array, 3 * n);
    this.trianglesA = next(Uint32Array, n);
    this.trianglesB = next(Uint32Array, n);
    /** Two numbers for each contact, as for the next: the kind, an index of `featureKinds`, and the feature's index. */
    this.featuresA = next(Uint8Array, 2 * n);
    this.featuresB = next(Uint8Array, 2 * n);
    /** Indices of the package's `normalSides`. */
    this.normalSides = next(Uint8Array, n);
    /** @type {QueryStats} */
    this.stats = stats(0);
  }

  /**
   * One contact as an object.
   *
   * @param {number} i
   * @returns {Contact}
   */
  at(i) {
    checkIndex(i, this.count, "contact");
    return {
      distance: this.distances[i],
      depth: this.depths[i],
      pointA: threeOf(this.pointsA, i),
      pointB: threeOf(this.pointsB, i),
      normal: threeOf(this.normals, i),
      weightsA: threeOf(this.weightsA, i),
      weightsB: threeOf(this.weightsB, i),
      triangleA: this.trianglesA[i],
      triangleB: this.trianglesB[i],
      featureA: featureOf(this.featuresA, i),
      featureB: featureOf(this.featuresB, i),
      normalSide: normalSides[this.normalSides[i]],
    };
  }

  [Symbol.iterator]() {
    return each(this);
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
  /**
   * @param {Model} model
   * @param {number} maxEdges
   */
  constructor(model, maxEdges) {
    super(engine().newRings(addressOf(model), numberOf(maxEdges, "maxEdges")), "deleteRings");
  }
}

/** @param {number} count */
function countOf(count) {
  if (!(numberOf(count, "count") >= 0)) throw invalid("count is not a number of pairs");
  return count;
}

/** @param {PairOptions} options */
function filterOf({ filter }) {
  if (filter !== undefined && typeof filter !== "function") throw invalid("filter is no function");
  return filter;
}

/** @param {SelfPairOptions} options @returns {[TrianglePairFilter | undefined, number]} */
function filterAndRings({ filter }) {
  if (filter instanceof NeighborRings) return [undefined, ownedAddress(filter, "filter")];
  return [filterOf({ filter }), 0];
}

/** Private to the package. @param {OrientedFacesOptions} options */
export function facesOf({ orientedFaces }) {
  if (orientedFaces === undefined) return -1;
  const number = ["none", "ofA", "ofB", "both"].indexOf(orientedFaces);
  if (number < 0) throw invalid("orientedFaces is not none, ofA, ofB or both");
  return number;
}

/** @returns {TrianglePairs} */
const trianglePairs = () => ({
  count: word(2),
  isComplete: word(3) !== 0,
  triangles: new Uint32Array(copyOf(word(0), word(1))),
  stats: stats(0),
});

/**
 * All pairs of triangles that intersect, each once, decided exactly.
 *
 * Throws invalidArgument unless both models are committed; notRigid; what the filter throws.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PoseOptions & PairOptions & CountOptions} [options]
 * @returns {TrianglePairs}
 */
export function intersections(a, b, options = {}) {
  checkNames(options, ["poseA", "poseB", "filter", "maxCount"]);
  const filter = filterOf(options), maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const placed = placedBodies(a, b, options);
  callWithFilter(filter, "intersections", ...placed, maxCount, filter ? 1 : 0);
  return trianglePairs();
}

/**
 * All pairs of triangles at most `margin` apart, each once. With a margin of 0, those that intersect.
 *
 * Throws as intersections(); invalidArgument unless the margin is finite and >= 0.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {number} margin
 * @param {PoseOptions & PairOptions & CountOptions & OrientedFacesOptions} [options]
 * @returns {Contacts}
 */
export function contacts(a, b, margin, options = {}) {
  checkNames(options, ["poseA", "poseB", "filter", "maxCount", "orientedFaces"]);
  const filter = filterOf(options), maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const faces = facesOf(options);
  const placed = placedBodies(a, b, options);
  callWithFilter(filter, "contacts", ...placed, numberOf(margin, "margin"), maxCount, filter ? 1 : 0, faces);
  return new Contacts();
}

/**
 * The closest pairs of triangles, nearest first: `count` of them, or fewer if there are not so many within maxDistance.
 *
 * Throws as intersections(); invalidArgument unless maxDistance is >= 0.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {number} count
 * @param {PoseOptions & PairOptions & MaxDistanceOptions & OrientedFacesOptions} [options]
 * @returns {Contacts}
 */
export function closestPairs(a, b, count, options = {}) {
  checkNames(options, ["poseA", "poseB", "filter", "maxDistance", "orientedFaces"]);
  const filter = filterOf(options), maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity);
  const faces = facesOf(options);
  const placed = placedBodies(a, b, options);
  callWithFilter(filter, "closestPairs", ...placed, countOf(count), maxDistance, filter ? 1 : 0, faces);
  return new Contacts();
}

// --- one model with itself ---
//
// Triangles that share vertices, by id, meet only if they have a point in common beyond what they share by these: a
// vertex, the edge between two, or all of a triangle of the same three. Otherwise such neighbors do not count, however
// close they are. Equal positions under different ids are not shared.

/**
 * Whether a model meets itself; stops at the first such pair found, decided exactly.
 *
 * Throws invalidArgument unless the model is committed; what the filter throws.
 *
 * @param {Model} model
 * @param {SelfPairOptions & { cache?: QueryCache }} [options]
 * @returns {CollideResult}
 */
export function selfCollide(model, options = {}) {
  checkNames(options, ["filter", "cache"]);
  const { cache } = options, [filter, rings] = filterAndRings(options);
  const address = addressOf(model), kept = cacheAddress(cache);
  callWithFilter(filter, "selfCollide", address, filter ? 1 : 0, rings, kept);
  return collideResult();
}

/**
 * The shortest distance of two triangles that are no neighbors; 0 if the model meets itself. Throws as selfCollide().
 *
 * @param {Model} model
 * @param {ErrorOptions & SelfPairOptions & { cache?: QueryCache }} [options]
 * @returns {DistanceResult}
 */
export function selfDistance(model, options = {}) {
  checkNames(options, ["relativeError", "absoluteError", "maxDistance", "filter", "cache"]);
  const errors = errorsOf(options);
  const { cache } = options, [filter, rings] = filterAndRings(options);
  const address = addressOf(model), kept = cacheAddress(cache);
  callWithFilter(filter, "selfDistance", address, ...errors, filter ? 1 : 0, rings, kept);
  return distanceResult();
}

/**
 * All pairs of triangles of a model that meet. Throws as selfCollide().
 *
 * @param {Model} model
 * @param {SelfPairOptions & CountOptions} [options]
 * @returns {TrianglePairs}
 */
export function selfIntersections(model, options = {}) {
  checkNames(options, ["filter", "maxCount"]);
  const maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const [filter, rings] = filterAndRings(options);
  const address = addressOf(model);
  callWithFilter(filter, "selfIntersections", address, maxCount, filter ? 1 : 0, rings);
  return trianglePairs();
}

/**
 * All pairs of triangles of a model that meet, or are no neighbors and at most `margin` apart.
 *
 * Throws as selfCollide(); invalidArgument unless the margin is finite and >= 0.
 *
 * @param {Model} model
 * @param {number} margin
 * @param {SelfPairOptions & CountOptions & OrientedFacesOptions} [options]
 * @returns {Contacts}
 */
export function selfContacts(model, margin, options = {}) {
  checkNames(options, ["filter", "maxCount", "orientedFaces"]);
  const maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const [filter, rings] = filterAndRings(options);
  const faces = facesOf(options);
  const address = addressOf(model);
  callWithFilter(filter, "selfContacts", address, numberOf(margin, "margin"), maxCount, filter ? 1 : 0, rings, faces);
  return new Contacts();
}

/**
 * The closest pairs of triangles of a model that meet or are no neighbors, as closestPairs(). Throws as selfCollide().
 *
 * @param {Model} model
 * @param {number} count
 * @param {SelfPairOptions & MaxDistanceOptions & OrientedFacesOptions} [options]
 * @returns {Contacts}
 */
export function selfClosestPairs(model, count, options = {}) {
  checkNames(options, ["filter", "maxDistance", "orientedFaces"]);
  const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity);
  const [filter, rings] = filterAndRings(options);
  const faces = facesOf(options);
  const address = addressOf(model);
  callWithFilter(filter, "selfClosestPairs", address, countOf(count), maxDistance, filter ? 1 : 0, rings, faces);
  return new Contacts();
}
