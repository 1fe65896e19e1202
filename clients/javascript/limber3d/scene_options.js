// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How a scene is asked: ids, poses, which pairs count, and what is kept from frame to frame.

import { filledFrom, flagOf, idsOf } from "./arrays.js";
import { LimberError, invalid } from "./errors.js";
import { Owner, check, engine, ownedAddress, word, writeIds } from "./wasm.js";
/** @import { Ids } from "./arrays.js" */
/** @import { PairFilter } from "./wasm.js" */

/**
 * Which pairs of objects count: called with two ids, the smaller one first, of objects whose bounds are close, now and
 * then twice; by functions for many configurations once for every two objects. May not call the library; what it throws
 * ends the query.
 *
 * @typedef {(a: number, b: number) => boolean} ObjectPairFilter
 */

/**
 * @typedef {object} ObjectPairOptions
 * @property {ObjectPairFilter | ObjectPairMatrix} [filter] all pairs count without one
 */

/**
 * Which objects count next to a body: called with their ids, as an ObjectPairFilter is with two.
 *
 * @typedef {(id: number) => boolean} ObjectFilter
 */

/**
 * Numbers of 4 x 4 matrices, each column by column, one matrix after the other.
 *
 * @typedef {Float64Array | Float32Array | readonly number[]} Matrices
 */

/** @param {number} id @param {string} name */
export function idOf(id, name) {
  if (!(Number.isInteger(id) && id >= 0 && id <= 0xffffffff)) throw invalid(`${name} is no id`);
  return id;
}

/**
 * Matrices, one for each of the objects: once, or as often as there are configurations.
 *
 * @param {Matrices} array
 * @param {number} objects
 * @param {boolean} isOnce
 */
export function matricesOf(array, objects, isOnce) {
  const isArray = array instanceof Float64Array || array instanceof Float32Array || Array.isArray(array);
  if (!isArray) throw invalid("poses is no Float64Array, Float32Array or array of numbers");
  if (isOnce ? array.length !== 16 * objects : array.length % (16 * objects) !== 0) {
    throw new LimberError("sizeMismatch", `limber3d: poses has ${array.length} numbers, not 16 an id`);
  }
  return array instanceof Float64Array ? array : filledFrom(new Float64Array(array.length), array, "poses");
}

/** Two ids a pair. @param {Ids} array */
export function pairsOf(array) {
  const pairs = idsOf(array, "pairs");
  if (pairs.length % 2 !== 0) {
    throw new LimberError("sizeMismatch", `limber3d: pairs has ${pairs.length} ids, not two a pair`);
  }
  return pairs;
}

/**
 * The filter to call, and what the module is told of it.
 *
 * @param {ObjectPairOptions} options
 * @returns {[wanted: PairFilter | undefined, hasFilter: number, matrix: number]}
 */
export function filterOf({ filter }) {
  if (filter instanceof ObjectPairMatrix) return [undefined, 0, ownedAddress(filter, "filter")];
  if (filter !== undefined && typeof filter !== "function") throw invalid("filter is no function or ObjectPairMatrix");
  return [filter, filter === undefined ? 0 : 1, 0];
}

/** @param {SceneCache | undefined} cache */
export function cacheAddress(cache) {
  if (cache === undefined) return 0;
  if (!(cache instanceof SceneCache)) throw invalid("cache is no SceneCache");
  return ownedAddress(cache, "cache");
}

/**
 * Which pairs of objects count, as a symmetric matrix of bits: a filter. Robots call it the allowed collision matrix,
 * where those pairs are allowed that do not count here. It has to be as large as scene.idBound.
 *
 * Functions throw invalidArgument if an id is not below the size, or a pair is named of one id twice.
 */
export class ObjectPairMatrix extends Owner {
  /**
   * All pairs of ids below `size` count, or none does. A bit for each two ids.
   *
   * @param {number} size
   * @param {boolean} [counts] true if not given
   */
  constructor(size, counts = true) {
    super(engine().newObjectPairMatrix(idOf(size, "size"), flagOf(counts, "counts")), "deleteObjectPairMatrix");
  }

  get size() {
    return engine().matrixSize(ownedAddress(this, "matrix")) >>> 0;
  }

  /**
   * Says whether two ids count as a pair.
   *
   * @param {number} a
   * @param {number} b
   * @param {boolean} counts
   */
  set(a, b, counts) {
    const address = ownedAddress(this, "matrix");
    check(engine().matrixSet(address, idOf(a, "a"), idOf(b, "b"), flagOf(counts, "counts")));
  }

  /**
   * Says it of every two different ids of a list.
   *
   * @param {Ids} ids
   * @param {boolean} counts
   */
  setAmong(ids, counts) {
    const list = idsOf(ids, "ids"), flag = flagOf(counts, "counts");
    const address = ownedAddress(this, "matrix");
    writeIds(list);
    check(engine().matrixSetAmong(address, list.length, flag));
  }

  /**
   * Says it of every id of one list with every other id of another.
   *
   * @param {Ids} idsA
   * @param {Ids} idsB
   * @param {boolean} counts
   */
  setBetween(idsA, idsB, counts) {
    const first = idsOf(idsA, "idsA"), others = idsOf(idsB, "idsB"), flag = flagOf(counts, "counts");
    const address = ownedAddress(this, "matrix");
    writeIds(first, others);
    check(engine().matrixSetBetween(address, first.length, others.length, flag));
  }

  /**
   * Whether a pair counts.
   *
   * @param {number} a
   * @param {number} b
   */
  counts(a, b) {
    check(engine().matrixCounts(ownedAddress(this, "matrix"), idOf(a, "a"), idOf(b, "b")));
    return word(0) === 1;
  }
}

/**
 * What the queries of a scene have found, for those of the next frame to start from. Answers do not depend on it beyond
 * rounding and the asked error. At most 90 kB for each of `maxPairs` pairs; dispose() frees them.
 */
export class SceneCache extends Owner {
  /** @param {number} [maxPairs] 256 if not given */
  constructor(maxPairs = 256) {
    super(engine().newSceneCache(idOf(maxPairs, "maxPairs")), "deleteSceneCache");
  }

  /** Makes the next queries start from nothing, and frees the memory. */
  clear() {
    engine().clearSceneCache(cacheAddress(this));
  }
}
