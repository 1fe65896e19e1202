// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers of a scene to many questions, one array for each of their numbers.

import { invalid } from "./errors.js";
import { answers, limits, statuses } from "./queries.js";
import { copyOf, word } from "./wasm.js";
/** @import { Point } from "./arrays.js" */
/** @import { CollideResult, DistanceResult, QueryStats, StoppedBy, Witness } from "./queries.js" */

/** What answers of both kinds have. */
class Results {
  /**
   * Private: made by queries, of what these have left in the module's memory.
   *
   * @param {number} count
   * @param {boolean} hasBounds
   * @param {boolean} hasObjects
   */
  constructor(count, hasBounds, hasObjects) {
    const bytes = copyOf(word(0), word(1));
    let at = 0;
    /** @param {number} each */
    const numbers = (each) => new Float64Array(bytes, (at += 8 * each * count) - 8 * each * count, each * count);
    /** @param {number} each */
    const ids = (each) => new Uint32Array(bytes, (at += 4 * each * count) - 4 * each * count, each * count);
    /** How many there are. */
    this.count = count;
    /** Lower bounds of distances, then upper ones. @protected */
    this.bounds = numbers(hasBounds ? 2 : 0);
    /** Three numbers for each answer, as for the next. All are 0 without a witness. */
    this.pointsA = numbers(3);
    this.pointsB = numbers(3);
    /** Work done: for each answer pairs of bounding volumes, then pairs of triangles. */
    this.tests = numbers(2);
    /** Two ids for each answer; 2 ** 32 - 1 if there is no witness. Of many configurations; otherwise empty. */
    this.objects = ids(hasObjects ? 2 : 0);
    /** 2 ** 32 - 1 if there is no witness. */
    this.trianglesA = ids(1);
    this.trianglesB = ids(1);
    /** @protected */
    this.statusNumbers = new Uint8Array(bytes, at, count);
    /** 0 nothing, 1 the deadline, 2 maxSteps. */
    this.stoppedBy = new Uint8Array(bytes, at + count, count);
  }

  /**
   * What both kinds of answers have in common.
   *
   * @param {number} i
   * @returns {{ witness: Witness | null, stoppedBy: StoppedBy, stats: QueryStats }}
   * @protected
   */
  common(i) {
    if (!(Number.isInteger(i) && i >= 0 && i < this.count)) throw invalid(`there is no answer ${i} of ${this.count}`);
    /** @param {Float64Array} from @returns {Point} */
    const point = (from) => [from[3 * i], from[3 * i + 1], from[3 * i + 2]];
    const triangleA = this.trianglesA[i], triangleB = this.trianglesB[i];
    const hasWitness = triangleA !== 0xffffffff;
    return {
      witness: hasWitness ? { pointA: point(this.pointsA), pointB: point(this.pointsB), triangleA, triangleB } : null,
      stoppedBy: limits[this.stoppedBy[i]],
      stats: { nodeTests: this.tests[2 * i], triangleTests: this.tests[2 * i + 1] },
    };
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
    return a === 0xffffffff ? null : [a, b];
  }
}

/** Many distances. */
export class DistanceResults extends Results {
  /** Private. @param {number} count @param {boolean} [hasObjects] */
  constructor(count, hasObjects = false) {
    super(count, true, hasObjects);
    this.lower = this.bounds.subarray(0, count);
    this.upper = this.bounds.subarray(count);
    /** 0 exact, 1 within error, 2 collision, 3 beyond limit, 4 interrupted. */
    this.statuses = this.statusNumbers;
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   * @returns {DistanceResult}
   */
  at(i) {
    const common = this.common(i);
    return { lower: this.lower[i], upper: this.upper[i], status: statuses[this.statuses[i]], ...common };
  }

  /** @returns {IterableIterator<DistanceResult>} */
  *[Symbol.iterator]() {
    for (let i = 0; i < this.count; ++i) yield this.at(i);
  }
}

/** Many answers to a question of yes or no. */
export class CollideResults extends Results {
  /** Private. @param {number} count @param {boolean} [hasObjects] */
  constructor(count, hasObjects = false) {
    super(count, false, hasObjects);
    /** 0 no, 1 yes, 2 unknown. */
    this.answers = this.statusNumbers;
  }

  /**
   * One of them as an object.
   *
   * @param {number} i
   * @returns {CollideResult}
   */
  at(i) {
    return { answer: answers[this.answers[i]], ...this.common(i) };
  }

  /** @returns {IterableIterator<CollideResult>} */
  *[Symbol.iterator]() {
    for (let i = 0; i < this.count; ++i) yield this.at(i);
  }
}
