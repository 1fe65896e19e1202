// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many answers: an array for each of their numbers. Private to the package, but for noId.

import { invalid } from "./errors.js";
import { copyOf, word } from "./wasm.js";

/** What arrays have in place of an id that is not there. Single answers have null. */
export const noId = 0xffffffff;

/**
 * Gives the next array: its kind, and how many numbers it has.
 *
 * @typedef {<T>(Kind: new (bytes: ArrayBuffer, at: number, size: number) => T & ArrayBufferView, size: number) => T}
 *   NextColumn
 */

/** Cuts what a query has left in the module's memory into arrays, one after the other. @returns {NextColumn} */
export function columnsOfLast() {
  const bytes = copyOf(word(0), word(1));
  let at = 0;
  return (Kind, size) => {
    const column = new Kind(bytes, at, size);
    at += column.byteLength;
    return column;
  };
}

/** Refuses what is no index of so many. @param {number} i @param {number} count @param {string} what */
export function checkIndex(i, count, what) {
  if (!(Number.isInteger(i) && i >= 0 && i < count)) throw invalid(`there is no ${what} ${i} of ${count}`);
}

/**
 * Three numbers of one of many.
 *
 * @param {Float64Array} from
 * @param {number} i
 * @returns {[number, number, number]}
 */
export const threeOf = (from, i) => [from[3 * i], from[3 * i + 1], from[3 * i + 2]];

/**
 * One object after the other.
 *
 * @template T
 * @param {{ readonly count: number, at: (i: number) => T }} many
 * @returns {IterableIterator<T>}
 */
export function* each(many) {
  for (let i = 0; i < many.count; ++i) yield many.at(i);
}
