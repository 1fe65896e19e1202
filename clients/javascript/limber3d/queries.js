// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of two bodies, of a model and itself, and of points.

import { collideResult, contactsFound, distanceResult, pointResults, signedDistances } from "./answers.js";
import { checkNames, coordinatesOf, errorsOf, limitsOf, none, numberOf, pointOf } from "./arguments.js";
import { poseOf, writePose } from "./arguments.js";
import { cacheAddress, countOf, modelAddress, placedBodies, ringsAddress } from "./bodies.js";
import { Owner, check, engine, number, ownedAddress, writeInput } from "./wasm.js";
/** @import { Model } from "./bodies.js" */
/** @import { Body, Coordinates, CountOptions, ErrorOptions, PointOptions, Pose, PoseOptions } from "./types.js" */
/** @import { QueryOptions, SelfQueryOptions, Vector } from "./types.js" */

/**
 * Shortest distance between two placed models, with a pair of points that attains it.
 *
 * Promises lower <= true distance <= upper, each up to rounding, and upper within either of the asked errors. If the
 * models meet, both are 0 and both points coincide. With a budget that is spent first, the status is "interrupted" and
 * the interval still holds; the next call with the same cache goes on from there.
 *
 * Throws invalidArgument unless both models are committed and options are what their comments say; notRigid.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PoseOptions & QueryOptions & ErrorOptions} [options]
 */
export function distance(a, b, options = none) {
  checkNames(options, ["poseA", "poseB", "relativeError", "absoluteError", "maxDistance", "budget", "cache"]);
  const { cache, budget } = options;
  const [relative, absolute, most] = errorsOf(options), [deadline, maxSteps] = limitsOf(budget);
  const [first, formA, second, formB] = placedBodies(a, b, options), kept = cacheAddress(cache);
  check(engine().distance(first, formA, second, formB, relative, absolute, most, deadline, maxSteps, kept));
  return distanceResult();
}

/**
 * Whether two placed models meet; stops at the first intersecting pair of triangles.
 *
 * Triangles are surfaces: a model wholly inside another does not meet it. With a budget the answer may be "undecided";
 * the next call with the same cache goes on from there. Throws as distance().
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PoseOptions & QueryOptions} [options]
 */
export function collide(a, b, options = none) {
  checkNames(options, ["poseA", "poseB", "budget", "cache"]);
  const { cache, budget } = options;
  const limits = limitsOf(budget), placed = placedBodies(a, b, options);
  check(engine().collide(...placed, ...limits, cacheAddress(cache)));
  return collideResult();
}

/**
 * Whether two placed models are at most maxDistance apart; stops at the first such pair of triangles.
 *
 * Throws as distance(); invalidArgument unless maxDistance is finite and >= 0.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {number} maxDistance
 * @param {PoseOptions & QueryOptions} [options]
 */
export function within(a, b, maxDistance, options = none) {
  checkNames(options, ["poseA", "poseB", "budget", "cache"]);
  const { cache, budget } = options;
  const limits = limitsOf(budget), placed = placedBodies(a, b, options);
  check(engine().within(...placed, numberOf(maxDistance, "maxDistance"), ...limits, cacheAddress(cache)));
  return collideResult();
}

/**
 * All pairs of triangles at most `margin` apart, each once, in an order that depends on the models, their history and
 * their poses alone. With a margin of 0, those that intersect, decided exactly.
 *
 * Throws as distance(); invalidArgument unless the margin is finite and >= 0.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {number} margin
 * @param {PoseOptions & CountOptions} [options]
 */
export function contacts(a, b, margin, options = none) {
  checkNames(options, ["poseA", "poseB", "maxCount"]);
  const maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const placed = placedBodies(a, b, options);
  check(engine().contacts(...placed, numberOf(margin, "margin"), maxCount));
  return contactsFound();
}

// --- one model with itself ---
//
// Triangles that share vertices, by id, meet only if they have a point in common beyond what they share by these: a
// vertex, the edge between two, or all of a triangle of the same three. Otherwise such neighbors do not count, however
// close they are. Equal positions under different ids are not shared.

/**
 * Whether a model meets itself; stops at the first such pair found, decided exactly.
 *
 * Throws invalidArgument unless the model is committed.
 *
 * @param {Model} model
 * @param {SelfQueryOptions} [options]
 */
export function selfCollide(model, options = none) {
  checkNames(options, ["filter", "cache"]);
  const { filter, cache } = options;
  check(engine().selfCollide(modelAddress(model), ringsAddress(filter), cacheAddress(cache)));
  return collideResult();
}

/**
 * The shortest distance of two triangles that are no neighbors; 0 if the model meets itself. Throws as selfCollide().
 *
 * @param {Model} model
 * @param {ErrorOptions & SelfQueryOptions} [options]
 */
export function selfDistance(model, options = none) {
  checkNames(options, ["relativeError", "absoluteError", "maxDistance", "filter", "cache"]);
  const { filter, cache } = options, errors = errorsOf(options);
  check(engine().selfDistance(modelAddress(model), ...errors, ringsAddress(filter), cacheAddress(cache)));
  return distanceResult();
}

/**
 * All pairs of triangles of a model that meet, or are no neighbors and at most `margin` apart; with a margin of 0,
 * those that meet.
 *
 * Throws as selfCollide(); invalidArgument unless the margin is finite and >= 0.
 *
 * @param {Model} model
 * @param {number} margin
 * @param {Omit<SelfQueryOptions, "cache"> & CountOptions} [options]
 */
export function selfContacts(model, margin, options = none) {
  checkNames(options, ["filter", "maxCount"]);
  const { filter } = options, maxCount = numberOf(options.maxCount, "maxCount", Infinity);
  const most = numberOf(margin, "margin");
  check(engine().selfContacts(modelAddress(model), most, maxCount, ringsAddress(filter)));
  return contactsFound();
}

// --- points and a model ---

/**
 * Asks a function of the module about many points; returns how many.
 *
 * @param {string} name
 * @param {() => number} addressOf
 * @param {Coordinates} points
 * @param {PointOptions} options
 */
function askOfPoints(name, addressOf, points, options) {
  checkNames(options, ["pose", "maxDistance"]);
  const maxDistance = numberOf(options.maxDistance, "maxDistance", Infinity), pose = poseOf(options.pose, "pose");
  const coordinates = coordinatesOf(points, "points"), [count, isFloat32] = countOf(coordinates);
  const address = addressOf(), form = writePose(pose, 0);
  writeInput(coordinates);
  check(engine()[name](address, form, count, isFloat32, maxDistance));
  return count;
}

/**
 * The points of a placed model that are closest to points of the world.
 *
 * Throws invalidArgument unless the model is committed, points are finite and maxDistance is >= 0; notRigid.
 *
 * @param {Model} model
 * @param {Coordinates} points
 * @param {PointOptions} [options]
 */
export function closestPointMany(model, points, options = none) {
  return pointResults(askOfPoints("closestPointMany", () => modelAddress(model), points, options));
}

/**
 * The point of a placed model that is closest to a point of the world. Throws as closestPointMany().
 *
 * @param {Model} model
 * @param {Vector} point
 * @param {PointOptions} [options]
 */
export function closestPoint(model, point, options = none) {
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
    super(engine().newClosedSurface(modelAddress(model)));
    this.#model = model;
  }

  #address() {
    modelAddress(this.#model, "the model of closed surface");
    return ownedAddress(this, "closed surface");
  }

  /**
   * Whether the surface encloses a point of the world, or the point lies on it: exact for the placed triangles.
   *
   * @param {Vector} point
   * @param {{ pose?: Pose | null }} [options]
   */
  contains(point, options = none) {
    checkNames(options, ["pose"]);
    const pose = poseOf(options.pose, "pose"), [x, y, z] = pointOf(point, "point");
    const address = this.#address(), form = writePose(pose, 0);
    check(engine().contains(address, form, x, y, z));
    return number(0) === 1;
  }

  /**
   * Closest points, and whether the surface encloses the points, which makes distances negative. Throws as
   * closestPointMany().
   *
   * @param {Coordinates} points
   * @param {PointOptions} [options]
   */
  signedDistanceMany(points, options = none) {
    return signedDistances(askOfPoints("signedDistanceMany", () => this.#address(), points, options));
  }

  /**
   * The same for one point.
   *
   * @param {Vector} point
   * @param {PointOptions} [options]
   */
  signedDistance(point, options = none) {
    return this.signedDistanceMany(pointOf(point, "point"), options).at(0);
  }
}
