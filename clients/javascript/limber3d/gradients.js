// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How a distance changes with poses and with vertices.
//
// Where the triangles are apart and no other points of the models are as close, the distance has a derivative. Where
// several pairs of points are equally close, as between parallel faces, it has a kink: what is given then is the
// derivative for the one pair that the contact names. To first order, a motion may bring the models closer than that
// says, but not farther apart. Where triangles cross, the distance and its derivative are 0; what is given is the
// direction in which the contact's normal parts them. All is in the world, as the contact is.

import { checkNames, pointOf } from "./arrays.js";
import { Contacts } from "./contacts.js";
import { invalid } from "./errors.js";
import { placedBodies } from "./queries.js";
import { check, engine } from "./wasm.js";
/** @import { Point, Vector } from "./arrays.js" */
/** @import { Contact } from "./contacts.js" */
/** @import { PoseOptions, Witness } from "./queries.js" */
/** @import { Body } from "./shapes.js" */

/**
 * The derivative of a distance by a rigid motion of one model: the power of a unit force along the contact's normal.
 *
 * @typedef {object} PoseGradient
 * @property {Point} force by a translation; of length 1
 * @property {Point} moment by a rotation about the center that was given, in radians about each axis
 */

/** @param {Point} p @param {Point} q @returns {Point} */
const difference = (p, q) => [p[0] - q[0], p[1] - q[1], p[2] - q[2]];

/** @param {Point} p @param {Point} q @returns {Point} */
const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];

/** @param {number} factor @param {Point} p @returns {Point} */
const times = (factor, p) => [factor * p[0], factor * p[1], factor * p[2]];

/**
 * The contact of the two triangles that a witness of distance(), collide() or within() names, for the same two models
 * and poses. Those of contacts() and closestPairs() need it not: they are contacts.
 *
 * Throws as contacts(); invalidArgument unless the models have these triangles.
 *
 * @param {Body} a
 * @param {Body} b
 * @param {Witness} witness
 * @param {PoseOptions} [options]
 * @returns {Contact}
 */
export function contactOf(a, b, witness, options = {}) {
  checkNames(options, ["poseA", "poseB"]);
  if (typeof witness !== "object" || witness === null) throw invalid("witness is no object");
  const triangles = [witness.triangleA, witness.triangleB];
  if (!triangles.every((id) => Number.isInteger(id) && id >= 0 && id <= 0xffffffff)) {
    throw invalid("witness does not name two triangles");
  }
  check(engine().contactOf(...placedBodies(a, b, options), ...triangles));
  return new Contacts().at(0);
}

/**
 * Three numbers of a contact.
 *
 * @param {Contact} contact
 * @param {"normal" | "pointA" | "pointB" | "weightsA" | "weightsB"} name
 */
function partOf(contact, name) {
  if (typeof contact !== "object" || contact === null) throw invalid("contact is no object");
  return pointOf(contact[name], `contact.${name}`);
}

/**
 * The derivative of the distance by the motion of a, which turns about `center`: nearly always the origin of its frame,
 * the translation of its pose, or its center of mass.
 *
 * @param {Contact} contact
 * @param {Vector} center
 * @returns {PoseGradient}
 */
export function poseGradientA(contact, center) {
  const normal = partOf(contact, "normal"), arm = difference(partOf(contact, "pointA"), pointOf(center, "center"));
  return { force: times(-1, normal), moment: times(-1, cross(arm, normal)) };
}

/**
 * The derivative of the distance by the motion of b, which turns about `center`. All else as poseGradientA().
 *
 * @param {Contact} contact
 * @param {Vector} center
 * @returns {PoseGradient}
 */
export function poseGradientB(contact, center) {
  const normal = partOf(contact, "normal"), arm = difference(partOf(contact, "pointB"), pointOf(center, "center"));
  return { force: normal, moment: cross(arm, normal) };
}

/**
 * The derivatives by the three corners of the triangle of a. Those by all other vertices are 0.
 *
 * @param {Contact} contact
 * @returns {Point[]}
 */
export function vertexGradientsA(contact) {
  const normal = partOf(contact, "normal");
  return partOf(contact, "weightsA").map((weight) => times(-weight, normal));
}

/**
 * The derivatives by the three corners of the triangle of b. Those by all other vertices are 0.
 *
 * @param {Contact} contact
 * @returns {Point[]}
 */
export function vertexGradientsB(contact) {
  const normal = partOf(contact, "normal");
  return partOf(contact, "weightsB").map((weight) => times(weight, normal));
}
