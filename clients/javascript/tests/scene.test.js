// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Scenes: objects, pairs, configurations, filters, memory, and arguments that are not what the comments say.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { refuses, tetrahedron } from "./support.js";

const at = (x) => ({ translation: [x, 0, 0] });

/** Tetrahedra of size 1 at x = 0, 0.75, 1.5, ... */
function row(count, model = tetrahedron()) {
  const scene = new limber.Scene();
  for (let i = 0; i < count; ++i) assert.equal(scene.add(model, at(0.75 * i)), i);
  scene.commit();
  return scene;
}

/** Matrices of translations along x. */
const matrices = (...xs) => xs.flatMap((x) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1]);
const joined = (pairs, i) => `${pairs[2 * i]},${pairs[2 * i + 1]}`;
const sorted = (pairs) => Array.from({ length: pairs.length / 2 }, (_, i) => joined(pairs, i)).sort();

before(() => limber.init());

test("pairs of objects are asked as two models are", () => {
  const model = tetrahedron(), scene = row(4, model), pairs = scene.candidatePairs(0);
  assert.deepEqual(sorted(pairs), ["0,1", "1,2", "2,3"]);
  assert.deepEqual(Array.from(scene.collide(pairs).answers, (i) => limber.answers[i]), ["yes", "yes", "yes"]);
  const asked = [0, 2, 3, 0, 1, 2];
  const distances = scene.distance(asked), answers = scene.within(asked, 0.6);
  assert.equal(distances.count, 3);
  for (let i = 0; i < 3; ++i) {
    const options = { poseA: scene.pose(asked[2 * i]), poseB: scene.pose(asked[2 * i + 1]) };
    assert.deepEqual(distances.at(i), limber.distance(model, model, options));
    assert.deepEqual([...answers][i], limber.within(model, model, 0.6, options));
  }
  assert.equal(distances.at(0).upper, 0.5);
  assert.equal(distances.uppers[0], 0.5);
  assert.equal(limber.distanceStatuses[distances.statuses[0]], "exact");
  refuses(() => distances.at(3), "invalidArgument", "no answer 3 of 3");
  refuses(() => distances.objectsAt(0), "invalidArgument", "no objects");
  assert.equal(scene.collide([]).count, 0);
  const cache = new limber.SceneCache(8);
  for (let i = 0; i < 3; ++i) assert.deepEqual([...scene.distance(asked, { cache }).uppers], [...distances.uppers]);
  cache.clear();
  const late = scene.distance([0, 2], { budget: { maxSteps: 0 } }), [stopped] = late;
  assert.equal(limber.stoppedBys[late.stoppedBys[0]], "maxSteps");
  assert.deepEqual([stopped.status, stopped.stoppedBy], ["interrupted", "maxSteps"]);
});

test("objects come, move and go", () => {
  const scene = row(3), other = tetrahedron();
  scene.remove(1);
  assert.deepEqual([scene.contains(1), scene.contains(2), scene.size, scene.idBound], [false, true, 2, 3]);
  assert.ok(!scene.isCommitted);
  assert.equal(scene.add(other), 1);
  assert.equal(scene.model(1), other);
  scene.setPoses([0, 2], matrices(5, 7));
  scene.setPose(1, at(9));
  scene.commit();
  assert.ok(scene.isCommitted);
  assert.deepEqual([0, 1, 2].map((id) => scene.pose(id)[12]), [5, 9, 7]);
  const { low, high } = scene.boundingBox(1);
  assert.ok(low[0] <= 9 && low[0] > 8.9 && high[0] >= 10 && high[0] < 10.1);
  scene.setPoses([], []);
  other.moveVertices([1], [4, 0, 0]);
  refuses(() => scene.commit(), "invalidArgument", "commit");
  other.commit();
  assert.ok(!scene.isCommitted);
  refuses(() => scene.collide([0, 1]), "invalidArgument", "commit");
  scene.commit();
  assert.ok(scene.boundingBox(1).high[0] >= 13);
});

test("the closest objects, any that are close, and which pairs count", () => {
  const scene = row(4);
  assert.equal(scene.closestObjects().result.status, "collision");
  const filter = (a, b) => b - a === 2, apart = scene.closestObjects({ filter });
  assert.equal(apart.result.upper, 0.5);
  assert.ok(["0,2", "1,3"].includes(apart.objects.join()));
  assert.equal(scene.closestObjects({ filter: () => false }).objects, null);
  assert.equal(scene.closestObjects({ filter, maxDistance: 0.25 }).result.status, "beyondLimit");
  assert.deepEqual(sorted(scene.candidatePairs(9, { filter })), ["0,2", "1,3"]);
  const matrix = new limber.ObjectPairMatrix(scene.idBound, false);
  assert.equal(matrix.size, 4);
  matrix.set(0, 3, true);
  assert.deepEqual([matrix.counts(3, 0), matrix.counts(0, 1)], [true, false]);
  assert.deepEqual(scene.closestObjects({ filter: matrix }).objects, [0, 3]);
  matrix.setAmong([0, 1, 2], true), matrix.setBetween([0], [1, 3], false);
  assert.deepEqual(sorted(scene.candidatePairs(9, { filter: matrix })), ["0,2", "1,2"]);
  assert.equal(scene.anyWithin(0).result.answer, "yes");
  assert.deepEqual(scene.anyWithin(0.25, { filter }), { ...scene.anyWithin(0.25, { filter }), objects: null });
  assert.equal(scene.anyWithin(0.5, { filter }).result.answer, "yes");
});

test("configurations are asked as scenes are, and change nothing", () => {
  const model = tetrahedron(), scene = row(3, model), xs = [[3, 8], [0.25, 2], [6, 6], [0, 0]];
  const asked = matrices(...xs.flat()), ids = [0, 2];
  const closest = scene.closestObjectsMany(ids, asked), close = scene.anyWithinMany(ids, asked, 1.5);
  assert.deepEqual([closest.count, close.count], [4, 4]);
  assert.ok(scene.isCommitted && scene.pose(2)[12] === 1.5);
  xs.forEach(([first, second], k) => {
    const other = row(3, model);
    other.setPoses(ids, matrices(first, second));
    other.commit();
    const one = other.closestObjects(), any = other.anyWithin(1.5);
    assert.deepEqual({ objects: closest.objectsAt(k), result: closest.at(k) }, one);
    assert.equal(close.at(k).answer, any.result.answer);
    assert.deepEqual(close.objectsAt(k), any.objects);
    assert.deepEqual([...close.objects.subarray(2 * k, 2 * k + 2)], any.objects ?? [limber.noId, limber.noId]);
    other.dispose();
  });
  assert.equal(scene.closestObjectsMany(ids, []).count, 0);
  const filter = () => { throw new RangeError("no"); };
  assert.throws(() => scene.closestObjectsMany(ids, asked, { filter }), RangeError);
  assert.deepEqual([...scene.anyWithinMany(ids, asked, 0, { filter: () => false }).answers], [0, 0, 0, 0]);
});

test("contacts of pairs are those of two models", () => {
  const model = tetrahedron(), scene = row(4, model), pairs = [0, 1, 0, 3, 2, 1];
  const { contacts, offsets } = scene.contacts(pairs, 0.1);
  assert.ok(offsets[0] === 0 && offsets[1] > 0 && offsets.length === 4 && contacts.isComplete);
  assert.deepEqual([offsets[2], offsets[3]], [offsets[1], contacts.count]);
  for (let i = 0; i < 3; ++i) {
    const options = { poseA: scene.pose(pairs[2 * i]), poseB: scene.pose(pairs[2 * i + 1]) };
    assert.deepEqual([...contacts].slice(offsets[i], offsets[i + 1]), [...limber.contacts(model, model, 0.1, options)]);
  }
  const plain = scene.contacts(pairs, 0.1, { orientedFaces: "none" }).contacts;
  assert.ok(contacts.normalSides.some((side) => side !== 0) && plain.normalSides.every((side) => side === 0));
  assert.deepEqual([...scene.contacts([], 1).offsets], [0]);
});

test("one body is asked about next to all objects", () => {
  const scene = row(4), ball = limber.Shape.sphere(0.25), pose = { translation: [9, 0, 0] };
  const one = scene.add(ball, { translation: [20, 0, 0] });
  scene.commit();
  assert.equal(scene.model(one), ball);
  const next = scene.closestObject(ball, { pose });
  assert.deepEqual([next.object, next.result.upper, next.result.witness.pointA], [3, 5.5, [8.75, 0, 0]]);
  const seen = [], filter = (...ids) => { seen.push(ids.length); return ids[0] !== 3; };
  assert.equal(scene.closestObject(ball, { pose, filter }).object, 2);
  assert.ok(seen.length > 0 && seen.every((count) => count === 1));
  const none = scene.closestObject(ball, { pose, maxDistance: 5 });
  assert.deepEqual([none.object, none.result.status], [null, "beyondLimit"]);
  assert.deepEqual([...scene.candidates(ball, 0.75, { pose: { translation: [20, 1, 0] } })], [one]);
  assert.deepEqual([...scene.candidates(ball, 99)].sort(), [0, 1, 2, 3, one]);
  assert.deepEqual([...scene.candidates(ball, 99, { filter: (id) => id > 2 })].sort(), [3, one]);
  const thrown = new Error("filter");
  assert.throws(() => scene.closestObject(ball, { filter: () => { throw thrown; } }), thrown);
  refuses(() => scene.closestObject(ball, { filter: 3 }), "invalidArgument", "filter");
  refuses(() => scene.closestObject(7), "invalidArgument", "body is no Model or Shape");
  refuses(() => scene.candidates(ball, -1), "invalidArgument", "margin");
  refuses(() => scene.contacts([0, 1], NaN), "invalidArgument", "margin");
  refuses(() => scene.contacts([0, 9], 1), "invalidArgument", "pair");
  ball.dispose();
  refuses(() => scene.candidatePairs(1), "disposed", `object ${one}`);
});

test("a body that moves is asked what it touches first", () => {
  const scene = row(4), ball = limber.Shape.sphere(0.25);
  const along = new limber.RigidMotion({ translation: [20, 0.1, 0.1] }, { translation: [-20, 0.1, 0.1] });
  const first = scene.timeOfImpact(ball, along), { status, time, witness, normal } = first.result;
  assert.deepEqual([first.object, status], [3, "contact"]);
  const alone = limber.timeOfImpact(ball, scene.model(3), {
    motionA: along, motionB: new limber.RigidMotion(scene.pose(3)),
  });
  assert.ok(Math.abs(time - alone.time) < 1e-6 && Math.abs(Math.hypot(...normal) - 1) < 1e-9 && normal[0] < 0);
  assert.ok(witness !== null && Math.abs(Math.hypot(...alone.normal) - 1) < 1e-9);
  const filter = (id) => id !== 3;
  assert.equal(scene.timeOfImpact(ball, along, { filter }).object, 2);
  assert.deepEqual(scene.timeOfImpact(ball, along, { maxTime: 0.1 }).object, null);
  const none = scene.timeOfImpact(ball, along, { budget: { maxSteps: 0 } }).result;
  assert.ok(none.status === "undecided" && none.time > 0 && none.time < time);
  assert.deepEqual([...none.normal], [0, 0, 0]);
  refuses(() => scene.timeOfImpact(ball, along, { filter: 3 }), "invalidArgument", "filter");
  refuses(() => scene.timeOfImpact(ball, { start: null }), "invalidArgument", "motion");
  refuses(() => scene.timeOfImpact(ball, along, { maxTime: 2 }), "invalidArgument", "max_time");
});

test("mistakes are errors and change nothing", () => {
  const model = tetrahedron(), scene = row(3, model);
  for (const id of [7, -1, 0.5, "1", undefined, NaN]) {
    for (const call of [
      () => scene.remove(id), () => scene.setPose(id, null), () => scene.pose(id), () => scene.model(id),
      () => scene.boundingBox(id),
    ]) {
      refuses(call, "invalidArgument");
    }
  }
  refuses(() => scene.add({}), "invalidArgument", "model");
  refuses(() => scene.add(model, { rotation: [2, 0, 0, 0, 1, 0, 0, 0, 1] }), "notRigid", "pose");
  refuses(() => scene.setPoses([0, 1], matrices(1)), "sizeMismatch", "poses");
  refuses(() => scene.setPoses([0, 9], matrices(1, 2)), "invalidArgument", "ids");
  refuses(() => scene.setPoses([0, 1], [...matrices(1), ...matrices(2).fill(1)]), "notRigid", "poses[1]");
  refuses(() => scene.setPoses([0], "poses"), "invalidArgument", "poses");
  refuses(() => scene.setPoses([0], [...matrices(1).slice(1), "1"]), "invalidArgument", "poses[15]");
  refuses(() => scene.closestObjectsMany([0, 1], matrices(1, 2, 3)), "sizeMismatch", "poses");
  refuses(() => scene.closestObjectsMany([], []), "invalidArgument", "ids");
  refuses(() => scene.closestObjectsMany([0], undefined), "invalidArgument", "poses");
  refuses(() => scene.anyWithinMany([9], matrices(1), 1), "invalidArgument", "ids");
  refuses(() => scene.collide([0, 1, 2]), "sizeMismatch", "pairs");
  refuses(() => scene.collide([0, 7]), "invalidArgument", "pair");
  refuses(() => scene.within([0, 1], -1), "invalidArgument", "max_distance");
  refuses(() => scene.candidatePairs(NaN), "invalidArgument", "margin");
  refuses(() => scene.collide([0, 1], { filter: () => true }), "invalidArgument", "there are budget, cache");
  refuses(() => scene.collide([0, 1], { cache: new limber.QueryCache() }), "invalidArgument", "SceneCache");
  refuses(() => scene.closestObjects({ filter: new limber.ObjectPairMatrix(2) }), "invalidArgument");
  refuses(() => scene.closestObjects({ filter: 3 }), "invalidArgument", "filter");
  refuses(() => new limber.ObjectPairMatrix(-1), "invalidArgument", "size");
  refuses(() => new limber.ObjectPairMatrix(3).set(1, 1, true), "invalidArgument");
  refuses(() => new limber.ObjectPairMatrix(3).set(1, 2, 1), "invalidArgument", "counts");
  refuses(() => new limber.ObjectPairMatrix(3).setAmong([1, 3], true), "invalidArgument");
  refuses(() => new limber.SceneCache("9"), "invalidArgument", "maxPairs");
  assert.ok(scene.isCommitted && scene.size === 3 && scene.pose(0)[12] === 0);
});

test("filters may not change a scene, and what they throw comes through", () => {
  const scene = row(3), thrown = new Error("filter");
  refuses(() => scene.candidatePairs(0, { filter: () => scene.remove(0) }), "busy");
  refuses(() => scene.closestObjects({ filter: () => scene.commit() }), "busy");
  assert.throws(() => scene.anyWithin(0, { filter: () => { throw thrown; } }), thrown);
  assert.equal(scene.size, 3);
});

test("a scene outlives its models only to lose them", () => {
  const scene = new limber.Scene(), first = tetrahedron(), second = tetrahedron();
  scene.add(first), scene.add(second), scene.add(second, at(3));
  scene.commit();
  first.dispose();
  for (const use of [
    () => scene.commit(), () => scene.isCommitted, () => scene.candidatePairs(1), () => scene.collide([1, 2]),
    () => scene.closestObjects(), () => scene.add(second), () => scene.setPose(1, null), () => scene.boundingBox(1),
    () => scene.closestObjectsMany([1], matrices(1)),
  ]) {
    refuses(use, "disposed", "object 0");
  }
  scene.remove(0);
  scene.commit();
  assert.equal(scene.closestObjects().result.upper, 2);
  second.dispose();
  scene.dispose();
  refuses(() => scene.size, "disposed");
  refuses(() => scene.contains(1), "disposed");
});
