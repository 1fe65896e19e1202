// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Nothing leaks in the module: whatever is called again and again, its memory stays as large as it was.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { setFlagsFromString } from "node:v8";
import { runInNewContext } from "node:vm";
import { engine } from "../limber3d/wasm.js";
import * as limber from "limber3d";
import { grid, tetrahedron } from "./support.js";

before(() => limber.init());

const bytesOfModule = () => engine().memory.buffer.byteLength;

/** Repeats `body` often; the memory may grow in the first tenth only. */
function staysFlat(times, body) {
  let before = 0;
  for (let i = 0; i < times; ++i) {
    if (i === Math.ceil(times / 10)) before = bytesOfModule();
    body(i);
  }
  assert.ok(before > 0);
  assert.equal(bytesOfModule(), before);
}

/** A sheet that is not flat. */
const roughSheet = (n) => grid(n, Math.sin);

test("100 000 calls of each kind take no memory", () => {
  const [vertices, faces] = roughSheet(6);
  const model = new limber.Model(vertices, faces), other = new limber.Model(vertices, faces);
  const cache = new limber.QueryCache(), options = { poseB: { translation: [0, 0, 3] }, cache };
  staysFlat(100_000, () => limber.distance(model, other, options));
  staysFlat(100_000, () => limber.collide(model, other, options));
  staysFlat(100_000, () => limber.closestPoint(model, [1, 2, 9]));
  staysFlat(100_000, () => model.nodeSpheres(1));
  staysFlat(100_000, (i) => {
    vertices[2] = Math.sin(i);
    model.moveVertices([0], vertices.subarray(0, 3));
    model.commit();
  });
  staysFlat(10_000, () => limber.contacts(model, other, 0.1, { poseB: { translation: [0.1, 0.1, 0.1] } }));
  staysFlat(10_000, () => limber.selfContacts(model, 0.3));
});

test("calls about motions take no memory", () => {
  const [vertices, faces] = roughSheet(6);
  const model = new limber.Model(vertices, faces), other = new limber.Model(vertices, faces);
  const moving = new limber.MovingModel(model), motionB = new limber.RigidMotion({ translation: [0, 0, 3] }, null);
  staysFlat(5000, () => {
    moving.setMotion(vertices);
    limber.selfTimeOfImpact(moving);
  });
  staysFlat(1000, () => limber.selfImpacts(moving, { minSeparation: 0.3, timeError: 0.1 }));
  // All in one plane, with few digits in common: for exact arithmetic, which allocates.
  const start = [0, 0, 0, 2 ** -90, 1, 0, 1 / 3, -1, 0, 3, 1, 0];
  const end = start.map((x, i) => (i % 3 === 2 ? 0 : i < 3 ? 1 / 7 : -x));
  staysFlat(5000, () => limber.vertexFaceImpact(start, end));
  staysFlat(2000, () => limber.timeOfImpact(model, other, { motionB, minSeparation: 1 }));
});

test("errors take no memory", () => {
  const [vertices, faces] = roughSheet(20);
  const model = new limber.Model(vertices, faces), bad = vertices.slice();
  bad[500] = NaN;
  const throws = (body) => assert.throws(body, limber.LimberError);
  staysFlat(2000, () => throws(() => new limber.Model(bad, faces)));
  staysFlat(20_000, () => throws(() => model.moveAll(bad)));
  staysFlat(2000, () => throws(() => new limber.ClosedSurface(model)));
  staysFlat(5000, () => throws(() => limber.distance(model, model, { relativeError: -1 })));
  const error = new Error("of the filter");
  const filter = () => {
    throw error;
  };
  staysFlat(5000, () => assert.throws(() => limber.contacts(model, model, 1, { filter }), error));
  const file = new TextEncoder().encode("v 0 0 0\nf 1 2 999\n".repeat(100));
  staysFlat(2000, () => throws(() => limber.readMeshBytes(file, "bad.obj")));
});

test("disposed objects leave nothing behind", () => {
  const [vertices, faces] = roughSheet(30);
  staysFlat(3000, () => {
    const model = new limber.Model(vertices, faces, { preallocate: true });
    const cache = new limber.QueryCache(), rings = new limber.NeighborRings(model, 1);
    model.moveAll(vertices);
    model.commit();
    limber.collide(model, model, { cache });
    const moving = new limber.MovingModel(model), motion = limber.RigidMotion.screw(null, null);
    moving.setMotion(vertices);
    for (const owner of [rings, cache, moving, motion, model]) owner.dispose();
  });
});

test("calls about bodies and scenes take no memory", () => {
  const [vertices, faces] = roughSheet(6);
  const model = new limber.Model(vertices, faces), ball = tetrahedron(), surface = new limber.ClosedSurface(ball);
  const poseB = { translation: [0.2, 0.1, 0.3] };
  staysFlat(2000, () => limber.solidRelation(surface, surface, { poseB }));
  staysFlat(500, () => limber.signedDistance(surface, surface, { poseB }));
  staysFlat(2000, () => limber.weld(vertices, faces));
  const scene = new limber.Scene(), cache = new limber.SceneCache();
  for (let i = 0; i < 6; ++i) scene.add(i % 2 === 0 ? model : ball, { translation: [0.5 * i, 0, 0] });
  const poses = Array.from({ length: 16 }, (_, i) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, i / 4, 0, 0, 1]).flat();
  staysFlat(2000, (i) => {
    scene.setPose(2, { translation: [Math.sin(i), 0, 0.5] });
    scene.commit();
    scene.distance(scene.candidatePairs(0.5), { cache });
    scene.contacts([0, 1, 2, 3], 0.2);
    scene.closestObject(ball, { filter: (id) => id > 0 });
    scene.closestObjects({ filter: (a, b) => b - a > 1 });
    scene.anyWithinMany([1, 4], poses, 0.1);
  });
  staysFlat(5000, () => limber.Shape.pointCloud(vertices, 0.1).dispose());
  staysFlat(5000, () => {
    const passing = new limber.Scene(), matrix = new limber.ObjectPairMatrix(500);
    passing.add(model);
    passing.dispose(), matrix.dispose();
  });
});

test("what is no longer reachable is freed", async () => {
  setFlagsFromString("--expose-gc");
  const collectGarbage = runInNewContext("gc");
  const [vertices, faces] = roughSheet(40);
  const bytes = [];
  for (let round = 0; round < 8; ++round) {
    for (let i = 0; i < 20; ++i) new limber.Model(vertices, faces);
    collectGarbage();
    await new Promise((resolve) => setTimeout(resolve, 5));  // finalizers run between tasks
    bytes.push(bytesOfModule());
  }
  assert.equal(bytes[7], bytes[2], `${bytes}`);
});

test("a moving model keeps its model", async () => {
  setFlagsFromString("--expose-gc");
  const collectGarbage = runInNewContext("gc");
  const [vertices, faces] = roughSheet(20);
  const moving = new limber.MovingModel(new limber.Model(vertices, faces));
  moving.setMotion(vertices.map((x) => 2 * x));
  const { status } = limber.selfTimeOfImpact(moving);
  collectGarbage();
  await new Promise((resolve) => setTimeout(resolve, 5));
  for (let i = 0; i < 5; ++i) new limber.Model(vertices.map((x) => x + i), faces);  // would be where it was
  assert.equal(limber.selfTimeOfImpact(moving).status, status);
  assert.deepEqual(moving.model.vertices(), Float64Array.from(vertices));
});

test("a scene keeps its models", async () => {
  setFlagsFromString("--expose-gc");
  const collectGarbage = runInNewContext("gc");
  const [vertices, faces] = roughSheet(20), scene = new limber.Scene();
  for (let i = 0; i < 2; ++i) scene.add(new limber.Model(vertices, faces), { translation: [0, 0, 9 * i] });
  scene.commit();
  const { upper } = scene.closestObjects().result;
  collectGarbage();
  await new Promise((resolve) => setTimeout(resolve, 5));
  for (let i = 0; i < 5; ++i) new limber.Model(vertices.map((x) => x + i), faces);  // would be where they were
  assert.equal(scene.closestObjects().result.upper, upper);
  assert.deepEqual(scene.model(1).vertices(), Float64Array.from(vertices));
});

test("too much memory is an error, and the engine goes on", () => {
  const [vertices, faces] = roughSheet(10);
  const model = new limber.Model(vertices, faces);
  for (const length of [3e9, 2 ** 32 - 8, 2 ** 32, 2 ** 33 + 5]) {
    const file = new Uint8Array(0);
    Object.defineProperty(file, "length", { value: length });  // no such array is needed to ask for its room
    assert.throws(() => limber.readMeshBytes(file, "large.obj"), { name: "LimberError", code: "outOfMemory" });
  }
  assert.equal(limber.collide(model, model).answer, "yes");
});
