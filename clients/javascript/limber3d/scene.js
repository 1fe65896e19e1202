// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many placed models: the pairs of them that may be close, and queries of many pairs.

import { collideResults, distanceResult, distanceResults } from "./answers.js";
import { checkNames, errorsOf, idOf, limitsOf, none, numberOf, pairsOf, poseOf, writePose } from "./arguments.js";
import { bodyAddress } from "./bodies.js";
import { noId } from "./types.js";
import { Owner, check, engine, givenBytes, number, ownedAddress, writeInput } from "./wasm.js";
/** @import { Body, DistanceResult, ErrorOptions, Ids, Pose, QueryBudget } from "./types.js" */

/**
 * @typedef {object} SceneQueryOptions
 * @property {QueryBudget} [budget] The deadline is that of the whole call, a number of steps that of each pair.
 */

/**
 * The two objects of a scene that are closest to each other.
 *
 * @typedef {object} ClosestObjectsResult
 * @property {[a: number, b: number] | null} objects none exactly when the result has no witness
 * @property {DistanceResult} result of a and b, in this order
 */

const noNumbers = new Float64Array(0);

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
  #bodies = new Map();

  constructor() {
    super(engine().newScene());
  }

  /** Where the scene is in the module's memory, unless one of its models has been disposed of. */
  #address() {
    for (const [id, body] of this.#bodies) bodyAddress(body, `the model of object ${id}`);
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
    const id = number(0);
    this.#bodies.set(id, model);
    return id;
  }

  /** Takes an object out. @param {number} id */
  remove(id) {
    check(engine().sceneRemove(ownedAddress(this, "scene"), idOf(id, "id")));
    this.#bodies.delete(id);
  }

  /**
   * Places an object elsewhere. Throws notRigid.
   *
   * @param {number} id
   * @param {Pose | null} pose
   */
  setPose(id, pose) {
    const read = poseOf(pose, "pose"), object = idOf(id, "id");
    const scene = ownedAddress(this, "scene"), form = writePose(read, 0);
    check(engine().sceneSetPose(scene, object, form));
  }

  /**
   * Prepares the scene for queries. Throws invalidArgument unless all models of the scene are committed. Cost: O(n),
   * and O(n log n) where objects lie in clusters within clusters.
   */
  commit() {
    check(engine().sceneCommit(this.#address()));
  }

  /** How many objects there are. */
  get size() {
    return engine().sceneSize(ownedAddress(this, "scene"));
  }

  /**
   * The pairs of objects whose bounds are at most `margin` apart: two ids for each, the smaller one first. No pair is
   * missing for which distance() would answer at most the margin. Cost: about O(n + pairs).
   *
   * Throws, as all queries of a scene, invalidArgument unless it is committed and options are what their comments say.
   *
   * @param {number} margin
   */
  candidatePairs(margin) {
    const most = numberOf(margin, "margin");
    check(engine().sceneCandidatePairs(this.#address(), most));
    return new Uint32Array(givenBytes());
  }

  /**
   * Asks a function of the module about pairs; returns how many.
   *
   * @param {string} name
   * @param {Ids} pairs
   * @param {number[]} values
   * @param {SceneQueryOptions} options
   */
  #ask(name, pairs, values, { budget }) {
    const asked = pairsOf(pairs, "pairs"), count = asked.length / 2, limits = limitsOf(budget);
    const scene = this.#address();
    writeInput(noNumbers, asked);
    check(engine()[name](scene, count, ...values, ...limits));
    return count;
  }

  /**
   * Asks collide() of each pair.
   *
   * @param {Ids} pairs two ids for each, as candidatePairs() gives them
   * @param {SceneQueryOptions} [options]
   */
  collide(pairs, options = none) {
    checkNames(options, ["budget"]);
    return collideResults(this.#ask("sceneCollide", pairs, [], options));
  }

  /**
   * Asks within() of each pair.
   *
   * @param {Ids} pairs
   * @param {number} maxDistance
   * @param {SceneQueryOptions} [options]
   */
  within(pairs, maxDistance, options = none) {
    checkNames(options, ["budget"]);
    return collideResults(this.#ask("sceneWithin", pairs, [numberOf(maxDistance, "maxDistance")], options));
  }

  /**
   * Asks distance() of each pair.
   *
   * @param {Ids} pairs
   * @param {ErrorOptions & SceneQueryOptions} [options]
   */
  distance(pairs, options = none) {
    checkNames(options, ["relativeError", "absoluteError", "maxDistance", "budget"]);
    return distanceResults(this.#ask("sceneDistance", pairs, errorsOf(options), options));
  }

  /**
   * The clearance of the scene: the shortest distance of any two objects, but for the pairs to be ignored, two ids for
   * each. Which of several equally close pairs is named is not defined.
   *
   * @param {ErrorOptions & SceneQueryOptions & { ignoredPairs?: Ids }} [options]
   * @returns {ClosestObjectsResult}
   */
  closestObjects(options = none) {
    checkNames(options, ["relativeError", "absoluteError", "maxDistance", "ignoredPairs", "budget"]);
    const { ignoredPairs = [], ...others } = options;
    this.#ask("sceneClosestObjects", pairsOf(ignoredPairs, "ignoredPairs"), errorsOf(others), others);
    return { objects: number(0) === noId ? null : [number(0), number(1)], result: distanceResult() };
  }
}
