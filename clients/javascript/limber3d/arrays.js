// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Arguments: options, numbers and arrays. Private to the package.
//
// Reading an argument may run code of the caller, such as a getter. So every function reads all of its arguments, each
// part once, before it takes the address of an object or writes to the module's memory.

import { LimberError, invalid } from "./errors.js";

/**
 * Three numbers for each point, one point after the other: x, y, z, x, y, z, ... Plain arrays are taken as float64.
 *
 * @typedef {Float32Array | Float64Array | readonly number[]} Coordinates
 */

/**
 * Ids of vertices or triangles. Plain arrays must hold whole numbers.
 *
 * @typedef {Uint32Array | Uint16Array | Int32Array | readonly number[]} Ids
 */

/**
 * Three numbers, as an array or as an object such as three.js's Vector3.
 *
 * @typedef {ArrayLike<number> | { readonly x: number, readonly y: number, readonly z: number }} Vector
 */

/** @typedef {[number, number, number]} Point */

/**
 * Refuses what is no object and options of other names. The caller reads each option once.
 *
 * @param {object} options
 * @param {readonly string[]} names
 * @param {string} [name] of the argument
 */
export function checkNames(options, names, name = "options") {
  if (typeof options !== "object" || options === null) throw invalid(`${name} is no object`);
  for (const key of Object.keys(options)) {
    if (!names.includes(key)) throw invalid(`${name} has no "${key}"; there are ${names.join(", ")}`);
  }
}

/**
 * A number, which is `usual` where an option is not given.
 *
 * @param {number | undefined} value
 * @param {string} name
 * @param {number} [usual]
 */
export function numberOf(value, name, usual) {
  const number = value === undefined ? usual : value;
  if (typeof number !== "number") throw invalid(`${name} is no number`);
  return number;
}

/**
 * True or false, as the module takes it; false where an option is not given.
 *
 * @param {boolean | undefined} value
 * @param {string} name
 */
export function flagOf(value, name) {
  if (value !== undefined && typeof value !== "boolean") throw invalid(`${name} is neither true nor false`);
  return value ? 1 : 0;
}

/**
 * Fills `numbers` from an array.
 *
 * @template {Float64Array | number[]} T
 * @param {T} numbers
 * @param {ArrayLike<number>} array
 * @param {string} name
 */
export function filledFrom(numbers, array, name) {
  for (let i = 0; i < numbers.length; ++i) {
    const number = array[i];
    if (typeof number !== "number") throw invalid(`${name}[${i}] is no number`);
    numbers[i] = number;
  }
  return numbers;
}

/**
 * @param {Coordinates} array
 * @param {string} name
 * @returns {Float32Array | Float64Array}
 */
export function coordinatesOf(array, name) {
  const isTyped = array instanceof Float32Array || array instanceof Float64Array;
  if (!isTyped && !Array.isArray(array)) throw invalid(`${name} is no Float32Array, Float64Array or array of numbers`);
  const coordinates = isTyped ? array : filledFrom(new Float64Array(array.length), array, name);
  if (coordinates.length % 3 !== 0) {
    throw new LimberError("sizeMismatch", `limber3d: ${name} has ${coordinates.length} numbers, not three a point`);
  }
  return coordinates;
}

/**
 * @param {Ids} array
 * @param {string} name
 * @returns {Uint32Array | Uint16Array}
 */
export function idsOf(array, name) {
  if (array instanceof Uint32Array || array instanceof Uint16Array) return array;
  const isIds = array instanceof Int32Array || Array.isArray(array);
  if (!isIds) throw invalid(`${name} is no Uint32Array, Uint16Array, Int32Array or array of numbers`);
  const ids = new Uint32Array(array.length);
  for (let i = 0; i < ids.length; ++i) {
    const id = array[i];
    if (!(Number.isInteger(id) && id >= 0 && id <= 0xffffffff)) {
      const shown = typeof id === "number" ? id : `of type ${typeof id}`;
      throw new LimberError("indexOutOfRange", `limber3d: ${name}[${i}] is ${shown}, which is no id`, i);
    }
    ids[i] = id;
  }
  return ids;
}

/**
 * @param {Vector} vector
 * @param {string} name
 * @returns {Point}
 */
export function pointOf(vector, name) {
  if (typeof vector !== "object" || vector === null) throw invalid(`${name} is not three numbers`);
  const point = /** @type {Point} */ (
    "x" in vector ? [vector.x, vector.y, vector.z] : vector.length === 3 ? [vector[0], vector[1], vector[2]] : []
  );
  if (point.length !== 3 || !point.every((x) => typeof x === "number")) throw invalid(`${name} is not three numbers`);
  return point;
}
