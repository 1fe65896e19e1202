// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How the module is loaded, and that nothing leaks in it. The tests depend on their order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { test } from "node:test";
import { setFlagsFromString } from "node:v8";
import { runInNewContext } from "node:vm";
import { engine } from "../limber3d/wasm.js";
import * as limber from "limber3d";
import { grid, tetrahedron } from "./support.js";

const isNotInitialized = { name: "LimberError", code: "notInitialized", message: /init\(\)/ };
const bytesOfFile = () => readFileSync(new URL("../limber3d/limber.wasm", import.meta.url));

test("nothing works before init()", () => {
  assert.throws(tetrahedron, isNotInitialized);
  assert.throws(() => new limber.Scene(), isNotInitialized);
});

test("init() fails as its source does, and may be repeated", async () => {
  await assert.rejects(limber.init(new Uint8Array([1, 2, 3])), WebAssembly.CompileError);
  await limber.init(await WebAssembly.compile(bytesOfFile()));
  const model = tetrahedron();
  await limber.init();
  assert.equal(model.vertices().length, 12, "a second init() must leave the first one alone");
});

test("the module is fetched, whatever its type", async () => {
  const bytes = bytesOfFile();
  const server = createServer((request, response) => {
    const types = { "/typed.wasm": "application/wasm", "/page.wasm": "text/html; charset=utf-8" };
    const type = types[request.url] ?? "application/octet-stream";
    response.writeHead(request.url === "/missing.wasm" ? 404 : 200, { "Content-Type": type, Connection: "close" });
    response.end(bytes);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const address = `http://127.0.0.1:${server.address().port}`;
  try {
    for (const name of ["typed", "plain"]) {
      const { engine, init } = await import(`../limber3d/wasm.js?${name}`);  // an instance of its own
      await assert.rejects(init(`${address}/missing.wasm`), { code: "unreadableFile", message: /missing.wasm: 404/ });
      await assert.rejects(init(`${address}/page.wasm`), { code: "unreadableFile", message: /page.wasm: a page of/ });
      assert.throws(engine, isNotInitialized);
      await init(new URL(`${address}/${name}.wasm`));
      assert.ok(engine().exchange() > 0);
    }
    const { init } = await import("../limber3d/wasm.js?response");
    await init(await fetch(`${address}/typed.wasm`));
  } finally {
    server.close();
  }
});

// --- memory ---

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

test("calls take no memory", () => {
  const [vertices, faces] = roughSheet(6);
  const model = new limber.Model(vertices, faces), other = new limber.Model(vertices, faces);
  const cache = new limber.QueryCache(), options = { poseB: { translation: [0, 0, 3] }, cache };
  staysFlat(100_000, () => limber.distance(model, other, options));
  staysFlat(100_000, () => limber.collide(model, other, options));
  staysFlat(100_000, () => limber.closestPoint(model, [1, 2, 9]));
  staysFlat(100_000, (i) => {
    vertices[2] = Math.sin(i);
    model.moveVertices([0], vertices.subarray(0, 3));
    model.commit();
  });
  staysFlat(10_000, () => limber.contacts(model, other, 0.1, { poseB: { translation: [0.1, 0.1, 0.1] } }));
  staysFlat(10_000, () => limber.selfContacts(model, 0.3));
  const moving = new limber.MovingModel(model), motionB = new limber.RigidMotion({ translation: [0, 0, 3] }, null);
  staysFlat(5000, () => {
    moving.setMotion(vertices);
    limber.selfTimeOfImpact(moving);
  });
  staysFlat(2000, () => limber.timeOfImpact(model, other, { motionB, minSeparation: 1 }));
  const scene = new limber.Scene();
  for (let i = 0; i < 6; ++i) scene.add(i % 2 === 0 ? model : other, { translation: [0.5 * i, 0, 0] });
  staysFlat(2000, (i) => {
    scene.setPose(2, { translation: [Math.sin(i), 0, 0.5] });
    scene.commit();
    scene.distance(scene.candidatePairs(0.5));
    scene.closestObjects({ ignoredPairs: [0, 1] });
  });
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
});

test("disposed objects leave nothing behind", () => {
  const [vertices, faces] = roughSheet(30), ball = tetrahedron();
  staysFlat(3000, () => {
    const model = new limber.Model(vertices, faces), rings = new limber.NeighborRings(model, 1);
    const moving = new limber.MovingModel(model), motion = new limber.RigidMotion(null, null);
    const scene = new limber.Scene(), hull = limber.Shape.convexHull(vertices.subarray(0, 12));
    const cache = new limber.QueryCache(), closed = new limber.ClosedSurface(ball);
    limber.collide(model, model, { cache });
    moving.setMotion(vertices);
    scene.add(model);
    for (const owner of [scene, hull, rings, cache, closed, moving, motion, model]) owner.dispose();
  });
});

test("what is no longer reachable is freed, and what is used is kept", async () => {
  setFlagsFromString("--expose-gc");
  const collectGarbage = runInNewContext("gc");
  const finalized = () => new Promise((resolve) => setTimeout(resolve, 5));  // finalizers run between tasks
  const [vertices, faces] = roughSheet(40);
  const moving = new limber.MovingModel(new limber.Model(vertices, faces)), scene = new limber.Scene();
  moving.setMotion(vertices.map((x) => 2 * x));
  for (let i = 0; i < 2; ++i) scene.add(new limber.Model(vertices, faces), { translation: [0, 0, 9 * i] });
  scene.commit();
  const { status } = limber.selfTimeOfImpact(moving), { upper } = scene.closestObjects().result;
  const bytes = [];
  for (let round = 0; round < 8; ++round) {
    for (let i = 0; i < 20; ++i) new limber.Model(vertices.map((x) => x + i), faces);  // where freed models were
    collectGarbage();
    await finalized();
    bytes.push(bytesOfModule());
  }
  assert.equal(bytes[7], bytes[2], `${bytes}`);
  assert.equal(limber.selfTimeOfImpact(moving).status, status);
  assert.deepEqual(moving.model.vertices(), Float64Array.from(vertices));
  assert.equal(scene.closestObjects().result.upper, upper);
});

test("too much memory is an error, and the engine goes on", () => {
  const model = tetrahedron();
  for (const byteLength of [3e9, 2 ** 32 - 8, 2 ** 32, 2 ** 33 + 8]) {
    const vertices = new Float64Array(0);  // no such array is needed to ask for its room
    Object.defineProperty(vertices, "byteLength", { value: byteLength });
    assert.throws(() => model.moveAll(vertices), { name: "LimberError", code: "outOfMemory" });
  }
  assert.equal(limber.collide(model, model).answer, "yes");
});
