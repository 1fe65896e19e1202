// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

import { checkNames, numberOf } from "./arrays.js";
import { invalid } from "./errors.js";
import { noId } from "./many.js";
import { poseOf, writePose } from "./poses.js";
import { bodyAddress } from "./shapes.js";
import { Owner, check, engine, number, ownedAddress, point, word } from "./wasm.js";
/** @import { Point } from "./arrays.js" */
/** @import { Pose } from "./poses.js" */
/** @import { Body } from "./shapes.js" */

/**
 * When a query has to end, whether or not it has its answer: the first limit that is reached ends it. Every query makes
 * at least one step.
 *
 * @typedef {object} QueryBudget
 * @property {number} [deadline] a time of performance.now(), in milliseconds; only as fine as that clock, which
 *   browsers make coarse
 * @property {number} [maxSteps] the same for all machines
 */

/**
 * @typedef {object} PoseOptions
 * @property {Pose | null} [poseA] where a stands in the world; at the identity if there is none
 * @property {Pose | null} [poseB]
 */

/**
 * @typedef {object} QueryOptions
 * @property {QueryBudget} [budget]
 * @property {QueryCache} [cache] what the last query of the same two models has found, to start from
 */

/**
 * How good the answer must be: within either error is enough. Contacts are found at any setting.
 *
 * @typedef {object} ErrorOptions
 * @property {number} [relativeError] the answer may exceed the true distance by this fraction of it; 0 if not given
 * @property {number} [absoluteError] the answer may exceed the true distance by this length; 0 if not given
 * @property {number} [maxDistance] beyond it the query only reports "beyondLimit"; no limit if not given
 */

/** @typedef {PoseOptions & QueryOptions & ErrorOptions} DistanceOptions */

/**
 * A pair of points, one on each model, in the world, and the triangles they lie on.
 *
 * @typedef {object} Witness
 * @property {Point} pointA
 * @property {Point} pointB
 * @property {number} triangleA
 * @property {number} triangleB
 */

/**
 * Work done by one query.
 *
 * @typedef {object} QueryStats
 * @property {number} nodeTests pairs of bounding volumes compared
 * @property {number} primitiveTests pairs of triangles compared; of elements where the query is about these
 */

/**
 * Why a query of a distance stopped where it did.
 *
 * - "exact": lower === upper, the distance up to rounding
 * - "withinError": upper is within the asked error of the true distance
 * - "collision": the models meet, lower === upper === 0
 * - "beyondLimit": nothing is as close as maxDistance; lower >= maxDistance, upper is infinite, no witness
 * - "interrupted": the budget was spent; lower <= distance <= upper
 *
 * @typedef {"exact" | "withinError" | "collision" | "beyondLimit" | "interrupted"} DistanceStatus
 */

/** What the numbers in arrays of statuses stand for. @type {readonly DistanceStatus[]} */
export const distanceStatuses = Object.freeze(["exact", "withinError", "collision", "beyondLimit", "interrupted"]);

/**
 * Which limit of its budget has ended a query.
 *
 * @typedef {"nothing" | "deadline" | "maxSteps"} StoppedBy
 */

/** What the numbers in `stoppedBys` of many answers stand for. @type {readonly StoppedBy[]} */
export const stoppedBys = Object.freeze(["nothing", "deadline", "maxSteps"]);

/**
 * What a question of yes or no is answered; "undecided" if a budget was spent before either was proven.
 *
 * @typedef {"no" | "yes" | "undecided"} Answer
 */

/** What the numbers in `answers` of many answers stand for. @type {readonly Answer[]} */
export const answers = Object.freeze(["no", "yes", "undecided"]);

/**
 * @typedef {object} DistanceResult
 * @property {number} lower no two points of the models are closer
 * @property {number} upper the distance of the witness points
 * @property {DistanceStatus} status
 * @property {Witness | null} witness none exactly when the status is "beyondLimit"
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "interrupted"
 * @property {QueryStats} stats
 */

/**
 * The answer of collide() and within(). It is "undecided" only where a budget was spent; then isYes and isNo are false.
 *
 * @typedef {object} CollideResult
 * @property {Answer} answer
 * @property {boolean} isYes
 * @property {boolean} isNo
 * @property {Witness | null} witness there exactly when the answer is "yes": the same point if the models meet; else at
 *   most as far apart as was asked, and not necessarily the closest
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the answer is "undecided"
 * @property {QueryStats} stats
 */

/**
 * What a query of two models has found, for the next query of the same two to start from. Keep one for each pair, from
 * frame to frame. Answers do not depend on it beyond the asked error and rounding. 90 kB, which dispose() frees.
 */
export class QueryCache extends Owner {
  constructor() {
    super(engine().newCache(), "deleteCache");
  }

  /** Makes the next query start from nothing. */
  clear() {
    engine().clearCache(cacheAddress(this));
  }
}

/** Private to the package. @param {QueryCache | undefined} cache */
export function cacheAddress(cache) {
  if (cache === undefined) return 0;
  if (!(cache instanceof QueryCache)) throw invalid("cache is no QueryCache");
  return ownedAddress(cache, "cache");
}

/** Private to the package. @returns {Witness | null} */
export function witness() {
  if (word(0) === noId) return null;
  return { pointA: point(2), pointB: point(5), triangleA: word(0), triangleB: word(1) };
}

/** Private to the package. */
export const stoppedBy = () => stoppedBys[word(3)];

/** @param {number} i @returns {QueryStats} */
export const stats = (i) => ({ nodeTests: number(i), primitiveTests: number(i + 1) });

/** Private to the package. @returns {DistanceResult} */
export function distanceResult() {
  return {
    lower: number(0),
    upper: number(1),
    status: distanceStatuses[word(2)],
    witness: witness(),
    stoppedBy: stoppedBy(),
    stats: stats(8),
  };
}

/** Private to the package: an answer by its number. @param {number} i */
export const answered = (i) => ({ answer: answers[i], isYes: answers[i] === "yes", isNo: answers[i] === "no" });

/** Private to the package. @returns {CollideResult} */
export const collideResult = () => ({
  ...answered(word(2)),
  witness: witness(),
  stoppedBy: stoppedBy(),
  stats: stats(8),
});

/** Stands for options that are not given. @type {Readonly<DistanceOptions>} */
const none = Object.freeze({});

const distanceOptions = ["poseA", "poseB", "relativeError", "absoluteError", "maxDistance", "budget", "cache"];
const answerOptions = ["poseA", "poseB", "budget", "cache"];

/**
 * Private to the package: the errors and the largest distance, as the module takes them.
 *
 * @param {ErrorOptions} options
 * @returns {[relativeError: number, absoluteError: number, maxDistance: number]}
 */
export const errorsOf = ({ relativeError, absoluteError, maxDistance }) => [
  numberOf(relativeError, "relativeError", 0),
  numberOf(absoluteError, "absoluteError", 0),
  numberOf(maxDistance, "maxDistance", Infinity),
];

/**
 * Private to the package: reads the poses and writes them; returns two bodies and poses, as the module takes them.
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

/** Private to the package. @param {QueryBudget} [budget] @returns {[deadline: number, maxSteps: number]} */
export function limitsOf(budget = /** @type {QueryBudget} */ (none)) {
  checkNames(budget, ["deadline", "maxSteps"], "budget");
  const { deadline, maxSteps } = budget;
  return [numberOf(deadline, "budget.deadline", Infinity), numberOf(maxSteps, "budget.maxSteps", Infinity)];
}

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
 * @param {DistanceOptions} [options]
 * @returns {DistanceResult}
 */
export function distance(a, b, options = none) {
  checkNames(options, distanceOptions);
  const { cache, budget } = options;
  const [relative, absolute, most] = errorsOf(options), [deadline, maxSteps] = limitsOf(budget);
  const [first, formA, second, formB] = placedBodies(a, b, options), kept = cacheAddress(cache);
  const { distance } = engine();
  check(distance(first, formA, second, formB, relative, absolute, most, deadline, maxSteps, kept));
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
 * @returns {CollideResult}
 */
export function collide(a, b, options = none) {
  checkNames(options, answerOptions);
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
 * @returns {CollideResult}
 */
export function within(a, b, maxDistance, options = none) {
  checkNames(options, answerOptions);
  const { cache, budget } = options;
  const limits = limitsOf(budget), placed = placedBodies(a, b, options);
  check(engine().within(...placed, numberOf(maxDistance, "maxDistance"), ...limits, cacheAddress(cache)));
  return collideResult();
}
