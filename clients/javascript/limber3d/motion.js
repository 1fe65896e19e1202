// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// When models whose vertices move, and rigid bodies, touch first. Time goes from 0, the start, to 1, the end.

import { impactResult, rigidImpactResult } from "./answers.js";
import { checkNames, coordinatesOf, flagOf, limitsOf, none, numberOf, pointOf } from "./arguments.js";
import { poseOf, writePose } from "./arguments.js";
import { Model, Shape, bodyAddress, cacheAddress, countOf, modelAddress } from "./bodies.js";
import { invalid } from "./errors.js";
import { Owner, check, engine, givenBytes, ownedAddress, writeInput } from "./wasm.js";
/** @import { Body, Coordinates, ImpactOptions, ImpactResult, Pose, RigidImpactOptions } from "./types.js" */
/** @import { RigidImpactResult, Vector } from "./types.js" */

/**
 * A model in one step of time: each vertex moves on a straight line at constant speed, from its committed position,
 * placed by one pose, to another position, placed by another pose.
 *
 * Moving the model's vertices ends the motion: it has to be set again. dispose() frees its memory, 48 bytes a vertex
 * and some 140 bytes a triangle, and leaves the model alone.
 */
export class MovingModel extends Owner {
  /** @type {Model} */
  #model;

  /**
   * It has no motion yet. Cost: O(n).
   *
   * @param {Model} model
   */
  constructor(model) {
    super(engine().newMovingModel(modelAddress(model)));
    this.#model = model;
  }

  get model() {
    return this.#model;
  }

  /**
   * Sets the motion of one step. Throws sizeMismatch, nonFinite or tooLarge with the entry's index, or notRigid, and
   * the motion is then as before; invalidArgument unless the model is committed.
   *
   * Cost: O(n); some four times as much as a commit() that moves all vertices.
   *
   * @param {Coordinates} endPositions in the model's own frame, of every vertex
   * @param {{ startPose?: Pose | null, endPose?: Pose | null }} [options]
   */
  setMotion(endPositions, options = none) {
    checkNames(options, ["startPose", "endPose"]);
    const startPose = poseOf(options.startPose, "startPose"), endPose = poseOf(options.endPose, "endPose");
    const coordinates = coordinatesOf(endPositions, "endPositions");
    const address = movingAddress(this, "moving model");
    const forms = [writePose(startPose, 0), writePose(endPose, 1)];
    writeInput(coordinates);
    check(engine().setMotion(address, ...countOf(coordinates), ...forms));
  }
}

/** @param {MovingModel} moving @param {string} name of the argument */
function movingAddress(moving, name) {
  if (!(moving instanceof MovingModel)) throw invalid(`${name} is no MovingModel`);
  modelAddress(moving.model, `the model of ${name}`);
  return ownedAddress(moving, name);
}

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
    super(engine().newRigidMotion(writePose(first, 0), writePose(last, 1), x, y, z));
  }

  /**
   * The pose at a time, a 4 x 4 matrix by columns; exactly that of the start and of the end at 0 and 1. Throws
   * invalidArgument unless the time is from 0 to 1.
   *
   * @param {number} time
   */
  at(time) {
    check(engine().poseAt(ownedAddress(this, "motion"), numberOf(time, "time")));
    return [...new Float64Array(givenBytes())];
  }
}

/** 0 stands for a body that stays where its model is. @param {RigidMotion | undefined} motion @param {string} name */
function motionAddress(motion, name) {
  if (motion === undefined) return 0;
  if (!(motion instanceof RigidMotion)) throw invalid(`${name} is no RigidMotion`);
  return ownedAddress(motion, name);
}

/** @param {Body} a @param {Body} b @param {RigidImpactOptions} options */
function rigidTimeOfImpact(a, b, options) {
  checkNames(options, ["motionA", "motionB", "maxTime", "minSeparation", "distanceError", "budget", "cache"]);
  const { motionA, motionB, distanceError, budget, cache } = options, maxTime = numberOf(options.maxTime, "maxTime", 1);
  const minSeparation = numberOf(options.minSeparation, "minSeparation", 0), limits = limitsOf(budget);
  const error = [distanceError === undefined ? 0 : 1, numberOf(distanceError, "distanceError", 0)];
  const first = [bodyAddress(a, "a"), motionAddress(motionA, "motionA")];
  const second = [bodyAddress(b, "b"), motionAddress(motionB, "motionB")], kept = cacheAddress(cache);
  check(engine().rigidTimeOfImpact(...first, ...second, maxTime, minSeparation, ...error, ...limits, kept));
  return rigidImpactResult();
}

/** As the module takes them. @param {ImpactOptions} options */
function impactOptions(options) {
  checkNames(options, ["maxTime", "timeError", "minSeparation", "separationFraction", "ignoreCrossings", "anyContact",
    "budget"]);
  const { ignoreCrossings, anyContact, budget } = options;
  return [
    numberOf(options.maxTime, "maxTime", 1),
    numberOf(options.timeError, "timeError", 0),
    numberOf(options.minSeparation, "minSeparation", 0),
    numberOf(options.separationFraction, "separationFraction", 0),
    flagOf(ignoreCrossings, "ignoreCrossings"),
    flagOf(anyContact, "anyContact"),
    ...limitsOf(budget),
  ];
}

/**
 * The first time at which two moving models touch.
 *
 * The first contact is between lower and upper, and upper - lower is at most timeError or 2 ** -53, unless the budget
 * was spent or anyContact is set. No contact is missed, and a reported one is real. Where many elements touch at the
 * same time, in one plane above all, a timeError of 1e-6 saves nearly all of the time.
 *
 * Throws invalidArgument unless both models have a motion that is still valid, and options are what their comments say.
 *
 * @overload
 * @param {MovingModel} a
 * @param {MovingModel} b
 * @param {ImpactOptions} [options]
 * @returns {ImpactResult}
 */
/**
 * The first time at which two rigid bodies are within minSeparation of each other on their way. What crosses is found,
 * however thin it is. A path that only just passes may count as a contact, by distanceError.
 *
 * Throws invalidArgument unless both models are committed and options are what their comments say.
 *
 * Cost: a distance for each part of the gap that is certainly free; 3 to 30 for paths that hit or miss.
 *
 * @overload
 * @param {Body} a
 * @param {Body} b
 * @param {RigidImpactOptions} [options]
 * @returns {RigidImpactResult}
 */
/**
 * @param {MovingModel | Body} a
 * @param {MovingModel | Body} b
 * @param {ImpactOptions & RigidImpactOptions} [options]
 * @returns {ImpactResult | RigidImpactResult}
 */
export function timeOfImpact(a, b, options = none) {
  if (a instanceof Model || a instanceof Shape) return rigidTimeOfImpact(a, /** @type {Body} */ (b), options);
  const asked = impactOptions(options), second = /** @type {MovingModel} */ (b);
  check(engine().timeOfImpact(movingAddress(a, "a"), movingAddress(second, "b"), ...asked));
  return impactResult();
}

/**
 * The first time at which a moving model touches itself: two of its elements that share no vertex, by id. What crosses
 * at the start is what selfCollide() finds. All else as timeOfImpact().
 *
 * @param {MovingModel} model
 * @param {ImpactOptions} [options]
 */
export function selfTimeOfImpact(model, options = none) {
  const asked = impactOptions(options);
  check(engine().timeOfImpact(movingAddress(model, "model"), 0, ...asked));
  return impactResult();
}
