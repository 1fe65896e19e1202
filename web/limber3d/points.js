// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { checkNames, coordinatesOf, numberOf, pointOf } from "./arrays.js";
import { featureKinds } from "./contacts.js";
import { invalid } from "./errors.js";
import { addressOf } from "./model.js";
import { poseOf, writePose } from "./poses.js";
import { Owner, check, copyOf, engine, word, writeInput } from "./wasm.js";
/** @import { Coordinates, Point, Vector } from "./arrays.js" */
/** @import { Feature } from "./contacts.js" */
/** @import { Model } from "./model.js" */
/** @import { Pose } from "./poses.js" */

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
 * @property {Point} barycentric weights of the triangle's corners
 * @property {Feature} feature what the position lies on
 */

/**
 * @typedef {object} SignedDistance
 * @property {number} distance negative inside; infinite where nothing is as close as maxDistance
 * @property {boolean} isInside whether the surface encloses the point, or the point lies on it
 * @property {SurfacePoint | null} closest none exactly when nothing is as close as maxDistance
 */

/** Closest points of a model to many points, one array for each of their numbers. */
export class SurfacePoints {
  /** Private: made by queries, of what these have left in the module's memory. @param {number} count */
  constructor(count) {
    const bytes = copyOf(word(0), word(1));
    this.count = count;
    /** Infinite where nothing is as close as maxDistance. Of signedDistances(), negative inside. */
    this.distances = new Float64Array(bytes, 0, count);
    /** Three numbers for each point. */
    this.positions = new Float64Array(bytes, 8 * count, 3 * count);
    /** Weights of the triangles' corners, three for each point. */
    this.barycentrics = new Float64Array(bytes, 32 * count, 3 * count);
    /** 2 ** 32 - 1 where nothing is as close as maxDistance. */
    this.triangles = new Uint32Array(bytes, 56 * count, count);
    const features = new Uint8Array(bytes, 60 * count, 3 * count);
    /** For each point kind (0 vertex, 1 edge, 2 face) and index of the feature, then 1 if the point is inside. */
    this.features = features;
  }

  /** Of signedDistances(): whether the surface encloses point i. @param {number} i */
  isInside(i) {
    return this.features[3 * i + 2] === 1;
  }

  /**
   * One of them as an object; null where nothing is as close as maxDistance.
   *
   * @param {number} i
   * @returns {SurfacePoint | null}
   */
  at(i) {
    if (!(Number.isInteger(i) && i >= 0 && i < this.count)) throw invalid(`there is no point ${i} of ${this.count}`);
    if (this.triangles[i] === 0xffffffff) return null;
    /** @param {Float64Array} from @returns {Point} */
    const three = (from) => [from[3 * i], from[3 * i + 1], from[3 * i + 2]];
    return {
      distance: Math.abs(this.distances[i]),
      position: three(this.positions),
      triangle: this.triangles[i],
      barycentric: three(this.barycentrics),
      feature: { kind: featureKinds[this.features[3 * i]], index: this.features[3 * i + 1] },
    };
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
export function closestPoints(model, points, options = {}) {
  checkNames(options, pointOptions);
  const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity), pose = poseOf(options.pose, "pose");
  const coordinates = coordinatesOf(points, "points");
  const address = addressOf(model), form = writePose(pose, 0);
  const isFloat32 = coordinates instanceof Float32Array ? 1 : 0;
  writeInput(coordinates);
  check(engine().closestPoints(address, form, coordinates.length / 3, isFloat32, maxDistance));
  return new SurfacePoints(coordinates.length / 3);
}

/**
 * The point of a placed model that is closest to a point of the world; null if nothing is as close as maxDistance.
 * Throws as closestPoints().
 *
 * @param {Model} model
 * @param {Vector} point
 * @param {PointOptions} [options]
 */
export function closestPoint(model, point, options = {}) {
  return closestPoints(model, pointOf(point, "point"), options).at(0);
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
   * Private to the package.
   *
   * @override
   * @param {ClosedSurface} surface
   * @param {string} name of the argument
   */
  static addressOf(surface, name) {
    if (!(surface instanceof ClosedSurface)) throw invalid(`${name} is no ClosedSurface`);
    const address = super.addressOf(surface, name);
    addressOf(surface.#model, `the model of ${name}`);
    return address;
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
    const address = ClosedSurface.addressOf(this, "closed surface"), form = writePose(pose, 0);
    check(engine().contains(address, form, x, y, z));
    return word(0) === 1;
  }

  /**
   * Closest points, and whether the surface encloses the points, which makes distances negative. Throws as
   * closestPoints().
   *
   * @param {Coordinates} points
   * @param {PointOptions} [options]
   */
  signedDistances(points, options = {}) {
    checkNames(options, pointOptions);
    const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity), pose = poseOf(options.pose, "pose");
    const coordinates = coordinatesOf(points, "points");
    const address = ClosedSurface.addressOf(this, "closed surface"), form = writePose(pose, 0);
    const isFloat32 = coordinates instanceof Float32Array ? 1 : 0;
    writeInput(coordinates);
    check(engine().signedDistances(address, form, coordinates.length / 3, isFloat32, maxDistance));
    return new SurfacePoints(coordinates.length / 3);
  }

  /**
   * The same for one point.
   *
   * @param {Vector} point
   * @param {PointOptions} [options]
   * @returns {SignedDistance}
   */
  signedDistance(point, options = {}) {
    const found = this.signedDistances(pointOf(point, "point"), options);
    return { distance: found.distances[0], isInside: found.isInside(0), closest: found.at(0) };
  }
}
