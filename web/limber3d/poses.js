// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a model stands. Private to the package.

import { pointOf } from "./arrays.js";
import { invalid } from "./errors.js";
import { check, engine, number, writePoseNumbers } from "./wasm.js";

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
 * @typedef {import("./arrays.js").Vector} Vector
 */

/** limber::web::PoseForm. */
const identity = 0, matrix = 1, quaternion = 2, rotation = 3;

/** @param {Matrix} from @param {number} count @param {string} name */
function elementsOf(from, count, name) {
  const elements = "elements" in from ? from.elements : from;
  if (elements?.length !== count) throw invalid(`${name} does not have ${count} numbers`);
  return elements;
}

/**
 * Writes a pose for the next call; returns the form it has.
 *
 * @param {Pose | null | undefined} pose
 * @param {number} which
 * @param {string} name
 */
export function writePose(pose, which, name) {
  if (pose === undefined || pose === null) return identity;
  if (typeof pose !== "object") throw invalid(`${name} is no pose`);
  if ("elements" in pose || "length" in pose) {
    writePoseNumbers(which, 0, elementsOf(pose, 16, name), name);
    return matrix;
  }
  const turn = /** @type {{ quaternion?: Quaternion, rotation?: Matrix, translation?: Vector }} */ (pose);
  const translation = turn.translation === undefined ? [0, 0, 0] : pointOf(turn.translation, `${name}.translation`);
  if (turn.rotation !== undefined) {
    writePoseNumbers(which, 0, elementsOf(turn.rotation, 9, `${name}.rotation`), name);
    writePoseNumbers(which, 9, translation, name);
    return rotation;
  }
  if (turn.quaternion === undefined && turn.translation === undefined) throw invalid(`${name} is no pose`);
  const q = turn.quaternion ?? [0, 0, 0, 1];
  const numbers = "x" in q ? [q.x, q.y, q.z, q.w] : q;
  if (numbers.length !== 4) throw invalid(`${name}.quaternion does not have 4 numbers`);
  writePoseNumbers(which, 0, numbers, `${name}.quaternion`);
  writePoseNumbers(which, 4, translation, name);
  return quaternion;
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
  writePoseNumbers(0, 0, elementsOf(rotation, 9, "rotation"), "rotation");
  check(engine().orthonormalized());
  return Array.from({ length: 9 }, (_, i) => number(i));
}
