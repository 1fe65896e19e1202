// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The JavaScript half: arguments, errors, poses, filters, budgets, memory.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, grid, refuses, tetrahedron } from "./support.js";

/** A sheet of n x n squares in the plane z = 0, over [0, 1] x [0, 1]. */
const sheet = (n, options) => new limber.Model(...grid(n), options);

before(() => limber.init());

test("arrays of every kind make the same model", () => {
  const kinds = [
    [corners, faces],
    [Float32Array.from(corners), Uint32Array.from(faces)],
    [Float64Array.from(corners), Int32Array.from(faces)],
    [Float32Array.from(corners), Uint16Array.from(faces)],
  ];
  for (const arrays of kinds) {
    const model = new limber.Model(...arrays);
    assert.deepEqual([...model.vertices()], corners);
    assert.deepEqual([...model.faces()], faces);
    assert.equal(model.vertexCount, 4);
    assert.equal(model.triangleCount, 4);
  }
});

test("arrays are copied, whatever part of a buffer they are", () => {
  const buffer = new Float32Array([9, 9, ...corners, 9]);
  const model = new limber.Model(buffer.subarray(2, 14), faces);
  buffer.fill(7);
  assert.deepEqual([...model.vertices()], corners);
  model.vertices().fill(5);
  assert.deepEqual([...model.vertices()], corners);
});

test("meshes that are none are refused with code and place", () => {
  refuses(() => new limber.Model([], []), "emptyMesh");
  refuses(() => new limber.Model([0, 0], [0, 1, 2]), "sizeMismatch", "vertices has 2 numbers");
  refuses(() => new limber.Model(corners, [0, 1]), "sizeMismatch", "faces has 2 ids");
  refuses(() => new limber.Model(corners, [0, 1, 4]), "indexOutOfRange", "vertex 4");
  refuses(() => new limber.Model(corners, [0, 1, -1]), "indexOutOfRange", "faces[2] is -1");
  refuses(() => new limber.Model(corners, Int32Array.of(0, -1, 1)), "indexOutOfRange", "faces[1] is -1");
  refuses(() => new limber.Model(corners, [0, 1, 1.5]), "indexOutOfRange", "faces[2] is 1.5");
  refuses(() => new limber.Model([0, 0, 0, 1, 0, NaN, 0, 1, 0], [0, 1, 2]), "nonFinite");
  refuses(() => new limber.Model([0, 0, 0, 1, 0, 1e300, 0, 1, 0], [0, 1, 2]), "tooLarge");
  refuses(() => new limber.Model(new Uint8Array(9), [0, 1, 2]), "invalidArgument", "vertices");
  refuses(() => new limber.Model("abc", [0, 1, 2]), "invalidArgument", "vertices");
  refuses(() => new limber.Model(corners, new Float32Array(3)), "invalidArgument", "faces");
  refuses(() => new limber.Model(corners), "invalidArgument", "faces");
  try {
    new limber.Model([0, 0, 0, 1, 0, Infinity, 0, 1, 0], [0, 1, 2]);
  } catch (error) {
    assert.equal(error.where, 1);
    assert.equal(error.name, "LimberError");
  }
});

test("options of a model are checked", () => {
  for (const motionMargin of [-1, NaN, Infinity, "auto"]) {
    refuses(() => sheet(2, { motionMargin }), "invalidArgument", "motionMargin");
  }
  refuses(() => sheet(2, { rebuildBudgetUs: -1 }), "invalidArgument", "rebuildBudgetUs");
  refuses(() => sheet(2, { rebuildPolicy: "onWorker" }), "invalidArgument", "rebuildPolicy");
  const model = sheet(4, { motionMargin: 0.25, preallocate: true });
  assert.equal(model.maintenanceStats().motionMargin, 0.25);
  refuses(() => model.setMotionMargin(-2), "invalidArgument", "motionMargin");
  model.setMotionMargin(0.5);
  assert.equal(model.maintenanceStats().motionMargin, 0.5);
  refuses(() => model.setMotionMargin("automatic"), "invalidArgument", "motionMargin");
});

test("the rebuild policy reaches the engine", () => {
  const rebuilt = (options) => {
    const model = sheet(40, options), vertices = model.vertices();
    for (let frame = 0; frame < 60; ++frame) {
      for (let i = 0; i < vertices.length; ++i) vertices[i] += 0.3 * Math.sin(i * (frame + 1));
      model.moveAll(vertices);
      model.commit();
    }
    return model.maintenanceStats().rebuiltTriangles;
  };
  assert.ok(rebuilt({}) > 0);
  assert.equal(rebuilt({ rebuildPolicy: "off" }), 0);
  assert.equal(rebuilt({ rebuildBudgetUs: 0 }), 0);
});

test("moves mark, commit() repairs, queries in between are refused", () => {
  const model = sheet(8), other = tetrahedron();
  assert.ok(model.isCommitted);
  model.moveVertices([40], [0.5, 0.5, 3]);
  assert.ok(!model.isCommitted);
  for (const query of [
    () => limber.distance(model, other),
    () => limber.collide(other, model),
    () => limber.within(model, other, 1),
    () => limber.contacts(model, other, 1),
    () => limber.selfCollide(model),
    () => limber.closestPoint(model, [0, 0, 0]),
    () => model.boundingBox(),
    () => model.boundingSphere(),
    () => model.nodeSpheres(0),
  ]) {
    refuses(query, "invalidArgument", "commit");
  }
  model.commit();
  assert.ok(model.isCommitted);
  assert.equal(model.boundingBox().high[2] >= 3, true);
  model.validate();
  refuses(() => model.moveVertices([81], [0, 0, 0]), "indexOutOfRange", "81");
  refuses(() => model.moveVertices([0, 1], [0, 0, 0]), "sizeMismatch");
  refuses(() => model.moveAll([0, 0, 0]), "sizeMismatch");
  assert.ok(model.isCommitted);
  model.rebuild();
});

test("poses of every form mean the same", () => {
  const a = sheet(6), b = tetrahedron();
  const half = Math.SQRT1_2;  // a quarter turn about z
  const quaternion = [0, 0, half, half], translation = [0.3, 0.2, 0.4];
  const matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, ...translation, 1];
  const rotation = [0, 1, 0, -1, 0, 0, 0, 0, 1];
  const [x, y, z] = translation;
  const forms = [
    matrix,
    { elements: matrix },
    Float64Array.from(matrix),
    { rotation, translation },
    { rotation: { elements: rotation }, translation: { x, y, z } },
    { quaternion, translation },
    { quaternion: { x: 0, y: 0, z: 2, w: 2 }, translation: Float32Array.of(x, y, z).map((v) => v) },
  ];
  for (const [i, poseB] of forms.entries()) {
    const { lower, witness } = limber.distance(a, b, { poseB });
    assert.ok(Math.abs(lower - 0.4) < 1e-7, `form ${i}: ${lower}`);
    assert.ok(witness.pointB[0] <= 0.3 + 1e-7 && witness.pointB[1] >= 0.2 - 1e-7, `form ${i}: ${witness.pointB}`);
    assert.equal(limber.distance(b, a, { poseA: poseB }).witness.pointA[2], witness.pointB[2]);
  }
  assert.equal(limber.distance(a, b, { poseB: { translation: [0, 0, 2] } }).upper, 2);
  for (const poseB of [undefined, null]) assert.equal(limber.distance(a, b, { poseB }).upper, 0);
  assert.equal(limber.distance(a, b, { poseA: { translation: [0, 0, 2] } }).witness.pointA[2], 2);
});

test("what is no pose is refused, naming the argument", () => {
  const a = tetrahedron();
  const scaled = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];
  const mirrored = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  refuses(() => limber.distance(a, a, { poseA: scaled }), "notRigid", "poseA");
  refuses(() => limber.distance(a, a, { poseB: { elements: mirrored } }), "notRigid", "poseB");
  refuses(() => limber.distance(a, a, { poseB: { translation: [0, NaN, 0] } }), "nonFinite", "poseB");
  refuses(() => limber.distance(a, a, { poseB: { quaternion: [0, 0, 0, 0] } }), "nonFinite", "poseB");
  refuses(() => limber.distance(a, a, { poseA: [1, 2, 3] }), "invalidArgument", "poseA");
  refuses(() => limber.distance(a, a, { poseA: { rotation: scaled } }), "invalidArgument", "poseA.rotation");
  refuses(() => limber.distance(a, a, { poseA: { quaternion: [0, 1] } }), "invalidArgument", "quaternion");
  refuses(() => limber.distance(a, a, { poseA: {} }), "invalidArgument", "poseA");
  refuses(() => limber.distance(a, a, { poseA: 7 }), "invalidArgument", "poseA");
  refuses(() => limber.distance(a, a, { poseA: { translation: ["1", 0, 0] } }), "invalidArgument", "translation");
  refuses(() => limber.distance(a, a, { poseA: Array(16).fill("1") }), "invalidArgument", "poseA");
  refuses(() => limber.closestPoint(a, [0, 0, 0], { pose: scaled }), "notRigid", "pose: ");
});

test("orthonormalized() makes a rotation of float32 rigid", () => {
  const a = tetrahedron(), angle = 0.7;
  const rotation = Float32Array.of(Math.cos(angle), Math.sin(angle), 0, -Math.sin(angle), Math.cos(angle), 0, 0, 0, 1);
  refuses(() => limber.distance(a, a, { poseB: { rotation } }), "notRigid");
  const rigid = limber.orthonormalized(rotation);
  for (let i = 0; i < 9; ++i) assert.ok(Math.abs(rigid[i] - rotation[i]) < 1e-6);
  assert.equal(limber.collide(a, a, { poseB: { rotation: rigid } }).answer, "yes");
  refuses(() => limber.orthonormalized([1, 0, 0, 0, 1, 0, 0, 0, -1]), "notRigid");
  refuses(() => limber.orthonormalized([1, 0, 0]), "invalidArgument");
});

test("distances, errors and limits", () => {
  const a = sheet(30), b = tetrahedron(), poseB = { translation: [0.2, 0.3, 1.25] };
  const exact = limber.distance(a, b, { poseB });
  assert.equal(exact.status, "exact");
  assert.equal(exact.lower, 1.25);
  assert.equal(exact.upper, 1.25);
  assert.equal(exact.stoppedBy, "nothing");
  assert.ok(exact.stats.nodeTests > 0 && exact.stats.primitiveTests > 0);
  const { lower, upper } = limber.distance(a, b, { poseB, relativeError: 0.5 });
  assert.ok(lower <= 1.25 && upper >= 1.25 && upper <= 1.5 * 1.25);
  assert.ok(limber.distance(a, b, { poseB, absoluteError: 0.1 }).upper <= 1.35);
  const far = limber.distance(a, b, { poseB, maxDistance: 1 });
  assert.deepEqual([far.status, far.witness, far.upper], ["beyondLimit", null, Infinity]);
  assert.ok(far.lower >= 1);
  const met = limber.distance(a, b);
  assert.deepEqual([met.status, met.lower, met.upper], ["collision", 0, 0]);
  refuses(() => limber.distance(a, b, { relativeError: -1 }), "invalidArgument", "relative_error");
  refuses(() => limber.distance(a, b, { relativeError: "much" }), "invalidArgument", "relativeError");
  refuses(() => limber.distance(a, b, { maxDistance: NaN }), "invalidArgument", "max_distance");
  refuses(() => limber.within(a, b), "invalidArgument", "maxDistance");
  assert.deepEqual(limber.within(a, b, 1.3, { poseB }).answer, "yes");
  assert.deepEqual(limber.within(a, b, 1.2, { poseB }).witness, null);
  const yes = limber.collide(a, b), no = limber.collide(a, b, { poseB });
  assert.deepEqual([yes.answer, yes.isYes, yes.isNo], ["yes", true, false]);
  assert.deepEqual([no.answer, no.isYes, no.isNo], ["no", false, true]);
});

test("budgets end queries, and caches go on", () => {
  const a = sheet(60), b = sheet(50), cache = new limber.QueryCache();
  const vertices = b.vertices();
  for (let i = 2; i < vertices.length; i += 3) vertices[i] = 0.1 + 0.01 * Math.sin(i);
  b.moveAll(vertices);
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
  assert.deepEqual(limber.collide(a, b, { budget: {} }).answer, "no");
  assert.deepEqual(limber.within(a, b, 1, { budget: {} }).answer, "yes");
  for (const budget of [{ deadline: NaN }, { maxSteps: -1 }, { maxSteps: "x" }]) {
    refuses(() => limber.distance(a, b, { budget }), "invalidArgument", "budget");
  }
});

test("a deadline is met", () => {
  const a = sheet(120), vertices = a.vertices(), poseB = { translation: [0, 0, 0.4] };
  for (let i = 2; i < vertices.length; i += 3) vertices[i] = 1e-9 * ((i * 7919) % 101);
  a.moveAll(vertices);
  a.commit();
  const timed = (budget) => {  // everything is about as far as everything else
    const start = performance.now();
    return [limber.distance(a, a, { poseB, budget: budget(start) }).status, performance.now() - start];
  };
  const [status, whole] = timed(() => ({}));
  assert.equal(status, "exact");
  const [interrupted, took] = timed((start) => ({ deadline: start + whole / 20 }));
  assert.equal(interrupted, "interrupted");
  assert.ok(took >= whole / 20 && took < whole / 2, `${took} ms of ${whole}`);
});

test("contacts and pairs of triangles", () => {
  const a = sheet(10), b = tetrahedron(), poseB = { translation: [0.35, 0.35, -0.5] };
  const pairs = limber.intersections(a, b, { poseB });
  assert.equal(pairs.triangles.length, 2 * pairs.count);
  assert.ok(pairs.count > 0 && pairs.isComplete);
  const close = limber.contacts(a, b, 0.05, { poseB });
  const meeting = [...close].filter((contact) => contact.distance === 0);
  assert.equal(meeting.length, pairs.count);
  assert.ok(close.count > pairs.count);
  for (const { depth, distance, normal, triangleA, featureA } of close) {
    assert.ok(distance === 0 ? depth >= 0 : depth === 0);
    assert.ok(Math.abs(Math.hypot(...normal) - 1) < 1e-12);
    assert.ok(triangleA < a.triangleCount && ["vertex", "edge", "face"].includes(featureA.kind));
  }
  const some = limber.contacts(a, b, 0.05, { poseB, maxCount: 2 });
  assert.deepEqual([some.count, some.isComplete], [2, false]);
  assert.deepEqual(some.at(1), close.at(1));
  for (const side of ["A", "B"]) {
    const kind = limber.featureKinds[close[`features${side}`][2]], index = close[`features${side}`][3];
    assert.deepEqual(close.at(1)[`feature${side}`], { kind, index });
  }
  assert.ok(close.isComplete && limber.intersections(a, b, { poseB, maxCount: pairs.count }).isComplete);
  refuses(() => close.at(close.count), "invalidArgument");
  for (const contact of limber.contacts(a, b, 0, { poseB, orientedFaces: "none" })) {
    assert.equal(contact.normalSide, "unknown");
  }
  const ways = [...limber.contacts(a, b, 0, { poseB, orientedFaces: "both" })].map((contact) => contact.normalSide);
  assert.ok(ways.includes("outward") && !ways.includes("inward"));
  for (const orientedFaces of ["a", 1, null]) {
    refuses(() => limber.contacts(a, b, 0, { orientedFaces }), "invalidArgument", "orientedFaces");
  }
  refuses(() => limber.contacts(a, b, -1), "invalidArgument", "margin");
  const nearest = limber.closestPairs(a, b, 7, { poseB: { translation: [0, 0, 1] } });
  assert.equal(nearest.count, 7);
  assert.ok(nearest.distances.every((d, i) => i === 0 || d >= nearest.distances[i - 1]));
  assert.equal(limber.closestPairs(b, b, 1e9).count, 16);
  assert.equal(limber.closestPairs(a, b, 0).count, 0);
  refuses(() => limber.closestPairs(a, b, NaN), "invalidArgument", "count");
});

test("filters decide which pairs count", () => {
  const a = sheet(10), b = tetrahedron(), poseB = { translation: [0.35, 0.35, -0.5] };
  const all = limber.intersections(a, b, { poseB }).count;
  const ofFace3 = limber.intersections(a, b, { poseB, filter: (s, t) => t === 3 });
  assert.ok(ofFace3.count > 0 && ofFace3.count < all);
  assert.ok(ofFace3.triangles.every((id, i) => i % 2 === 0 || id === 3));
  const mine = new Error("mine");
  const throwing = () => {
    throw mine;
  };
  assert.throws(() => limber.contacts(a, b, 1, { poseB, filter: throwing }), (error) => error === mine);
  refuses(() => limber.contacts(a, b, 1, { filter: () => limber.collide(a, b) }), "busy", "filter");
  refuses(() => limber.contacts(a, b, 1, { filter: () => a.dispose() }), "busy", "filter");
  for (const filter of [3, new limber.NeighborRings(a, 0)]) {
    refuses(() => limber.contacts(a, b, 1, { filter }), "invalidArgument", "filter");
    refuses(() => limber.intersections(a, b, { filter }), "invalidArgument", "filter");
    refuses(() => limber.closestPairs(a, b, 1, { filter }), "invalidArgument", "filter");
  }
  refuses(() => limber.selfContacts(a, 1, { filter: 3 }), "invalidArgument", "filter");
  assert.equal(limber.intersections(a, b, { poseB }).count, all, "queries must work again after a filter has thrown");
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
  const pairs = limber.selfIntersections(a), close = limber.selfContacts(a, 0.01);
  assert.ok(pairs.count > 0 && close.count >= pairs.count);
  const far = limber.selfContacts(a, 0.01, { filter: new limber.NeighborRings(a, 30) });
  assert.equal(far.count, 0);
  assert.equal(limber.selfClosestPairs(a, 3).count, 3);
  refuses(() => new limber.NeighborRings(a, -1), "invalidArgument", "maxEdges");
  const rings = new limber.NeighborRings(tetrahedron(), 0);
  refuses(() => limber.selfContacts(a, 0.01, { filter: rings }), "invalidArgument");
});

test("points", () => {
  const a = tetrahedron(), pose = { translation: [10, 0, 0] };
  const { closest: near, stats } = limber.closestPoint(a, [10.25, 0.25, -2], { pose });
  assert.ok(stats.nodeTests === 0 && stats.primitiveTests > 0);
  assert.deepEqual([near.distance, near.position, near.feature], [2, [10.25, 0.25, 0], { kind: "face", index: 0 }]);
  assert.ok(Math.abs(near.weights.reduce((sum, weight) => sum + weight) - 1) < 1e-12);
  assert.equal(limber.closestPoint(a, { x: 0, y: 0, z: 0 }, { pose, maxDistance: 1 }).closest, null);
  const many = limber.closestPointMany(a, Float32Array.of(0, 0, -3, 0.1, 0.1, 0.1), { maxDistance: 2 });
  assert.ok(many instanceof limber.PointResults);
  assert.deepEqual([many.count, many.at(0).closest, many.distances[0]], [2, null, Infinity]);
  assert.deepEqual([many.triangles[0], limber.noId], [limber.noId, 0xffffffff]);
  assert.deepEqual([...many][1], many.at(1));
  const { closest: second } = many.at(1), kind = limber.featureKinds.indexOf(second.feature.kind);
  assert.ok(second.distance > 0 && many.at(1).stats.nodeTests === many.nodeTests[1] && many.primitiveTests[1] > 0);
  assert.deepEqual([...many.features.subarray(2)], [kind, second.feature.index]);
  refuses(() => limber.closestPoint(a, [0, 0]), "invalidArgument", "point");
  refuses(() => limber.closestPoint(a, [0, 0, NaN]), "invalidArgument", "point");
  refuses(() => limber.closestPointMany(a, [0, 0]), "sizeMismatch", "points");
  const surface = new limber.ClosedSurface(a);
  assert.ok(surface.contains([0.1, 0.1, 0.1]) && !surface.contains([0.1, 0.1, 0.1], { pose }));
  const { distance, isInside, closest } = surface.signedDistance([0.1, 0.1, 0.2]);
  assert.ok(isInside && distance < 0 && closest.distance === -distance);
  const outside = surface.signedDistance([3, 3, 3]);
  assert.ok(outside.distance > 0 && !outside.isInside && outside.stats.primitiveTests > 0);
  const signed = surface.signedDistanceMany([0.1, 0.1, 0.1, 3, 3, 3, 0, 0, 0], { maxDistance: 0.01 });
  assert.ok(signed instanceof limber.SignedDistances && signed instanceof limber.PointResults);
  assert.deepEqual([...signed.insides], [1, 0, 1]);
  assert.deepEqual([...signed.distances], [Infinity, Infinity, 0]);
  assert.deepEqual([...signed].map((one) => [one.isInside, one.distance, one.closest?.distance]),
    [[true, Infinity, undefined], [false, Infinity, undefined], [true, 0, 0]]);
  refuses(() => signed.at(3), "invalidArgument", "no point 3 of 3");
  refuses(() => new limber.ClosedSurface(sheet(3)), "notClosed", "edge");
  a.dispose();
  refuses(() => surface.contains([0, 0, 0]), "disposed", "model");
  surface.dispose();
});

test("levels of spheres, to draw the tree", () => {
  const a = sheet(30), { levels, nodes, leaves } = a.treeStats();
  let count = 0;
  for (let level = 0; level < levels; ++level) count += a.nodeSpheres(level).length / 4;
  assert.equal(count, nodes);
  assert.equal(a.nodeSpheres(levels - 1).length / 4, leaves);
  const { center, radius } = a.boundingSphere();
  assert.deepEqual([...a.nodeSpheres(0)], [...center, radius]);
  for (const level of [levels, -1, NaN, 1e12]) refuses(() => a.nodeSpheres(level), "invalidArgument", "level");
});

test("mesh files in memory", () => {
  const bytes = new TextEncoder().encode("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1 2 3 4\n");
  for (const given of [bytes, bytes.buffer]) {
    const file = limber.readMeshBytes(given, "a folder/square.obj");
    assert.deepEqual([...file.vertices], [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5]);
    assert.deepEqual([...file.faces], [0, 1, 2, 0, 2, 3]);
    assert.deepEqual([[...file.faceOfTriangle], file.faceCount], [[0, 0], 1]);
  }
  refuses(() => limber.readMeshBytes(bytes, "square.xyz"), "unsupportedFormat", "square.xyz");
  refuses(() => limber.readMeshBytes(bytes, "square.stl"), "malformedFile");
  refuses(() => limber.readMeshBytes(new Uint8Array(0), "none.obj"), "malformedFile", "none.obj: is empty");
  refuses(() => limber.readMeshBytes("text", "none.obj"), "invalidArgument", "bytes");
});

test("names of numbers cannot be changed, and nothing inside of objects is reachable", () => {
  const names = Object.entries(limber).filter(([, value]) => Array.isArray(value));
  assert.deepEqual(names.map(([name]) => name).sort(), ["answers", "distanceStatuses", "elementPairKinds",
    "featureKinds", "impactStatuses", "normalSides", "stoppedBys"]);
  for (const [name, value] of names) assert.ok(Object.isFrozen(value), name);
  for (const type of [limber.Model, limber.MovingModel, limber.ClosedSurface]) assert.ok(!("addressOf" in type));
  const scene = new limber.Scene();
  scene.commit();
  const distances = scene.distance([]), answers = scene.collide([]);
  const shared = ["count", "nodeTests", "objects", "pointsA", "pointsB", "stoppedBys", "primitiveTests", "trianglesA",
    "trianglesB"];
  assert.deepEqual(Object.keys(distances).sort(), ["lowers", "statuses", "uppers", ...shared].sort());
  assert.deepEqual(Object.keys(answers).sort(), ["answers", ...shared].sort());
});

test("what is not of this package is refused", () => {
  const a = tetrahedron(), cache = new limber.QueryCache();
  for (const wrong of [undefined, null, {}, 5, cache, Object.create(limber.Model.prototype)]) {
    refuses(() => limber.distance(a, wrong), "invalidArgument", "b is");
    refuses(() => limber.collide(wrong, a), "invalidArgument", "a is");
    refuses(() => limber.selfCollide(wrong), "invalidArgument", "model is");
  }
  for (const wrong of [a, {}, 1]) refuses(() => limber.distance(a, a, { cache: wrong }), "invalidArgument", "cache");
});

test("what has been disposed of is refused, and disposing again does nothing", () => {
  const a = tetrahedron(), b = tetrahedron(), cache = new limber.QueryCache();
  const rings = new limber.NeighborRings(b, 0);
  for (const owner of [a, cache, rings]) {
    assert.ok(!owner.isDisposed);
    owner.dispose();
    owner.dispose();
    assert.ok(owner.isDisposed);
  }
  for (const use of [
    () => limber.distance(a, b),
    () => limber.distance(b, b, { cache }),
    () => limber.selfContacts(b, 1, { filter: rings }),
    () => a.commit(),
    () => a.moveAll(corners),
    () => a.vertices(),
    () => a.isCommitted,
    () => cache.clear(),
  ]) {
    refuses(use, "disposed");
  }
});
