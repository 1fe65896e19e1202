// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How the bodies of two closed surfaces lie to each other, how deep they are in each other, and how they come apart. A
// body is a closed surface with its inside, as ClosedSurface says. All is in the world.

import { checkNames, numberOf, pointOf } from "./arrays.js";
import { featureKinds } from "./contacts.js";
import { noId } from "./many.js";
import { surfaceAddress } from "./points.js";
import { poseOf, writePose } from "./poses.js";
import { limitsOf, stats, stoppedBy, witness } from "./queries.js";
import { check, engine, number, point, word } from "./wasm.js";
/** @import { Point, Vector } from "./arrays.js" */
/** @import { ClosedSurface, SurfacePoint } from "./points.js" */
/** @import { PoseOptions, QueryBudget, QueryStats, StoppedBy, Witness } from "./queries.js" */

/**
 * How two solids lie to each other. A solid is where the winding number of its closed surface is not 0, without the
 * surface itself; so a cavity does not belong to it. Solids overlap if they have a point in common.
 *
 * - "apart": no overlap, and the surfaces have no common point
 * - "touching": no overlap, but the surfaces have a common point
 * - "overlapping": overlap, and each reaches out of the other
 * - "aInsideB": overlap, and a does not reach out of b; the surfaces may have common points
 * - "bInsideA": overlap, and b does not reach out of a
 * - "equal": overlap, and neither reaches out of the other
 *
 * @typedef {"apart" | "touching" | "overlapping" | "aInsideB" | "bInsideA" | "equal"} SolidRelation
 */

/** @type {readonly SolidRelation[]} */
const relations = ["apart", "touching", "overlapping", "aInsideB", "bInsideA", "equal"];

/**
 * @typedef {object} SolidRelationResult
 * @property {SolidRelation} relation
 * @property {Witness | null} witness a point that both surfaces have in common, exactly when there is one: it tells a
 *   body that touches the wall around it from one that does not
 * @property {QueryStats} stats
 */

/**
 * The vertex of a body that is deepest inside of another one.
 *
 * @typedef {object} DeepestVertex
 * @property {number} vertex
 * @property {number} depth its distance from the surface of the other body
 * @property {Point} position
 * @property {SurfacePoint} closest the point of that surface that is closest to it
 * @property {Point} direction the shortest way out, of length 1: from the position to the closest point
 */

/**
 * @typedef {object} DeepestPair
 * @property {DeepestVertex | null} ofA the vertex of a that is deepest in b; null if b contains no vertex of a
 * @property {DeepestVertex | null} ofB the vertex of b that is deepest in a
 * @property {number} maxDepth no vertex of either is deeper in the other: the larger depth, unless the budget was spent
 */

/** @typedef {DeepestPair & { stoppedBy: StoppedBy, stats: QueryStats }} DeepestVertices */

/**
 * How far a body has to be moved along a direction to leave another one for good.
 *
 * @typedef {object} SeparatingTranslation
 * @property {Point} direction that was asked for, of length 1
 * @property {number} lower moved by this, the surfaces meet or nearly do; 0 if they do at no move from there on
 * @property {number} upper moved by this or more, the bodies are apart; 0 if they are apart at every move >= 0
 * @property {Witness | null} witness where they meet last: points that meet when b is moved by `lower`; b is where its
 *   pose says
 * @property {StoppedBy} stoppedBy
 * @property {QueryStats} stats
 */

/**
 * The signed distance of two bodies: their distance if they are apart, otherwise minus the length of the shortest
 * translation of b that makes them so.
 *
 * @typedef {object} SolidDistance
 * @property {number} lower
 * @property {number} upper lower <= signed distance <= upper
 * @property {boolean} areApart whether lower > 0
 * @property {Point} translation moved by it, b is apart from a: as long as -lower; 0 if they are known to be apart
 * @property {Witness | null} witness the closest points, if the bodies are apart
 * @property {DeepestPair} deepest
 * @property {StoppedBy} stoppedBy
 * @property {QueryStats} stats
 */

/** @typedef {PoseOptions & { budget?: QueryBudget }} DeepestVerticesOptions */
/** @typedef {PoseOptions & { budget?: QueryBudget }} SeparatingTranslationOptions */

/**
 * The search for a shorter translation ends when it is proven to be within the relative error of the shortest; 0.01 if
 * not given. Steps of the distance, and all others together, may each be budget.maxSteps.
 *
 * @typedef {PoseOptions & { relativeError?: number, budget?: QueryBudget }} SolidDistanceOptions
 */

/**
 * Two surfaces and poses, as the module takes them.
 *
 * @param {ClosedSurface} a
 * @param {ClosedSurface} b
 * @param {PoseOptions} poses
 * @returns {[number, number, number, number]}
 */
function placedSurfaces(a, b, { poseA, poseB }) {
  const readA = poseOf(poseA, "poseA"), readB = poseOf(poseB, "poseB");
  const first = surfaceAddress(a, "a"), second = surfaceAddress(b, "b");
  return [first, writePose(readA, 0), second, writePose(readB, 1)];
}

/** Deepest vertex 0 or 1 of the last result. @param {0 | 1} i @returns {DeepestVertex | null} */
function deepestVertex(i) {
  const at = 14 + 14 * i, ids = 4 + 4 * i;
  if (word(ids) === noId) return null;
  const feature = { kind: featureKinds[word(ids + 2)], index: word(ids + 3) };
  const closest = { distance: number(at + 4), position: point(at + 5), triangle: word(ids + 1) };
  return {
    vertex: word(ids),
    depth: number(at),
    position: point(at + 1),
    closest: { ...closest, weights: point(at + 8), feature },
    direction: point(at + 11),
  };
}

/** @returns {DeepestPair} */
const deepestPair = () => ({ ofA: deepestVertex(0), ofB: deepestVertex(1), maxDepth: number(13) });

/**
 * How the solids of two placed closed surfaces lie to each other.
 *
 * Decided exactly for the placed vertices, for all closed surfaces: also where they meet themselves, where faces
 * coincide, and where triangles are degenerate. It does not depend on the direction of normals. A surface that encloses
 * nothing is apart or touching. Vertices are placed in float64, so a pose that turns flush faces may make them overlap,
 * or part them.
 *
 * Throws invalidArgument unless both models are committed; notRigid.
 *
 * @param {ClosedSurface} a
 * @param {ClosedSurface} b
 * @param {PoseOptions} [options]
 * @returns {SolidRelationResult}
 */
export function solidRelation(a, b, options = {}) {
  checkNames(options, ["poseA", "poseB"]);
  check(engine().solidRelation(...placedSurfaces(a, b, options)));
  return { relation: relations[word(2)], witness: witness(), stats: stats(8) };
}

/**
 * The deepest vertices of two bodies; of vertices that are equally deep, the one with the lowest id. Bodies may meet
 * although no vertex of either is in the other. If the budget is spent, the vertices are the deepest found so far.
 *
 * Throws as solidRelation(). Cost: that of some hundred signed distances.
 *
 * @param {ClosedSurface} a
 * @param {ClosedSurface} b
 * @param {DeepestVerticesOptions} [options]
 * @returns {DeepestVertices}
 */
export function deepestVertices(a, b, options = {}) {
  checkNames(options, ["poseA", "poseB", "budget"]);
  const limits = limitsOf(options.budget);
  check(engine().deepestVertices(...placedSurfaces(a, b, options), ...limits));
  return { ...deepestPair(), stoppedBy: stoppedBy(), stats: stats(8) };
}

/**
 * How far b has to be moved along a direction, while a rests, until it is apart from a and stays so however far it goes
 * on. Surfaces that slide along each other meet. If the budget is spent, the interval still holds.
 *
 * Throws as solidRelation(); invalidArgument unless the direction is finite and its length above 0. Cost: some ten
 * times that of a distance.
 *
 * @param {ClosedSurface} a
 * @param {ClosedSurface} b
 * @param {Vector} direction
 * @param {SeparatingTranslationOptions} [options]
 * @returns {SeparatingTranslation}
 */
export function separatingTranslation(a, b, direction, options = {}) {
  checkNames(options, ["poseA", "poseB", "budget"]);
  const limits = limitsOf(options.budget), along = pointOf(direction, "direction");
  check(engine().separatingTranslation(...placedSurfaces(a, b, options), ...along, ...limits));
  const bounds = { direction: point(10), lower: number(0), upper: number(1) };
  return { ...bounds, witness: witness(), stoppedBy: stoppedBy(), stats: stats(8) };
}

/**
 * The signed distance of two bodies.
 *
 * Promises lower <= signed distance <= upper, up to rounding. Apart, both are the distance. Otherwise `upper` is minus
 * a lower bound of the translation, and `lower` minus the length of `translation`, which is proven to part them; of
 * bodies that are not convex it need not be the shortest. If the budget is spent, the interval still holds.
 *
 * Throws as solidRelation(); invalidArgument unless relativeError is finite and >= 0.
 *
 * @param {ClosedSurface} a
 * @param {ClosedSurface} b
 * @param {SolidDistanceOptions} [options]
 * @returns {SolidDistance}
 */
export function signedDistance(a, b, options = {}) {
  checkNames(options, ["poseA", "poseB", "relativeError", "budget"]);
  const limits = limitsOf(options.budget), relativeError = numberOf(options.relativeError, "relativeError", 0.01);
  check(engine().signedDistance(...placedSurfaces(a, b, options), relativeError, ...limits));
  const bounds = { lower: number(0), upper: number(1), areApart: number(0) > 0, translation: point(10) };
  return { ...bounds, witness: witness(), deepest: deepestPair(), stoppedBy: stoppedBy(), stats: stats(8) };
}
