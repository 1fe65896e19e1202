// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { checkNames, coordinatesOf, numberOf, pointOf } from "./arrays.js";
import { featureOf } from "./contacts.js";
import { invalid } from "./errors.js";
import { checkIndex, columnsOfLast, each, noId, threeOf } from "./many.js";
import { addressOf } from "./model.js";
import { poseOf, writePose } from "./poses.js";
import { Owner, check, engine, ownedAddress, word, writeInput } from "./wasm.js";
/** @import { Coordinates, Point, Vector } from "./arrays.js" */
/** @import { Feature } from "./contacts.js" */
/** @import { NextColumn } from "./many.js" */
/** @import { Model } from "./model.js" */
/** @import { Pose } from "./poses.js" */
/** @import { QueryStats } from "./queries.js" */

/**
 * @typedef {object} PointOptions
 * @property {Pose | null} [pose] where the model stands in the world; at the identity if there is none
 * @property {number} [maxDistance] beyond it nothing is found; no limit if not given
 */

/**
 * The point of a model that is closest to some point, in the world.
 *
 * @typedef {object} SurfacePoint
 * @property {number} distance from the point that was asked for
 * @property {Point} position
 * @property {number} triangle
 * @property {Point} weights of the position, by corner of its triangle: >= 0, together 1
 * @property {Feature} feature what the position lies on
 */

/**
 * @typedef {object} PointResult
 * @property {SurfacePoint | null} closest none exactly when nothing is as close as maxDistance
 * @property {QueryStats} stats
 */

/**
 * @typedef {object} SignedDistance
 * @property {number} distance negative inside; infinite where nothing is as close as maxDistance
 * @property {boolean} isInside whether the surface encloses the point, or the point lies on it
 * @property {SurfacePoint | null} closest none exactly when nothing is as close as maxDistance
 * @property {QueryStats} stats
 */

/** Closest points of a model to many points, one array for each of their numbers. */
export class PointResults {
  /**
   * Private: made by queries, of what these have left in the module's memory.
   *
   * @param {number} count
   * @param {NextColumn} [next]
   */
  constructor(count, next = columnsOfLast()) {
    /** How many there are. */
    this.count = count;
    /** Infinite where nothing is as close as maxDistance. */
    this.distances = next(Float64Array, count);
    /** Three numbers for each point. */
    this.positions = next(Float64Array, 3 * count);
    /** Of the positions, by corner of their triangles: three for each point, >= 0, together 1. */
    this.weights = next(Float64Array, 3 * count);
    /** Work done: pairs of bounding volumes, and pairs of triangles, that were compared. */
    this.nodeTests = next(Float64Array, count);
    this.primitiveTests = next(Float64Array, count);
    /** noId where nothing is as close as maxDistance. */
    this.triangles = next(Uint32Array, count);
    /** Two numbers for each point: the kind, an index of `featureKinds`, and the feature's index. */
    this.features = next(Uint8Array, 2 * count);
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   * @returns {PointResult}
   */
  at(i) {
    checkIndex(i, this.count, "point");
    const closest = {
      distance: Math.abs(this.distances[i]),
      position: threeOf(this.positions, i),
      triangle: this.triangles[i],
      weights: threeOf(this.weights, i),
      feature: featureOf(this.features, i),
    };
    return {
      closest: closest.triangle === noId ? null : closest,
      stats: { nodeTests: this.nodeTests[i], primitiveTests: this.primitiveTests[i] },
    };
  }

  /** @returns {IterableIterator<PointResult>} */
  [Symbol.iterator]() {
    return each(this);
  }
}

/** The same with the insides of a surface. Distances are negative inside. */
export class SignedDistances extends PointResults {
  /** Private. @param {number} count */
  constructor(count) {
    const next = columnsOfLast();
    super(count, next);
    /** 1 where the surface encloses the point, or the point lies on it; otherwise 0. */
    this.insides = next(Uint8Array, count);
  }

  /**
   * @override
   * @param {number} i
   * @returns {SignedDistance}
   */
  at(i) {
    return { ...super.at(i), distance: this.distances[i], isInside: this.insides[i] === 1 };
  }

  /** @override @returns {IterableIterator<SignedDistance>} */
  [Symbol.iterator]() {
    return each(this);
  }
}

const pointOptions = ["pose", "maxDistance"];

/**
 * The points of a placed model that are closest to points of the world.
 *
 * Throws invalidArgument unless the model is committed, points are finite and maxDistance is >= 0; notRigid.
 *
 * @param {Model} model
 * @param {Coordinates} points
 * @param {PointOptions} [options]
 */
export function closestPointMany(model, points, options = {}) {
  checkNames(options, pointOptions);
  const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity), pose = poseOf(options.pose, "pose");
  const coordinates = coordinatesOf(points, "points");
  const address = addressOf(model), form = writePose(pose, 0);
  const isFloat32 = coordinates instanceof Float32Array ? 1 : 0;
  writeInput(coordinates);
  check(engine().closestPointMany(address, form, coordinates.length / 3, isFloat32, maxDistance));
  return new PointResults(coordinates.length / 3);
}

/**
 * The point of a placed model that is closest to a point of the world. Throws as closestPointMany().
 *
 * @param {Model} model
 * @param {Vector} point
 * @param {PointOptions} [options]
 */
export function closestPoint(model, point, options = {}) {
  return closestPointMany(model, pointOf(point, "point"), options).at(0);
}

/**
 * A model whose surface is closed and oriented, so that it has an inside: every edge, by vertex ids, belongs to exactly
 * two triangles, which run through it in opposite directions. This is checked once; the model may deform afterwards.
 */
export class ClosedSurface extends Owner {
  /** @type {Model} */
  #model;

  /**
   * Throws notClosed, naming the edge. Cost: O(n log n).
   *
   * @param {Model} model
   */
  constructor(model) {
    super(engine().newClosedSurface(addressOf(model)), "deleteClosedSurface");
    this.#model = model;
  }

  get model() {
    return this.#model;
  }

  /**
   * Whether the surface encloses a point of the world, or the point lies on it: exact for the placed triangles.
   *
   * @param {Vector} point
   * @param {{ pose?: Pose | null }} [options]
   */
  contains(point, options = {}) {
    checkNames(options, ["pose"]);
    const pose = poseOf(options.pose, "pose"), [x, y, z] = pointOf(point, "point");
    const address = surfaceAddress(this, "closed surface"), form = writePose(pose, 0);
    check(engine().contains(address, form, x, y, z));
    return word(0) === 1;
  }

  /**
   * Closest points, and whether the surface encloses the points, which makes distances negative. Throws as
   * closestPointMany().
   *
   * @param {Coordinates} points
   * @param {PointOptions} [options]
   */
  signedDistanceMany(points, options = {}) {
    checkNames(options, pointOptions);
    const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity), pose = poseOf(options.pose, "pose");
    const coordinates = coordinatesOf(points, "points");
    const address = surfaceAddress(this, "closed surface"), form = writePose(pose, 0);
    const isFloat32 = coordinates instanceof Float32Array ? 1 : 0;
    writeInput(coordinates);
    check(engine().signedDistanceMany(address, form, coordinates.length / 3, isFloat32, maxDistance));
    return new SignedDistances(coordinates.length / 3);
  }

  /**
   * The same for one point.
   *
   * @param {Vector} point
   * @param {PointOptions} [options]
   * @returns {SignedDistance}
   */
  signedDistance(point, options = {}) {
    return this.signedDistanceMany(pointOf(point, "point"), options).at(0);
  }
}

/**
 * Private to the package.
 *
 * @param {ClosedSurface} surface
 * @param {string} name of the argument
 */
export function surfaceAddress(surface, name) {
  if (!(surface instanceof ClosedSurface)) throw invalid(`${name} is no ClosedSurface`);
  const address = ownedAddress(surface, name);
  addressOf(surface.model, `the model of ${name}`);
  return address;
}
