// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// When two elements touch first. Time goes from 0, the start, to 1, the end. Vertices move on straight lines at
// constant speed. Elements are closed; they may be degenerate or stand still.

import { checkNames, coordinatesOf, numberOf } from "./arrays.js";
import { LimberError } from "./errors.js";
import { check, engine, number, word, writeInput } from "./wasm.js";
/** @import { Coordinates } from "./arrays.js" */

/**
 * @typedef {object} ElementImpactOptions
 * @property {number} [maxTime] a first contact after this time does not count; from 0 to 1, which is the default.
 *   `upper` may be after it
 * @property {number} [timeError] how far `upper` may be above `lower`; never less than the rounding of a time, 2 ** -53
 * @property {number} [minSeparation] Elements that are this far apart, or less, touch. 0, the default, asks for exact
 *   contact. A greater number may be rounded up, at each time in another way: by up to 2 ** -44 of the extent, the
 *   largest coordinate of a corner relative to the first corner at the start; by more for slivers, short edges and
 *   nearly parallel edges that are about that near.
 */

/**
 * Whether, and when, things that move touch.
 *
 * - "clear": they do not touch up to and including maxTime
 * - "contact": they are apart at the start and touch later
 * - "initialContact": they touch at the start
 * - "undecided": a query of models has spent its budget before it could tell; never without a budget
 *
 * @typedef {"clear" | "contact" | "initialContact" | "undecided"} ImpactStatus
 */

/** What the numbers in `statuses` of impacts stand for. @type {readonly ImpactStatus[]} */
export const impactStatuses = Object.freeze(["clear", "contact", "initialContact", "undecided"]);

/**
 * When two elements touch first: between `lower` and `upper`. Both are 0 for "initialContact", infinite for "clear".
 *
 * @typedef {object} ElementImpact
 * @property {ImpactStatus} status
 * @property {number} lower
 * @property {number} upper
 */

/** Private to the package: the names of the options. */
export const elementImpactOptions = ["maxTime", "timeError", "minSeparation"];

/**
 * Private to the package: the options, as the module takes them.
 *
 * @param {ElementImpactOptions} options
 * @returns {[maxTime: number, timeError: number, minSeparation: number]}
 */
export const timesOf = ({ maxTime, timeError, minSeparation }) => [
  numberOf(maxTime, "maxTime", 1),
  numberOf(timeError, "timeError", 0),
  numberOf(minSeparation, "minSeparation", 0),
];

/** @param {Coordinates} points @param {string} name */
function fourPoints(points, name) {
  const coordinates = coordinatesOf(points, name), count = coordinates.length / 3;
  if (count !== 4) throw new LimberError("sizeMismatch", `limber3d: ${name} has ${count} points, not 4`);
  return coordinates;
}

/**
 * @param {0 | 1} areEdges
 * @param {Coordinates} start
 * @param {Coordinates} end
 * @param {ElementImpactOptions} options
 * @returns {ElementImpact}
 */
function elementImpact(areEdges, start, end, options) {
  checkNames(options, elementImpactOptions);
  const times = timesOf(options);
  const points = new Float64Array(24);
  points.set(fourPoints(start, "start")), points.set(fourPoints(end, "end"), 12);
  writeInput(points);
  check(engine().elementImpact(areEdges, ...times));
  return { status: impactStatuses[word(2)], lower: number(0), upper: number(1) };
}

/**
 * The first time at which a vertex touches a face.
 *
 * Without minSeparation the status is exact: no contact is missed, not even one at a single instant, and a reported one
 * is real. With it, nothing nearer than the separation is missed. lower <= time <= upper, and upper - lower is at most
 * timeError or 2 ** -53.
 *
 * Throws sizeMismatch unless there are four points each; invalidArgument unless coordinates are finite and at most
 * 2 ** 200 in size, and options are what their comments say.
 *
 * @param {Coordinates} start the vertex, then the three corners of the face
 * @param {Coordinates} end the same
 * @param {ElementImpactOptions} [options]
 */
export function vertexFaceImpact(start, end, options = {}) {
  return elementImpact(0, start, end, options);
}

/**
 * The first time at which two edges touch. All else as vertexFaceImpact().
 *
 * @param {Coordinates} start the two ends of one edge, then those of the other
 * @param {Coordinates} end the same
 * @param {ElementImpactOptions} [options]
 */
export function edgeEdgeImpact(start, end, options = {}) {
  return elementImpact(1, start, end, options);
}
