// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Known answers of each function, and what its options and results mean; answers.test.js has the bits of many more.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, grid, refuses, row, tetrahedron } from "./support.js";

const { Shape } = limber;

/** A sheet of n x n squares in the plane z = 0, over [0, 1] x [0, 1]. */
const sheet = (n, options) => new limber.Model(...grid(n), options);
const at = (...translation) => ({ poseB: { translation } });
const near = (x, expected, error = 1e-12) => assert.ok(Math.abs(x - expected) <= error, `${x}, not ${expected}`);

before(() => limber.init());

test("arrays of every kind make the same model, and are copied", () => {
  const kinds = [
    [corners, faces],
    [Float32Array.from(corners), Uint32Array.from(faces)],
    [Float64Array.from(corners), Int32Array.from(faces)],
    [new Float32Array([9, 9, ...corners, 9]).subarray(2, 14), Uint16Array.from(faces)],
  ];
  for (const arrays of kinds) {
    const model = new limber.Model(...arrays);
    if (!Array.isArray(arrays[0])) arrays.forEach((array) => array.fill(7));
    model.vertices().fill(5);
    assert.deepEqual([...model.vertices()], corners);
    assert.deepEqual([...model.edges()], [0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3]);
  }
});

test("options of a model reach the engine, and change no answers", () => {
  const work = (options) => {
    const model = sheet(40, options), vertices = model.vertices();
    for (let frame = 0; frame < 60; ++frame) {
      for (let i = 0; i < vertices.length; ++i) vertices[i] += 0.3 * Math.sin(i * (frame + 1));
      model.moveAll(vertices);
      model.commit();
    }
    return limber.selfContacts(model, 0.001);
  };
  const usual = work({}), off = work({ rebuildPolicy: "off" });
  const margin = work({ rebuildPolicy: "off", motionMargin: 9 });
  assert.deepEqual([off.count, margin.count], [usual.count, usual.count]);
  assert.ok(usual.stats.nodeTests < off.stats.nodeTests && off.stats.nodeTests < margin.stats.nodeTests);
});

test("moves mark, commit() repairs, queries in between are refused", () => {
  const model = sheet(8), other = tetrahedron();
  model.moveVertices([40], [0.5, 0.5, 3]);
  for (const query of [
    () => limber.distance(model, other), () => limber.collide(other, model), () => limber.within(model, other, 1),
    () => limber.contacts(model, other, 1), () => limber.selfCollide(model), () => model.boundingBox(),
    () => limber.closestPoint(model, [0, 0, 0]), () => limber.timeOfImpact(model, other),
    () => new limber.Scene().add(model),
  ]) {
    refuses(query, "invalidArgument", "commit");
  }
  model.commit();
  const { low, high } = model.boundingBox();
  assert.ok(high[2] >= 3 && high[2] < 3.01 && low[2] <= 0 && low[2] > -0.01 && high[0] < 1.01);
  model.moveVertices([40], [0.5, 0.5, 2]);
  model.rebuild();
  assert.equal(limber.closestPoint(model, [0.5, 0.5, 9]).closest.distance, 7);
});

test("poses of every form mean the same", () => {
  const a = sheet(6), b = tetrahedron(), half = Math.SQRT1_2;  // a quarter turn about z
  const quaternion = [0, 0, half, half], translation = [0.3, 0.2, 0.4], [x, y, z] = translation;
  const matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, ...translation, 1];
  const rotation = [0, 1, 0, -1, 0, 0, 0, 0, 1];
  const forms = [
    matrix,
    { elements: matrix },
    Float64Array.from(matrix),
    { rotation, translation },
    { rotation: { elements: rotation }, translation: { x, y, z } },
    { quaternion, translation },
    { quaternion: { x: 0, y: 0, z: 2, w: 2 }, translation: Float32Array.from(translation) },
  ];
  for (const [i, poseB] of forms.entries()) {
    const { lower, witness } = limber.distance(a, b, { poseB });
    assert.ok(Math.abs(lower - 0.4) < 1e-7, `form ${i}: ${lower}`);
    assert.ok(witness.pointB[0] <= 0.3 + 1e-7 && witness.pointB[1] >= 0.2 - 1e-7, `form ${i}: ${witness.pointB}`);
    assert.equal(limber.distance(b, a, { poseA: poseB }).witness.pointA[2], witness.pointB[2]);
  }
  for (const poseB of [undefined, null]) assert.equal(limber.distance(a, b, { poseB }).upper, 0);
});

test("distances, errors and limits", () => {
  const a = sheet(30), b = tetrahedron(), poseB = { translation: [0.2, 0.3, 1.25] };
  const exact = limber.distance(a, b, { poseB });
  assert.deepEqual([exact.status, exact.lower, exact.upper, exact.stoppedBy], ["exact", 1.25, 1.25, "nothing"]);
  assert.deepEqual([exact.witness.pointA[2], exact.witness.pointB[2]], [0, 1.25]);
  assert.ok(exact.witness.triangleA < 1800 && exact.witness.triangleB < 4 && exact.stats.nodeTests > 0);
  for (const error of [{ relativeError: 0.08 }, { absoluteError: 0.1 }]) {
    const { lower, upper } = limber.distance(a, b, { poseB, ...error });
    assert.ok(lower <= 1.25 && upper >= 1.25 && upper <= 1.35);
  }
  const far = limber.distance(a, b, { poseB, maxDistance: 1 });
  assert.deepEqual([far.status, far.witness, far.upper], ["beyondLimit", null, Infinity]);
  assert.equal(limber.distance(a, b).status, "collision");
  assert.equal(limber.within(a, b, 1.2, { poseB }).witness, null);
  for (const [{ answer, isYes, isNo }, ...expected] of [
    [limber.within(a, b, 1.3, { poseB }), "yes", true, false], [limber.within(a, b, 1.2, { poseB }), "no", false, true],
    [limber.collide(a, b), "yes", true, false], [limber.collide(a, b, { poseB }), "no", false, true],
  ]) {
    assert.deepEqual([answer, isYes, isNo], expected);
  }
});

test("budgets end queries, and caches go on", () => {
  const a = sheet(60), b = sheet(50), cache = new limber.QueryCache();
  b.moveAll(b.vertices().map((x, i) => (i % 3 === 2 ? 0.1 + 0.01 * Math.sin(i) : x)));
  b.commit();
  const exact = limber.distance(a, b).upper;
  const first = limber.distance(a, b, { budget: { maxSteps: 3 } });
  assert.deepEqual([first.status, first.stoppedBy], ["interrupted", "maxSteps"]);
  assert.ok(first.lower <= exact && first.upper >= exact);
  let calls = 0;
  while (limber.distance(a, b, { budget: { maxSteps: 20 }, cache }).status === "interrupted") ++calls;
  assert.ok(calls > 2 && calls < 1000);
  cache.clear();
  const late = limber.distance(a, b, { budget: { deadline: performance.now() - 1 }, cache });
  assert.deepEqual([late.status, late.stoppedBy], ["interrupted", "deadline"]);
  assert.equal(limber.distance(a, b, { budget: { deadline: performance.now() + 1e4 } }).status, "exact");
  const undecided = limber.within(a, b, 1.0001 * exact, { budget: { maxSteps: 1 } });
  assert.deepEqual([undecided.answer, undecided.stoppedBy, undecided.witness], ["undecided", "maxSteps", null]);
  assert.ok(!undecided.isYes && !undecided.isNo);
  assert.equal(limber.collide(a, b, { budget: {} }).answer, "no");
});

test("a deadline is met", () => {
  const a = sheet(120), poseB = { translation: [0, 0, 0.4] };
  a.moveAll(a.vertices().map((x, i) => (i % 3 === 2 ? 1e-9 * ((i * 7919) % 101) : x)));
  a.commit();
  const timed = (budget) => {  // everything is about as far as everything else
    const start = performance.now(), deadline = start + budget;
    return [limber.distance(a, a, { poseB, budget: { deadline } }).status, performance.now() - start];
  };
  const [exact, whole] = timed(Infinity), [interrupted, took] = timed(whole / 20);
  assert.deepEqual([exact, interrupted], ["exact", "interrupted"]);
  assert.ok(took >= whole / 20 && took < whole / 2, `${took} ms of ${whole}`);
});

test("contacts are arrays, and records", () => {
  const a = sheet(10), b = tetrahedron(), poseB = { translation: [0.35, 0.35, -0.5] };
  const meeting = limber.contacts(a, b, 0, { poseB }), close = limber.contacts(a, b, 0.05, { poseB });
  assert.ok(meeting.isComplete && meeting.count > 0 && close.count > meeting.count);
  assert.equal([...close].filter((contact) => contact.distance === 0).length, meeting.count);
  for (const { distance, normal, triangleB, pointA, pointB, weightsB } of close) {
    normal.forEach((x, i) => near(pointB[i] - pointA[i], x * distance));
    const ids = faces.slice(3 * triangleB, 3 * triangleB + 3);
    const weighted = (axis) => ids.reduce((sum, v, k) => sum + weightsB[k] * corners[3 * v + axis], 0);
    pointB.forEach((x, i) => near(weighted(i) + poseB.translation[i], x));
  }
  const some = limber.contacts(a, b, 0.05, { poseB, maxCount: 2 }), second = close.at(1);
  assert.deepEqual([some.count, some.isComplete, some.at(1)], [2, false, second]);
  for (const [feature, column] of [[second.featureA, close.featuresA], [second.featureB, close.featuresB]]) {
    assert.deepEqual(feature, { kind: limber.featureKinds[column[2]], index: column[3] });
  }
  const columns = [close.distances, close.depths, close.trianglesA, close.trianglesB];
  const told = [second.distance, second.depth, second.triangleA, second.triangleB];
  assert.deepEqual(told, columns.map((column) => column[1]));
  assert.deepEqual([...close.weightsA.subarray(3, 6)], second.weightsA);
  assert.ok(close.stats.primitiveTests >= close.count);
  for (const wrong of [-1, close.count, 0.5, NaN]) refuses(() => close.at(wrong), "invalidArgument", "answer");
  const sides = [...limber.contacts(b, b, 0, at(0.5, 0, 0))].map((contact) => contact.normalSide);
  assert.ok(sides.includes("outward"));
});

test("queries of a model with itself", () => {
  const a = sheet(20);
  assert.equal(limber.selfCollide(a).answer, "no");
  const vertices = a.vertices();
  for (let i = 0; i < vertices.length; i += 3) {
    const angle = 2.2 * Math.PI * vertices[i];  // a roll that overlaps itself
    [vertices[i], vertices[i + 2]] = [Math.cos(angle), Math.sin(angle)];
  }
  a.moveAll(vertices);
  a.commit();
  assert.equal(limber.selfCollide(a, { cache: new limber.QueryCache() }).answer, "yes");
  assert.equal(limber.selfDistance(a).status, "collision");
  assert.ok(limber.selfContacts(a, 0).count > 0);
  assert.equal(limber.selfContacts(a, 0.01, { filter: new limber.NeighborRings(a, 30) }).count, 0);
  assert.equal(limber.selfContacts(a, 0.01, { maxCount: 3 }).count, 3);
  const rings = new limber.NeighborRings(tetrahedron(), 0);
  refuses(() => limber.selfContacts(a, 0.01, { filter: rings }), "invalidArgument");
});

test("points", () => {
  const a = tetrahedron(), pose = { translation: [10, 0, 0] };
  const { closest } = limber.closestPoint(a, [10.25, 0.25, -2], { pose });
  assert.deepEqual([closest.distance, closest.position, closest.triangle], [2, [10.25, 0.25, 0], 0]);
  assert.deepEqual([closest.feature, closest.weights], [{ kind: "face", index: 0 }, [0.5, 0.25, 0.25]]);
  assert.equal(limber.closestPoint(a, { x: 0, y: 0, z: 0 }, { pose, maxDistance: 1 }).closest, null);
  const many = limber.closestPointMany(a, Float32Array.of(0, 0, -3, 0.1, 0.1, 0.1), { maxDistance: 2 });
  assert.deepEqual([many.count, many.at(0).closest, many.distances[0]], [2, null, Infinity]);
  assert.deepEqual([many.triangles[0], limber.noId], [limber.noId, 0xffffffff]);
  assert.deepEqual([...many][1], many.at(1));
  assert.ok(many.at(1).closest.distance > 0 && many.at(1).stats.primitiveTests === many.primitiveTests[1]);
  const surface = new limber.ClosedSurface(a);
  assert.ok(surface.contains([0.1, 0.1, 0.1]) && !surface.contains([0.1, 0.1, 0.1], { pose }));
  const inside = surface.signedDistance([0.1, 0.1, 0.2]), outside = surface.signedDistance([3, 3, 3]);
  assert.ok(inside.isInside && inside.distance < 0 && inside.closest.distance === -inside.distance);
  assert.ok(!outside.isInside && outside.distance > 0);
  const signed = surface.signedDistanceMany([0.1, 0.1, 0.1, 3, 3, 3, 0, 0, 0], { maxDistance: 0.01 });
  assert.deepEqual([[...signed.insides], [...signed.distances]], [[1, 0, 1], [Infinity, Infinity, 0]]);
});

test("shapes are what formulas say, and are taken where models are", () => {
  const point = Shape.sphere(0), ball = Shape.sphere(0.5), rod = Shape.capsule([0, 0, -1], { x: 0, y: 0, z: 1 }, 0.25);
  assert.deepEqual([ball.radius, ball.isSolid, Shape.box([1, 2, 3]).isSolid], [0.5, false, true]);
  const hulls = [corners, Float32Array.from(corners)].map((points) => Shape.convexHull(points, 0.5));
  for (const [a, b, place, expected] of [
    [ball, rod, [2, 0, 0.5], 1.25], [Shape.box([1, 2, 3]), point, [1, 5, 0], 3],
    [Shape.box([1, 2, 3], 0.25), point, [4, 6, 0], 4.75], [tetrahedron(), ball, [2, 0, 0], 0.5],
    ...hulls.map((hull) => [hull, point, [1, 1, 1], 2 / Math.sqrt(3) - 0.5]),
  ]) {
    near(limber.distance(a, b, at(...place)).upper, expected);
  }
  assert.equal(limber.within(ball, rod, 1.24, at(2, 0, 0)).answer, "no");
  assert.equal(limber.collide(Shape.box([2, 2, 2]), tetrahedron()).answer, "yes");
});

// --- motion ---

/** A moving model of these arrays, which goes to `end` or stays. */
function moving(vertices, triangles, end = vertices, poses = {}) {
  const model = new limber.MovingModel(new limber.Model(vertices, triangles));
  model.setMotion(end, poses);
  return model;
}

/** The plate z = 0 over [-3, 3] x [-3, 3]. */
const plateArrays = [[-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0], [0, 1, 2, 0, 2, 3]];
const above = (z) => ({ translation: [0.1, 0.2, z] });
/** A tetrahedron that falls from one height to another. Its lowest face is flat. */
const falling = (from, to) => moving(corners, faces, corners, { startPose: above(from), endPose: above(to) });

test("a body falls on a plate", () => {
  const floor = moving(...plateArrays), found = limber.timeOfImpact(falling(3, -1), floor);
  assert.deepEqual([found.status, found.lower, found.upper, found.stoppedBy], ["contact", 0.75, 0.75, "nothing"]);
  assert.ok(["vertexFace", "edgeEdge"].includes(found.elements.kind) && found.stats.primitiveTests > 0);
  assert.deepEqual(found.normal.map((x) => x + 0), [0, 0, -1]);
  assert.deepEqual([found.witness.pointA[2], found.witness.pointB[2]], [0, 0]);
  const clear = limber.timeOfImpact(falling(3, 2), floor);
  assert.deepEqual([clear.status, clear.lower, clear.upper], ["clear", Infinity, Infinity]);
  assert.deepEqual([clear.elements, clear.witness, clear.normal], [null, null, [0, 0, 0]]);
  for (const [from, to, options, status, least, most] of [
    [-0.5, 2, {}, "initialContact", 0, 0],
    // What crosses may go on. An edge is 0.4 above the plate's diagonal, at (0.2, 0.2).
    [-0.5, -1.5, { ignoreCrossings: true }, "contact", 0.4, 0.4],
    [3, -1, { minSeparation: 1, maxTime: 0.9 }, "contact", 0.5, 0.5],
    [3, -1, { anyContact: true }, "contact", 0.75, 1],
    [3, -1.7, { timeError: 2 ** -7 }, "contact", 3 / 4.7, 3 / 4.7 + 2 ** -7],
    [0.3, 3, { minSeparation: 0.5 }, "initialContact", 0, 0],
    [0.3, 3, { minSeparation: 0.5, separationFraction: 0.5 }, "clear", Infinity, Infinity],
  ]) {
    const { upper, ...other } = limber.timeOfImpact(falling(from, to), floor, options);
    assert.equal(other.status, status);
    assert.ok(upper >= least - 1e-12 && upper <= most + 1e-12, `${upper} of ${JSON.stringify(options)}`);
  }
  const none = limber.timeOfImpact(falling(3, -1), floor, { budget: { maxSteps: 0 } });
  assert.deepEqual([none.status, none.stoppedBy], ["undecided", "maxSteps"]);
});

test("a model folds onto itself, and a motion ends when the model changes", () => {
  const book = [0, 0, 0, 0, 1, 0, 1, 0.25, 0, -1, 0.25, 0], end = book.map((x, i) => (i === 9 ? 0.5 : x));
  const a = moving(book, [0, 1, 2, 1, 0, 3], end), { status, upper, elements } = limber.selfTimeOfImpact(a);
  assert.equal(status, "contact");
  near(upper, 2 / 3);
  assert.deepEqual(elements, { kind: "vertexFace", a: 3, b: 0 });
  refuses(() => a.setMotion(book.slice(3)), "sizeMismatch", "3 positions for 4 vertices");
  assert.throws(() => a.setMotion(book.map((x, i) => (i === 7 ? NaN : x))), { code: "nonFinite", where: 2 });
  assert.equal(limber.selfTimeOfImpact(a).upper, upper, "what is refused leaves the motion as it was");
  a.model.moveVertices([3], [-1, 0.25, 0]);
  refuses(() => a.setMotion(book), "invalidArgument", "commit");
  a.model.commit();
  refuses(() => limber.selfTimeOfImpact(a), "invalidArgument", "motion");
  a.setMotion(Float32Array.from(book));
  assert.equal(limber.selfTimeOfImpact(a).status, "clear");
});

test("rigid bodies move, and turn", () => {
  const body = tetrahedron(), floor = new limber.Model(...plateArrays), cache = new limber.QueryCache();
  const motionA = new limber.RigidMotion(above(3), above(-1));
  const found = limber.timeOfImpact(body, floor, { motionA, distanceError: 1e-6 });
  assert.ok(found.time <= 0.75 && found.time >= 0.75 - 1e-6 && found.distanceCount > 0 && found.distanceCount < 40);
  assert.deepEqual([found.status, found.stoppedBy, found.witness.pointB[2]], ["contact", "nothing", 0]);
  near(found.normal[2], -1, 1e-9);
  near(limber.timeOfImpact(body, floor, { motionA, minSeparation: 1, cache }).time, 0.5, 1e-5);
  assert.equal(limber.timeOfImpact(floor, body, { motionB: motionA, distanceError: 1e-6 }).time, found.time);
  const clear = limber.timeOfImpact(body, floor, { motionA, maxTime: 0.5 });
  assert.deepEqual([clear.status, clear.time, clear.witness], ["clear", Infinity, null]);
  assert.equal(limber.timeOfImpact(body, floor).status, "initialContact");
  const few = limber.timeOfImpact(body, floor, { motionA, minSeparation: 0.01, budget: { maxSteps: 1 } });
  assert.deepEqual([few.status, few.stoppedBy], ["undecided", "maxSteps"]);
  const half = Math.SQRT1_2, quarter = { quaternion: [0, 0, half, half], translation: [2, 0, 0] };
  const turns = new limber.RigidMotion(null, quarter);
  const middle = [half, half, 0, 0, -half, half, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1];
  assert.deepEqual(turns.at(0), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  turns.at(0.5).forEach((x, i) => near(x, middle[i]));
  const about = new limber.RigidMotion(null, quarter, { x: 1, y: 0, z: 0 }).at(0.5);  // the center goes straight
  near(half + about[12], 1.5), near(half + about[13], 0.5);
  assert.deepEqual(new limber.RigidMotion(quarter).at(0.5), new limber.RigidMotion(quarter).at(1));
});

// --- scenes ---

test("pairs of objects are asked as two models are", () => {
  const model = tetrahedron(), scene = row(4, model), pairs = scene.candidatePairs(0);
  assert.deepEqual([0, 2, 4].map((i) => `${pairs[i]},${pairs[i + 1]}`).sort(), ["0,1", "1,2", "2,3"]);
  assert.deepEqual(Array.from(scene.collide(pairs).answers, (i) => limber.answers[i]), ["yes", "yes", "yes"]);
  const asked = [0, 2, 3, 0, 1, 2], distances = scene.distance(asked), answers = scene.within(asked, 0.6);
  const place = (id) => ({ translation: [0.75 * id, 0, 0] });
  for (let i = 0; i < 3; ++i) {
    const options = { poseA: place(asked[2 * i]), poseB: place(asked[2 * i + 1]) };
    assert.deepEqual(distances.at(i), limber.distance(model, model, options));
    assert.deepEqual([...answers][i], limber.within(model, model, 0.6, options));
  }
  assert.deepEqual([distances.count, distances.uppers[0]], [3, 0.5]);
  assert.equal(limber.distanceStatuses[distances.statuses[0]], "exact");
  assert.equal(scene.collide([]).count, 0);
  const late = scene.distance([0, 2], { budget: { maxSteps: 0 } }), [stopped] = late;
  assert.equal(limber.stoppedBys[late.stoppedBys[0]], "maxSteps");
  assert.deepEqual([stopped.status, stopped.stoppedBy], ["interrupted", "maxSteps"]);
});

test("objects come, move and go, and the closest ones are found", () => {
  const scene = row(4), other = tetrahedron();
  assert.equal(scene.closestObjects().result.status, "collision");
  const ignoredPairs = [0, 1, 2, 1, 2, 3], apart = scene.closestObjects({ ignoredPairs });
  assert.equal(apart.result.upper, 0.5);
  assert.ok(["0,2", "1,3"].includes(apart.objects.join()));
  const limited = scene.closestObjects({ ignoredPairs, maxDistance: 0.25 });
  assert.deepEqual([limited.objects, limited.result.status], [null, "beyondLimit"]);
  scene.remove(1), scene.remove(3);
  assert.equal(scene.size, 2);
  assert.equal(scene.add(Shape.sphere(0.5), { translation: [9, 0, 0] }), 3);
  assert.equal(scene.add(other), 1);
  [5, 3, 7].forEach((x, id) => scene.setPose(id, { translation: [x, 0, 0] }));
  scene.commit();
  assert.deepEqual([...scene.distance([0, 2, 1, 0, 2, 3]).uppers], [1, 1, 0.5]);
  other.moveVertices([1], [1.5, 0, 0]);
  refuses(() => scene.commit(), "invalidArgument", "commit");
  other.commit();
  refuses(() => scene.collide([0, 1]), "invalidArgument", "commit");
  scene.commit();
  assert.equal(scene.distance([0, 1]).uppers[0], 0.5);
});
