// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// When models whose vertices move touch first, and what touches.

import { checkNames, coordinatesOf, flagOf, numberOf } from "./arrays.js";
import { elementImpactOptions, impactStatuses, timesOf } from "./elements.js";
import { invalid } from "./errors.js";
import { checkIndex, columnsOfLast, each, noId } from "./many.js";
import { Model, addressOf } from "./model.js";
import { pathImpact } from "./path.js";
import { poseOf, writePose } from "./poses.js";
import { limitsOf, stats, stoppedBy, witness } from "./queries.js";
import { Shape } from "./shapes.js";
import { Owner, check, engine, number, ownedAddress, point, word, writeInput } from "./wasm.js";
/** @import { Coordinates, Point } from "./arrays.js" */
/** @import { CountOptions } from "./contacts.js" */
/** @import { ElementImpact, ElementImpactOptions, ImpactStatus } from "./elements.js" */
/** @import { PathImpact, PathImpactOptions } from "./path.js" */
/** @import { Pose } from "./poses.js" */
/** @import { QueryBudget, QueryStats, StoppedBy, Witness } from "./queries.js" */
/** @import { Body } from "./shapes.js" */

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
    super(engine().newMovingModel(addressOf(model)), "deleteMovingModel");
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
  setMotion(endPositions, options = {}) {
    checkNames(options, ["startPose", "endPose"]);
    const startPose = poseOf(options.startPose, "startPose"), endPose = poseOf(options.endPose, "endPose");
    const coordinates = coordinatesOf(endPositions, "endPositions"), count = coordinates.length / 3;
    const address = movingAddress(this, "moving model");
    const forms = [writePose(startPose, 0), writePose(endPose, 1)];
    writeInput(coordinates);
    check(engine().setMotion(address, count, coordinates instanceof Float32Array ? 1 : 0, ...forms));
  }
}

/**
 * @param {MovingModel} moving
 * @param {string} name of the argument
 */
function movingAddress(moving, name) {
  if (!(moving instanceof MovingModel)) throw invalid(`${name} is no MovingModel`);
  const address = ownedAddress(moving, name);
  addressOf(moving.model, `the model of ${name}`);
  return address;
}

/**
 * Two elements, the first of model a and the second of model b, or two of one model.
 *
 * - "vertexFace": a vertex of a and a face of b
 * - "faceVertex": a face of a and a vertex of b; never of one model
 * - "edgeEdge": two edges; of one model, the one of smaller id first
 *
 * @typedef {object} ElementPair
 * @property {"vertexFace" | "faceVertex" | "edgeEdge"} kind
 * @property {number} a a vertex, a triangle or an edge, see Model.edges()
 * @property {number} b
 */

/** What the numbers in `kinds` of impacts stand for. @type {readonly ElementPair["kind"][]} */
export const elementPairKinds = Object.freeze(["vertexFace", "faceVertex", "edgeEdge"]);

/**
 * @typedef {object} NearerOptions
 * @property {number} [separationFraction] Elements that are nearer than minSeparation at the start may come as near as
 *   this fraction of their distance then; from 0 to below 1. With 0, the default, they touch at the start.
 */

/** @typedef {ElementImpactOptions & NearerOptions} ImpactOptions */

/**
 * @typedef {object} FirstImpactOptions
 * @property {boolean} [ignoreCrossings] Whether models that cross at the start may go on: only elements that touch
 *   count, a vertex and a face or two edges. Otherwise triangles that intersect at the start are an "initialContact".
 * @property {boolean} [anyContact] whether any contact up to maxTime will do, not the first one
 * @property {QueryBudget} [budget]
 */

/**
 * When two models touch first.
 *
 * @typedef {object} ImpactResult
 * @property {ImpactStatus} status
 * @property {number} lower The first contact is between `lower` and `upper`, as in ElementImpact. With "undecided",
 *   none is before `lower`; if `upper` is finite, the elements touch by then.
 * @property {number} upper
 * @property {ElementPair | null} elements what touches; none if nothing does, or if triangles cross at the start
 * @property {Witness | null} witness the closest points of the elements at the time `upper`, in the world, and a
 *   triangle of each; or a point that two triangles share at the start; none if nothing touches
 * @property {Point} normal from a to b, of length 1; 0, 0, 0 where there is no such direction
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "undecided"
 * @property {QueryStats} stats primitiveTests counts the pairs of elements that may touch
 */

/**
 * Two elements that touch, and when they do first.
 *
 * @typedef {object} Impact
 * @property {ElementPair} elements
 * @property {ElementImpact} time
 */

/** Many impacts, one array for each of their numbers. */
export class Impacts {
  /** Private: made by queries, of what these have left in the module's memory. */
  constructor() {
    const n = word(2), next = columnsOfLast();
    /** How many there are. */
    this.count = n;
    /** False if there may be more than maxCount. */
    this.isComplete = word(3) !== 0;
    this.lowers = next(Float64Array, n);
    this.uppers = next(Float64Array, n);
    /** Ids as in ElementPair. */
    this.elementsA = next(Uint32Array, n);
    this.elementsB = next(Uint32Array, n);
    /** Indices of `elementPairKinds`. */
    this.kinds = next(Uint8Array, n);
    /** Indices of `impactStatuses`. */
    this.statuses = next(Uint8Array, n);
    /** @type {QueryStats} */
    this.stats = stats(0);
  }

  /**
   * One impact as an object.
   *
   * @param {number} i
   * @returns {Impact}
   */
  at(i) {
    checkIndex(i, this.count, "impact");
    return {
      elements: { kind: elementPairKinds[this.kinds[i]], a: this.elementsA[i], b: this.elementsB[i] },
      time: { status: impactStatuses[this.statuses[i]], lower: this.lowers[i], upper: this.uppers[i] },
    };
  }

  [Symbol.iterator]() {
    return each(this);
  }
}

const impactOptions = [...elementImpactOptions, "separationFraction"];

/** @param {ImpactOptions} options */
const limitsInTimeOf = (options) => [
  ...timesOf(options),
  numberOf(options.separationFraction, "separationFraction", 0),
];

/**
 * The options of timeOfImpact() and selfTimeOfImpact(), as the module takes them.
 *
 * @param {ImpactOptions & FirstImpactOptions} options
 */
function firstImpactOptions(options) {
  checkNames(options, [...impactOptions, "ignoreCrossings", "anyContact", "budget"]);
  const { ignoreCrossings, anyContact, budget } = options;
  const flags = [flagOf(ignoreCrossings, "ignoreCrossings"), flagOf(anyContact, "anyContact")];
  return [...limitsInTimeOf(options), ...flags, ...limitsOf(budget)];
}

/** @returns {ImpactResult} */
const impactResult = () => ({
  status: impactStatuses[word(2)],
  lower: number(0),
  upper: number(1),
  elements: word(5) === noId ? null : { kind: elementPairKinds[word(4)], a: word(5), b: word(6) },
  witness: witness(),
  normal: point(10),
  stoppedBy: stoppedBy(),
  stats: stats(8),
});

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
 * @param {ImpactOptions & FirstImpactOptions} [options]
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
 * @param {PathImpactOptions} [options]
 * @returns {PathImpact}
 */
/**
 * @param {MovingModel | Body} a
 * @param {MovingModel | Body} b
 * @param {ImpactOptions & FirstImpactOptions & PathImpactOptions} [options]
 * @returns {ImpactResult | PathImpact}
 */
export function timeOfImpact(a, b, options = {}) {
  if (a instanceof Model || a instanceof Shape) return pathImpact(a, /** @type {Body} */ (b), options);
  const asked = firstImpactOptions(options);
  const second = /** @type {MovingModel} */ (b);
  check(engine().timeOfImpact(movingAddress(a, "a"), movingAddress(second, "b"), ...asked));
  return impactResult();
}

/**
 * The first time at which a moving model touches itself: two of its elements that share no vertex, by id. What crosses
 * at the start is what selfCollide() finds. All else as timeOfImpact().
 *
 * @param {MovingModel} model
 * @param {ImpactOptions & FirstImpactOptions} [options]
 */
export function selfTimeOfImpact(model, options = {}) {
  const asked = firstImpactOptions(options);
  check(engine().timeOfImpact(movingAddress(model, "model"), 0, ...asked));
  return impactResult();
}

/**
 * The options of impacts() and selfImpacts(), as the module takes them.
 *
 * @param {ImpactOptions & CountOptions} options
 */
function impactsOptions(options) {
  checkNames(options, [...impactOptions, "maxCount"]);
  return [...limitsInTimeOf(options), numberOf(options.maxCount, "maxCount", Infinity)];
}

/**
 * All pairs of elements that touch up to maxTime, each once, with the first time at which they do. Crossings do not
 * count. The order depends on the models and their history alone. Throws as timeOfImpact().
 *
 * @param {MovingModel} a
 * @param {MovingModel} b
 * @param {ImpactOptions & CountOptions} [options]
 */
export function impacts(a, b, options = {}) {
  const asked = impactsOptions(options);
  check(engine().impacts(movingAddress(a, "a"), movingAddress(b, "b"), ...asked));
  return new Impacts();
}

/**
 * The same of a moving model and itself, as selfTimeOfImpact().
 *
 * @param {MovingModel} model
 * @param {ImpactOptions & CountOptions} [options]
 */
export function selfImpacts(model, options = {}) {
  const asked = impactsOptions(options);
  check(engine().impacts(movingAddress(model, "model"), 0, ...asked));
  return new Impacts();
}
