// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The types of arguments and answers, and the words that stand for numbers in arrays. All of it is public.

/** @import { Many } from "./answers.js" */
/** @import { Model, NeighborRings, QueryCache, Shape } from "./bodies.js" */
/** @import { RigidMotion } from "./motion.js" */

// --- arguments ---

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
 * Matrices must be rigid to 1e-9. What was computed in float32 is not: give a quaternion instead.
 *
 * @typedef {Matrix
 *   | { readonly quaternion: Quaternion, readonly translation?: Vector }
 *   | { readonly rotation: Matrix, readonly translation?: Vector }
 *   | { readonly translation: Vector }} Pose
 */

/** What queries of two bodies are about. @typedef {Model | Shape} Body */

/**
 * @typedef {object} ModelOptions
 * @property {number} [motionMargin] How far a vertex may move before its bounds are refitted. A length in the model's
 *   frame, finite and >= 0. With 0, the default, every commit() refits all that has moved. Answers do not depend on it
 *   beyond rounding.
 * @property {"off" | "inCommit"} [rebuildPolicy] When a tree is rebuilt in part, because motion has degraded it: never,
 *   or in commits, a little each, which is the default. There is no worker thread, as C++ has it.
 */

/**
 * When a query has to end, whether or not it has its answer: the first limit that is reached ends it. Every query makes
 * at least one step.
 *
 * @typedef {object} QueryBudget
 * @property {number} [deadline] a time of performance.now(), in milliseconds; only as fine as that clock, which
 *   browsers make coarse
 * @property {number} [maxSteps] the same for all machines
 */

/**
 * @typedef {object} PoseOptions
 * @property {Pose | null} [poseA] where a stands in the world; at the identity if there is none
 * @property {Pose | null} [poseB]
 */

/**
 * @typedef {object} QueryOptions
 * @property {QueryBudget} [budget]
 * @property {QueryCache} [cache] what the last query of the same two models has found, to start from
 */

/**
 * How good the answer must be: within either error is enough. Contacts are found at any setting.
 *
 * @typedef {object} ErrorOptions
 * @property {number} [relativeError] the answer may exceed the true distance by this fraction of it; 0 if not given
 * @property {number} [absoluteError] the answer may exceed the true distance by this length; 0 if not given
 * @property {number} [maxDistance] beyond it the query only reports "beyondLimit"; no limit if not given
 */

/**
 * @typedef {object} SelfQueryOptions
 * @property {NeighborRings} [filter] all pairs count without one
 * @property {QueryCache} [cache]
 */

/** @typedef {{ maxCount?: number }} CountOptions stop after that many contacts */

/**
 * @typedef {object} PointOptions
 * @property {Pose | null} [pose] where the model stands in the world; at the identity if there is none
 * @property {number} [maxDistance] beyond it nothing is found; no limit if not given
 */

/**
 * @typedef {object} ImpactOptions
 * @property {number} [maxTime] a first contact after this time does not count; from 0 to 1, which is the default.
 *   `upper` may be after it
 * @property {number} [timeError] how far `upper` may be above `lower`; never less than the rounding of a time, 2 ** -53
 * @property {number} [minSeparation] Elements that are this far apart, or less, touch. 0, the default, asks for exact
 *   contact. A greater number may be rounded up, at each time in another way: by some 2 ** -44 of the extent.
 * @property {number} [separationFraction] Elements that are nearer than minSeparation at the start may come as near as
 *   this fraction of their distance then; from 0 to below 1. With 0, the default, they touch at the start.
 * @property {boolean} [ignoreCrossings] Whether models that cross at the start may go on: only elements that touch
 *   count, a vertex and a face or two edges. Otherwise triangles that intersect at the start are an "initialContact".
 * @property {boolean} [anyContact] whether any contact up to maxTime will do, not the first one
 * @property {QueryBudget} [budget]
 */

/**
 * @typedef {object} RigidImpactOptions
 * @property {RigidMotion} [motionA] how a moves; at the identity all the time if not given
 * @property {RigidMotion} [motionB]
 * @property {number} [maxTime] from 0 to 1, which is the default
 * @property {number} [minSeparation] models that are this far apart, or less, touch; finite and >= 0
 * @property {number} [distanceError] How much more than the separation may count as touching: finite and >= 0. If it is
 *   not given, 2 ** -20 of the sum of the radii of both models. Never less than what moves in 2 ** -40 of the time: 0
 *   asks for that, and models that pass each other closely then take very many distances.
 * @property {QueryBudget} [budget] its maxSteps counts distances
 * @property {QueryCache} [cache]
 */

// --- answers ---

/** What arrays have in place of an id that is not there. Single answers have null. */
export const noId = 0xffffffff;

/**
 * A pair of points, one on each model, in the world, and the triangles they lie on.
 *
 * @typedef {object} Witness
 * @property {Point} pointA
 * @property {Point} pointB
 * @property {number} triangleA
 * @property {number} triangleB
 */

/**
 * Work done by one query.
 *
 * @typedef {object} QueryStats
 * @property {number} nodeTests pairs of bounding volumes compared
 * @property {number} primitiveTests pairs of triangles compared; of elements where the query is about these
 */

/** Which limit of its budget has ended a query. @typedef {"nothing" | "deadline" | "maxSteps"} StoppedBy */

/** What the numbers in `stoppedBys` stand for. @type {readonly StoppedBy[]} */
export const stoppedBys = Object.freeze(["nothing", "deadline", "maxSteps"]);

/**
 * Why a query of a distance stopped where it did.
 *
 * - "exact": lower === upper, the distance up to rounding
 * - "withinError": upper is within the asked error of the true distance
 * - "collision": the models meet, lower === upper === 0
 * - "beyondLimit": nothing is as close as maxDistance; lower >= maxDistance, upper is infinite, no witness
 * - "interrupted": the budget was spent; lower <= distance <= upper
 *
 * @typedef {"exact" | "withinError" | "collision" | "beyondLimit" | "interrupted"} DistanceStatus
 */

/** What the numbers in `statuses` of distances stand for. @type {readonly DistanceStatus[]} */
export const distanceStatuses = Object.freeze(["exact", "withinError", "collision", "beyondLimit", "interrupted"]);

/**
 * What a question of yes or no is answered; "undecided" if a budget was spent before either was proven.
 *
 * @typedef {"no" | "yes" | "undecided"} Answer
 */

/** What the numbers in `answers` of many answers stand for. @type {readonly Answer[]} */
export const answers = Object.freeze(["no", "yes", "undecided"]);

/**
 * @typedef {object} DistanceResult
 * @property {number} lower no two points of the models are closer
 * @property {number} upper the distance of the witness points
 * @property {DistanceStatus} status
 * @property {Witness | null} witness none exactly when the status is "beyondLimit"
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "interrupted"
 * @property {QueryStats} stats
 */

/**
 * The answer of collide() and within(). It is "undecided" only where a budget was spent; then isYes and isNo are false.
 *
 * @typedef {object} CollideResult
 * @property {Answer} answer
 * @property {boolean} isYes
 * @property {boolean} isNo
 * @property {Witness | null} witness there exactly when the answer is "yes": the same point if the models meet; else at
 *   most as far apart as was asked, and not necessarily the closest
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the answer is "undecided"
 * @property {QueryStats} stats
 */

/**
 * A part of a triangle: vertex i is corner i, edge i goes from corner i to the next one; 0 for the face.
 *
 * @typedef {{ kind: "vertex" | "edge" | "face", index: number }} Feature
 */

/** What the first number of each feature stands for, in arrays of features. @type {readonly Feature["kind"][]} */
export const featureKinds = Object.freeze(["vertex", "edge", "face"]);

/**
 * How a normal lies to the outsides of the faces, which those of a closed mesh have: "outward" out of a and into b;
 * "inward" if the triangles are apart, and one looks at the back of the other; "unknown" if neither has an outside, or
 * the faces do not tell.
 *
 * @typedef {"unknown" | "outward" | "inward"} NormalSide
 */

/** What the numbers in `normalSides` of contacts stand for. @type {readonly NormalSide[]} */
export const normalSides = Object.freeze(["unknown", "outward", "inward"]);

/**
 * Two triangles that intersect or are close, in the world; for pairs of one model, in the model's own frame.
 *
 * @typedef {object} Contact
 * @property {number} distance 0 exactly when the triangles intersect
 * @property {number} depth 0 unless they intersect: their least overlap, a motion of b that parts them
 * @property {Point} pointA
 * @property {Point} pointB
 * @property {Point} normal of length 1, from a to b
 * @property {Point} weightsA of pointA, by corner of its triangle: >= 0, together 1; 0 off the feature
 * @property {Point} weightsB
 * @property {number} triangleA
 * @property {number} triangleB
 * @property {Feature} featureA
 * @property {Feature} featureB
 * @property {NormalSide} normalSide whether the normal points the way that parts bodies
 */

/**
 * The point of a model that is closest to some point, in the world.
 *
 * @typedef {object} SurfacePoint
 * @property {number} distance from the point that was asked for
 * @property {Point} position
 * @property {number} triangle
 * @property {Point} weights of the position, by corner of its triangle: >= 0, together 1
 * @property {Feature} feature what the position lies on
 */

/**
 * @typedef {object} PointResult
 * @property {SurfacePoint | null} closest none exactly when nothing is as close as maxDistance
 * @property {QueryStats} stats
 */

/**
 * `distance` is negative inside, and infinite where nothing is as close as maxDistance; `isInside` tells whether the
 * surface encloses the point, or the point lies on it.
 *
 * @typedef {PointResult & { distance: number, isInside: boolean }} SignedDistance
 */

/**
 * Whether, and when, things that move touch.
 *
 * - "clear": they do not touch up to and including maxTime
 * - "contact": they are apart at the start and touch later
 * - "initialContact": they touch at the start
 * - "undecided": the budget was spent before the query could tell
 *
 * @typedef {"clear" | "contact" | "initialContact" | "undecided"} ImpactStatus
 */

/** @type {readonly ImpactStatus[]} */
export const impactStatuses = Object.freeze(["clear", "contact", "initialContact", "undecided"]);

/**
 * Two elements, the first of model a and the second of model b, or two of one model.
 *
 * - "vertexFace": a vertex of a and a face of b
 * - "faceVertex": a face of a and a vertex of b; never of one model
 * - "edgeEdge": two edges; of one model, the one of smaller id first
 *
 * @typedef {object} ElementPair
 * @property {"vertexFace" | "faceVertex" | "edgeEdge"} kind
 * @property {number} a a vertex, a triangle or an edge, see Model.edges()
 * @property {number} b
 */

/** @type {readonly ElementPair["kind"][]} */
export const elementPairKinds = Object.freeze(["vertexFace", "faceVertex", "edgeEdge"]);

/**
 * When two models whose vertices move touch first.
 *
 * @typedef {object} ImpactResult
 * @property {ImpactStatus} status
 * @property {number} lower The first contact is between `lower` and `upper`; both are 0 for "initialContact", infinite
 *   for "clear". With "undecided", none is before `lower`; if `upper` is finite, the elements touch by then.
 * @property {number} upper
 * @property {ElementPair | null} elements what touches; none if nothing does, or if triangles cross at the start
 * @property {Witness | null} witness the closest points of the elements at the time `upper`, in the world, and a
 *   triangle of each; or a point that two triangles share at the start; none if nothing touches
 * @property {Point} normal from a to b, of length 1; 0, 0, 0 where there is no such direction
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "undecided"
 * @property {QueryStats} stats primitiveTests counts the pairs of elements that may touch
 */

/**
 * When two rigid bodies come too near to each other first. They are farther apart than the separation before `time`,
 * and at most distanceError farther apart at `time` for "contact" and "initialContact".
 *
 * @typedef {object} RigidImpactResult
 * @property {ImpactStatus} status
 * @property {number} time infinite for "clear"
 * @property {Witness | null} witness the closest points at `time`, if they touch
 * @property {Point} normal from a to b, of length 1; 0, 0, 0 without a witness
 * @property {number} distanceCount how many distances were asked for
 * @property {StoppedBy} stoppedBy something else than "nothing" exactly when the status is "undecided"
 * @property {QueryStats} stats
 */

// --- many answers: an array for each of their numbers, three for each point or vector ---

/**
 * Without a witness points are 0 and triangles are noId. `stoppedBys` are indices of the package's list of that name.
 *
 * @typedef {Record<"pointsA" | "pointsB" | "nodeTests" | "primitiveTests", Float64Array>
 *   & Record<"trianglesA" | "trianglesB", Uint32Array> & { stoppedBys: Uint8Array }} WitnessColumns
 */

/** @typedef {WitnessColumns & { lowers: Float64Array, uppers: Float64Array, statuses: Uint8Array }} DistanceColumns */
/** @typedef {Many<DistanceResult> & DistanceColumns} DistanceResults */
/** @typedef {WitnessColumns & { answers: Uint8Array }} CollideColumns */
/** @typedef {Many<CollideResult> & CollideColumns} CollideResults */

/**
 * Features are two numbers: an index of `featureKinds`, and the feature's own. `normalSides` are indices of the
 * package's list of that name.
 *
 * @typedef {Record<"distances" | "depths" | "pointsA" | "pointsB" | "normals" | "weightsA" | "weightsB", Float64Array>
 *   & Record<"trianglesA" | "trianglesB", Uint32Array>
 *   & Record<"featuresA" | "featuresB" | "normalSides", Uint8Array>} ContactColumns
 */

/**
 * `isComplete` is false if there may be more than maxCount.
 *
 * @typedef {Many<Contact> & ContactColumns & { isComplete: boolean, stats: QueryStats }} Contacts
 */

/**
 * Where nothing is as close as maxDistance, distances are infinite and triangles are noId. Features are as in contacts.
 *
 * @typedef {Record<"distances" | "positions" | "weights" | "nodeTests" | "primitiveTests", Float64Array>
 *   & { triangles: Uint32Array, features: Uint8Array }} PointColumns
 */

/** @typedef {Many<PointResult> & PointColumns} PointResults */
/** 1 stands for isInside, 0 for not. @typedef {PointColumns & { insides: Uint8Array }} SignedDistanceColumns */
/** @typedef {Many<SignedDistance> & SignedDistanceColumns} SignedDistances */
