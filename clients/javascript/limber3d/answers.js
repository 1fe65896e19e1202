// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Makes objects of the tables that queries leave in the module's memory. Private to the package.

import { invalid } from "./errors.js";
import { answers, distanceStatuses, elementPairKinds, featureKinds, impactStatuses, noId } from "./types.js";
import { normalSides, stoppedBys } from "./types.js";
import { addColumns, number, row } from "./wasm.js";
/** @import * as types from "./types.js" */

/**
 * Many answers: an array for each of their numbers.
 *
 * @template T
 */
export class Many {
  /** @type {(columns: any, i: number) => T} */
  #at;

  /**
   * Private: made by queries.
   *
   * @param {string} table
   * @param {number} count
   * @param {(columns: any, i: number) => T} at
   */
  constructor(table, count, at) {
    /** How many there are. */
    this.count = count;
    addColumns(this, table, count);
    this.#at = at;
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   */
  at(i) {
    if (!(Number.isInteger(i) && i >= 0 && i < this.count)) throw invalid(`there is no answer ${i} of ${this.count}`);
    return this.#at(this, i);
  }

  /** @returns {IterableIterator<T>} */
  *[Symbol.iterator]() {
    for (let i = 0; i < this.count; ++i) yield this.at(i);
  }
}

/** @param {Float64Array} from @param {number} i @returns {types.Point} */
const pointAt = (from, i) => [from[3 * i], from[3 * i + 1], from[3 * i + 2]];

/** @param {Uint8Array} from @param {number} i @returns {types.Feature} */
const featureAt = (from, i) => ({ kind: featureKinds[from[2 * i]], index: from[2 * i + 1] });

/** @param {types.WitnessColumns | types.PointColumns} c @param {number} i @returns {types.QueryStats} */
const statsAt = (c, i) => ({ nodeTests: c.nodeTests[i], primitiveTests: c.primitiveTests[i] });

/** @param {types.WitnessColumns} c @param {number} i @returns {types.Witness | null} */
function witnessAt(c, i) {
  const triangleA = c.trianglesA[i], triangleB = c.trianglesB[i];
  if (triangleA === noId) return null;
  return { pointA: pointAt(c.pointsA, i), pointB: pointAt(c.pointsB, i), triangleA, triangleB };
}

/** @param {types.WitnessColumns} c @param {number} i @returns {types.StoppedBy} */
const stoppedByAt = (c, i) => stoppedBys[c.stoppedBys[i]];

/** @param {types.DistanceColumns} c @param {number} i @returns {types.DistanceResult} */
const distanceAt = (c, i) => ({
  lower: c.lowers[i],
  upper: c.uppers[i],
  status: distanceStatuses[c.statuses[i]],
  witness: witnessAt(c, i),
  stoppedBy: stoppedByAt(c, i),
  stats: statsAt(c, i),
});

/** @param {types.CollideColumns} c @param {number} i @returns {types.CollideResult} */
function collideAt(c, i) {
  const answer = answers[c.answers[i]];
  return {
    answer,
    isYes: answer === "yes",
    isNo: answer === "no",
    witness: witnessAt(c, i),
    stoppedBy: stoppedByAt(c, i),
    stats: statsAt(c, i),
  };
}

/** @param {types.ContactColumns} c @param {number} i @returns {types.Contact} */
const contactAt = (c, i) => ({
  distance: c.distances[i],
  depth: c.depths[i],
  pointA: pointAt(c.pointsA, i),
  pointB: pointAt(c.pointsB, i),
  normal: pointAt(c.normals, i),
  weightsA: pointAt(c.weightsA, i),
  weightsB: pointAt(c.weightsB, i),
  triangleA: c.trianglesA[i],
  triangleB: c.trianglesB[i],
  featureA: featureAt(c.featuresA, i),
  featureB: featureAt(c.featuresB, i),
  normalSide: normalSides[c.normalSides[i]],
});

/** @param {types.PointColumns} c @param {number} i @returns {types.PointResult} */
function pointResultAt(c, i) {
  const closest = {
    distance: Math.abs(c.distances[i]),
    position: pointAt(c.positions, i),
    triangle: c.triangles[i],
    weights: pointAt(c.weights, i),
    feature: featureAt(c.features, i),
  };
  return { closest: closest.triangle === noId ? null : closest, stats: statsAt(c, i) };
}

/** @param {types.SignedDistanceColumns} c @param {number} i @returns {types.SignedDistance} */
const signedDistanceAt = (c, i) => ({
  ...pointResultAt(c, i),
  distance: c.distances[i],
  isInside: c.insides[i] === 1,
});

// --- the answers of the last query ---

export const distanceResult = () => distanceAt(row("distance"), 0);
export const collideResult = () => collideAt(row("collide"), 0);

/** @returns {types.ImpactResult} */
export function impactResult() {
  const c = row("impact");
  const [a] = c.elementsA, [b] = c.elementsB;
  return {
    status: impactStatuses[c.statuses[0]],
    lower: c.lowers[0],
    upper: c.uppers[0],
    elements: a === noId ? null : { kind: elementPairKinds[c.kinds[0]], a, b },
    witness: witnessAt(c, 0),
    normal: pointAt(c.normals, 0),
    stoppedBy: stoppedByAt(c, 0),
    stats: statsAt(c, 0),
  };
}

/** @returns {types.RigidImpactResult} */
export function rigidImpactResult() {
  const c = row("rigidImpact");
  return {
    status: impactStatuses[c.statuses[0]],
    time: c.times[0],
    witness: witnessAt(c, 0),
    normal: pointAt(c.normals, 0),
    distanceCount: c.distanceCounts[0],
    stoppedBy: stoppedByAt(c, 0),
    stats: statsAt(c, 0),
  };
}

/** @template T @param {string} table @param {number} count @param {(c: any, i: number) => unknown} at @returns {T} */
const many = (table, count, at) => /** @type {T} */ (new Many(table, count, at));

/** @param {number} count @returns {types.DistanceResults} */
export const distanceResults = (count) => many("distance", count, distanceAt);

/** @param {number} count @returns {types.CollideResults} */
export const collideResults = (count) => many("collide", count, collideAt);

/** @param {number} count @returns {types.PointResults} */
export const pointResults = (count) => many("point", count, pointResultAt);

/** @param {number} count @returns {types.SignedDistances} */
export const signedDistances = (count) => many("signedDistance", count, signedDistanceAt);

/** @returns {types.Contacts} */
export function contactsFound() {
  const stats = { nodeTests: number(4), primitiveTests: number(5) };
  return Object.assign(many("contact", number(2), contactAt), { isComplete: number(3) === 1, stats });
}
