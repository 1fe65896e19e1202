// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a model stands. Private to the package.

import { checkNames, filledFrom, pointOf } from "./arrays.js";
import { invalid } from "./errors.js";
import { check, engine, number, writePoseNumbers } from "./wasm.js";
/** @import { Vector } from "./arrays.js" */

/**
 * Numbers of a matrix, column by column: an array of them, or an object with such an array, as three.js's Matrix3 and
 * Matrix4 are.
 *
 * @typedef {ArrayLike<number> | { readonly elements: ArrayLike<number> }} Matrix
 */

/**
 * A quaternion as an array x, y, z, w, or as an object such as three.js's Quaternion. Any length but 0 will do.
 *
 * @typedef {ArrayLike<number> | { readonly x: number, readonly y: number, readonly z: number, readonly w: number }}
 *   Quaternion
 */

/**
 * The rigid motion from the frame of a model to the world: a 4 x 4 matrix, or a turn and then a translation. The turn
 * is a quaternion, or a 3 x 3 matrix, or nothing. Nothing stands for the identity.
 *
 * Matrices must be rigid to 1e-9. What was computed in float32 is not: orthonormalized() makes a rotation so.
 *
 * @typedef {Matrix
 *   | { readonly quaternion: Quaternion, readonly translation?: Vector }
 *   | { readonly rotation: Matrix, readonly translation?: Vector }
 *   | { readonly translation: Vector }} Pose
 */

/** limber::web::PoseForm. */
const identity = 0, matrix = 1, quaternion = 2, rotation = 3;

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
  if (r !== undefined) return { form: rotation, numbers: [...elementsOf(r, 9, `${name}.rotation`), ...translation] };
  const numbers = q === undefined ? [0, 0, 0, 1] : quaternionOf(q, `${name}.quaternion`);
  return { form: quaternion, numbers: [...numbers, ...translation] };
}

/** @param {Quaternion} from @param {string} name */
function quaternionOf(from, name) {
  const hasNames = typeof from === "object" && from !== null && "x" in from;
  return hasNames ? filledFrom([0, 0, 0, 0], [from.x, from.y, from.z, from.w], name) : elementsOf(from, 4, name);
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

/**
 * The rotation nearest to a 3 x 3 matrix that is nearly one, such as a rotation computed in float32, column by column.
 *
 * Throws nonFinite, or notRigid if the matrix is a reflection or further than 0.1 from every rotation.
 *
 * @param {Matrix} rotation
 * @returns {number[]}
 */
export function orthonormalized(rotation) {
  writePoseNumbers(0, elementsOf(rotation, 9, "rotation"));
  check(engine().orthonormalized());
  return Array.from({ length: 9 }, (_, i) => number(i));
}
