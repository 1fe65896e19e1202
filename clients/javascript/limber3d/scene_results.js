// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers of a scene to many questions, one array for each of their numbers.

import { invalid } from "./errors.js";
import { checkIndex, columnsOfLast, each, noId, threeOf } from "./many.js";
import { answered, distanceStatuses, stoppedBys } from "./queries.js";
/** @import { NextColumn } from "./many.js" */
/** @import { CollideResult, DistanceResult, QueryStats, StoppedBy, Witness } from "./queries.js" */

/** What answers of both kinds have. */
class Results {
  /**
   * Private: made by queries, of what these have left in the module's memory.
   *
   * @param {number} count
   * @param {boolean} hasObjects
   * @param {NextColumn} next
   */
  constructor(count, hasObjects, next) {
    /** How many there are. */
    this.count = count;
    /** Three numbers for each answer, as for the next. All are 0 without a witness. */
    this.pointsA = next(Float64Array, 3 * count);
    this.pointsB = next(Float64Array, 3 * count);
    /** Work done: pairs of bounding volumes, and pairs of triangles, that were compared. */
    this.nodeTests = next(Float64Array, count);
    this.primitiveTests = next(Float64Array, count);
    /** Two ids for each answer; noId if there is no witness. Of many configurations; otherwise empty. */
    this.objects = next(Uint32Array, hasObjects ? 2 * count : 0);
    /** noId if there is no witness. */
    this.trianglesA = next(Uint32Array, count);
    this.trianglesB = next(Uint32Array, count);
    /** Indices of `stoppedBys`. */
    this.stoppedBys = next(Uint8Array, count);
  }

  /**
   * The two objects of configuration i; null without a witness.
   *
   * @param {number} i
   * @returns {[a: number, b: number] | null}
   */
  objectsAt(i) {
    const a = this.objects[2 * i], b = this.objects[2 * i + 1];
    if (a === undefined || b === undefined) throw invalid(`there are no objects of answer ${i}`);
    return a === noId ? null : [a, b];
  }
}

/**
 * What both kinds of answers have in common.
 *
 * @param {Results} results
 * @param {number} i
 * @returns {{ witness: Witness | null, stoppedBy: StoppedBy, stats: QueryStats }}
 */
function common(results, i) {
  checkIndex(i, results.count, "answer");
  const triangleA = results.trianglesA[i], triangleB = results.trianglesB[i];
  const points = { pointA: threeOf(results.pointsA, i), pointB: threeOf(results.pointsB, i) };
  return {
    witness: triangleA === noId ? null : { ...points, triangleA, triangleB },
    stoppedBy: stoppedBys[results.stoppedBys[i]],
    stats: { nodeTests: results.nodeTests[i], primitiveTests: results.primitiveTests[i] },
  };
}

/** Many distances. */
export class DistanceResults extends Results {
  /** Private. @param {number} count @param {boolean} [hasObjects] */
  constructor(count, hasObjects = false) {
    const next = columnsOfLast(), lowers = next(Float64Array, count), uppers = next(Float64Array, count);
    super(count, hasObjects, next);
    this.lowers = lowers;
    this.uppers = uppers;
    /** Indices of `distanceStatuses`. */
    this.statuses = next(Uint8Array, count);
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   * @returns {DistanceResult}
   */
  at(i) {
    const others = common(this, i);
    return { lower: this.lowers[i], upper: this.uppers[i], status: distanceStatuses[this.statuses[i]], ...others };
  }

  [Symbol.iterator]() {
    return each(this);
  }
}

/** Many answers to a question of yes or no. */
export class CollideResults extends Results {
  /** Private. @param {number} count @param {boolean} [hasObjects] */
  constructor(count, hasObjects = false) {
    const next = columnsOfLast();
    super(count, hasObjects, next);
    /** Indices of the package's `answers`. */
    this.answers = next(Uint8Array, count);
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   * @returns {CollideResult}
   */
  at(i) {
    return { ...answered(this.answers[i]), ...common(this, i) };
  }

  [Symbol.iterator]() {
    return each(this);
  }
}
