// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads arguments: options, numbers, arrays and poses. Private to the package.
//
// Reading an argument may run code of the caller, such as a getter. So every function reads all of its arguments, each
// part once, before it takes the address of an object or writes to the module's memory.

import { LimberError, invalid } from "./errors.js";
import { writePoseNumbers } from "./wasm.js";
/** @import { Coordinates, ErrorOptions, Ids, Matrix, Point, Pose } from "./types.js" */
/** @import { Quaternion, QueryBudget, Vector } from "./types.js" */

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

// --- numbers ---

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

/** @param {number} id @param {string} name */
export function idOf(id, name) {
  if (!(Number.isInteger(id) && id >= 0 && id <= 0xffffffff)) throw invalid(`${name} is no id`);
  return id;
}

/**
 * The errors and the largest distance, as the module takes them.
 *
 * @param {ErrorOptions} options
 * @returns {[relativeError: number, absoluteError: number, maxDistance: number]}
 */
export const errorsOf = ({ relativeError, absoluteError, maxDistance }) => [
  numberOf(relativeError, "relativeError", 0),
  numberOf(absoluteError, "absoluteError", 0),
  numberOf(maxDistance, "maxDistance", Infinity),
];

/** Stands for options that are not given. */
export const none = Object.freeze({});

/** @param {QueryBudget} [budget] @returns {[deadline: number, maxSteps: number]} */
export function limitsOf(budget = none) {
  checkNames(budget, ["deadline", "maxSteps"], "budget");
  const { deadline, maxSteps } = budget;
  return [numberOf(deadline, "budget.deadline", Infinity), numberOf(maxSteps, "budget.maxSteps", Infinity)];
}

// --- arrays ---

/**
 * Fills `numbers` from an array.
 *
 * @template {Float64Array | number[]} T
 * @param {T} numbers
 * @param {ArrayLike<number>} array
 * @param {string} name
 */
function filledFrom(numbers, array, name) {
  for (let i = 0; i < numbers.length; ++i) {
    const number = array[i];
    if (typeof number !== "number") throw invalid(`${name}[${i}] is no number`);
    numbers[i] = number;
  }
  return numbers;
}

/** @param {Coordinates} array @param {string} name @returns {Float32Array | Float64Array} */
export function coordinatesOf(array, name) {
  const isTyped = array instanceof Float32Array || array instanceof Float64Array;
  if (!isTyped && !Array.isArray(array)) throw invalid(`${name} is no Float32Array, Float64Array or array of numbers`);
  const coordinates = isTyped ? array : filledFrom(new Float64Array(array.length), array, name);
  if (coordinates.length % 3 === 0) return coordinates;
  throw new LimberError("sizeMismatch", `limber3d: ${name} has ${coordinates.length} numbers, not three a point`);
}

/** @param {Ids} array @param {string} name @returns {Uint32Array | Uint16Array} */
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

/** Ids, two a pair. @param {Ids} array @param {string} name */
export function pairsOf(array, name) {
  const pairs = idsOf(array, name);
  if (pairs.length % 2 === 0) return pairs;
  throw new LimberError("sizeMismatch", `limber3d: ${name} has ${pairs.length} ids, not two a pair`);
}

/** @param {Vector} vector @param {string} name @returns {Point} */
export function pointOf(vector, name) {
  if (typeof vector !== "object" || vector === null) throw invalid(`${name} is not three numbers`);
  const point = /** @type {Point} */ (
    "x" in vector ? [vector.x, vector.y, vector.z] : vector.length === 3 ? [vector[0], vector[1], vector[2]] : []
  );
  if (point.length !== 3 || !point.every((x) => typeof x === "number")) throw invalid(`${name} is not three numbers`);
  return point;
}

// --- poses ---

/** limber::web::PoseForm. */
const identity = 0, matrix = 1, quaternion = 2;

/**
 * A pose that has been read: its form, and the numbers that this form has.
 *
 * @typedef {{ form: number, numbers: readonly number[] }} ReadPose
 */

/** @type {ReadPose} */
const atIdentity = { form: identity, numbers: [] };

/** @param {Matrix} from @param {number} count @param {string} name */
function elementsOf(from, count, name) {
  const isObject = typeof from === "object" && from !== null;
  const elements = isObject && "elements" in from ? from.elements : from;
  if (!isObject || elements?.length !== count) throw invalid(`${name} does not have ${count} numbers`);
  return filledFrom(Array(count).fill(0), elements, name);
}

/** @param {Quaternion} from @param {string} name */
function quaternionOf(from, name) {
  const hasNames = typeof from === "object" && from !== null && "x" in from;
  return hasNames ? filledFrom([0, 0, 0, 0], [from.x, from.y, from.z, from.w], name) : elementsOf(from, 4, name);
}

/**
 * Reads a pose, and writes nothing.
 *
 * @param {Pose | null | undefined} pose
 * @param {string} name
 * @returns {ReadPose}
 */
export function poseOf(pose, name) {
  if (pose === undefined || pose === null) return atIdentity;
  if (typeof pose !== "object") throw invalid(`${name} is no pose`);
  if ("elements" in pose || "length" in pose) return { form: matrix, numbers: elementsOf(pose, 16, name) };
  /** @typedef {{ quaternion?: Quaternion, rotation?: Matrix, translation?: Vector }} Turn */
  checkNames(pose, ["quaternion", "rotation", "translation"], name);
  const { quaternion: q, rotation: r, translation: t } = /** @type {Turn} */ (pose);
  if (q === undefined && r === undefined && t === undefined) throw invalid(`${name} is no pose`);
  if (q !== undefined && r !== undefined) throw invalid(`${name} has a quaternion and a rotation`);
  const translation = t === undefined ? [0, 0, 0] : pointOf(t, `${name}.translation`);
  if (r !== undefined) {
    const m = elementsOf(r, 9, `${name}.rotation`);
    const columns = [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0];
    return { form: matrix, numbers: [...columns, ...translation, 1] };
  }
  const numbers = q === undefined ? [0, 0, 0, 1] : quaternionOf(q, `${name}.quaternion`);
  return { form: quaternion, numbers: [...numbers, ...translation] };
}

/**
 * Writes a pose for the next call; returns the form it has.
 *
 * @param {ReadPose} pose
 * @param {number} which
 */
export function writePose(pose, which) {
  if (pose.form !== identity) writePoseNumbers(which, pose.numbers);
  return pose.form;
}
