// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many placed models: the pairs of them that may be close, and queries of many pairs and of many configurations.

import { checkNames, idsOf, numberOf } from "./arrays.js";
import { Contacts, facesOf } from "./contacts.js";
import { invalid } from "./errors.js";
import { noId } from "./many.js";
import { distanceErrorOf, motionAddress, pathImpactResult } from "./path.js";
import { poseOf, writePose } from "./poses.js";
import { collideResult, distanceResult, errorsOf, limitsOf } from "./queries.js";
import { cacheAddress, filterOf, idOf, matricesOf, pairsOf } from "./scene_options.js";
import { CollideResults, DistanceResults } from "./scene_results.js";
import { bodyAddress } from "./shapes.js";
import { Owner, callWithFilter, check, copyOf, engine, ownedAddress } from "./wasm.js";
import { number, point, word, writeIds, writeInput } from "./wasm.js";
/** @import { Ids, Point } from "./arrays.js" */
/** @import { OrientedFacesOptions } from "./contacts.js" */
/** @import { PathImpact, RigidMotion } from "./path.js" */
/** @import { Pose } from "./poses.js" */
/** @import { CollideResult, DistanceResult, ErrorOptions, QueryBudget } from "./queries.js" */
/** @import { Matrices, ObjectFilter, ObjectPairOptions, SceneCache } from "./scene_options.js" */
/** @import { Body } from "./shapes.js" */

/**
 * @typedef {object} SceneQueryOptions
 * @property {QueryBudget} [budget] The deadline is that of the whole call, a number of steps that of each pair.
 * @property {SceneCache} [cache] what the last frame has found, to start from
 */

/**
 * The two objects of a scene that are closest to each other.
 *
 * @typedef {object} ClosestObjectsResult
 * @property {[a: number, b: number] | null} objects none exactly when the result has no witness
 * @property {DistanceResult} result of a and b, in this order
 */

/**
 * Two objects of a scene that are within a distance.
 *
 * @typedef {object} AnyWithinResult
 * @property {[a: number, b: number] | null} objects there exactly when the answer is "yes"
 * @property {CollideResult} result whether there are two such objects; the witness is of a and b, in this order
 */

/**
 * The object of a scene that is closest to a body.
 *
 * @typedef {object} ClosestObjectResult
 * @property {number | null} object none exactly when the result has no witness
 * @property {DistanceResult} result of the body and the object, in this order
 */

/**
 * The object of a scene that a moving body touches first.
 *
 * @typedef {object} ObjectImpactResult
 * @property {number | null} object none exactly when the result has no witness
 * @property {PathImpact} result of the body and the object, in this order; `distanceCount` and `stats` count all
 *   objects
 */

/**
 * Until when a body moves, what counts as touching, as PathImpactOptions say, and which objects count.
 *
 * @typedef {object} ObjectImpactOptions
 * @property {number} [maxTime]
 * @property {number} [minSeparation]
 * @property {number} [distanceError]
 * @property {ObjectFilter} [filter] all objects count without one
 * @property {QueryBudget} [budget] The deadline is that of the whole call, a number of distances that of each object.
 */

/**
 * The contacts of many pairs of objects.
 *
 * @typedef {object} ObjectContacts
 * @property {Contacts} contacts pair by pair, without statistics
 * @property {Uint32Array} offsets pair i has contacts from offsets[i] to offsets[i + 1]; one more than pairs
 */

/** Asks about one object. @param {ObjectFilter | undefined} filter */
function objectFilterOf(filter) {
  if (filter !== undefined && typeof filter !== "function") throw invalid("filter is no function");
  return filter && ((/** @type {number} */ id) => filter(id));
}

/** The object of the last result. @returns {number | null} */
function objectOfLast() {
  return word(4) === noId ? null : word(4);
}

/** The two objects of the last result. @returns {[a: number, b: number] | null} */
const objects = () => (word(4) === noId ? null : [word(4), word(5)]);

/**
 * Many models and shapes, each with a pose. Objects are added, moved and removed one by one; commit() takes over where
 * they are, and reads the bounds of models that have been committed or rebuilt since the last time. After that the
 * scene may be queried.
 *
 * A scene keeps its models from being collected, but not from being disposed of: it may not be used while it has an
 * object of a disposed model, but to remove that. Any number of objects may share a model. Wrong ids are an
 * invalidArgument; after an error the scene is as before the call.
 */
export class Scene extends Owner {
  /** By id. @type {Map<number, Body>} */
  #models = new Map();

  constructor() {
    super(engine().newScene(), "deleteScene");
  }

  /**
   * Where the scene is in the module's memory, unless one of its models has been disposed of.
   *
   * @returns {number}
   */
  #address() {
    for (const [id, model] of this.#models) bodyAddress(model, `the model of object ${id}`);
    return ownedAddress(this, "scene");
  }

  /**
   * Adds an object, and returns its id: the one that was freed last, otherwise the next number after all others. Throws
   * invalidArgument unless the model is committed; notRigid.
   *
   * @param {Body} model
   * @param {Pose | null} [pose]
   */
  add(model, pose) {
    const read = poseOf(pose, "pose");
    const scene = this.#address(), address = bodyAddress(model, "model"), form = writePose(read, 0);
    check(engine().sceneAdd(scene, address, form));
    const id = word(0);
    this.#models.set(id, model);
    return id;
  }

  /** Takes an object out. @param {number} id */
  remove(id) {
    check(engine().sceneRemove(ownedAddress(this, "scene"), idOf(id, "id")));
    this.#models.delete(id);
  }

  /**
   * Places an object elsewhere. Throws notRigid.
   *
   * @param {number} id
   * @param {Pose | null} pose
   */
  setPose(id, pose) {
    const read = poseOf(pose, "pose"), object = idOf(id, "id");
    const scene = this.#address(), form = writePose(read, 0);
    check(engine().sceneSetPose(scene, object, form));
  }

  /**
   * Places object ids[i] at the i-th of the poses; later entries win where an id is repeated. If one entry is bad, no
   * object is moved. Throws sizeMismatch; notRigid with the entry's index.
   *
   * @param {Ids} ids
   * @param {Matrices} poses
   */
  setPoses(ids, poses) {
    const list = idsOf(ids, "ids"), matrices = matricesOf(poses, list.length, true);
    const scene = this.#address();
    writeInput(matrices, list);
    check(engine().sceneSetPoses(scene, list.length));
  }

  /**
   * Prepares the scene for queries. Throws invalidArgument unless all models of the scene are committed. Cost: O(n),
   * and O(n log n) where objects lie in clusters within clusters.
   */
  commit() {
    check(engine().sceneCommit(this.#address()));
  }

  /** Whether nothing has changed since the last commit(), neither objects nor their models. */
  get isCommitted() {
    return engine().sceneIsCommitted(this.#address()) !== 0;
  }

  /** How many objects there are. */
  get size() {
    return engine().sceneSize(ownedAddress(this, "scene")) >>> 0;
  }

  /** All ids are less than this. */
  get idBound() {
    return engine().sceneIdBound(ownedAddress(this, "scene")) >>> 0;
  }

  /** Whether that is the id of an object. @param {number} id */
  contains(id) {
    ownedAddress(this, "scene");
    return this.#models.has(id);
  }

  /** The model of an object. @param {number} id @returns {Body} */
  model(id) {
    const model = this.#models.get(id);
    if (model === undefined) throw invalid("id names no object of the scene");
    return model;
  }

  /** The pose of an object: 16 numbers of a matrix, column by column. @param {number} id @returns {number[]} */
  pose(id) {
    check(engine().scenePose(this.#address(), idOf(id, "id")));
    return Array.from({ length: 16 }, (_, i) => number(i));
  }

  /**
   * A box along the axes of the world that contains the object where it was at the last commit.
   *
   * @param {number} id
   * @returns {{ low: Point, high: Point }}
   */
  boundingBox(id) {
    check(engine().sceneBoundingBox(this.#address(), idOf(id, "id")));
    return { low: point(0), high: point(3) };
  }

  /**
   * The pairs of objects whose bounds are at most `margin` apart: two ids for each, the smaller one first. No pair is
   * missing for which distance() would answer at most the margin. Cost: about O(n + pairs).
   *
   * Throws, as all queries of a scene, invalidArgument unless it is committed and options are what their comments say;
   * what the filter throws.
   *
   * @param {number} margin
   * @param {ObjectPairOptions} [options]
   */
  candidatePairs(margin, options = {}) {
    checkNames(options, ["filter"]);
    const [wanted, ...filter] = filterOf(options), most = numberOf(margin, "margin");
    callWithFilter(wanted, "sceneCandidatePairs", this.#address(), most, ...filter);
    return new Uint32Array(copyOf(word(0), word(1)));
  }

  /**
   * Asks collide() of each pair.
   *
   * @param {Ids} pairs two ids for each, as candidatePairs() gives them
   * @param {SceneQueryOptions} [options]
   */
  collide(pairs, options = {}) {
    checkNames(options, ["budget", "cache"]);
    const asked = pairsOf(pairs), limits = limitsOf(options.budget), cache = options.cache;
    const scene = this.#address(), kept = cacheAddress(cache);
    writeIds(asked);
    check(engine().sceneCollide(scene, asked.length / 2, ...limits, kept));
    return new CollideResults(asked.length / 2);
  }

  /**
   * Asks within() of each pair.
   *
   * @param {Ids} pairs
   * @param {number} maxDistance
   * @param {SceneQueryOptions} [options]
   */
  within(pairs, maxDistance, options = {}) {
    checkNames(options, ["budget", "cache"]);
    const asked = pairsOf(pairs), limits = limitsOf(options.budget), cache = options.cache;
    const most = numberOf(maxDistance, "maxDistance");
    const scene = this.#address(), kept = cacheAddress(cache);
    writeIds(asked);
    check(engine().sceneWithin(scene, asked.length / 2, most, ...limits, kept));
    return new CollideResults(asked.length / 2);
  }

  /**
   * Asks distance() of each pair.
   *
   * @param {Ids} pairs
   * @param {ErrorOptions & SceneQueryOptions} [options]
   */
  distance(pairs, options = {}) {
    checkNames(options, ["relativeError", "absoluteError", "maxDistance", "budget", "cache"]);
    const asked = pairsOf(pairs), errors = errorsOf(options), limits = limitsOf(options.budget), cache = options.cache;
    const scene = this.#address(), kept = cacheAddress(cache);
    writeIds(asked);
    check(engine().sceneDistance(scene, asked.length / 2, ...errors, ...limits, kept));
    return new DistanceResults(asked.length / 2);
  }

  /**
   * The contacts of each pair, as contacts() finds them for its two bodies, in that order. Throws also unless the
   * margin is finite and >= 0.
   *
   * @param {Ids} pairs
   * @param {number} margin
   * @param {OrientedFacesOptions} [options]
   * @returns {ObjectContacts}
   */
  contacts(pairs, margin, options = {}) {
    checkNames(options, ["orientedFaces"]);
    const asked = pairsOf(pairs), most = numberOf(margin, "margin"), faces = facesOf(options);
    const scene = this.#address();
    writeIds(asked);
    check(engine().sceneContacts(scene, asked.length / 2, most, faces));
    return { contacts: new Contacts(), offsets: new Uint32Array(copyOf(word(4), 4 * (asked.length / 2 + 1))) };
  }

  /**
   * The clearance of the scene: the shortest distance of any two objects that the filter lets through. Which of several
   * equally close pairs is named is not defined.
   *
   * @param {ErrorOptions & ObjectPairOptions & SceneQueryOptions} [options]
   * @returns {ClosestObjectsResult}
   */
  closestObjects(options = {}) {
    checkNames(options, ["relativeError", "absoluteError", "maxDistance", "filter", "budget", "cache"]);
    const errors = errorsOf(options), limits = limitsOf(options.budget), cache = options.cache;
    const [wanted, ...filter] = filterOf(options);
    const scene = this.#address(), kept = cacheAddress(cache);
    callWithFilter(wanted, "sceneClosestObjects", scene, ...errors, ...limits, ...filter, kept);
    return { objects: objects(), result: distanceResult() };
  }

  /**
   * Whether any two objects that the filter lets through are at most `maxDistance` apart; with 0, whether any two meet.
   * Stops at the first such pair.
   *
   * @param {number} maxDistance
   * @param {ObjectPairOptions & { budget?: QueryBudget }} [options]
   * @returns {AnyWithinResult}
   */
  anyWithin(maxDistance, options = {}) {
    checkNames(options, ["filter", "budget"]);
    const most = numberOf(maxDistance, "maxDistance"), limits = limitsOf(options.budget);
    const [wanted, ...filter] = filterOf(options);
    callWithFilter(wanted, "sceneAnyWithin", this.#address(), most, ...limits, ...filter);
    return { objects: objects(), result: collideResult() };
  }

  /**
   * The objects whose bounds are at most `margin` from those of a body, which need not be in the scene. No object is
   * missing for which distance() would answer at most the margin, if the filter lets it through. Throws also notRigid.
   *
   * @param {Body} body
   * @param {number} margin
   * @param {{ pose?: Pose | null, filter?: ObjectFilter }} [options]
   */
  candidates(body, margin, options = {}) {
    checkNames(options, ["pose", "filter"]);
    const most = numberOf(margin, "margin"), wanted = objectFilterOf(options.filter);
    const read = poseOf(options.pose, "pose");
    const scene = this.#address(), address = bodyAddress(body, "body"), form = writePose(read, 0);
    callWithFilter(wanted, "sceneCandidates", scene, address, form, most, wanted ? 1 : 0);
    return new Uint32Array(copyOf(word(0), word(1)));
  }

  /**
   * The object that is closest to a body, of those that the filter lets through. The body need not be in the scene; for
   * one of its objects, pass a filter that leaves it out. All else as closestObjects().
   *
   * @param {Body} body
   * @param {ErrorOptions & { pose?: Pose | null, filter?: ObjectFilter, budget?: QueryBudget }} [options]
   * @returns {ClosestObjectResult}
   */
  closestObject(body, options = {}) {
    checkNames(options, ["pose", "relativeError", "absoluteError", "maxDistance", "filter", "budget"]);
    const { filter, budget } = options, errors = errorsOf(options), limits = limitsOf(budget);
    const read = poseOf(options.pose, "pose"), wanted = objectFilterOf(filter);
    const scene = this.#address(), address = bodyAddress(body, "body"), form = writePose(read, 0);
    callWithFilter(wanted, "sceneClosestObject", scene, address, form, ...errors, ...limits, wanted ? 1 : 0);
    return { object: objectOfLast(), result: distanceResult() };
  }

  /**
   * The object that a body touches first on its way, of those that the filter lets through; all objects stand where
   * they were at the last commit. Other engines call this a sweep or a shape cast. All else as timeOfImpact().
   *
   * @param {Body} body
   * @param {RigidMotion} motion
   * @param {ObjectImpactOptions} [options]
   * @returns {ObjectImpactResult}
   */
  timeOfImpact(body, motion, options = {}) {
    checkNames(options, ["maxTime", "minSeparation", "distanceError", "filter", "budget"]);
    const { budget } = options, maxTime = numberOf(options.maxTime, "maxTime", 1);
    const minSeparation = numberOf(options.minSeparation, "minSeparation", 0);
    const distanceError = distanceErrorOf(options.distanceError), limits = limitsOf(budget);
    const wanted = objectFilterOf(options.filter), way = motionAddress(motion, "motion");
    const given = [this.#address(), bodyAddress(body, "body"), way, maxTime, minSeparation, ...distanceError];
    callWithFilter(wanted, "sceneTimeOfImpact", ...given, ...limits, wanted ? 1 : 0);
    return { object: objectOfLast(), result: pathImpactResult() };
  }

  /**
   * Asks closestObjects() of many configurations. In configuration k, ids[j] is at poses[k * ids.length + j]; later
   * entries win where an id is repeated. All other objects are where they were at the last commit. The scene does not
   * change. Configurations that are left when the deadline has passed are "interrupted".
   *
   * Throws also sizeMismatch unless there are as many poses for each configuration; notRigid with the pose's index.
   *
   * @param {Ids} ids at least one
   * @param {Matrices} poses
   * @param {ErrorOptions & ObjectPairOptions & { budget?: QueryBudget }} [options]
   */
  closestObjectsMany(ids, poses, options = {}) {
    checkNames(options, ["relativeError", "absoluteError", "maxDistance", "filter", "budget"]);
    const errors = errorsOf(options), limits = limitsOf(options.budget);
    const count = this.#askMany("sceneClosestObjectsMany", ids, poses, [...errors, ...limits], options);
    return new DistanceResults(count, true);
  }

  /**
   * Asks anyWithin() of many configurations. All else as closestObjectsMany(); those that are left are "undecided".
   *
   * @param {Ids} ids
   * @param {Matrices} poses
   * @param {number} maxDistance
   * @param {ObjectPairOptions & { budget?: QueryBudget }} [options]
   */
  anyWithinMany(ids, poses, maxDistance, options = {}) {
    checkNames(options, ["filter", "budget"]);
    const most = numberOf(maxDistance, "maxDistance"), limits = limitsOf(options.budget);
    const count = this.#askMany("sceneAnyWithinMany", ids, poses, [most, ...limits], options);
    return new CollideResults(count, true);
  }

  /**
   * Asks about many configurations; returns how many.
   *
   * @param {string} name of the function
   * @param {Ids} ids
   * @param {Matrices} poses
   * @param {number[]} values
   * @param {ObjectPairOptions} options
   */
  #askMany(name, ids, poses, values, options) {
    const list = idsOf(ids, "ids");
    if (list.length === 0) throw invalid("ids is empty");
    const matrices = matricesOf(poses, list.length, false), count = matrices.length / (16 * list.length);
    const [wanted, ...filter] = filterOf(options);
    const scene = this.#address();
    writeInput(matrices, list);
    callWithFilter(wanted, name, scene, list.length, count, ...values, ...filter);
    return count;
  }
}
