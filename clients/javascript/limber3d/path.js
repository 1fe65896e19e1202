// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models that move as rigid bodies: when they come too near to each other first, and how near they come. Time goes from
// 0 to 1.

import { checkNames, numberOf, pointOf } from "./arrays.js";
import { impactStatuses } from "./elements.js";
import { invalid } from "./errors.js";
import { poseOf, writePose } from "./poses.js";
import { cacheAddress, limitsOf, stats, stoppedBy, witness } from "./queries.js";
import { bodyAddress } from "./shapes.js";
import { Owner, check, engine, number, ownedAddress, point, word } from "./wasm.js";
/** @import { Point, Vector } from "./arrays.js" */
/** @import { ImpactStatus } from "./elements.js" */
/** @import { Pose } from "./poses.js" */
/** @import { QueryBudget, QueryCache, QueryStats, StoppedBy, Witness } from "./queries.js" */
/** @import { Body } from "./shapes.js" */

/**
 * The motion of a rigid body from one pose to another: a point of it, the center, moves straight at constant speed, and
 * the body turns about it at constant rate about one axis, the shorter way round. dispose() frees its memory.
 */
export class RigidMotion extends Owner {
  /**
   * Throws notRigid; invalidArgument unless the center is finite and at most 2 ** 200 in size.
   *
   * @param {Pose | null} [start]
   * @param {Pose | null} [end] where it starts, if not given
   * @param {Vector} [center] in the model's own frame; its origin, if not given
   */
  constructor(start, end, center = [0, 0, 0]) {
    const first = poseOf(start, "start"), last = end === undefined ? first : poseOf(end, "end");
    const [x, y, z] = pointOf(center, "center");
    super(engine().newRigidMotion(writePose(first, 0), writePose(last, 1), x, y, z), "deleteRigidMotion");
  }

  /**
   * A screw: the center is on the axis about which the body turns and along which it moves, where that is nearest to
   * the model's origin at the start. Where nothing turns, as the constructor. Throws as the constructor.
   *
   * @param {Pose | null} start
   * @param {Pose | null} end
   */
  static screw(start, end) {
    const motion = new RigidMotion(start, end);
    check(engine().makeScrew(ownedAddress(motion, "motion")));
    return motion;
  }

  /**
   * The pose at a time, a 4 x 4 matrix by columns; exactly that of the start and of the end at 0 and 1. Throws
   * invalidArgument unless the time is from 0 to 1.
   *
   * @param {number} time
   * @returns {number[]}
   */
  at(time) {
    check(engine().poseAt(ownedAddress(this, "motion"), numberOf(time, "time")));
    return Array.from({ length: 16 }, (_, i) => number(i));
  }
}

/**
 * @typedef {object} PathOptions
 * @property {RigidMotion} [motionA] how a moves; at the identity all the time if not given
 * @property {RigidMotion} [motionB]
 * @property {number} [maxTime] from 0 to 1, which is the default
 * @property {number} [distanceError] How much more than the separation may count as touching, and how far off a least
 *   distance may be: finite and >= 0. If it is not given, a part of the sum of the radii of both models: 2 ** -20 for
 *   what touches, 2 ** -10 for a least distance, or of that distance if it is larger. Never less than what moves in
 *   2 ** -40 of the time: 0 asks for that, and models that pass each other closely then take very many distances.
 * @property {QueryBudget} [budget] its maxSteps counts distances
 * @property {QueryCache} [cache]
 */

/**
 * @typedef {object} SeparationOptions
 * @property {number} [minSeparation] models that are this far apart, or less, touch; finite and >= 0
 */

/** @typedef {PathOptions & SeparationOptions} PathImpactOptions */

/**
 * When two models come too near to each other first. They are farther apart than the separation before `time`, and at
 * most distanceError farther apart at `time` for "contact" and "initialContact".
 *
 * @typedef {object} PathImpact
 * @property {ImpactStatus} status
 * @property {number} time infinite for "clear"
 * @property {Witness | null} witness the closest points at `time`, if they touch
 * @property {Point} normal from a to b, of length 1; 0, 0, 0 without a witness
 * @property {number} distanceCount how many distances were asked for
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "undecided"
 * @property {QueryStats} stats
 */

/**
 * How near two models come to each other on their way.
 *
 * @typedef {object} PathDistance
 * @property {number} lower no nearer than this at any time up to maxTime
 * @property {number} upper so far apart at `time`; at most distanceError above `lower`, unless the budget was spent
 * @property {number} time
 * @property {Witness | null} witness the closest points at `time`
 * @property {number} distanceCount how many distances were asked for
 * @property {StoppedBy} stoppedBy
 * @property {QueryStats} stats
 */

/**
 * Private to the package: 0 stands for a body that stays where its model is.
 *
 * @param {RigidMotion | undefined} motion @param {string} name
 */
export function motionAddress(motion, name) {
  if (motion === undefined) return 0;
  if (!(motion instanceof RigidMotion)) throw invalid(`${name} is no RigidMotion`);
  return ownedAddress(motion, name);
}

/**
 * Two models and their motions, as the module takes them.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PathOptions} motions
 * @returns {[number, number, number, number]}
 */
function movingBodies(a, b, { motionA, motionB }) {
  const ofA = motionAddress(motionA, "motionA"), ofB = motionAddress(motionB, "motionB");
  return [bodyAddress(a, "a"), ofA, bodyAddress(b, "b"), ofB];
}

/**
 * Private to the package: whether an error is given, and the error.
 *
 * @param {number | undefined} value
 */
export const distanceErrorOf = (value) => [value === undefined ? 0 : 1, numberOf(value, "distanceError", 0)];

/** What both results have. */
const asked = () => ({
  time: number(10),
  witness: witness(),
  distanceCount: number(11),
  stoppedBy: stoppedBy(),
  stats: stats(8),
});

/** Private to the package: the last result. @returns {PathImpact} */
export function pathImpactResult() {
  return { status: impactStatuses[word(2)], ...asked(), normal: point(12) };
}

/**
 * Private to the package: timeOfImpact() of rigid bodies.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PathImpactOptions} options
 * @returns {PathImpact}
 */
export function pathImpact(a, b, options) {
  checkNames(options, ["motionA", "motionB", "maxTime", "minSeparation", "distanceError", "budget", "cache"]);
  const { budget, cache } = options, maxTime = numberOf(options.maxTime, "maxTime", 1);
  const minSeparation = numberOf(options.minSeparation, "minSeparation", 0);
  const distanceError = distanceErrorOf(options.distanceError), limits = limitsOf(budget);
  const bodies = movingBodies(a, b, options), kept = cacheAddress(cache);
  check(engine().pathImpact(...bodies, maxTime, minSeparation, ...distanceError, ...limits, kept));
  return pathImpactResult();
}

/**
 * The least distance of two models up to maxTime, and when they are so near.
 *
 * Promises lower <= least distance <= upper, up to the rounding of distances. Throws invalidArgument unless both models
 * are committed and options are what their comments say.
 *
 * Cost: a distance for each piece of time that the speed cannot exclude, 10 to some 100 by default.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {PathOptions} [options]
 * @returns {PathDistance}
 */
export function minDistance(a, b, options = {}) {
  checkNames(options, ["motionA", "motionB", "maxTime", "distanceError", "budget", "cache"]);
  const { budget, cache } = options, maxTime = numberOf(options.maxTime, "maxTime", 1);
  const distanceError = distanceErrorOf(options.distanceError), limits = limitsOf(budget);
  const bodies = movingBodies(a, b, options), kept = cacheAddress(cache);
  check(engine().minDistance(...bodies, maxTime, ...distanceError, ...limits, kept));
  return { lower: number(0), upper: number(1), ...asked() };
}
