// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Arguments that are arrays. Private to the package.

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
 * @param {Coordinates} array
 * @param {string} name
 * @returns {Float32Array | Float64Array}
 */
export function coordinatesOf(array, name) {
  const isTyped = array instanceof Float32Array || array instanceof Float64Array;
  if (!isTyped && !Array.isArray(array)) throw invalid(`${name} is no Float32Array, Float64Array or array of numbers`);
  const coordinates = isTyped ? array : Float64Array.from(array);
  if (coordinates.length % 3 !== 0) {
    throw new LimberError("sizeMismatch", `limber3d: ${name} has ${coordinates.length} numbers, not three a point`);
  }
  return coordinates;
}

/**
 * @param {Ids} array
 * @param {string} name
 * @returns {Uint32Array | Uint16Array | Int32Array}
 */
export function idsOf(array, name) {
  if (array instanceof Uint32Array || array instanceof Uint16Array) return array;
  const isIds = array instanceof Int32Array || Array.isArray(array);
  if (!isIds) throw invalid(`${name} is no Uint32Array, Uint16Array, Int32Array or array of numbers`);
  for (let i = 0; i < array.length; ++i) {
    if (Number.isInteger(array[i]) && array[i] >= 0 && array[i] <= 0xffffffff) continue;
    throw new LimberError("indexOutOfRange", `limber3d: ${name}[${i}] is ${array[i]}, which is no id`, i);
  }
  return array instanceof Int32Array ? array : Uint32Array.from(array);
}

/**
 * @param {Vector} vector
 * @param {string} name
 * @returns {Point}
 */
export function pointOf(vector, name) {
  const point = /** @type {Point} */ (
    "x" in vector ? [vector.x, vector.y, vector.z] : vector.length === 3 ? [vector[0], vector[1], vector[2]] : []
  );
  if (point.length !== 3 || !point.every((x) => typeof x === "number")) throw invalid(`${name} is not three numbers`);
  return point;
}
